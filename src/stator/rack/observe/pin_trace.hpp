#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/board/lines/logic_trace.hpp"
#include "stator/board/lines/vcd.hpp"
#include "stator/link/system/background_output.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/observe/trace_configuration.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::rack {

/// A logic analyser at the pins of one chip, which writes a value change dump while the rack runs:
/// a queue of fixed length and a thread of its own, since no bus can wait for a disk.
///
/// What finds no room in the queue is counted, and the lines concerned are unknown ("x") in the
/// file from there on until there is room again. In lockstep nobody waits for the machine's clock;
/// there time waits for the queue instead, so that equal runs give equal files, until the file does
/// not move although the end has come.
class PinTrace {
 public:
  /// Opens the file and begins at once. Throws std::runtime_error for a file that cannot be written
  /// or pins that do not exist. The chip must not be advanced after the trace has ended its life.
  PinTrace(const product::TracedPins& pins, const TraceConfiguration& configuration,
           ClockKind clock);
  ~PinTrace();
  PinTrace(const PinTrace&) = delete;
  PinTrace& operator=(const PinTrace&) = delete;

  /// Writes what is left, up to `now`, and closes the file. Nobody advances the chip meanwhile;
  /// what comes later is not recorded. `asked`: as in OutputFiles::finish().
  void finish(base::SimTime now, link::BackgroundOutput::Clock::time_point asked =
                                     link::BackgroundOutput::Clock::now());

  /// The file.
  [[nodiscard]] link::BackgroundOutput& output() { return *output_; }

  /// Edges that found no room.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// Records in the file; right after finish().
  [[nodiscard]] std::uint64_t written() const { return written_; }

 private:
  void take(std::span<const board::TraceRecord> records);
  void drop(const board::TraceRecord& record);
  void resume(base::SimTime now);
  void push(const board::TraceRecord& record);
  [[nodiscard]] std::size_t room() const {
    return queue_.size() -
           (pushed_.load(std::memory_order_relaxed) - popped_.load(std::memory_order_acquire));
  }
  void run();
  void write_waiting();

  bool waits_;  ///< for room, rather than losing edges
  board::LogicTrace trace_;
  board::VcdFormat format_;
  std::unique_ptr<link::BackgroundOutput> output_;  ///< for which only the writer waits

  // One thread at a time puts in, that which holds the rack; the writer takes out.
  std::vector<board::TraceRecord> queue_;
  std::atomic<std::size_t> pushed_{0};
  std::atomic<std::size_t> popped_{0};
  std::uint64_t dropped_ = 0;
  std::uint32_t lost_ = 0;  ///< lines whose level the file does not know any more
  base::SimTime lost_since_;
  std::array<bool, board::kLines> levels_{};  ///< of lost lines

  std::string text_;
  std::uint64_t written_ = 0;
  bool finished_ = false;
  std::mutex mutex_;  ///< guards ending_
  std::condition_variable changed_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace stator::rack
