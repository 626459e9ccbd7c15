#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "devices/test_bus.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/ethercat/standard/al_state.hpp"

namespace stator::tests {

/// A TMC8461 on a bus of its own, with a controller at its pins and a list of what the lines told.
class ChipBoard final : public product::HostLineSink {
 public:
  using Bytes = std::vector<std::byte>;

  explicit ChipBoard(const devices::Tmc8461Configuration& configuration = {})
      : chip(configuration), bus(chip) {}
  ~ChipBoard() override { chip.watch(0, nullptr); }

  static Bytes bytes(std::initializer_list<unsigned> values) {
    Bytes result;
    for (const unsigned value : values) {
      result.push_back(static_cast<std::byte>(value));
    }
    return result;
  }

  /// A datagram at the PDI; what came back.
  std::vector<unsigned> pdi(std::initializer_list<unsigned> mosi) {
    return spi(product::HostSpi::pdi, mosi);
  }
  std::vector<unsigned> spi(product::HostSpi port, std::initializer_list<unsigned> mosi) {
    const Bytes out = bytes(mosi);
    Bytes in(out.size(), std::byte{0xAA});
    chip.exchange(port, out, in);
    std::vector<unsigned> result;
    for (const std::byte each : in) {
      result.push_back(std::to_integer<unsigned>(each));
    }
    return result;
  }
  void pdi_write(std::uint16_t address, std::initializer_list<unsigned> data) {
    Bytes out = bytes({address >> 5U & 0xFFU, (address & 0x1FU) << 3U | 6U,
                       (static_cast<unsigned>(address) >> 13U) << 5U | 4U << 2U});
    const Bytes tail = bytes(data);
    out.insert(out.end(), tail.begin(), tail.end());
    Bytes in(out.size());
    chip.exchange(product::HostSpi::pdi, out, in);
  }

  [[nodiscard]] bool high(product::HostLine line) {
    return (chip.levels() & product::host_line(line)) != 0;
  }
  void watch(std::initializer_list<product::HostLine> lines) {
    product::HostLines mask = 0;
    for (const product::HostLine line : lines) {
      mask = static_cast<product::HostLines>(mask | product::host_line(line));
    }
    changes.clear();
    chip.watch(mask, this);
  }
  void on_lines(const product::HostLineChange& change) override { changes.push_back(change); }
  /// Times at which `line` rose, ns.
  [[nodiscard]] std::vector<std::int64_t> rises(product::HostLine line) const {
    std::vector<std::int64_t> times;
    for (const product::HostLineChange& change : changes) {
      if ((change.rose & product::host_line(line)) != 0) {
        times.push_back((change.time - base::SimTime()).nanoseconds());
      }
    }
    return times;
  }
  [[nodiscard]] std::vector<std::int64_t> falls(product::HostLine line) const {
    std::vector<std::int64_t> times;
    for (const product::HostLineChange& change : changes) {
      if ((change.fell & product::host_line(line)) != 0) {
        times.push_back((change.time - base::SimTime()).nanoseconds());
      }
    }
    return times;
  }
  void bus_write(std::uint16_t address, std::initializer_list<unsigned> values) {
    bus.write(address, bytes(values));
  }
  unsigned bus_read(std::uint16_t address) {
    return std::to_integer<unsigned>(bus.read(address, 1)[0]);
  }

  devices::Tmc8461 chip;
  TestBus bus;
  std::vector<product::HostLineChange> changes;
};

}  // namespace stator::tests
