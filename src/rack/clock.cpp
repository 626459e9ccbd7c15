#include "rack/clock.hpp"

#include <chrono>

namespace stator::rack {

namespace {

std::int64_t monotonic_nanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

RealClock::RealClock(base::SimTime start) : start_(monotonic_nanoseconds() - start.nanoseconds()) {}

base::SimTime RealClock::now() const {
  return base::SimTime(base::SimDuration(monotonic_nanoseconds() - start_));
}

std::optional<CycleRecognition::Opening> LockstepClock::first_logical_datagram(
    std::span<std::byte> frame) {
  ethercat::DatagramCursor cursor(frame);
  while (const auto datagram = cursor.next()) {
    if (ethercat::is_logical(datagram->command)) {
      return CycleRecognition::Opening{datagram->command, datagram->address};
    }
  }
  return std::nullopt;
}

bool CycleRecognition::opens(const Opening& logical) {
  if (!opening_ || ++frames_without_opening_ > kForgetAfter) {
    opening_ = logical;
  }
  if (logical != *opening_) {
    return false;
  }
  frames_without_opening_ = 0;
  return true;
}

base::SimTime LockstepClock::on_frame(std::span<std::byte> frame) {
  const std::optional<CycleRecognition::Opening> logical = first_logical_datagram(frame);
  return now_ += logical && cycles_.opens(*logical) ? cycle_ : step_;
}

}  // namespace stator::rack
