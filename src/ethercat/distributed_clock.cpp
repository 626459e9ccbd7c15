#include "ethercat/distributed_clock.hpp"

#include <algorithm>

#include "base/byte_order.hpp"

namespace stator::ethercat {

namespace {

constexpr std::size_t kReceiveTimePort0 = 0x0900;
constexpr std::size_t kSystemTime = 0x0910;
constexpr std::size_t kReceiveTimeProcessingUnit = 0x0918;
constexpr std::size_t kSystemTimeOffset = 0x0920;
constexpr std::size_t kSystemTimeDelay = 0x0928;
constexpr std::size_t kSystemTimeDifference = 0x092C;
constexpr std::size_t kSpeedCounterStart = 0x0930;
constexpr std::size_t kFilterDepth = 0x0934;

constexpr std::int64_t kBillion = 1'000'000'000;
constexpr int kFilterFraction = 16;  // bits of filtered_difference_ behind the point
constexpr std::uint32_t kLocalIsBehind = 0x80000000;

/// Largest relative correction of the clock in parts per billion for a speed counter start value:
/// the deviation formula of the datasheet at its largest counter difference, start - 7Fh.
std::int64_t largest_slew(std::uint16_t speed_counter_start) {
  const std::int64_t start = std::clamp<std::int64_t>(speed_counter_start, 0x80, 0x3FFF);
  const std::int64_t difference = start - 0x7F;
  return kBillion * difference / (5 * (start + difference + 2) * (start - difference + 2));
}

}  // namespace

void DistributedClock::reset(base::SimTime now) {
  power_on_ = now;
  last_compare_ = now;
  correction_ = 0;
  reset_filter();
}

std::uint64_t DistributedClock::local_time(base::SimTime t) const {
  const std::int64_t elapsed = (t - power_on_).nanoseconds();
  // Whole seconds and the rest apart, so that the product stays within 64 bits.
  const std::int64_t drift =
      elapsed / kBillion * deviation_ppb_ + elapsed % kBillion * deviation_ppb_ / kBillion;
  return static_cast<std::uint64_t>(elapsed + drift + correction_);
}

std::uint64_t DistributedClock::system_time(base::SimTime t) const {
  return local_time(t) + offset();
}

void DistributedClock::show_system_time(base::SimTime t, bool for_bus) {
  const std::uint64_t shown = system_time(t) - (for_bus ? delay() : 0U);
  base::store_le(registers_, kSystemTime, shown);
}

void DistributedClock::latch_receive_times(const FrameTiming& timing) {
  for (unsigned port = 0; port < kPortsPerSlave; ++port) {
    if (timing.received_at(port)) {
      base::store_le(registers_, kReceiveTimePort0 + 4 * std::size_t{port},
                     static_cast<std::uint32_t>(local_time(timing.port(port))));
    }
  }
  base::store_le(registers_, kReceiveTimeProcessingUnit, local_time(timing.processing_unit));
}

void DistributedClock::compare(std::uint32_t received, base::SimTime t) {
  const auto copy = static_cast<std::uint32_t>(system_time(t) - delay());
  const auto difference = std::int64_t{static_cast<std::int32_t>(copy - received)};
  const unsigned depth = std::to_integer<unsigned>(registers_[kFilterDepth]) & 0x0F;
  if (filter_primed_) {
    filtered_difference_ += ((difference << kFilterFraction) - filtered_difference_) >> depth;
  } else {
    filtered_difference_ = difference << kFilterFraction;
    filter_primed_ = true;
  }

  const auto start = base::load_le<std::uint16_t>(registers_, kSpeedCounterStart);
  const std::int64_t elapsed =
      std::clamp<std::int64_t>((t - last_compare_).nanoseconds(), 0, kBillion);
  const std::int64_t limit = elapsed * largest_slew(start) / kBillion;
  const std::int64_t step = std::clamp(difference, -limit, limit);
  correction_ -= step;
  last_compare_ = t;
  show_difference();
}

void DistributedClock::reset_filter() {
  filtered_difference_ = 0;
  filter_primed_ = false;
  base::store_le(registers_, kSystemTimeDifference, std::uint32_t{0});
}

std::uint64_t DistributedClock::offset() const {
  return base::load_le<std::uint64_t>(registers_, kSystemTimeOffset);
}

std::uint32_t DistributedClock::delay() const {
  return base::load_le<std::uint32_t>(registers_, kSystemTimeDelay);
}

void DistributedClock::show_difference() {
  const std::int64_t mean = filtered_difference_ >> kFilterFraction;
  const auto magnitude =
      static_cast<std::uint32_t>(std::min<std::int64_t>(mean < 0 ? -mean : mean, 0x7FFFFFFF));
  base::store_le(registers_, kSystemTimeDifference,
                 mean < 0 ? magnitude | kLocalIsBehind : magnitude);
}

}  // namespace stator::ethercat
