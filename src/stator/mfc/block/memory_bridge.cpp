#include "stator/mfc/block/memory_bridge.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::mfc {

namespace {

using Buffer = std::array<std::byte, 8>;

constexpr unsigned kWriteBlock = 0;
constexpr unsigned kReadBlock = 1;

bool overlaps(const MappedRegister& mapped, std::uint32_t from, std::uint32_t to) {
  return mapped.address < to && from < mapped.end();
}

/// Bit i: byte i of the register lies in [from, to).
std::uint8_t bytes_in(const MappedRegister& mapped, std::uint32_t from, std::uint32_t to) {
  unsigned mask = 0;
  for (unsigned i = 0; i < mapped.size; ++i) {
    const std::uint32_t at = mapped.address + i;
    mask |= at >= from && at < to ? 1U << i : 0U;
  }
  return static_cast<std::uint8_t>(mask);
}

}  // namespace

void MemoryBridge::set_access(bool reads, bool writes) {
  reads_ = reads;
  writes_ = writes;
}

void MemoryBridge::configure(const Configuration& configuration) {
  map_ = MemoryMap(configuration);
  triggers_ = 0;
  for (const unsigned block : {kWriteBlock, kReadBlock}) {
    for (const MappedRegister& mapped : map_.registers(block)) {
      triggers_ |= 1U << static_cast<unsigned>(mapped.trigger);
    }
  }
}

void MemoryBridge::put(const MappedRegister& mapped, std::uint8_t written,
                       BridgedRegisters& registers) const {
  if (writes_) {
    registers.transfer_in(mapped.number, shadows_[mapped.number], written);
  }
}

void MemoryBridge::take(const MappedRegister& mapped, BridgedRegisters& registers) {
  shadows_[mapped.number] =
      registers.transfer_out(mapped.number, clearing_ == FlagClearing::by_transfer);
}

void MemoryBridge::store(const MappedRegister& mapped, ProcessData& memory) const {
  Buffer bytes{};
  base::store_le(std::span<std::byte>(bytes), 0, shadows_[mapped.number]);
  memory.write(static_cast<std::uint16_t>(mapped.address),
               std::span<const std::byte>(bytes).first(mapped.size));
}

void MemoryBridge::after_write(std::uint32_t address, std::size_t length, ProcessData& memory,
                               BridgedRegisters& registers) {
  const MemoryMap::Block& block = map_.block(kWriteBlock);
  const auto end = static_cast<std::uint32_t>(address + length);
  if (!block.valid() || !block.overlaps(address, end)) {
    return;
  }
  for (const MappedRegister& mapped : map_.registers(kWriteBlock)) {
    if (!overlaps(mapped, address, end)) {
      continue;
    }
    if (mapped.trigger == Trigger::before_bridge) {
      put(mapped, kEveryByte, registers);
    }
    Buffer bytes{};
    memory.read(static_cast<std::uint16_t>(mapped.address), std::span(bytes).first(mapped.size));
    shadows_[mapped.number] = base::load_le<std::uint64_t>(bytes);
    if (transparent(mapped.trigger) || mapped.trigger == Trigger::after_bridge) {
      put(mapped, bytes_in(mapped, address, end), registers);
    }
  }
  memory.finish(static_cast<std::uint16_t>(block.start), block.length);
}

void MemoryBridge::before_read(std::uint32_t address, std::size_t length, ProcessData& memory,
                               BridgedRegisters& registers) {
  const MemoryMap::Block& block = map_.block(kReadBlock);
  const auto end = static_cast<std::uint32_t>(address + length);
  if (!reads_ || !block.valid() || !block.overlaps(address, end)) {
    return;
  }
  for (const MappedRegister& mapped : map_.registers(kReadBlock)) {
    if (!overlaps(mapped, address, end)) {
      continue;
    }
    if (transparent(mapped.trigger) || mapped.trigger == Trigger::before_bridge) {
      take(mapped, registers);
    }
    store(mapped, memory);
    if (mapped.trigger == Trigger::after_bridge) {
      take(mapped, registers);
    }
    if (clearing_ == FlagClearing::by_master) {
      static_cast<void>(registers.transfer_out(mapped.number, true));
    }
  }
  memory.finish(static_cast<std::uint16_t>(block.start), block.length);
}

void MemoryBridge::trigger(Trigger trigger, ProcessData& memory, BridgedRegisters& registers) {
  if (map_.block(kWriteBlock).valid()) {
    for (const MappedRegister& mapped : map_.registers(kWriteBlock)) {
      if (mapped.trigger == trigger) {
        put(mapped, kEveryByte, registers);
      }
    }
  }
  if (!reads_ || !map_.block(kReadBlock).valid()) {
    return;
  }
  for (const MappedRegister& mapped : map_.registers(kReadBlock)) {
    if (mapped.trigger == trigger) {
      take(mapped, registers);
      store(mapped, memory);
    }
  }
}

}  // namespace stator::mfc
