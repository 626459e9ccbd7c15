#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "board/bench.hpp"
#include "stator/board/assembly/block_pins.hpp"
#include "stator/mfc/block/block.hpp"
#include "stator/mfc/registers/register_map.hpp"
#include "stator/mfc/registers/register_numbers.hpp"

namespace stator::board {

/// A TMC8461's I/O block in Operational with a board at its pins.
class Chip {
 public:
  /// `connections`: line and signal.
  Chip(std::initializer_list<std::pair<unsigned, mfc::Signal>> connections,
       std::vector<PeripheralConfiguration> parts, LogicTrace* trace = nullptr) {
    std::array<std::byte, mfc::Configuration::kLength> parameters{};
    for (const auto& [line, signal] : connections) {
      parameters[line] = static_cast<std::byte>(signal);
    }
    block.load_configuration(parameters);
    block.set_al_state(mfc::Block::kOperational);
    block.set_emergency_pin(true);
    board = std::make_unique<Board>(BoardConfiguration{std::move(parts)}, pins, base::SimTime());
    if (trace != nullptr) {
      board->trace(*trace);
    }
  }

  mfc::Block block;
  BlockPins pins{block};
  std::unique_ptr<Board> board;

  void wait(base::SimDuration time) { board->advance(board->time() + time); }
  void set(unsigned number, std::uint64_t value) {
    board->advance(board->time());
    std::array<std::byte, 8> bytes{};
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      bytes[k] = static_cast<std::byte>(value >> (8 * k));
    }
    block.write(static_cast<std::uint16_t>(number << 4U), bytes);
  }
  std::uint64_t get(unsigned number) {
    board->advance(board->time());
    std::array<std::byte, 8> bytes{};
    block.read(static_cast<std::uint16_t>(number << 4U), bytes);
    std::uint64_t value = 0;
    for (std::size_t k = bytes.size(); k-- > 0;) {
      value = value << 8U | std::to_integer<std::uint64_t>(bytes[k]);
    }
    return value;
  }
  [[nodiscard]] double signal(const std::string& name) {
    for (const base::Signal& signal : board->signals()) {
      if (signal.name == name) {
        return signal.read();
      }
    }
    throw std::runtime_error("no signal " + name);
  }
  void input(const std::string& name, double value) {
    for (const base::Input& input : board->inputs()) {
      if (input.name == name) {
        input.set(value);
        board->advance(board->time());
        return;
      }
    }
    throw std::runtime_error("no input " + name);
  }

  /// One transfer of the SPI master at select 0; 1 us a bit at most.
  std::uint64_t spi(std::uint64_t data, unsigned bits, bool keep_selected = false) {
    using namespace mfc::register_number;
    set(kSpiLength, bits - 1);
    set(kSpiConf, keep_selected ? 8 : 0);
    set(kSpiTxData, data);
    wait(base::SimDuration(1'000 * (bits + 2)));
    return get(kSpiRxData) & (bits < 64 ? (std::uint64_t{1} << bits) - 1 : ~std::uint64_t{0});
  }
  /// A command of the I2C master at 1 us per bit; returns the status behind it.
  std::uint64_t i2c(std::uint64_t command) {
    using namespace mfc::register_number;
    set(kI2cControl, command);
    wait(15_us);
    return get(kI2cStatus) & 0xFFU;
  }
};

inline const std::initializer_list<std::pair<unsigned, mfc::Signal>> kSpiConnections{
    {kSckLine, mfc::Signal::sck},
    {kMosiLine, mfc::Signal::sdo},
    {kMisoLine, mfc::Signal::sdi},
    {kCsLine, mfc::Signal::cs0}};

}  // namespace stator::board
