#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "rack/rack_bench.hpp"
#include "rack/test_can_device.hpp"
#include "rack/test_serial_device.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/networks/can_network.hpp"

namespace stator::tests {

/// A bench whose faults are asked for as in a rack file.
template <typename Bench>
class WithFaults : public Bench {
 public:
  using Bench::Bench;

  std::uint64_t inject(const std::string& keys) {
    const auto armed = this->rack.inject(rack::parse_fault(keys, this->configuration), this->now());
    EXPECT_TRUE(armed) << armed.error();
    return armed ? *armed : 0;
  }
  void clear(std::uint64_t fault) { EXPECT_EQ(this->rack.clear_faults(fault, this->now()), 1U); }
  [[nodiscard]] rack::FaultStatus status(std::uint64_t fault) {
    for (const rack::FaultStatus& status : this->rack.faults(this->now())) {
      if (status.id == fault) {
        return status;
      }
    }
    ADD_FAILURE() << "no fault " << fault;
    return {};
  }
  [[nodiscard]] rack::FaultState state(std::uint64_t fault) { return status(fault).state; }
};

/// A segment whose frames can be sent one by one.
class SegmentFaultBench : public WithFaults<SegmentBench> {
 public:
  explicit SegmentFaultBench(const std::string& file = kTwoModules) : WithFaults(file) {}

  /// One frame with one datagram, as it was sent or came back.
  struct Answer {
    std::uint8_t index = 0;
    std::uint16_t working_counter = 0;
    std::uint64_t value = 0;
  };
  std::optional<Answer> send(ethercat::Command command, std::uint16_t slave, std::uint16_t address,
                             std::uint16_t value = 0, base::SimDuration timeout = {}) {
    std::array<std::byte, 64> buffer{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    std::array<std::byte, 2> data{};
    base::store_le(data, 0, value);
    const auto position = static_cast<std::uint16_t>(-static_cast<int>(slave));
    builder.append(command, ++index_, ethercat::physical_address(position, address),
                   std::span<const std::byte>(data));
    return take(port.exchange(builder.finish(), reply_, timeout));
  }
  /// The next frame that comes within `timeout`.
  std::optional<Answer> receive(base::SimDuration timeout) {
    return take(port.exchange({}, reply_, timeout));
  }
  [[nodiscard]] std::uint8_t index() const { return index_; }
  /// A register as it is, without a frame, while frames do not come through.
  [[nodiscard]] unsigned peek(std::size_t slave, std::uint16_t address) {
    std::array<std::byte, 2> bytes{};
    rack.segment(0).slave(slave).peek(address, bytes);
    return base::load_le<std::uint16_t>(bytes);
  }
  /// A register as a frame reads it.
  [[nodiscard]] unsigned read(std::uint16_t slave, std::uint16_t address) {
    const auto answer = send(ethercat::Command::aprd, slave, address);
    EXPECT_TRUE(answer && answer->working_counter == 1) << slave << " " << address;
    return answer ? static_cast<unsigned>(answer->value) : 0U;
  }
  [[nodiscard]] unsigned counter(std::uint16_t slave, std::uint16_t address) {
    return read(slave, address) & 0xFFU;
  }

 private:
  std::optional<Answer> take(const master::Result<std::size_t>& length) {
    if (!length || *length == 0) {
      return std::nullopt;
    }
    const auto datagram = ethercat::DatagramCursor(std::span(reply_).first(*length)).next();
    if (!datagram) {
      return std::nullopt;
    }
    return Answer{datagram->index, datagram->working_counter,
                  base::load_le<std::uint16_t>(datagram->bytes())};
  }

  std::array<std::byte, ethercat::kMaximumFrameLength> reply_{};
  std::uint8_t index_ = 0;
};

/// Two devices "a" and "b" on a bus "can0", which answer 601h and 602h.
class BusFaultBench : public WithFaults<BusBench> {
 public:
  explicit BusFaultBench(std::optional<std::uint32_t> bit_rate = {},
                         base::SimDuration heartbeat = {})
      : WithFaults(rack_with_bus(2, bit_rate, heartbeat)) {}

  [[nodiscard]] const can::Bus& bus() const { return rack.bus(0).bus(); }
  std::vector<std::uint32_t> ask(std::uint32_t identifier) {
    static_cast<void>(received());
    port.send(can::data_frame(identifier, {1, 2}));
    return received();
  }
};

/// A module with address 1 on a serial line.
class LineFaultBench : public WithFaults<LineBench> {
 public:
  explicit LineFaultBench()
      : WithFaults(rack_with_line("pty:field", {TestSerialDevice::Settings{}})) {}

  /// Asks the module for its address and returns what comes within `patience`.
  Bytes ask(base::SimDuration patience = base::SimDuration(5'000'000)) {
    return LineBench::ask(tmcl::encode(tmcl::Request{.address = 1, .command = 10, .type = 66}),
                          patience);
  }
  static Bytes answer() {
    const tmcl::Telegram telegram =
        tmcl::encode(tmcl::Reply{.module_address = 1, .command = 10, .value = 1});
    return {telegram.begin(), telegram.end()};
  }
};

}  // namespace stator::tests
