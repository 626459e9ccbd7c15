#pragma once

#include <cstdint>

namespace stator::ethercat {

/// What an access causes besides moving bits. Named by the register group; which side and which
/// kind of access causes it stands in register_effects.cpp and distributed_clock_unit.cpp.
enum class Effect : std::uint8_t {
  none,
  station_address,
  unlock_registers,
  unlock_controller,
  write_protection,
  reset_by_bus,
  reset_by_host,
  dl_control,
  dl_status,
  al_control,
  al_status,
  led_override,
  event_mask,
  event_request,
  clear_receive_errors,
  clear_processing_unit_errors,
  clear_pdi_errors,
  clear_lost_links,
  watchdog_time,
  watchdog_status,
  clear_watchdog_counters,
  sii_access,
  sii_interface,
  mii_interface,
  mii_access,
  mii_port_status,
  fmmu,
  sync_manager,
  sync_manager_activate,
  sync_manager_host_control,
  receive_time,
  system_time,
  time_setting,
  time_loop,
  time_filter,
  speed_filter,
  speed_difference,
  clock_side,
  sync_activation,
  sync_status,
  sync_times,
  sync_cycle,
  latch_control,
  latch_status,
  latch_time,
  buffer_event_time,
  parameter_ram,
};

/// Effects that one access touches, one bit each.
using EffectSet = std::uint64_t;
static_assert(static_cast<unsigned>(Effect::parameter_ram) < 64);

/// The set of the effects given.
template <typename... Effects>
constexpr EffectSet set_of(Effects... effects) {
  return ((EffectSet{1} << static_cast<unsigned>(effects)) | ...);
}
/// True if the sets share an effect.
constexpr bool any_of(EffectSet effects, EffectSet wanted) {
  return (effects & wanted) != 0;
}

/// Effects of the distributed clocks whose registers are computed for each read.
inline constexpr EffectSet kClockReads =
    set_of(Effect::system_time, Effect::speed_difference, Effect::sync_status, Effect::sync_times,
           Effect::latch_status, Effect::latch_time, Effect::buffer_event_time);

/// Effects of the distributed clocks that a write has.
inline constexpr EffectSet kClockWrites =
    set_of(Effect::system_time, Effect::time_setting, Effect::time_loop, Effect::time_filter,
           Effect::speed_filter, Effect::clock_side, Effect::sync_activation, Effect::sync_times,
           Effect::sync_cycle, Effect::latch_control);

/// What is done in distributed_clock_unit.cpp, or nowhere; all else is done in
/// register_effects.cpp.
inline constexpr EffectSet kNoRegisterEffects = kClockReads | kClockWrites | set_of(Effect::none);

/// Effects for which a read by the bus has to compute the value first or changes something.
inline constexpr EffectSet kBusReads =
    kClockReads | set_of(Effect::dl_status, Effect::al_status, Effect::led_override,
                         Effect::event_request, Effect::watchdog_status, Effect::mii_port_status);

/// Effects whose registers a side may write under a condition only; see accepts_bus_write(),
/// accepts_host_write() of SlaveController and DistributedClockUnit::accepts_write().
inline constexpr EffectSet kConditionalWrites =
    set_of(Effect::al_control, Effect::al_status, Effect::watchdog_status, Effect::sii_access,
           Effect::sii_interface, Effect::mii_interface, Effect::mii_access, Effect::sync_manager,
           Effect::sync_manager_activate, Effect::sync_activation, Effect::sync_status,
           Effect::sync_times, Effect::sync_cycle, Effect::latch_control, Effect::latch_time);

/// True if the bytes written to such a register only unlock and are not stored, although the
/// document calls the field "r/w".
constexpr bool discards_value(Effect effect) {
  return effect == Effect::unlock_registers || effect == Effect::unlock_controller;
}

}  // namespace stator::ethercat
