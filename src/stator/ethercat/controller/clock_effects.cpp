// What accesses to the registers of the distributed clocks cause (0x0910..0x09FF), and when SYNC
// pulses have to be looked at.

#include <algorithm>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
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

constexpr std::uint32_t kClockAlEvents =
    al_event::kDcLatch | al_event::kDcSync0 | al_event::kDcSync1;

}  // namespace

void SlaveController::reset_clocks() {
  clock_.reset(now_);
  sync_.reset();
  latch_.reset();
  shown_system_time_.reset();
  for (auto& shown : shown_buffer_events_) {
    shown.reset();
  }
  buffer_events_.fill(0);
  sync_deadline_ = base::SimTime::never();
  start_time_bytes_ = 0;
}

void SlaveController::before_clock_read(Side side, EffectSet effects, std::uint32_t address,
                                        std::size_t length) {
  if (any_of(effects, set_of(Effect::system_time))) {
    // The bus sees the time at which the frame began, the host that of its access.
    const bool from_bus = side == Side::bus;
    shown_system_time_.show(registers(), side, address, length,
                            from_bus ? clock_.bus_time(frame_start_) : clock_.system_time(now_));
  }
  if (any_of(effects, set_of(Effect::speed_difference))) {
    clock_.show_speed_counter_difference();
  }
  if (any_of(effects, set_of(Effect::sync_status, Effect::sync_times))) {
    advance_sync();
    sync_.show(clock_.system_time(now_));
  }
  if (any_of(effects, set_of(Effect::latch_status, Effect::latch_time))) {
    latch_.show(side, address, length);
  }
  if (any_of(effects, set_of(Effect::buffer_event_time))) {
    for (std::size_t i = 0; i < buffer_events_.size(); ++i) {
      shown_buffer_events_[i].show(registers(), side, address, length, buffer_events_[i]);
    }
  }
}

void SlaveController::after_clock_read(Side side, EffectSet effects, std::uint32_t address,
                                       std::size_t length) {
  if (side == Side::bus) {
    acknowledge_clock(side, effects, address, length);
  }
}

void SlaveController::acknowledge_clock(Side side, EffectSet effects, std::uint32_t address,
                                        std::size_t length) {
  if (any_of(effects, set_of(Effect::sync_status)) && side == Side::host) {
    advance_sync();  // pulses before this moment are acknowledged too
    for (std::size_t output = 0; output < SyncUnit::kOutputs; ++output) {
      if (touches(address, length, kSync0Status + output)) {
        sync_.acknowledge(output);
      }
    }
    publish_clock_events();
    schedule_sync();
  }
  if (any_of(effects, set_of(Effect::latch_time))) {
    latch_.acknowledge(side, address, length);
    publish_clock_events();
  }
}

bool SlaveController::accepts_clock_write(Side side, Effect effect, std::size_t address) const {
  const auto controls = [&](unsigned bit) {
    return register_bit(kCyclicUnitControl, bit) == (side == Side::host);
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
      return side == Side::host && configuration_.acknowledge_by_write;
    default:
      return true;
  }
}

void SlaveController::after_clock_write(Side side, EffectSet effects, std::uint32_t address,
                                        std::span<const std::byte> data) {
  const auto has = [effects](Effect effect) { return any_of(effects, set_of(effect)); };
  if (has(Effect::system_time) && side == Side::host) {
    take_host_system_time(address, data);
  } else if (has(Effect::system_time)) {
    take_system_time(address, data);
    if (effects == set_of(Effect::system_time)) {
      return;  // the usual write of a cycle; the comparison follows at the end of the frame
    }
  }
  if (has(Effect::time_setting)) {
    advance_sync();
    clock_.take_settings();
    sync_.jump(clock_.system_time(now_));
  }
  if (has(Effect::time_loop)) {
    clock_.reset_loop(now_);
  }
  if (has(Effect::time_filter)) {
    clock_.reset_difference(now_);
  }
  if (has(Effect::speed_filter)) {
    clock_.reset_speed_filter(now_);
  }
  if (has(Effect::latch_control)) {
    latch_.take_control();
  }
  if (has(Effect::sync_cycle)) {
    advance_sync();
    sync_.write_cycle_times();
  }
  if (has(Effect::sync_activation) && touches(address, data.size(), kSyncActivation)) {
    advance_sync();
    report_activation(sync_.write_activation(
        std::to_integer<std::uint8_t>(data[kSyncActivation - address]), clock_.system_time(now_)));
  }
  if (has(Effect::sync_times)) {
    take_start_time(side, address, data.size());
  }
  publish_clock_events();
  schedule_sync();
}

void SlaveController::set_clock_deviation(std::int32_t ppb) {
  configuration_.clock_deviation_ppb = ppb;
  clock_.set_deviation(ppb, now_);
  schedule_sync();
  ports_.note_topology_change();
}

void SlaveController::take_system_time(std::uint32_t address, std::span<const std::byte> data) {
  if (!touches(address, data.size(), kSystemTime)) {
    return;
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
  frame_work_ |= FrameWork::kCompareSystemTime;
}

/// Only where the host controls the time. Its interface may bring the bytes one by one; the last
/// one sets off the comparison, with zeros for those that have not come since the one before.
void SlaveController::take_host_system_time(std::uint32_t address,
                                            std::span<const std::byte> data) {
  for (std::size_t i = 0; i < sizeof received_system_time_; ++i) {
    if (touches(address, data.size(), kSystemTime + i)) {
      const auto byte = std::to_integer<std::uint32_t>(data[kSystemTime + i - address]);
      received_system_time_ = (received_system_time_ & ~(0xFFU << 8 * i)) | byte << 8 * i;
    }
  }
  if (touches(address, data.size(), kSystemTime + sizeof received_system_time_ - 1)) {
    advance_sync();
    clock_.compare_latched(std::exchange(received_system_time_, 0), latch_.rising_edge(0), now_);
    schedule_sync();
  }
}

void SlaveController::take_start_time(Side side, std::uint32_t address, std::size_t length) {
  for (std::size_t i = 0; i < 8; ++i) {
    if (touches(address, length, kSyncStartTime + i)) {
      start_time_bytes_ = static_cast<std::uint8_t>(start_time_bytes_ | 1U << i);
    }
  }
  if (side == Side::bus) {
    // Both halves may come in datagrams of their own.
    frame_work_ |= FrameWork::kTakeStartTime;
  } else {
    finish_start_time();
  }
}

void SlaveController::finish_start_time() {
  const bool lower_half_only = (start_time_bytes_ & 0xF0U) == 0;
  start_time_bytes_ = 0;
  report_activation(sync_.write_start_time(lower_half_only, clock_.system_time(now_)));
  publish_clock_events();
  schedule_sync();
}

void SlaveController::report_activation(SyncUnit::Activation activation) {
  const auto start =
      static_cast<std::int64_t>(base::load_le<std::uint64_t>(registers(), kSyncStartTime));
  const auto system_time = static_cast<std::int64_t>(clock_.system_time(now_));
  switch (activation) {
    case SyncUnit::Activation::never:
      reporter_.report(now_, kSyncStartPast, {start, system_time});
      break;
    case SyncUnit::Activation::immediate:
      reporter_.report(now_, kSyncStartsAtOnce, {start, system_time});
      break;
    case SyncUnit::Activation::disabled:
      reporter_.report(now_, kSyncDisabled);
      break;
    case SyncUnit::Activation::none:
    case SyncUnit::Activation::waiting:
      break;
  }
}

void SlaveController::advance_sync() {
  if (sync_.active() && sync_.advance(clock_.system_time(now_))) {
    publish_clock_events();
    schedule_sync();
  }
}

void SlaveController::schedule_sync() {
  sync_edges_.fill(std::nullopt);
  const base::SimTime former = std::exchange(sync_deadline_, base::SimTime::never());
  if (sync_.wants_pulse_in_time()) {
    for (unsigned output = 0; output < SyncUnit::kOutputs; ++output) {
      if (const auto next = sync_.next_pulse(output)) {
        sync_deadline_ = std::min(sync_deadline_, clock_.when(*next, now_));
      }
    }
  }
  if (sync_deadline_ != former) {
    update_deadline();
  }
}

void SlaveController::publish_clock_events() {
  al_event_request_ = (al_event_request_ & ~kClockAlEvents) | sync_.al_events() |
                      (latch_.event(Side::host) ? al_event::kDcLatch : 0U);
  set_ecat_event(ecat_event::kDcLatch, latch_.event(Side::bus));
}

base::SimTime SlaveController::next_sync_edge(unsigned output) {
  if (!sync_.active()) {
    return base::SimTime::never();
  }
  std::optional<base::SimTime>& edge = sync_edges_[output];
  if (!edge || *edge <= now_) {
    advance_sync();
    const auto next = sync_.next_pulse(output);
    edge = next ? clock_.when(*next, now_) : base::SimTime::never();
  }
  return *edge;
}

std::uint64_t SlaveController::sync_pulse_count(unsigned output) {
  advance_sync();
  return sync_.pulse_count(output);
}

bool SlaveController::sync_output(unsigned output) {
  advance_sync();
  return sync_.asserted(output, clock_.system_time(now_));
}

PinLevel SlaveController::sync_pin(unsigned output) {
  advance_sync();
  return sync_.pin(output, clock_.system_time(now_));
}

void SlaveController::set_latch_input(unsigned input, bool level) {
  latch_.set_input(input, level, clock_.system_time(now_));
  publish_clock_events();
}

void SlaveController::latch_buffer_event(Side side, std::size_t channel, bool start, bool change) {
  const std::uint8_t activation = activations_[channel];
  if (side == Side::bus && change && (activation & kLatchBusEvents) != 0) {
    buffer_events_[0] = static_cast<std::uint32_t>(clock_.local_time(frame_start_));
  }
  if (side == Side::host && (activation & kLatchHostEvents) != 0) {
    const auto now = static_cast<std::uint32_t>(clock_.local_time(now_));
    buffer_events_[1] = start ? now : buffer_events_[1];
    buffer_events_[2] = change ? now : buffer_events_[2];
  }
}

}  // namespace stator::ethercat
