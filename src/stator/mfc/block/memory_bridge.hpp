#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/mfc/block/memory_map.hpp"

namespace stator::mfc {

/// The process data RAM as the memory bridge sees it.
class ProcessData {
 public:
  ProcessData() = default;
  ProcessData(const ProcessData&) = default;
  ProcessData& operator=(const ProcessData&) = default;
  ProcessData(ProcessData&&) = default;
  ProcessData& operator=(ProcessData&&) = default;
  virtual ~ProcessData() = default;

  virtual void read(std::uint16_t address, std::span<std::byte> out) = 0;
  virtual void write(std::uint16_t address, std::span<const std::byte> data) = 0;
  /// The bridge has transferred all it wants of a block.
  virtual void finish(std::uint16_t address, std::size_t length) = 0;
};

/// The registers behind their shadows. Values are little-endian in the lowest bytes.
class BridgedRegisters {
 public:
  BridgedRegisters() = default;
  BridgedRegisters(const BridgedRegisters&) = default;
  BridgedRegisters& operator=(const BridgedRegisters&) = default;
  BridgedRegisters(BridgedRegisters&&) = default;
  BridgedRegisters& operator=(BridgedRegisters&&) = default;
  virtual ~BridgedRegisters() = default;

  /// Value of a read register. `clear`: flags that a read clears are cleared.
  virtual std::uint64_t transfer_out(unsigned number, bool clear) = 0;
  /// A write register takes over `value`. Bit i of `written`: the event behind it wrote byte i.
  virtual void transfer_in(unsigned number, std::uint64_t value, std::uint8_t written) = 0;
};

/// The memory bridge: it moves mapped registers between the process data RAM and their shadow
/// registers, and shadow registers to or from the registers when their trigger comes (TMC8461
/// datasheet section 7.9, L8834-L8900).
///
/// It runs for the bytes that the master writes, and for those it is about to read: block 0 into
/// shadows after the write, shadows into block 1 before the read. A transparent shadow is
/// exchanged at once. Triggers other than these exchange shadow and register and bring block 1 up
/// to date. Padding stays plain memory.
class MemoryBridge {
 public:
  /// What clears flags that are cleared by reading.
  enum class FlagClearing : std::uint8_t {
    by_transfer,  ///< their way into the shadow register
    by_master,    ///< the master's read of the RAM
  };

  /// Parameters have changed: the next transfer goes by them. Shadows keep their content.
  void configure(const Configuration& configuration);
  /// Shadows as after a reset.
  void reset() { *this = MemoryBridge(); }
  /// By AL state: the master reads registers in Safe-Operational and Operational, and writes them
  /// in Operational (L8128-L8140).
  void set_access(bool reads, bool writes);
  void set_flag_clearing(FlagClearing clearing) { clearing_ = clearing; }

  [[nodiscard]] const MemoryMap& map() const { return map_; }
  /// Whether an enabled register waits for `trigger`.
  [[nodiscard]] bool uses(Trigger trigger) const {
    return (triggers_ >> static_cast<unsigned>(trigger) & 1U) != 0;
  }

  /// The master has written `length` bytes from `address` on.
  void after_write(std::uint32_t address, std::size_t length, ProcessData& memory,
                   BridgedRegisters& registers);
  /// The master is about to read `length` bytes from `address` on.
  void before_read(std::uint32_t address, std::size_t length, ProcessData& memory,
                   BridgedRegisters& registers);
  /// A trigger other than the bridge's own has come.
  void trigger(Trigger trigger, ProcessData& memory, BridgedRegisters& registers);

 private:
  static constexpr std::uint8_t kEveryByte = 0xFF;

  void put(const MappedRegister& mapped, std::uint8_t written, BridgedRegisters& registers) const;
  void take(const MappedRegister& mapped, BridgedRegisters& registers);
  void store(const MappedRegister& mapped, ProcessData& memory) const;

  MemoryMap map_;
  std::uint32_t triggers_ = 0;  ///< bit n: an enabled register waits for trigger n
  std::array<std::uint64_t, kMappableCount> shadows_{};
  FlagClearing clearing_ = FlagClearing::by_transfer;
  bool reads_ = false;
  bool writes_ = false;
};

}  // namespace stator::mfc
