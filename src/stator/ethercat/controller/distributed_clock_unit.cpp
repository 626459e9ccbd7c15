#include "stator/ethercat/controller/distributed_clock_unit.hpp"

#include <algorithm>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr base::EventRule kSyncStartPast{
    "esc-sync-start-past", base::Severity::warning,
    "SYNC unit activated with start time {0} ns while the system time is {1} ns: the start is past "
    "and no SYNC0 will come; write a start time ahead of 0910h to 0990h before 0981h, or set bit 5 "
    "of 0981h to start at once"};
constexpr base::EventRule kSyncStartsAtOnce{
    "esc-sync-start-at-once", base::Severity::information,
    "SYNC unit starts at once: start time {0} ns is not in the near future of system time {1} ns"};
constexpr base::EventRule kSyncDisabled{
    "esc-sync-disabled", base::Severity::warning,
    "SYNC unit activated, but bit 2 of the ESC configuration 0141h, from word 0 of the EEPROM, "
    "keeps it off; no SYNC0 will come"};

}  // namespace

void DistributedClockUnit::reset(base::SimTime now) {
  clock_.reset(now);
  sync_.reset();
  latch_.reset();
  shown_system_time_.reset();
  for (auto& shown : shown_buffer_events_) {
    shown.reset();
  }
  buffer_events_.fill(0);
  deadline_ = base::SimTime::never();
  received_system_time_ = 0;
  start_time_bytes_ = 0;
}

unsigned DistributedClockUnit::before_read(AccessSide side, EffectSet effects,
                                           std::uint32_t address, std::size_t length,
                                           base::SimTime frame_start, base::SimTime now) {
  unsigned work = 0;
  if (any_of(effects, set_of(Effect::system_time))) {
    // The bus sees the time at which the frame began, the host that of its access.
    const bool from_bus = side == AccessSide::bus;
    shown_system_time_.show(registers_, side, address, length,
                            from_bus ? clock_.bus_time(frame_start) : clock_.system_time(now));
  }
  if (any_of(effects, set_of(Effect::speed_difference))) {
    clock_.show_speed_counter_difference();
  }
  if (any_of(effects, set_of(Effect::sync_status, Effect::sync_times))) {
    work |= advance(now);
    sync_.show(clock_.system_time(now));
  }
  if (any_of(effects, set_of(Effect::latch_status, Effect::latch_time))) {
    latch_.show(side, address, length);
  }
  if (any_of(effects, set_of(Effect::buffer_event_time))) {
    for (std::size_t i = 0; i < buffer_events_.size(); ++i) {
      shown_buffer_events_[i].show(registers_, side, address, length, buffer_events_[i]);
    }
  }
  return work;
}

unsigned DistributedClockUnit::acknowledge(AccessSide side, EffectSet effects,
                                           std::uint32_t address, std::size_t length,
                                           base::SimTime now) {
  unsigned work = 0;
  if (any_of(effects, set_of(Effect::sync_status)) && side == AccessSide::host) {
    work |= advance(now);  // pulses before this moment are acknowledged too
    for (std::size_t output = 0; output < SyncUnit::kOutputs; ++output) {
      if (touches(address, length, kSync0Status + output)) {
        sync_.acknowledge(output);
      }
    }
    work |= refresh(now);
  }
  if (any_of(effects, set_of(Effect::latch_time))) {
    latch_.acknowledge(side, address, length);
    work |= ClockWork::kTakeEvents;
  }
  return work;
}

bool DistributedClockUnit::accepts_write(AccessSide side, Effect effect,
                                         std::size_t address) const {
  const auto controls = [&](unsigned bit) {
    return register_bit(kCyclicUnitControl, bit) == (side == AccessSide::host);
  };
  switch (effect) {
    case Effect::sync_activation:
    case Effect::sync_cycle:
      return controls(0);
    case Effect::sync_times:
      return controls(0) && !register_bit(kSyncActivation, 0);
    case Effect::latch_control:
      return controls(address == kLatch0Control ? 4 : 5);
    case Effect::sync_status:
    case Effect::latch_time:
      return side == AccessSide::host && configuration_.acknowledge_by_write;
    default:
      return true;
  }
}

unsigned DistributedClockUnit::after_write(AccessSide side, EffectSet effects,
                                           std::uint32_t address, std::span<const std::byte> data,
                                           base::SimTime now) {
  unsigned work = 0;
  const auto has = [effects](Effect effect) { return any_of(effects, set_of(effect)); };
  if (has(Effect::system_time) && side == AccessSide::host) {
    work |= take_host_system_time(address, data, now);
  } else if (has(Effect::system_time)) {
    work |= take_system_time(address, data);
    if (effects == set_of(Effect::system_time)) {
      return work;  // the usual write of a cycle; the comparison follows at the end of the frame
    }
  }
  if (has(Effect::time_setting)) {
    work |= advance(now);
    clock_.take_settings();
    sync_.jump(clock_.system_time(now));
  }
  if (has(Effect::time_loop)) {
    clock_.reset_loop(now);
  }
  if (has(Effect::time_filter)) {
    clock_.reset_difference(now);
  }
  if (has(Effect::speed_filter)) {
    clock_.reset_speed_filter(now);
  }
  if (has(Effect::latch_control)) {
    latch_.take_control();
  }
  if (has(Effect::sync_cycle)) {
    work |= advance(now);
    sync_.write_cycle_times();
  }
  if (has(Effect::sync_activation) && touches(address, data.size(), kSyncActivation)) {
    work |= advance(now);
    report_activation(
        sync_.write_activation(std::to_integer<std::uint8_t>(data[kSyncActivation - address]),
                               clock_.system_time(now)),
        now);
  }
  if (has(Effect::sync_times)) {
    work |= take_start_time(side, address, data.size(), now);
  }
  return work | refresh(now);
}

unsigned DistributedClockUnit::compare(const FrameTiming& timing, base::SimTime now) {
  clock_.compare(received_system_time_, timing.processing_unit);
  return schedule(now);
}

unsigned DistributedClockUnit::set_deviation(std::int32_t ppb, base::SimTime now) {
  clock_.set_deviation(ppb, now);
  return schedule(now);
}

unsigned DistributedClockUnit::take_system_time(std::uint32_t address,
                                                std::span<const std::byte> data) {
  if (!touches(address, data.size(), kSystemTime)) {
    return 0;
  }
  const std::span<const std::byte> written = data.subspan(kSystemTime - address);
  if (written.size() >= sizeof received_system_time_) {
    received_system_time_ = base::load_le<std::uint32_t>(written);
  } else {
    // Bytes that were not written count as zero.
    std::array<std::byte, sizeof received_system_time_> bytes{};
    std::copy(written.begin(), written.end(), bytes.begin());
    received_system_time_ = base::load_le<std::uint32_t>(bytes);
  }
  return FrameWork::kCompareSystemTime;
}

/// Only where the host controls the time. Its interface may bring the bytes one by one; the last
/// one sets off the comparison, with zeros for those that have not come since the one before.
unsigned DistributedClockUnit::take_host_system_time(std::uint32_t address,
                                                     std::span<const std::byte> data,
                                                     base::SimTime now) {
  unsigned work = 0;
  for (std::size_t i = 0; i < sizeof received_system_time_; ++i) {
    if (touches(address, data.size(), kSystemTime + i)) {
      const auto byte = std::to_integer<std::uint32_t>(data[kSystemTime + i - address]);
      received_system_time_ = (received_system_time_ & ~(0xFFU << 8 * i)) | byte << 8 * i;
    }
  }
  if (touches(address, data.size(), kSystemTime + sizeof received_system_time_ - 1)) {
    work |= advance(now);
    clock_.compare_latched(std::exchange(received_system_time_, 0), latch_.rising_edge(0), now);
    work |= schedule(now);
  }
  return work;
}

unsigned DistributedClockUnit::take_start_time(AccessSide side, std::uint32_t address,
                                               std::size_t length, base::SimTime now) {
  for (std::size_t i = 0; i < 8; ++i) {
    if (touches(address, length, kSyncStartTime + i)) {
      start_time_bytes_ = static_cast<std::uint8_t>(start_time_bytes_ | 1U << i);
    }
  }
  if (side == AccessSide::bus) {
    // Both halves may come in datagrams of their own.
    return FrameWork::kTakeStartTime;
  }
  return finish_start_time(now);
}

unsigned DistributedClockUnit::finish_start_time(base::SimTime now) {
  const bool lower_half_only = (start_time_bytes_ & 0xF0U) == 0;
  start_time_bytes_ = 0;
  report_activation(sync_.write_start_time(lower_half_only, clock_.system_time(now)), now);
  return refresh(now);
}

void DistributedClockUnit::report_activation(SyncUnit::Activation activation, base::SimTime now) {
  const auto start =
      static_cast<std::int64_t>(base::load_le<std::uint64_t>(registers_, kSyncStartTime));
  const auto system_time = static_cast<std::int64_t>(clock_.system_time(now));
  switch (activation) {
    case SyncUnit::Activation::never:
      reporter_.report(now, kSyncStartPast, {start, system_time});
      break;
    case SyncUnit::Activation::immediate:
      reporter_.report(now, kSyncStartsAtOnce, {start, system_time});
      break;
    case SyncUnit::Activation::disabled:
      reporter_.report(now, kSyncDisabled);
      break;
    case SyncUnit::Activation::none:
    case SyncUnit::Activation::waiting:
      break;
  }
}

unsigned DistributedClockUnit::advance(base::SimTime now) {
  return sync_.active() && sync_.advance(clock_.system_time(now)) ? refresh(now) : 0U;
}

unsigned DistributedClockUnit::expire(base::SimTime now) {
  const unsigned work = advance(now);
  return work | schedule(now);
}

unsigned DistributedClockUnit::schedule(base::SimTime now) {
  sync_edges_.fill(std::nullopt);
  const base::SimTime former = std::exchange(deadline_, base::SimTime::never());
  if (sync_.wants_pulse_in_time()) {
    for (unsigned output = 0; output < SyncUnit::kOutputs; ++output) {
      if (const auto next = sync_.next_pulse(output)) {
        deadline_ = std::min(deadline_, clock_.when(*next, now));
      }
    }
  }
  return deadline_ != former ? ClockWork::kUpdateDeadline : 0U;
}

base::SimTime DistributedClockUnit::next_sync_edge(unsigned output, base::SimTime now) {
  if (!sync_.active()) {
    return base::SimTime::never();
  }
  std::optional<base::SimTime>& edge = sync_edges_[output];
  if (!edge || *edge <= now) {
    const auto next = sync_.next_pulse(output);
    edge = next ? clock_.when(*next, now) : base::SimTime::never();
  }
  return *edge;
}

unsigned DistributedClockUnit::set_latch_input(unsigned input, bool level, base::SimTime now) {
  latch_.set_input(input, level, clock_.system_time(now));
  return ClockWork::kTakeEvents;
}

void DistributedClockUnit::latch_bus_change(base::SimTime t) {
  buffer_events_[0] = static_cast<std::uint32_t>(clock_.local_time(t));
}

void DistributedClockUnit::latch_host_access(bool start, bool change, base::SimTime t) {
  const auto time = static_cast<std::uint32_t>(clock_.local_time(t));
  buffer_events_[1] = start ? time : buffer_events_[1];
  buffer_events_[2] = change ? time : buffer_events_[2];
}

}  // namespace stator::ethercat
