#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/byte_order.hpp"
#include "stator/mfc/block/block.hpp"

namespace stator::mfc::testing {

/// 64 KB of plain process data RAM.
class Ram final : public ProcessData {
 public:
  void read(std::uint16_t address, std::span<std::byte> out) override {
    std::copy_n(bytes_.begin() + address, out.size(), out.begin());
  }
  void write(std::uint16_t address, std::span<const std::byte> data) override {
    std::copy(data.begin(), data.end(), bytes_.begin() + address);
  }
  void finish(std::uint16_t /*address*/, std::size_t /*length*/) override { ++finished; }
  int finished = 0;

 private:
  std::vector<std::byte> bytes_ = std::vector<std::byte>(0x10000);
};

/// What a listener was told.
struct LineChange {
  std::int64_t time;
  std::size_t line;
  PinState state;
  friend bool operator==(const LineChange&, const LineChange&) = default;
};
constexpr std::size_t kInterruptLine = 99;

/// A block with a master at its process data and a controller at its MFC CTRL SPI.
class BlockFixture : public PinListener {
 public:
  static constexpr std::uint16_t kWrites = 0x1000;
  static constexpr std::uint16_t kReads = 0x2000;

  BlockFixture() {
    block.set_process_data(&ram);
    block.set_listener(this);
    configuration.set_block_start(0, kWrites);
    configuration.set_block_start(1, kReads);
  }

  BlockFixture& connect(std::size_t line, Signal signal) {
    configuration.set_signal(line, static_cast<std::uint8_t>(signal));
    return *this;
  }
  BlockFixture& map(std::uint8_t number, Trigger trigger = Trigger::always) {
    configuration.set_mapping(number, {true, trigger});
    return *this;
  }
  void configure() { block.load_configuration(configuration.bytes()); }
  void operational() { block.set_al_state(Block::kOperational); }
  void wait(base::SimDuration time) { block.advance(block.now() + time); }

  /// The controller's side.
  void set(std::uint8_t number, std::uint64_t value, std::size_t bytes = 0) {
    std::array<std::byte, 8> data{};
    base::store_le(std::span<std::byte>(data), 0, value);
    block.write(
        kRegisters[number].spi_address(),
        std::span<const std::byte>(data).first(bytes == 0 ? kRegisters[number].size : bytes));
  }
  std::uint64_t get(std::uint8_t number) {
    std::array<std::byte, 8> data{};
    block.read(kRegisters[number].spi_address(), data);
    return base::load_le<std::uint64_t>(data);
  }

  /// The master's side: address of a mapped register.
  std::uint16_t address(std::uint8_t number) const {
    for (const unsigned part : {0U, 1U}) {
      for (const MappedRegister& mapped : block.memory_map().registers(part)) {
        if (mapped.number == number) {
          return static_cast<std::uint16_t>(mapped.address);
        }
      }
    }
    return 0;
  }
  void master_writes(std::uint8_t number, std::uint64_t value) {
    std::array<std::byte, 8> data{};
    base::store_le(std::span<std::byte>(data), 0, value);
    const std::size_t size = kRegisters[number].size;
    ram.write(address(number), std::span<const std::byte>(data).first(size));
    block.after_bus_write(address(number), size);
  }
  std::uint64_t master_reads(std::uint8_t number) {
    std::array<std::byte, 8> data{};
    const std::size_t size = kRegisters[number].size;
    block.before_bus_read(address(number), size);
    ram.read(address(number), std::span(data).first(size));
    return base::load_le<std::uint64_t>(data);
  }

  void pin_changed(base::SimTime time, std::size_t line, PinState state) override {
    changes.push_back({time.nanoseconds(), line, state});
  }
  void interrupt_changed(base::SimTime time, bool level) override {
    changes.push_back({time.nanoseconds(), kInterruptLine, level ? PinState::high : PinState::low});
  }

  Ram ram;
  Block block;
  Configuration configuration;
  std::vector<LineChange> changes;
};

}  // namespace stator::mfc::testing
