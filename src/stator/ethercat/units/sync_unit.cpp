#include "stator/ethercat/units/sync_unit.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr unsigned kSyncOutEnabled = 0x04;  // of the ESC configuration

// Bits of 0x0981.
constexpr unsigned kActive = 0x01;
constexpr unsigned kAutoActivation = 0x08;
constexpr unsigned kExtendStartTime = 0x10;
constexpr unsigned kPlausibilityCheck = 0x20;
constexpr unsigned kNearFuture = 0x40;
constexpr unsigned kDebugPulse = 0x80;
constexpr unsigned output_bit(std::size_t output) {
  return 0x02U << output;
}

// Bits of 0x0984.
constexpr unsigned kOutOfNearFuture = 0x04;

// Bits of each half of 0x0151.
constexpr unsigned kDriver = 0x03;
constexpr unsigned kPinIsOutput = 0x04;
constexpr unsigned kMapped = 0x08;

constexpr std::uint64_t kHalfRange = std::uint64_t{1} << 63;
constexpr std::uint64_t kTwoSeconds = std::uint64_t{1} << 31;

/// True if `time` is now or past, in the half of the range that is not ahead.
bool reached(std::uint64_t time, std::uint64_t now) {
  return now - time < kHalfRange;
}

/// SYNC1 repeats with the shortest multiple of the SYNC0 cycle that is not below its delay.
std::uint64_t sync1_period(std::uint64_t cycle, std::uint64_t delay) {
  return cycle == 0 ? 0 : std::max<std::uint64_t>((delay + cycle - 1) / cycle, 1) * cycle;
}

}  // namespace

void SyncUnit::reset() {
  signals_ = {};
  start_time_ = 0;
  sync0_cycle_ = 0;
  sync1_cycle_ = 0;
  active_ = false;
  start_is_past_ = false;
  out_of_near_future_ = false;
}

void SyncUnit::fire(Signal& signal, std::uint64_t pulses, std::uint64_t last) const {
  if (!signal.enabled) {
    return;
  }
  signal.count += pulses;
  signal.last = last;
  signal.first_pending = false;
  signal.held = pulse_length() == 0;
}

bool SyncUnit::waits_for_wrap(std::uint64_t now) {
  start_is_past_ = start_is_past_ && reached(signals_[0].next, now);
  return start_is_past_;
}

bool SyncUnit::advance(std::uint64_t now) {
  bool any = false;
  if (!active_ || waits_for_wrap(now)) {
    return any;
  }
  for (Signal& signal : signals_) {
    if (!signal.armed || !reached(signal.next, now)) {
      continue;
    }
    const std::uint64_t more = signal.period == 0 ? 0 : (now - signal.next) / signal.period;
    const std::uint64_t last = signal.next + more * signal.period;
    signal.armed = signal.period != 0;
    signal.next = last + signal.period;
    fire(signal, more + 1, last);
    any = true;
  }
  return any;
}

void SyncUnit::jump(std::uint64_t now) {
  if (!active_ || waits_for_wrap(now)) {
    return;
  }
  for (Signal& signal : signals_) {
    if (!signal.armed || !reached(signal.next, now)) {
      continue;
    }
    signal.armed = signal.period != 0;
    if (signal.period != 0) {
      signal.next += ((now - signal.next) / signal.period + 1) * signal.period;
    }
    fire(signal, 1, now);
  }
}

SyncUnit::Activation SyncUnit::write_activation(std::uint8_t written, std::uint64_t now) {
  const bool activate_now = (byte(kSyncActivation) & kActive) != 0;
  Activation result = Activation::none;
  if (active_ && !activate_now) {
    deactivate();
  }
  if (!active_ && activate_now) {
    result = activate(now);
  }
  enable_outputs();
  static_cast<void>(advance(now));
  if ((written & kDebugPulse) != 0) {
    for (std::size_t output = 0; output < kOutputs; ++output) {
      if ((written & output_bit(output)) != 0) {
        Signal ping = signals_[output];
        ping.enabled = true;
        fire(ping, 1, now);
        signals_[output].count = ping.count;
        signals_[output].last = ping.last;
        signals_[output].held = ping.held;
      }
    }
  }
  return result;
}

SyncUnit::Activation SyncUnit::write_start_time(bool lower_half_only, std::uint64_t now) {
  const unsigned activation = byte(kSyncActivation);
  if (lower_half_only && (activation & (kExtendStartTime | kAutoActivation)) != 0) {
    const auto lower = base::load_le<std::uint32_t>(registers_, kSyncStartTime);
    const std::uint64_t upper = (now >> 32) + (lower < static_cast<std::uint32_t>(now) ? 1 : 0);
    base::store_le(registers_, kSyncStartTime, upper << 32 | lower);
  }
  start_time_ = base::load_le<std::uint64_t>(registers_, kSyncStartTime);
  if ((activation & kAutoActivation) == 0) {
    return Activation::none;
  }
  registers_[kSyncActivation] |= std::byte{kActive};
  return write_activation(0, now);
}

SyncUnit::Activation SyncUnit::activate(std::uint64_t now) {
  if ((byte(kEscConfiguration) & kSyncOutEnabled) == 0) {
    return Activation::disabled;
  }
  const unsigned activation = byte(kSyncActivation);
  const std::uint64_t ahead = start_time_ - now;
  const std::uint64_t near_future = (activation & kNearFuture) != 0 ? kTwoSeconds : kHalfRange;
  out_of_near_future_ = ahead > near_future;
  const bool immediate = out_of_near_future_ && (activation & kPlausibilityCheck) != 0;
  start_is_past_ = !immediate && ahead >= kHalfRange;
  active_ = true;
  sync0_cycle_ = base::load_le<std::uint32_t>(registers_, kSync0CycleTime);
  sync1_cycle_ = base::load_le<std::uint32_t>(registers_, kSync1CycleTime);
  const std::uint64_t first = immediate ? now : start_time_;
  signals_[0].next = first;
  signals_[1].next = first + sync1_cycle_;
  for (Signal& signal : signals_) {
    signal.armed = true;
    signal.enabled = false;
  }
  take_periods();
  if (immediate) {
    return Activation::immediate;
  }
  return start_is_past_ ? Activation::never : Activation::waiting;
}

void SyncUnit::deactivate() {
  active_ = false;
  start_is_past_ = false;
  out_of_near_future_ = false;
  for (Signal& signal : signals_) {
    signal.armed = false;
    signal.enabled = false;
    signal.first_pending = false;
    signal.held = false;
  }
  base::store_le(registers_, kSyncStartTime, start_time_);
}

void SyncUnit::enable_outputs() {
  for (std::size_t output = 0; output < kOutputs; ++output) {
    Signal& signal = signals_[output];
    const bool enabled = active_ && (byte(kSyncActivation) & output_bit(output)) != 0;
    if (enabled != signal.enabled) {
      signal.enabled = enabled;
      signal.first_pending = enabled && signal.armed;
    }
  }
}

void SyncUnit::take_periods() {
  signals_[0].period = sync0_cycle_;
  signals_[1].period = sync1_period(sync0_cycle_, sync1_cycle_);
}

void SyncUnit::write_cycle_times() {
  if (!active_) {
    return;
  }
  const auto sync0 = base::load_le<std::uint32_t>(registers_, kSync0CycleTime);
  const auto sync1 = base::load_le<std::uint32_t>(registers_, kSync1CycleTime);
  if (sync0 == sync0_cycle_ && sync1 == sync1_cycle_) {
    return;
  }
  sync0_cycle_ = sync0;
  sync1_cycle_ = sync1;
  take_periods();
  if (signals_[0].armed) {
    signals_[1].armed = true;
    signals_[1].next = signals_[0].next + sync1;
  }
}

void SyncUnit::show(std::uint64_t now) {
  unsigned status = out_of_near_future_ ? kOutOfNearFuture : 0U;
  for (std::size_t output = 0; output < kOutputs; ++output) {
    status |= (signals_[output].first_pending ? 1U : 0U) << output;
    registers_[kSync0Status + output] = std::byte{asserted(output, now)};
  }
  registers_[kSyncActivationStatus] = static_cast<std::byte>(status);
  if (active_) {
    base::store_le(registers_, kSyncStartTime, signals_[0].next);
    base::store_le(registers_, kNextSync1Pulse, signals_[1].next);
  }
}

std::uint64_t SyncUnit::pulse_length() const {
  return std::uint64_t{base::load_le<std::uint16_t>(registers_, kSyncPulseLength)} * 10;
}

bool SyncUnit::mapped(std::size_t output) const {
  return (byte(kSyncLatchConfiguration) >> (4 * output) & kMapped) != 0;
}

bool SyncUnit::wants_pulse_in_time() const {
  for (std::size_t output = 0; output < kOutputs; ++output) {
    const Signal& signal = signals_[output];
    if (signal.enabled && !signal.held && mapped(output) && pulse_length() == 0) {
      return true;
    }
  }
  return false;
}

std::optional<std::uint64_t> SyncUnit::next_pulse(std::size_t output) const {
  const Signal& signal = signals_[output];
  if (!signal.enabled || !signal.armed || start_is_past_) {
    return std::nullopt;
  }
  return signal.next;
}

bool SyncUnit::asserted(std::size_t output, std::uint64_t now) const {
  const Signal& signal = signals_[output];
  return signal.held || (signal.count != 0 && now - signal.last < pulse_length());
}

PinLevel SyncUnit::pin(std::size_t output, std::uint64_t now) const {
  const unsigned configuration = byte(kSyncLatchConfiguration) >> (4 * output);
  if ((configuration & kPinIsOutput) == 0) {
    return PinLevel::released;
  }
  const bool on = asserted(output, now);
  switch (configuration & kDriver) {
    case 0:  // push-pull, active low
      return on ? PinLevel::low : PinLevel::high;
    case 1:  // open drain, active low
      return on ? PinLevel::low : PinLevel::released;
    case 2:  // push-pull, active high
      return on ? PinLevel::high : PinLevel::low;
    default:  // open source, active high
      return on ? PinLevel::high : PinLevel::released;
  }
}

std::uint32_t SyncUnit::al_events() const {
  return (signals_[0].held && mapped(0) ? al_event::kDcSync0 : 0U) |
         (signals_[1].held && mapped(1) ? al_event::kDcSync1 : 0U);
}

}  // namespace stator::ethercat
