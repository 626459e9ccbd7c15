#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "stator/can/acceptance_filter.hpp"
#include "stator/can/bounded_queue.hpp"
#include "stator/can/error_counters.hpp"
#include "stator/can/frame.hpp"
#include "stator/can/pending_members.hpp"
#include "stator/can/transmitter.hpp"

namespace stator::can {

/// The CAN controller of a node: its firmware sends and takes frames on one side, the bus fetches
/// and delivers them on the other.
class Controller final : public Transmitter {
 public:
  static constexpr std::size_t kTransmitBuffer = 256;
  static constexpr std::size_t kReceiveBuffer = 256;

  // The firmware's side.

  bool send(const Frame& frame) override {
    const bool sent = state_ != ErrorState::bus_off && transmit_.push(frame);
    transmit_lost_ += sent ? 0U : 1U;
    changed();
    return sent;
  }
  [[nodiscard]] std::size_t room() const override {
    return state_ == ErrorState::bus_off ? 0 : kTransmitBuffer - transmit_.size();
  }
  /// The oldest frame received and not taken yet.
  [[nodiscard]] std::optional<Frame> take() {
    if (receive_.empty()) {
      return std::nullopt;
    }
    const Frame frame = receive_.front();
    receive_.pop();
    return frame;
  }
  [[nodiscard]] ErrorState error_state() const { return state_; }
  /// Frames lost since power-on because a buffer was full, or while bus-off.
  [[nodiscard]] std::uint64_t transmit_lost() const { return transmit_lost_; }
  [[nodiscard]] std::uint64_t receive_lost() const { return receive_lost_; }

  /// Frames that do not pass are not delivered and cost the node nothing.
  [[nodiscard]] AcceptanceFilter& filter() { return filter_; }
  [[nodiscard]] const AcceptanceFilter& filter() const { return filter_; }

  /// Forgets what waits in both buffers: the node's software starts anew.
  void clear() {
    transmit_.clear();
    receive_.clear();
    changed();
  }

  // The bus's side.

  /// Notes `member` in `pending` whenever the controller gets something to send; null ends that.
  void attach(PendingMembers* pending, std::size_t member) {
    pending_ = pending;
    member_ = member;
    changed();
  }
  /// The frame to send next, or null.
  [[nodiscard]] const Frame* pending() const {
    return transmit_.empty() ? nullptr : &transmit_.front();
  }
  /// `frame` has been on the bus. Its firmware may have cleared the buffer meanwhile.
  void transmitted(const Frame& frame) {
    if (!transmit_.empty() && transmit_.front() == frame) {
      transmit_.pop();
    }
  }
  void deliver(const Frame& frame) { receive_lost_ += receive_.push(frame) ? 0U : 1U; }
  /// Entering bus-off empties the transmit buffer.
  void set_error_state(ErrorState state) {
    state_ = state;
    if (state == ErrorState::bus_off) {
      transmit_.clear();
      changed();
    }
  }

 private:
  void changed() {
    if (pending_ != nullptr) {
      pending_->note(member_);
    }
  }

  BoundedQueue<Frame, kTransmitBuffer> transmit_;
  BoundedQueue<Frame, kReceiveBuffer> receive_;
  AcceptanceFilter filter_;
  ErrorState state_ = ErrorState::error_active;
  std::uint64_t transmit_lost_ = 0;
  std::uint64_t receive_lost_ = 0;
  PendingMembers* pending_ = nullptr;
  std::size_t member_ = 0;
};

}  // namespace stator::can
