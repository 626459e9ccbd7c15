// What accesses to registers cause, by effect as declared in register_table_*.cpp and by side.

#include <algorithm>
#include <bit>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/al_transition.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr base::EventRule kSyncManagerMode{
    "esc-sync-manager-mode", base::Severity::warning,
    "sync manager {0} stays inactive: control byte {1:x2} names a reserved mode or direction; use "
    "mode 0 (buffered) or 2 (mailbox) and direction 0 or 1"};
constexpr base::EventRule kSyncManagerArea{
    "esc-sync-manager-area", base::Severity::warning,
    "sync manager {0} stays inactive: start {1:x4} with length {2} takes {3} bytes; it needs a "
    "length above 1 and must lie within 1000h..{4:x4}"};
constexpr std::uint16_t kAlStateMask = 0x000F;
constexpr std::uint16_t kAlErrorIndication = 0x0010;

/// Runs `handle` for each effect in the set that is handled in this file, in the order of their
/// declaration.
template <typename Handler>
void for_each_effect(EffectSet effects, Handler handle) {
  for (effects &= ~kNoRegisterEffects; effects != 0; effects &= effects - 1) {
    handle(static_cast<Effect>(std::countr_zero(effects)));
  }
}

}  // namespace

void SlaveController::before_read(EffectSet effects) {
  for_each_effect(effects, [&](Effect effect) {
    switch (effect) {
      case Effect::event_request:
        base::store_le(registers(), kEcatEventRequest, ecat_event_request_);
        base::store_le(registers(), kAlEventRequest, al_event_request_);
        break;
      case Effect::watchdog_status: {
        const bool off = base::load_le<std::uint16_t>(registers(), kProcessDataWatchdogTime) == 0;
        memory_[kProcessDataWatchdogStatus] = std::byte{off || process_data_watchdog_.running()};
        break;
      }
      case Effect::led_override:
        show_leds();
        break;
      case Effect::mii_port_status:
        mii_.show_port_status();
        break;
      default:
        break;
    }
  });
}

void SlaveController::after_bus_read(EffectSet effects) {
  for_each_effect(effects, [&](Effect effect) {
    switch (effect) {
      case Effect::dl_status:
        set_ecat_event(ecat_event::kDlStatus, false);
        break;
      case Effect::al_status:
        set_ecat_event(ecat_event::kAlStatus, false);
        break;
      default:
        break;
    }
  });
}

void SlaveController::after_host_read(EffectSet effects, std::uint32_t address,
                                      std::size_t length) {
  if (!configuration_.acknowledge_by_write) {
    acknowledge(effects, address, length);
  }
}

void SlaveController::acknowledge(EffectSet effects, std::uint32_t address, std::size_t length) {
  for_each_effect(effects, [&](Effect effect) {
    switch (effect) {
      case Effect::al_control:
        al_control_taken_ = true;
        al_event_request_ &= ~al_event::kAlControl;
        break;
      case Effect::watchdog_status:
        al_event_request_ &= ~al_event::kProcessDataWatchdog;
        break;
      case Effect::sync_manager_activate:
        for (std::uint32_t at = address; at < address + length; ++at) {
          if ((at & 7) == 6 && at >= kSyncManagers) {
            const unsigned channel = static_cast<unsigned>(at - kSyncManagers) / 8;
            changed_activations_ &= static_cast<std::uint16_t>(~(1U << channel & 0xFFFFU));
          }
        }
        if (changed_activations_ == 0) {
          al_event_request_ &= ~al_event::kSyncManagerActivation;
        }
        break;
      default:
        break;
    }
  });
  take_clock_work(clock_unit_.acknowledge(Side::host, effects, address, length, now_));
}

void SlaveController::after_bus_write(EffectSet effects, std::uint32_t address,
                                      std::span<const std::byte> data) {
  const auto written = [&](std::size_t at) {
    return std::to_integer<std::uint8_t>(data[at - address]);
  };
  for_each_effect(effects, [&](Effect effect) {
    switch (effect) {
      case Effect::station_address:
        station_address_ = base::load_le<std::uint16_t>(registers(), kStationAddress);
        break;
      case Effect::unlock_registers:
        registers_unlocked_ = true;
        frame_work_ |= FrameWork::kLockRegisters;
        break;
      case Effect::unlock_controller:
        controller_unlocked_ = true;
        frame_work_ |= FrameWork::kLockRegisters;
        break;
      case Effect::write_protection:
        compile_mappings();
        break;
      case Effect::reset_by_bus:
        frame_work_ |= FrameWork::kResetKey;
        reset_sequence_.take_key(Side::bus, written(kResetByBus));
        break;
      case Effect::dl_control:
        alias_enabled_ = register_bit(kAliasEnable, 0);
        if (touches(address, data.size(), kLoopControl)) {
          frame_work_ |= FrameWork::kApplyLoopControl;
        }
        ports_.note_topology_change();  // a receive FIFO of another size delays frames differently
        break;
      case Effect::al_control:
        take_al_control();
        break;
      case Effect::event_mask:
        ecat_event_mask_ = base::load_le<std::uint16_t>(registers(), kEcatEventMask);
        set_ecat_event(0, false);
        break;
      case Effect::clear_receive_errors:
        clear_registers(kReceiveErrors, kLastForwardedError);
        break;
      case Effect::clear_processing_unit_errors:
        clear_registers(kProcessingUnitErrors, kProcessingUnitErrors);
        break;
      case Effect::clear_pdi_errors:
        clear_registers(kPdiErrors, kPdiErrorCode);
        break;
      case Effect::clear_lost_links:
        clear_registers(kLostLinks, kLastLostLink);
        break;
      case Effect::watchdog_time:
        update_watchdog_times();
        break;
      case Effect::clear_watchdog_counters:
        clear_registers(kProcessDataWatchdogCounter, kPdiWatchdogCounter);
        break;
      case Effect::fmmu:
        compile_mappings();
        break;
      case Effect::sync_manager:
      case Effect::sync_manager_activate:
        update_sync_managers(address, data.size());
        break;
      case Effect::receive_time:
        if (address == kReceiveTimes) {
          frame_work_ |= FrameWork::kLatchReceiveTimes;
        }
        break;
      default:
        after_write(effect, address, data.size());
        break;
    }
  });
}

void SlaveController::after_host_write(EffectSet effects, std::uint32_t address,
                                       std::span<const std::byte> data) {
  // Registers of read_acknowledge rights get here only in acknowledge-by-write mode.
  acknowledge(effects, address, data.size());
  for_each_effect(effects, [&](Effect effect) {
    switch (effect) {
      case Effect::station_address:
        station_alias_ = base::load_le<std::uint16_t>(registers(), kStationAlias);
        break;
      case Effect::reset_by_host:
        reset_sequence_.take_key(Side::host,
                                 std::to_integer<std::uint8_t>(data[kResetByHost - address]));
        if (reset_sequence_.complete(Side::host)) {
          request_reset(Side::host);
        }
        break;
      case Effect::al_status:
        change_al_status();
        break;
      case Effect::sync_manager_host_control:
        update_sync_managers(address, data.size());
        break;
      default:
        after_write(effect, address, data.size());
        break;
    }
  });
}

void SlaveController::after_write(Effect effect, std::uint32_t address, std::size_t length) {
  switch (effect) {
    case Effect::sii_access:
      sii_.update_owner();
      break;
    case Effect::sii_interface:
      if (touches(address, length, kSiiControl, 2)) {
        start_sii_command();
      }
      break;
    case Effect::mii_interface:
      if (touches(address, length, kMiiControl, 2)) {
        start_mii_command();
      }
      mii_.update_port_address();
      break;
    case Effect::mii_access:
      mii_.update_owner();
      break;
    case Effect::mii_port_status:
      mii_.clear_port_errors();
      break;
    case Effect::parameter_ram:
      if (partner_ != nullptr) {
        partner_->parameters_changed(now_);
      }
      break;
    default:
      break;
  }
}

void SlaveController::take_al_control() {
  if (register_bit(kEscConfiguration, 0)) {
    const auto before = static_cast<AlState>(al_status_ & kAlStateMask);
    std::copy_n(memory_.begin() + kAlControl, 2, memory_.begin() + kAlStatus);
    change_al_status();
    const auto after = static_cast<AlState>(al_status_ & kAlStateMask);
    if (after != before) {
      reporter_.report(now_, rules::kAlStateChanged, {to_text(before), to_text(after)});
    }
    return;
  }
  al_control_taken_ = false;
  al_event_request_ |= al_event::kAlControl;
  report_unanswered_al_control(base::load_le<std::uint16_t>(registers(), kAlControl), false);
}

void SlaveController::change_al_status() {
  const auto status = base::load_le<std::uint16_t>(registers(), kAlStatus);
  if (status != al_status_) {
    const bool new_error = (status & ~unsigned{al_status_} & kAlErrorIndication) != 0;
    al_status_ = status;
    memory_[kRunLedOverride] &= std::byte{0x0F};
    if (new_error) {
      memory_[kErrorLedOverride] &= std::byte{0x0F};
    }
    set_ecat_event(ecat_event::kAlStatus, true);
    if (partner_ != nullptr) {
      partner_->al_status_changed(now_, status);
    }
  }
}

void SlaveController::update_sync_managers(std::uint32_t address, std::size_t length) {
  bool reconfigured = false;
  for (std::size_t channel = 0; channel < configuration_.sync_manager_count; ++channel) {
    const std::size_t base = kSyncManagers + channel * SyncManager::kRegisterLength;
    if (!touches(address, length, base, SyncManager::kRegisterLength)) {
      continue;
    }
    SyncManager& manager = sync_managers_[channel];
    const auto activate = std::to_integer<std::uint8_t>(memory_[base + 6]);
    const auto former = std::exchange(activations_[channel], activate);
    manager.refresh_control(std::to_integer<std::uint8_t>(memory_[base + 4]));
    if (activate != former) {
      changed_activations_ |= static_cast<std::uint16_t>(1U << channel);
      al_event_request_ |= al_event::kSyncManagerActivation;
    }
    const bool enable_changed = ((activate ^ former) & 0x01) != 0;
    if (enable_changed) {
      memory_[base + 7] &= std::byte{0xFE};  // a new enable ends a deactivation by the host
    }
    const bool deactivate = register_bit(base + 7, 0) && (activate & 0x01) != 0;
    const bool deactivated = manager.condition() == SyncManager::Condition::deactivated;
    if (enable_changed || deactivate != deactivated) {
      configure_sync_manager(channel);
      reconfigured = true;
    }
    reconfigured = reconfigured || ((activate ^ former) & kLatchBusEvents) != 0;
  }
  if (reconfigured) {
    compile_mappings();
  }
}

void SlaveController::configure_sync_manager(std::size_t channel) {
  const std::size_t base = kSyncManagers + channel * SyncManager::kRegisterLength;
  SyncManager& manager = sync_managers_[channel];
  manager.configure(registers().subspan(base).first<SyncManager::kRegisterLength>(), memory_.size(),
                    configuration_.one_byte_sync_managers);
  al_event_request_ &= ~al_event::sync_manager(static_cast<unsigned>(channel));
  set_ecat_event(ecat_event::sync_manager(channel), false);
  publish_sync_manager(channel);
  if (manager.condition() == SyncManager::Condition::bad_mode) {
    reporter_.report(now_, kSyncManagerMode,
                     {channel, std::to_integer<unsigned>(memory_[base + 4])});
  } else if (manager.condition() == SyncManager::Condition::bad_area) {
    const unsigned bytes = manager.length() * (manager.buffered() ? 3U : 1U);
    reporter_.report(now_, kSyncManagerArea,
                     {channel, manager.start(), manager.length(), bytes, memory_.size() - 1});
  }
}

void SlaveController::update_watchdog_times() {
  // The divider counts 25 MHz clocks less two.
  const auto registers16 = [&](std::size_t at) {
    return std::int64_t{base::load_le<std::uint16_t>(registers(), at)};
  };
  const base::SimDuration increment((registers16(kWatchdogDivider) + 2) * 40);
  process_data_watchdog_.set_period(increment * registers16(kProcessDataWatchdogTime), now_);
  host_watchdog_.set_period(increment * registers16(kPdiWatchdogTime), now_);
  update_deadline();
}

void SlaveController::clear_registers(std::size_t first, std::size_t last) {
  std::fill(memory_.begin() + static_cast<std::ptrdiff_t>(first),
            memory_.begin() + static_cast<std::ptrdiff_t>(last) + 1, std::byte{0});
}

void SlaveController::count(std::size_t address) {
  if (register_map_[address].built && memory_[address] != std::byte{0xFF}) {
    memory_[address] = static_cast<std::byte>(std::to_integer<unsigned>(memory_[address]) + 1);
  }
}

}  // namespace stator::ethercat
