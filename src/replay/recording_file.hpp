#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "rack/hand_over_queue.hpp"
#include "replay/recording_format.hpp"
#include "replay/regular_file.hpp"

namespace stator::replay {

/// Writes the chunks of a recording in a thread of its own. Who hands one over never waits: when
/// the disk does not keep up until all buffers are full, or when it is full itself, the file ends
/// with the last chunk that was written, and says so.
class RecordingFile {
 public:
  /// Chunks that wait for the disk at most: 32 MiB.
  static constexpr std::size_t kChunks = 128;
  using Chunk = std::vector<std::byte>;

  /// Creates the file, which has its name once the header is in it. Throws std::runtime_error
  /// naming the file and the reason.
  RecordingFile(const std::string& path, const RecordingHeader& header);
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;
  /// Writes what waits.
  ~RecordingFile();

  // For whoever records.

  /// An empty buffer with room for kMaximumChunk; null: none is free, or the file has failed.
  [[nodiscard]] Chunk* take_empty();
  /// Gives a filled buffer to be written.
  void write(Chunk& chunk);

  // For any thread.

  /// Waits until everything handed over is in the file.
  void finish();
  [[nodiscard]] std::uint64_t bytes() const { return bytes_.load(std::memory_order_relaxed); }
  /// Everything was written so far.
  [[nodiscard]] bool good() const { return !failed_.load(std::memory_order_acquire); }

 private:
  void run();
  bool append(std::span<const std::byte> content);

  NewFile file_;
  std::vector<Chunk> chunks_;
  rack::HandOverQueue<Chunk*, kChunks> empty_;
  rack::HandOverQueue<Chunk*, kChunks> full_;
  std::atomic<std::uint64_t> bytes_{0};
  std::atomic<bool> failed_{false};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace stator::replay
