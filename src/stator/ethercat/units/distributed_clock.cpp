#include "stator/ethercat/units/distributed_clock.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr std::int64_t kBillion = 1'000'000'000;
constexpr std::uint32_t kLocalIsBehind = 0x80000000;

// Bits behind the point.
constexpr int kLineFraction = 10;
constexpr int kTrimFraction = 20;
constexpr int kDifferenceFraction = 16;
constexpr int kScaleFraction = 30;

/// Speed counter start values outside 0x0080..0x3FFF act as the nearest one inside.
std::int64_t effective_start(std::uint16_t speed_counter_start) {
  return std::clamp<std::int64_t>(speed_counter_start, 0x80, 0x3FFF);
}
std::int64_t largest_difference(std::int64_t start) {
  return start - 0x7F;
}
/// The deviation of the clock period in ppb that a speed counter difference stands for (TMC8461
/// datasheet, register 0x0932).
std::int64_t deviation(std::int64_t start, std::int64_t difference) {
  return kBillion * difference / (5 * (start + difference + 2) * (start - difference + 2));
}

}  // namespace

void DistributedClock::reset(base::SimTime now) {
  start_ = now;
  start_time_ = 0;
  start_fraction_ = 0;
  slew_amount_ = 0;
  slew_span_ = 0;
  take_settings();
  reset_loop(now);
}

std::int64_t DistributedClock::slewed(std::int64_t elapsed) const {
  if (elapsed >= slew_span_) {
    return slew_amount_;
  }
  // Within the span the product stays below 2^62, see compare().
  const std::int64_t progress =
      (std::max<std::int64_t>(elapsed, 0) * largest_slew_ppb_ / 1'000'000 << kLineFraction) / 1'000;
  return slew_amount_ < 0 ? std::max(-progress, slew_amount_) : std::min(progress, slew_amount_);
}

std::int64_t DistributedClock::gained(std::int64_t elapsed) const {
  // Whole seconds and the rest apart, so that the product stays within 64 bits.
  const std::int64_t seconds = elapsed / kBillion;
  const std::int64_t rest = elapsed - seconds * kBillion;
  return seconds * rate_ + rest * rate_ / kBillion;
}

std::uint64_t DistributedClock::local_time(base::SimTime t) const {
  const std::int64_t elapsed = (t - start_).nanoseconds();
  const std::int64_t gain = (start_fraction_ + gained(elapsed) + slewed(elapsed)) >> kLineFraction;
  return start_time_ + static_cast<std::uint64_t>(elapsed + gain);
}

base::SimTime DistributedClock::when(std::uint64_t system_time_wanted, base::SimTime from) const {
  base::SimTime t = from;
  // The rate is nearly 1, so each round leaves a small fraction of the distance.
  for (int round = 0; round < 8; ++round) {
    const auto missing = static_cast<std::int64_t>(system_time_wanted - system_time(t));
    if (missing > base::SimDuration::max().nanoseconds() / 2) {
      return base::SimTime::never();
    }
    if (missing == 0) {
      break;
    }
    t = std::max(from, t + base::SimDuration(missing));
  }
  const auto reached = [&](base::SimTime at) {
    return static_cast<std::int64_t>(system_time(at) - system_time_wanted) >= 0;
  };
  constexpr base::SimDuration kStep(1);
  while (!reached(t)) {
    t += kStep;
  }
  while (t > from && reached(t - kStep)) {
    t = t - kStep;
  }
  return t;
}

std::int64_t DistributedClock::restart_line(base::SimTime t) {
  const std::int64_t elapsed = (t - start_).nanoseconds();
  const std::int64_t slew = slewed(elapsed);
  const std::int64_t gain = start_fraction_ + gained(elapsed) + slew;
  slew_amount_ -= slew;
  slew_span_ = std::max<std::int64_t>(slew_span_ - elapsed, 0);
  start_time_ += static_cast<std::uint64_t>(elapsed + (gain >> kLineFraction));
  start_fraction_ = gain & ((1 << kLineFraction) - 1);
  start_ = t;
  return slew;
}

void DistributedClock::latch_receive_times(const FrameTiming& timing) {
  for (unsigned port = 0; port < kPortsPerSlave; ++port) {
    if (timing.received_at(port)) {
      base::store_le(registers_, kReceiveTimes + 4 * std::size_t{port},
                     static_cast<std::uint32_t>(local_time(timing.port(port))));
    }
  }
  base::store_le(registers_, kReceiveTimeProcessingUnit, local_time(timing.processing_unit));
}

void DistributedClock::compare(std::uint32_t received, base::SimTime t) {
  const std::int64_t elapsed = (t - start_).nanoseconds();
  const std::int64_t corrected = restart_line(t);
  const auto copy = static_cast<std::uint32_t>(start_time_ + offset_ - delay_);
  take_difference(copy - received, elapsed, corrected);
}

void DistributedClock::compare_latched(std::uint32_t received, std::uint64_t latched,
                                       base::SimTime t) {
  const std::int64_t elapsed = (t - start_).nanoseconds();
  const std::int64_t corrected = restart_line(t);
  take_difference(static_cast<std::uint32_t>(latched) - received, elapsed, corrected);
}

void DistributedClock::take_difference(std::uint32_t difference_ns, std::int64_t elapsed,
                                       std::int64_t slewed_by) {
  const std::int64_t corrected = slewed_by << (kDifferenceFraction - kLineFraction);
  const auto difference = std::int64_t{static_cast<std::int32_t>(difference_ns)}
                          << kDifferenceFraction;
  if (primed_) {
    // The part of the difference that the loop has corrected itself since the last comparison is
    // known; only the rest measures phase and rate.
    const unsigned depth = std::to_integer<unsigned>(registers_[kDifferenceFilterDepth]) & 0x0F;
    const std::int64_t expected = mean_difference_ + corrected;
    const std::int64_t innovation = difference - expected;
    mean_difference_ = expected + (innovation >> depth);
    learn_rate(innovation, elapsed);
  } else {
    mean_difference_ = difference;
    primed_ = true;
  }
  // |mean| < 2^31 ns and at least 11 ppm: the span times the rate fits into 64 bits.
  slew_amount_ = -(mean_difference_ >> (kDifferenceFraction - kLineFraction));
  const std::int64_t magnitude = slew_amount_ < 0 ? -slew_amount_ : slew_amount_;
  slew_span_ = ((magnitude >> kLineFraction) + 1) * slew_duration_;
  show_difference();
}

void DistributedClock::learn_rate(std::int64_t innovation, std::int64_t elapsed) {
  if (elapsed <= 0 || elapsed > kBillion) {
    return;
  }
  // Limited to twice what the loop with the greatest bandwidth could have corrected in that time; 6
  // bits of fraction.
  const std::int64_t most = elapsed * 64 / 512;
  const std::int64_t gain = std::clamp(innovation >> (kDifferenceFraction - 6), -most, most);
  const std::int64_t limit = largest_slew_ppb_ << 6;
  // ppb per ns: depends on `elapsed` alone, so the processor can divide before it knows the
  // difference.
  const std::int64_t scale = (kBillion << kScaleFraction) / elapsed;
  const std::int64_t error = std::clamp(gain * scale >> kScaleFraction, -limit, limit);
  const unsigned depth = std::to_integer<unsigned>(registers_[kSpeedFilterDepth]) & 0x0F;
  set_trim(trim_ - ((error << (kTrimFraction - 6)) >> depth));
}

void DistributedClock::set_trim(std::int64_t trim) {
  const std::int64_t limit = largest_slew_ppb_ << kTrimFraction;
  trim_ = std::clamp(trim, -limit, limit);
  rate_ =
      (std::int64_t{deviation_ppb_} << kLineFraction) + (trim_ >> (kTrimFraction - kLineFraction));
}

void DistributedClock::set_deviation(std::int32_t ppb, base::SimTime now) {
  restart_line(now);
  deviation_ppb_ = ppb;
  set_trim(trim_);
}

void DistributedClock::take_settings() {
  offset_ = base::load_le<std::uint64_t>(registers_, kSystemTimeOffset);
  delay_ = base::load_le<std::uint32_t>(registers_, kSystemTimeDelay);
}

void DistributedClock::reset_loop(base::SimTime now) {
  restart_line(now);  // at the old rate up to here
  const std::int64_t start =
      effective_start(base::load_le<std::uint16_t>(registers_, kSpeedCounterStart));
  largest_slew_ppb_ = deviation(start, largest_difference(start));
  slew_duration_ = kBillion / largest_slew_ppb_ + 1;
  reset_difference(now);
  set_trim(0);
  show_speed_counter_difference();
}

void DistributedClock::reset_difference(base::SimTime now) {
  restart_line(now);
  // The correction under way ends, since the difference that it corrects is forgotten.
  mean_difference_ = 0;
  slew_amount_ = 0;
  slew_span_ = 0;
  primed_ = false;
  show_difference();
}

void DistributedClock::reset_speed_filter(base::SimTime now) {
  restart_line(now);
  set_trim(0);
}

void DistributedClock::show_difference() {
  const std::int64_t mean = mean_difference_ >> kDifferenceFraction;
  const auto magnitude =
      static_cast<std::uint32_t>(std::min<std::int64_t>(mean < 0 ? -mean : mean, 0x7FFFFFFF));
  base::store_le(registers_, kSystemTimeDifference,
                 mean < 0 ? magnitude | kLocalIsBehind : magnitude);
}

void DistributedClock::show_speed_counter_difference() {
  const std::int64_t start =
      effective_start(base::load_le<std::uint16_t>(registers_, kSpeedCounterStart));
  const std::int64_t wanted = (trim_ < 0 ? -trim_ : trim_) >> kTrimFraction;
  // The deviation grows with the difference: the largest one that does not exceed what is wanted.
  std::int64_t low = 0;
  std::int64_t high = largest_difference(start);
  while (low < high) {
    const std::int64_t middle = (low + high + 1) / 2;
    if (deviation(start, middle) <= wanted) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  base::store_le(registers_, kSpeedCounterDifference,
                 static_cast<std::int16_t>(trim_ < 0 ? -low : low));
}

}  // namespace stator::ethercat
