#include "stator/rack/world/clock.hpp"

#include <chrono>

namespace stator::rack {

namespace {

template <typename Clock>
std::int64_t nanoseconds_of() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

using Monotonic = std::chrono::steady_clock;
using TimeOfDay = std::chrono::system_clock;

}  // namespace

RealClock::RealClock(base::SimTime start)
    : start_(nanoseconds_of<Monotonic>() - start.nanoseconds()),
      epoch_(nanoseconds_of<TimeOfDay>() - start.nanoseconds()) {}

base::SimTime RealClock::now() const {
  return base::SimTime(base::SimDuration(nanoseconds_of<Monotonic>() - start_));
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
