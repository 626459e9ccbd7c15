#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <thread>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

/// What becomes of a record for which there is no room.
enum class WhenFull : std::uint8_t {
  wait,  ///< the writer waits: nothing is missing, and simulated time stands still meanwhile
  drop,  ///< it is lost and counted: the writer answers masters and must not wait
};

/// A file, FIFO, pipe or terminal that a thread of its own writes, so that its callers do not wait
/// for a disk or a reader. In between is a queue of bytes of fixed length; records fit in as a
/// whole or are lost as a whole. After a loss nothing is taken before the queue is half empty, so
/// that gaps are few.
///
/// A FIFO is opened when a reader comes. Where this opens files and FIFOs itself, no slow reader
/// stops the thread for ever. Where the system makes it wait nevertheless (a disk that has stopped,
/// a terminal that others fill at the same moment), the thread is left behind.
class BackgroundOutput {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::size_t kCapacity = std::size_t{4} << 20U;
  /// In the end a reader is given up that has taken nothing for this long.
  static constexpr std::chrono::milliseconds kPatience{400};
  /// In the end a reader that takes a little again and again is given up after this time.
  static constexpr std::chrono::milliseconds kLongestEnd{10'000};

  /// Creates the file, or replaces its content, and writes `head`. Waits (WhenFull::wait) until
  /// told otherwise. The error names the file and the reason.
  static base::Expected<std::unique_ptr<BackgroundOutput>, LinkError> create(
      const std::string& path, std::span<const std::byte> head = {},
      std::size_t capacity = kCapacity);
  /// Writes to a copy of `descriptor`, which others may use as well; `name` is what errors call it.
  static std::unique_ptr<BackgroundOutput> onto(int descriptor, std::string name,
                                                std::size_t capacity = kCapacity);
  /// As stop_waiting() and finish().
  ~BackgroundOutput();
  BackgroundOutput(const BackgroundOutput&) = delete;
  BackgroundOutput& operator=(const BackgroundOutput&) = delete;

  // For one thread at a time.

  /// Appends a record, `first` and then `second`. False: it is lost.
  bool write(std::span<const std::byte> first, std::span<const std::byte> second = {});
  bool write(std::string_view text) { return write(std::as_bytes(std::span(text))); }
  /// Waits until everything is taken: without limit with WhenFull::wait unless stop_waiting() was
  /// called, else until kPatience has passed since `asked` and since bytes were last taken, or
  /// `longest` since `asked`. A reader that was given up and has taken nothing since is not waited
  /// for again. False: something is left.
  bool drain(Clock::time_point asked = Clock::now(),
             std::chrono::milliseconds longest = kLongestEnd);
  /// Drains, then closes the file; may be called twice.
  void finish(Clock::time_point asked = Clock::now(),
              std::chrono::milliseconds longest = kLongestEnd);

  // For any thread.

  void set_when_full(WhenFull when_full) { when_full_ = when_full; }
  /// The run is being ended: a write that waits, and each after it, gives up kPatience after bytes
  /// were last taken.
  void stop_waiting();

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Records that found room, and those that did not.
  [[nodiscard]] std::uint64_t records() const { return records_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }
  /// Bytes that have been written.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Bytes that wait; after finish() those that nobody took.
  [[nodiscard]] std::size_t waiting() const;
  /// Why nothing can be written any more; nothing: it can.
  [[nodiscard]] std::optional<LinkError> error() const;
  /// It was a pipe or FIFO whose reader has gone: nobody wants any more.
  [[nodiscard]] bool reader_has_gone() const;
  /// Something is lost, or nothing can be written any more.
  [[nodiscard]] bool in_trouble() const;
  /// Nothing of what was written so far is missing to a reader.
  [[nodiscard]] bool complete() const;
  /// "3 of 1200 rows are missing, because they were not taken in time", after finish(); empty if
  /// nothing is missing to a reader. `records`: the word for them, here "rows".
  [[nodiscard]] std::string what_is_missing(const std::string& records) const;

 private:
  struct Shared;

  BackgroundOutput(std::string name, std::shared_ptr<Shared> shared);
  [[nodiscard]] bool make_room(std::size_t size);
  [[nodiscard]] bool gives_up(Clock::time_point asked, std::chrono::milliseconds longest);
  [[nodiscard]] std::size_t room() const;
  void put(std::span<const std::byte> bytes, std::size_t at);

  std::string name_;
  std::shared_ptr<Shared> shared_;  ///< with a thread that may have to be left behind
  std::thread thread_;
  std::atomic<WhenFull> when_full_{WhenFull::wait};
  std::atomic<Clock::rep> stopped_{0};  ///< when stop_waiting() was called
  std::atomic<std::uint64_t> records_{0};
  std::atomic<std::uint64_t> lost_{0};
  bool losing_ = false;
  std::optional<std::size_t> stuck_at_;  ///< what was taken when drain() gave up
};

/// Writes `text` to `descriptor` unless nobody takes it within `longest`: last words of a program.
void write_within(int descriptor, std::string_view text,
                  std::chrono::milliseconds longest = BackgroundOutput::kPatience);

}  // namespace stator::link
