#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "stator/link/system/background_output.hpp"
#include "stator/replay/recording_format.hpp"
#include "stator/replay/regular_file.hpp"

namespace stator::replay {

/// Writes the chunks of a recording in a thread of its own. A recording has no holes: when the disk
/// does not keep up until the queue is full and nobody may wait for it (link::WhenFull::drop), or
/// when it is full itself, the file ends with the last chunk that was written, and says so.
class RecordingFile {
 public:
  /// Bytes that wait for the disk at most.
  static constexpr std::size_t kQueue = std::size_t{32} << 20U;
  using Chunk = std::vector<std::byte>;

  /// Creates the file, which has its name once the header is in it. Throws std::runtime_error
  /// naming the file and the reason.
  RecordingFile(const std::string& path, const RecordingHeader& header);
  RecordingFile(const RecordingFile&) = delete;
  RecordingFile& operator=(const RecordingFile&) = delete;

  // For whoever records.

  /// An empty buffer with room for kMaximumChunk; null: the file has ended. Until it is written
  /// there is no other.
  [[nodiscard]] Chunk* take_empty();
  /// Gives it to be written.
  void write(Chunk& chunk);
  /// Waits until everything handed over is in the file, as output().finish() does.
  void finish(link::BackgroundOutput::Clock::time_point asked);

  // For any thread.

  [[nodiscard]] std::uint64_t bytes() const { return head_ + output_->bytes(); }
  /// Nothing is missing: every chunk so far is in the file or waits to be written.
  [[nodiscard]] bool good() const { return output_->complete(); }
  [[nodiscard]] link::BackgroundOutput& output() { return *output_; }

 private:
  NewFile file_;
  std::uint64_t head_ = 0;  ///< bytes of the file's beginning
  Chunk chunk_;
  std::unique_ptr<link::BackgroundOutput> output_;
};

}  // namespace stator::replay
