// How bus and host reach the bytes of the controller's memory: rights of registers, sync managers
// in front of the process memory.

#include <algorithm>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

/// Stores the bits of `value` that `mask` selects.
void store_bits(std::byte& target, std::byte value, std::uint8_t mask) {
  target = (target & ~std::byte{mask}) | (value & std::byte{mask});
}

/// Mask of byte `index` of `length` when only the ends are partial.
std::uint8_t mask_at(std::size_t index, std::size_t length, std::uint8_t first, std::uint8_t last) {
  unsigned mask = 0xFF;
  if (index == 0) {
    mask &= first;
  }
  if (index + 1 == length) {
    mask &= last;
  }
  return static_cast<std::uint8_t>(mask);
}

void store_masked(std::byte* to, std::span<const std::byte> data, std::uint8_t first_mask,
                  std::uint8_t last_mask) {
  if ((first_mask & last_mask) == 0xFF) {
    std::copy(data.begin(), data.end(), to);
    return;
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    store_bits(to[i], data[i], mask_at(i, data.size(), first_mask, last_mask));
  }
}

}  // namespace

SlaveController::Piece SlaveController::piece_at(std::uint32_t address, std::size_t length) const {
  for (std::size_t channel = 0; channel < configuration_.sync_manager_count; ++channel) {
    const SyncManager& manager = sync_managers_[channel];
    if (manager.guards(address)) {
      const std::uint32_t offset = address - manager.start();
      const std::uint32_t end =
          offset < manager.length() ? manager.length() : manager.guarded_length();
      return {channel, std::min<std::size_t>(length, end - offset)};
    }
    if (manager.guarded_length() != 0 && manager.start() > address) {
      length = std::min<std::size_t>(length, manager.start() - address);
    }
  }
  return {kNoChannel, length};
}

bool SlaveController::read_memory(Side side, std::uint32_t address, std::span<std::byte> out) {
  bool any = false;
  while (!out.empty() && address < memory_.size()) {
    std::size_t count = 0;
    if (address < kRegisterSpace) {
      count = std::min<std::size_t>(out.size(), kRegisterSpace - address);
      any |= read_registers(side, address, out.first(count));
    } else if (!loaded_) {
      return any;
    } else {
      const Piece piece = piece_at(address, std::min(out.size(), memory_.size() - address));
      count = piece.length;
      if (side == Side::bus && partner_ != nullptr) [[unlikely]] {
        partner_->before_bus_read(now_, static_cast<std::uint16_t>(address), count);
      }
      if (piece.channel == kNoChannel) {
        std::copy_n(memory_.begin() + address, count, out.begin());
        any = true;
      } else {
        any |= read_area(side, piece.channel, address, out.first(count));
      }
    }
    address += static_cast<std::uint32_t>(count);
    out = out.subspan(count);
  }
  return any;
}

bool SlaveController::write_memory(Side side, std::uint32_t address,
                                   std::span<const std::byte> data, std::uint8_t first_mask,
                                   std::uint8_t last_mask) {
  bool any = false;
  while (!data.empty() && address < memory_.size()) {
    std::size_t count = 0;
    const bool in_registers = address < kRegisterSpace;
    Piece piece{kNoChannel, 0};
    if (in_registers) {
      count = std::min<std::size_t>(data.size(), kRegisterSpace - address);
    } else if (!loaded_) {
      return any;
    } else {
      piece = piece_at(address, std::min(data.size(), memory_.size() - address));
      count = piece.length;
    }
    const std::span<const std::byte> part = data.first(count);
    const std::uint8_t last = count == data.size() ? last_mask : std::uint8_t{0xFF};
    if (in_registers) {
      any |= write_registers(side, address, part, first_mask, last);
    } else if (side == Side::bus && write_protected(address)) {
      return any;
    } else if (piece.channel == kNoChannel) {
      store_masked(memory_.data() + address, part, first_mask, last);
      any = true;
      tell_partner_of_write(side, address, count);
    } else {
      any |= write_area(side, piece.channel, address, part, first_mask, last);
    }
    address += static_cast<std::uint32_t>(count);
    data = data.subspan(count);
    first_mask = 0xFF;
  }
  return any;
}

bool SlaveController::read_registers(Side side, std::uint32_t address, std::span<std::byte> out) {
  const auto readable = [side](const RegisterMap::Byte& byte) {
    return side == Side::bus ? byte.bus_reads : byte.host_reads;
  };
  EffectSet effects = 0;
  bool any = false;
  for (std::size_t i = 0; i < out.size();) {
    const RegisterMap::Byte& byte = register_map_[address + i];
    if (readable(byte)) {
      any = true;
      effects |= set_of(byte.effect);
    }
    i += byte.run();
  }
  if (!any) {
    return false;
  }
  before_read(effects);
  if (any_of(effects, kClockReads)) {
    take_clock_work(
        clock_unit_.before_read(side, effects, address, out.size(), frame_start_, now_));
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = readable(register_map_[address + i]) ? memory_[address + i] : std::byte{0};
  }
  if (side == Side::bus) {
    after_bus_read(effects);
  } else {
    after_host_read(effects, address, out.size());
  }
  if (any_of(effects, kClockReads) && side == Side::bus) {
    take_clock_work(clock_unit_.acknowledge(side, effects, address, out.size(), now_));
  }
  return true;
}

bool SlaveController::write_registers(Side side, std::uint32_t address,
                                      std::span<const std::byte> data, std::uint8_t first_mask,
                                      std::uint8_t last_mask) {
  EffectSet effects = 0;
  bool any = false;
  for (std::size_t i = 0; i < data.size();) {
    const std::size_t at = address + i;
    const RegisterMap::Byte& byte = register_map_[at];
    const bool conditional = any_of(set_of(byte.effect), kConditionalWrites) || protects_writes();
    const std::size_t next = conditional ? i + 1 : std::min(i + byte.run(), data.size());
    if (!(side == Side::bus ? byte.bus_writes : byte.host_writes) ||
        (conditional && !accepts_write(side, at))) {
      i = next;
      continue;
    }
    any = true;
    effects |= set_of(byte.effect);
    unsigned stores = side == Side::bus ? byte.bus_stores : byte.host_stores;
    if (byte.effect == Effect::sync_manager && register_bit((at & ~std::size_t{7}) + 6, 0)) {
      stores &= 0x40;  // of an enabled sync manager only the watchdog trigger may change
    }
    for (; i < next; ++i) {
      const unsigned mask = stores & mask_at(i, data.size(), first_mask, last_mask);
      store_bits(memory_[address + i], data[i], static_cast<std::uint8_t>(mask));
    }
  }
  if (!any) {
    return false;
  }
  if (side == Side::bus) {
    after_bus_write(effects, address, data);
  } else {
    after_host_write(effects, address, data);
  }
  if (any_of(effects, kClockWrites)) {
    take_clock_work(clock_unit_.after_write(side, effects, address, data, now_));
  }
  return true;
}

bool SlaveController::accepts_write(Side side, std::size_t address) const {
  const Effect effect = register_map_[address].effect;
  return side == Side::bus ? !write_protected(static_cast<std::uint32_t>(address)) &&
                                 accepts_bus_write(effect, address)
                           : accepts_host_write(effect, address);
}

bool SlaveController::accepts_bus_write(Effect effect, std::size_t address) const {
  switch (effect) {
    case Effect::al_control:
      return al_control_taken_ || register_bit(kEscConfiguration, 0);
    case Effect::sii_interface:
      return sii_.bus_may_write();
    case Effect::mii_interface:
      return mii_.bus_may_write();
    case Effect::mii_access:
      return address != kMiiBusAccess || mii_.bus_may_claim();
    case Effect::sync_manager: {
      // Start and length are locked while the sync manager is enabled; control keeps one open bit.
      const bool enabled = register_bit((address & ~std::size_t{7}) + 6, 0);
      return !enabled || (address & 7) == 4;
    }
    default:
      return clock_unit_.accepts_write(Side::bus, effect, address);
  }
}

bool SlaveController::accepts_host_write(Effect effect, std::size_t address) const {
  switch (effect) {
    case Effect::al_control:
    case Effect::watchdog_status:
    case Effect::sync_manager_activate:
      return configuration_.acknowledge_by_write;
    case Effect::al_status:
      return !register_bit(kEscConfiguration, 0);
    case Effect::sii_access:
      return sii_.host_may_take();
    case Effect::sii_interface:
      return sii_.host_may_write();
    case Effect::mii_interface:
      return mii_.host_may_write();
    case Effect::mii_access:
      return mii_.host_may_take();
    default:
      return clock_unit_.accepts_write(Side::host, effect, address);
  }
}

bool SlaveController::protects_writes() const {
  return register_bit(kWriteRegisterProtection, 0) || register_bit(kEscWriteProtection, 0);
}

bool SlaveController::write_protected(std::uint32_t address) const {
  if (register_bit(kEscWriteProtection, 0) && !controller_unlocked_ && address != kEscWriteEnable) {
    return true;
  }
  const bool protectable = address <= 0x0137 || (address >= 0x013A && address <= 0x0F0F);
  return protectable && register_bit(kWriteRegisterProtection, 0) && !registers_unlocked_ &&
         address != kWriteRegisterEnable && address != kEscWriteEnable;
}

bool SlaveController::read_area(Side side, std::size_t channel, std::uint32_t address,
                                std::span<std::byte> out) {
  SyncManager& manager = sync_managers_[channel];
  const std::uint32_t offset = address - manager.start();
  if (manager.condition() == SyncManager::Condition::watchdog_trigger) {
    std::copy_n(memory_.begin() + address, out.size(), out.begin());
    return true;
  }
  const bool is_reader = manager.bus_writes() == (side == Side::host);
  if (!manager.active() || !is_reader || offset >= manager.length() ||
      !manager.begin_read(offset)) {
    return false;
  }
  std::copy_n(memory_.begin() + manager.read_base() + offset, out.size(), out.begin());
  const bool complete = manager.end_read(offset + static_cast<std::uint32_t>(out.size()));
  if ((activations_[channel] & kLatchEvents) != 0) {
    latch_buffer_event(side, channel, offset == 0, complete);
  }
  publish_sync_manager(channel);
  return true;
}

bool SlaveController::write_area(Side side, std::size_t channel, std::uint32_t address,
                                 std::span<const std::byte> data, std::uint8_t first_mask,
                                 std::uint8_t last_mask) {
  SyncManager& manager = sync_managers_[channel];
  const std::uint32_t offset = address - manager.start();
  if (manager.condition() == SyncManager::Condition::watchdog_trigger) {
    store_masked(memory_.data() + address, data, first_mask, last_mask);
    trigger_process_data_watchdog();
    tell_partner_of_write(side, address, data.size());
    return true;
  }
  const bool is_writer = manager.bus_writes() == (side == Side::bus);
  if (!manager.active() || !is_writer || offset >= manager.length() ||
      !manager.begin_write(offset)) {
    return false;
  }
  store_masked(memory_.data() + manager.write_base() + offset, data, first_mask, last_mask);
  const bool complete = manager.end_write(offset + static_cast<std::uint32_t>(data.size()));
  if (complete && manager.triggers_watchdog()) {
    trigger_process_data_watchdog();
  }
  if ((activations_[channel] & kLatchEvents) != 0) {
    latch_buffer_event(side, channel, offset == 0, complete);
  }
  publish_sync_manager(channel);
  if (complete) {
    tell_partner_of_write(side, manager.start(), manager.length());
  }
  return true;
}

void SlaveController::tell_partner_of_write(Side side, std::uint32_t address, std::size_t length) {
  if (side == Side::bus && partner_ != nullptr) [[unlikely]] {
    partner_->after_bus_write(now_, static_cast<std::uint16_t>(address), length);
  }
}

}  // namespace stator::ethercat
