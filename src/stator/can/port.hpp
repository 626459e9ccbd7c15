#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/can/bounded_queue.hpp"
#include "stator/can/frame.hpp"
#include "stator/can/pending_members.hpp"

namespace stator::can {

/// A frame with the moment at which its last bit was on the bus.
struct TimedFrame {
  base::SimTime time;
  Frame frame;
  bool destroyed = false;  ///< by an error frame, which is what was on the bus in its place
};

/// An outside participant of a bus: frames of a master are put in, frames of the bus are taken out.
/// It sees all frames but its own, and error frames if it asks for them.
///
/// Nothing is lost while both sides heed full buffers: the program that feeds a port keeps its
/// frames while room() is 0, and an unlimited bus waits for a port whose received frames are not
/// fetched, unless it is lossy.
class Port {
 public:
  static constexpr std::size_t kTransmitBuffer = 64;
  static constexpr std::size_t kReceiveBuffer = 4096;

  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  // The outside.

  /// Hands a frame to the bus. False: there is no room, try again when the bus has moved on.
  bool put(const Frame& frame) {
    const bool taken = transmit_.push(frame);
    changed();
    return taken;
  }
  [[nodiscard]] std::size_t room() const { return kTransmitBuffer - transmit_.size(); }
  /// The oldest frame of the bus that was not taken yet.
  [[nodiscard]] std::optional<TimedFrame> take() {
    if (receive_.empty()) {
      return std::nullopt;
    }
    const TimedFrame frame = receive_.front();
    receive_.pop();
    return frame;
  }
  [[nodiscard]] const TimedFrame* front() const {
    return receive_.empty() ? nullptr : &receive_.front();
  }
  [[nodiscard]] std::size_t waiting() const { return receive_.size(); }
  /// Lossy: what finds no room is dropped and counted; else an unlimited bus stands still
  /// meanwhile.
  void set_lossy(bool lossy) { lossy_ = lossy; }
  [[nodiscard]] bool lossy() const { return lossy_; }
  /// Whether error frames are taken out like frames, as TimedFrame::destroyed.
  void set_hears_errors(bool hears) { hears_errors_ = hears; }
  /// Frames of the bus that found no room.
  [[nodiscard]] std::uint64_t lost() const { return lost_; }

  // The bus's side.

  void attach(PendingMembers* pending, std::size_t member) {
    pending_ = pending;
    member_ = member;
    changed();
  }
  [[nodiscard]] const Frame* pending() const {
    return transmit_.empty() ? nullptr : &transmit_.front();
  }
  void transmitted(const Frame& /*frame*/) { transmit_.pop(); }
  [[nodiscard]] bool full() const { return receive_.full(); }
  void deliver(const Frame& frame, base::SimTime time) {
    lost_ += receive_.push({time, frame}) ? 0U : 1U;
  }
  /// `frame`, its own or another's, was destroyed by an error frame.
  void deliver_error(const Frame& frame, base::SimTime time) {
    if (hears_errors_) {
      lost_ += receive_.push({time, frame, true}) ? 0U : 1U;
    }
  }

 private:
  void changed() {
    if (pending_ != nullptr) {
      pending_->note(member_);
    }
  }

  BoundedQueue<Frame, kTransmitBuffer> transmit_;
  BoundedQueue<TimedFrame, kReceiveBuffer> receive_;
  bool lossy_ = false;
  bool hears_errors_ = false;
  std::uint64_t lost_ = 0;
  PendingMembers* pending_ = nullptr;
  std::size_t member_ = 0;
};

}  // namespace stator::can
