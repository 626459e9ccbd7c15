#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "stator/bench/local_can_port.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::tests {

/// Two modules in line, "left" and "right".
inline constexpr const char* kTwoModules = R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "left"
[[segment.device]]
type = "tmcm-3315"
name = "right"
)";

/// Why a rack file is refused.
inline std::string refusal_of_rack(const std::string& file) {
  try {
    static_cast<void>(rack::parse_rack_file(file, "test.toml", devices::products()));
  } catch (const rack::RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

/// A rack, its events and its signals by name.
class RackBench {
 public:
  explicit RackBench(rack::RackConfiguration wanted)
      : configuration(std::move(wanted)), rack(configuration, log) {}
  explicit RackBench(const std::string& file)
      : RackBench(rack::parse_rack_file(file, file_name, devices::products())) {}

  [[nodiscard]] double signal(const std::string& name) {
    for (const product::Signal& candidate : rack.signals()) {
      if (candidate.name == name) {
        return candidate.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }

  static constexpr const char* file_name = "test.toml";
  rack::RackConfiguration configuration;
  rack::EventLog log;
  rack::Rack rack;
};

/// A rack whose first segment has a master in the same process.
class SegmentBench : public RackBench {
 public:
  explicit SegmentBench(rack::RackConfiguration wanted)
      : RackBench(std::move(wanted)),
        port(rack, 0, configuration.cycle, configuration.step),
        master(port) {}
  explicit SegmentBench(const std::string& file = kTwoModules)
      : SegmentBench(rack::parse_rack_file(file, file_name, devices::products())) {}

  [[nodiscard]] base::SimTime now() { return port.now(); }
  /// Lets simulated time pass up to `moment` after the start.
  void wait_until(base::SimDuration moment) { port.wait(base::SimTime(moment) - port.now()); }
  [[nodiscard]] std::size_t scan() { return master.scan() ? master.slaves().size() : 0; }
  void bring_to_operational(std::size_t slaves = 2) {
    ASSERT_EQ(scan(), slaves);
    const auto configured = master.configure_process_data();
    ASSERT_TRUE(configured) << configured.error().text;
    const auto operational = master.go_operational();
    ASSERT_TRUE(operational) << operational.error().text;
    ASSERT_TRUE(master.exchange_process_data());
  }

  bench::LocalPort port;
  master::Master master;
};

/// A rack whose first CAN bus has a master in the same process.
class BusBench : public RackBench {
 public:
  explicit BusBench(rack::RackConfiguration wanted)
      : RackBench(std::move(wanted)), port(rack, 0, configuration.cycle, configuration.step) {}
  explicit BusBench(const std::string& file)
      : BusBench(rack::parse_rack_file(file, file_name, devices::products())) {}

  [[nodiscard]] base::SimTime now() const { return port.now(); }
  /// What came since the last call.
  std::vector<can::Frame> received_frames() {
    std::vector<can::Frame> frames;
    while (const auto entry = port.receive()) {
      frames.push_back(entry->frame);
    }
    return frames;
  }
  /// The identifiers of that.
  std::vector<std::uint32_t> received() {
    std::vector<std::uint32_t> identifiers;
    for (const can::Frame& frame : received_frames()) {
      identifiers.push_back(frame.identifier);
    }
    return identifiers;
  }

  bench::LocalCanPort port;
};

/// A rack whose first serial line has a host at its other end.
class LineBench : public RackBench {
 public:
  using Bytes = std::vector<std::byte>;

  explicit LineBench(rack::RackConfiguration wanted) : RackBench(std::move(wanted)) {
    rack.connect_line(0, rack::SerialLine::Output::bind<&LineBench::hear>(*this));
  }
  explicit LineBench(const std::string& file)
      : LineBench(rack::parse_rack_file(file, file_name, devices::products())) {}

  [[nodiscard]] base::SimTime now() const { return now_; }
  void wait(base::SimDuration duration) {
    now_ += duration;
    rack.advance(now_);
  }
  /// What comes within `patience` after `request`.
  Bytes ask(std::span<const std::byte> request, base::SimDuration patience) {
    heard_.clear();
    rack.put(0, request, now_);
    wait(patience);
    return heard_;
  }
  [[nodiscard]] const Bytes& heard() const { return heard_; }

 private:
  void hear(std::span<const std::byte> bytes) {
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }

  base::SimTime now_{base::SimDuration(2'000'000)};
  Bytes heard_;
};

}  // namespace stator::tests
