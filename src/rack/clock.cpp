#include "rack/clock.hpp"

#include <chrono>

namespace stator::rack {

namespace {

std::int64_t monotonic_nanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

bool is_logical(ethercat::Command command) {
  return command == ethercat::Command::lrd || command == ethercat::Command::lwr ||
         command == ethercat::Command::lrw;
}

}  // namespace

RealClock::RealClock(base::SimTime start) : start_(monotonic_nanoseconds() - start.nanoseconds()) {}

base::SimTime RealClock::now() const {
  return base::SimTime(base::SimDuration(monotonic_nanoseconds() - start_));
}

std::optional<LockstepClock::Opening> LockstepClock::first_logical_datagram(
    std::span<std::byte> frame) {
  ethercat::DatagramCursor cursor(frame);
  while (const auto datagram = cursor.next()) {
    if (is_logical(datagram->command)) {
      return Opening{datagram->command, datagram->address};
    }
  }
  return std::nullopt;
}

base::SimTime LockstepClock::on_frame(std::span<std::byte> frame) {
  const std::optional<Opening> logical = first_logical_datagram(frame);
  if (!logical) {
    return now_ += step_;
  }
  if (!opening_ || ++frames_without_opening_ > kForgetAfter) {
    opening_ = logical;
  }
  if (logical != opening_) {
    return now_ += step_;
  }
  frames_without_opening_ = 0;
  return now_ += cycle_;
}

}  // namespace stator::rack
