#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/byte_order.hpp"
#include "master/master.hpp"
#include "rack/fault_section.hpp"
#include "rack/faults.hpp"
#include "rack/local_can_port.hpp"
#include "rack/local_port.hpp"
#include "rack/rack.hpp"
#include "rack/rack_file.hpp"
#include "rack/test_can_device.hpp"
#include "rack/test_serial_device.hpp"

namespace stator::tests {

/// What benches of all networks have: a rack whose faults are asked for as in a rack file.
template <typename Derived>
class FaultBenchBase {
 public:
  std::uint64_t inject(const std::string& keys) {
    const auto armed =
        self().rack.faults().inject(rack::parse_fault(keys, self().configuration), self().now());
    EXPECT_TRUE(armed) << armed.error();
    return armed ? *armed : 0;
  }
  void clear(std::uint64_t fault) { EXPECT_TRUE(self().rack.faults().clear(fault, self().now())); }
  [[nodiscard]] rack::FaultStatus status(std::uint64_t fault) {
    for (const rack::FaultStatus& status : self().rack.faults().list(self().now())) {
      if (status.id == fault) {
        return status;
      }
    }
    ADD_FAILURE() << "no fault " << fault;
    return {};
  }
  [[nodiscard]] rack::FaultState state(std::uint64_t fault) { return status(fault).state; }
  [[nodiscard]] double signal(const std::string& name) {
    for (const devices::Signal& candidate : self().rack.signals()) {
      if (candidate.name == name) {
        return candidate.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }

 private:
  [[nodiscard]] Derived& self() { return static_cast<Derived&>(*this); }
};

inline constexpr const char* kTwoModules = R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "left"
[[segment.device]]
type = "tmcm-3315"
name = "right"
)";

/// Two modules in line, "left" and "right", behind a master in the same process.
class SegmentFaultBench : public FaultBenchBase<SegmentFaultBench> {
 public:
  explicit SegmentFaultBench(const std::string& file = kTwoModules)
      : configuration(rack::parse_rack_file(file, "test.toml")),
        rack(configuration, log),
        port(rack, 0, configuration.cycle, configuration.step),
        master(port) {}

  [[nodiscard]] base::SimTime now() { return port.now(); }
  [[nodiscard]] std::size_t scan() { return master.scan() ? master.slaves().size() : 0; }
  void bring_to_operational(std::size_t slaves = 2) {
    ASSERT_EQ(scan(), slaves);
    const auto configured = master.configure_process_data();
    ASSERT_TRUE(configured) << configured.error().text;
    const auto operational = master.go_operational();
    ASSERT_TRUE(operational) << operational.error().text;
    ASSERT_TRUE(master.exchange_process_data());
  }
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
  /// A register as it is, without a frame.
  [[nodiscard]] unsigned peek(std::size_t slave, std::uint16_t address) {
    std::array<std::byte, 2> bytes{};
    rack.segment(0).slave(slave).peek(address, bytes);
    return base::load_le<std::uint16_t>(bytes);
  }
  [[nodiscard]] unsigned counter(std::size_t slave, std::uint16_t address) {
    return peek(slave, address) & 0xFFU;
  }

  rack::RackConfiguration configuration;
  rack::EventLog log;
  rack::Rack rack;
  rack::LocalPort port;
  master::Master master;

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
class BusFaultBench : public FaultBenchBase<BusFaultBench> {
 public:
  explicit BusFaultBench(std::optional<std::uint32_t> bit_rate = {},
                         base::SimDuration heartbeat = {})
      : configuration(rack_with_bus(2, bit_rate, heartbeat)),
        rack(configuration, log),
        port(rack, 0, configuration.cycle, configuration.step) {}

  [[nodiscard]] base::SimTime now() { return port.now(); }
  [[nodiscard]] const can::Bus& bus() { return rack.bus(0).bus(); }
  /// What came since the last call.
  std::vector<std::uint32_t> received() {
    std::vector<std::uint32_t> identifiers;
    while (const auto entry = port.receive()) {
      identifiers.push_back(entry->frame.identifier);
    }
    return identifiers;
  }
  std::vector<std::uint32_t> ask(std::uint32_t identifier) {
    static_cast<void>(received());
    port.send(can::data_frame(identifier, {1, 2}));
    return received();
  }

  rack::RackConfiguration configuration;
  rack::EventLog log;
  rack::Rack rack;
  rack::LocalCanPort port;
};

/// A module with address 1 on a serial line.
class LineFaultBench : public FaultBenchBase<LineFaultBench> {
 public:
  static constexpr const char* kLine = "pty:field";
  using Bytes = std::vector<std::byte>;

  explicit LineFaultBench() : configuration(configured()), rack(configuration, log) {
    rack.line(0).connect(rack::SerialLine::Output::bind<&LineFaultBench::hear>(*this));
  }

  [[nodiscard]] base::SimTime now() const { return now_; }
  void wait(base::SimDuration duration) {
    now_ += duration;
    rack.advance(now_);
  }
  /// Asks the module for its address and returns what comes within `patience`.
  Bytes ask(base::SimDuration patience = base::SimDuration(5'000'000)) {
    heard_.clear();
    const tmcl::Telegram telegram =
        tmcl::encode(tmcl::Request{.address = 1, .command = 10, .type = 66});
    rack.line(0).put(telegram, now_);
    wait(patience);
    return heard_;
  }
  [[nodiscard]] const Bytes& heard() const { return heard_; }
  static Bytes answer() {
    const tmcl::Telegram telegram =
        tmcl::encode(tmcl::Reply{.module_address = 1, .command = 10, .value = 1});
    return {telegram.begin(), telegram.end()};
  }

  rack::RackConfiguration configuration;
  rack::EventLog log;
  rack::Rack rack;

 private:
  static rack::RackConfiguration configured() {
    return rack_with_line(kLine, {TestSerialDevice::Settings{}});
  }
  void hear(std::span<const std::byte> bytes) {
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }

  base::SimTime now_{base::SimDuration(2'000'000)};
  Bytes heard_;
};

}  // namespace stator::tests
