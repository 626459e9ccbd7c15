#include "stator/ethercat/units/sync_manager.hpp"

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/registers/register_table.hpp"

namespace stator::ethercat {

void SyncManager::configure(std::span<const std::byte, kRegisterLength> registers,
                            std::size_t memory_end, bool one_byte) {
  *this = SyncManager();
  const std::span<const std::byte> bytes = registers;
  const auto control = std::to_integer<unsigned>(bytes[4]);
  const auto activate = std::to_integer<unsigned>(bytes[6]);
  const auto host_control = std::to_integer<unsigned>(bytes[7]);
  const unsigned mode = control & 0x03;
  const unsigned direction = control >> 2 & 0x03;
  start_ = base::load_le<std::uint16_t>(bytes, 0);
  length_ = base::load_le<std::uint16_t>(bytes, 2);
  buffered_ = mode == 0;
  bus_writes_ = direction == 1;
  watchdog_trigger_ = (control & 0x40) != 0;
  if ((activate & 0x01) == 0) {
    return;
  }
  const bool known_mode = (mode == 0 || mode == 2) && direction <= 1;
  const std::uint32_t area = std::uint32_t{length_} * (buffered_ ? 3U : 1U);
  if (!known_mode) {
    condition_ = Condition::bad_mode;
    return;
  }
  const bool only_trigger = length_ == 1 && watchdog_trigger_ && bus_writes_ && !one_byte;
  const bool long_enough = length_ > 1 || only_trigger || (length_ == 1 && one_byte);
  if (!long_enough || start_ < kRegisterSpace || start_ + area > memory_end) {
    condition_ = Condition::bad_area;
    return;
  }
  if (only_trigger) {
    guarded_length_ = 1;
    condition_ = Condition::watchdog_trigger;
    return;
  }
  guarded_length_ = area;
  status_ = buffered_ ? kNoBuffer : 0;
  if (buffered_) {
    buffer_offset_[1] = length_;
    buffer_offset_[2] = 2U * length_;
  }
  // A side is interrupted by what the other side does: the reader by a write, the writer by a read.
  if ((control & 0x20) != 0) {
    host_interrupt_bits_ = bus_writes_ ? kWriteInterrupt : kReadInterrupt;
  }
  if ((control & 0x10) != 0) {
    bus_interrupt_bits_ = bus_writes_ ? kReadInterrupt : kWriteInterrupt;
  }
  condition_ = (host_control & 0x01) != 0 ? Condition::deactivated : Condition::active;
}

void SyncManager::refresh_control(std::uint8_t control) {
  watchdog_trigger_ = (control & 0x40) != 0;
}

}  // namespace stator::ethercat
