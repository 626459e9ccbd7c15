// Many TMCC160 on one CAN bus in lockstep: equal runs give equal bits.

#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "sanitized.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/can/bus.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;

/// Twelve are one of each way to turn.
constexpr unsigned kDrives = tests::kSanitized ? 12 : 32;
constexpr unsigned kCycles = 100;

/// A way to turn: one of the four modes with the object of its target, commutated by the halls, by
/// the encoder, or, where no torque is asked for, by an angle of its own.
struct Way {
  std::uint8_t mode;
  std::uint8_t commutation;  ///< 2055h
  std::uint16_t target_object;
  std::int32_t target;
};

Way way_of(unsigned drive) {
  const auto commutation = static_cast<std::uint8_t>(6 + drive / 4 % (drive % 4 == 3 ? 2 : 3));
  const auto more = static_cast<std::int32_t>(drive);
  switch (drive % 4) {
    case 0:
      return {1, commutation, 0x607A, 3'000 + 40 * more};
    case 1:
      return {3, commutation, 0x60FF, -500 - 20 * more};
    case 2:
      return {6, commutation, 0x6099, 200 + 5 * more};
    default:
      return {10, commutation, 0x6071, 900 + 25 * more};
  }
}

/// What one run leaves behind.
struct Evidence {
  std::vector<can::TimedFrame> frames;  ///< all of the bus, as a port gets them
  std::string recording;                ///< every signal in every cycle
  std::string capture;                  ///< of the wire, with its error frames
  std::vector<double> speeds;           ///< of the shafts at the end
  can::BusStatistics bus;
  std::uint64_t sent = 0;  ///< frames of the master
};

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

class Run {
 public:
  Run(std::optional<std::uint32_t> bit_rate, const std::string& directory)
      : configuration_(configure(bit_rate, directory)),
        rack_(configuration_, log_),
        port_(rack_, 0, 1_ms, 50_us) {}

  Evidence make(std::int32_t more_torque) {
    port_.wait(510_ms);
    for (unsigned drive = 0; drive < kDrives; ++drive) {
      Way way = way_of(drive);
      way.target += drive == 3 ? more_torque : 0;
      prepare(drive, way);
    }
    send(can::data_frame(0x000, {1, 0}));
    for (const unsigned word : {0x06U, 0x07U, 0x0FU, 0x1FU}) {
      for (unsigned drive = 0; drive < kDrives; ++drive) {
        send(can::data_frame(0x201U + drive, {word, 0}));
      }
      send(can::data_frame(0x080, {}));
      send(can::data_frame(0x080, {}));
    }
    const base::SimTime end = port_.now() + 1_ms * kCycles;
    while (port_.now() < end) {
      send(can::data_frame(0x080, {}));
    }
    evidence_.bus = rack_.bus(0).bus().statistics();
    for (const product::Signal& signal : rack_.signals()) {
      if (signal.name.ends_with(".axis0.shaft_speed")) {
        evidence_.speeds.push_back(signal.read());
      }
    }
    return std::move(evidence_);
  }

 private:
  static RackConfiguration configure(std::optional<std::uint32_t> bit_rate,
                                     const std::string& directory) {
    RackConfiguration configuration = single_device_rack("tmcc160", devices::products());
    BusConfiguration& bus = configuration.buses.front();
    bus.bit_rate = bit_rate;
    bus.capture = directory + "/run.pcap";
    const DeviceConfiguration drive = bus.devices.front();
    bus.devices.clear();
    for (unsigned i = 0; i < kDrives; ++i) {
      bus.devices.push_back({"drive" + std::to_string(i + 1), drive.setup});
      *bus.devices.back().setup.node_id() = static_cast<std::uint8_t>(i + 1);
    }
    configuration.record = RecordConfiguration{directory + "/run.csv", 1_ms, {"*"}};
    const DeviceAddress disturbed{0, 5, NetworkKind::bus};
    configuration.events = {
        {580_ms, FrameFaultEvent{0, {}, {.kind = can::FrameFaultKind::corrupt, .frames = 3}}},
        {590_ms, InputEvent{disturbed, "axis0.load_torque", 0.02}}};
    return configuration;
  }

  void send(const can::Frame& frame) {
    port_.send(frame);
    ++evidence_.sent;
    while (const auto received = port_.receive()) {
      evidence_.frames.push_back(*received);
    }
  }
  void write(unsigned drive, unsigned index, unsigned subindex, std::size_t size,
             std::int32_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    send(can::data_frame(0x601U + drive, {static_cast<unsigned>(0x23U | (4U - size) << 2U),
                                          index & 0xFFU, index >> 8U, subindex, bits & 0xFFU,
                                          bits >> 8U & 0xFFU, bits >> 16U & 0xFFU, bits >> 24U}));
    ASSERT_FALSE(evidence_.frames.empty());
    ASSERT_EQ(evidence_.frames.back().frame.data[0], std::byte{0x60})
        << std::hex << index << " of drive " << drive;
  }
  void prepare(unsigned drive, const Way& way) {
    write(drive, 0x2005, 0, 4, way.mode == 6 ? 0 : 3);  // homing needs its switches
    write(drive, 0x2055, 0, 1, way.commutation);
    write(drive, 0x6060, 0, 1, way.mode);
    if (way.mode == 6) {
      write(drive, 0x6098, 0, 1, 17 + static_cast<std::int32_t>(drive % 2));
      write(drive, 0x6099, 1, 4, way.target);
      write(drive, 0x6099, 2, 4, way.target);
    } else {
      write(drive, way.target_object, 0, 4, way.target);
    }
  }

  EventLog log_;
  RackConfiguration configuration_;
  Rack rack_;
  bench::LocalCanPort port_;
  Evidence evidence_;
};

Evidence run(std::optional<std::uint32_t> bit_rate, std::int32_t more_torque = 0) {
  const tests::TemporaryDirectory directory;
  Evidence evidence = Run(bit_rate, directory.path()).make(more_torque);
  evidence.recording = content_of(directory.path() + "/run.csv");
  evidence.capture = content_of(directory.path() + "/run.pcap");
  return evidence;
}

class Tmcc160Determinism : public testing::TestWithParam<std::optional<std::uint32_t>> {};

TEST_P(Tmcc160Determinism, TwoRunsOfManyTurningDrivesAreEqualToTheLastBit) {
  const Evidence first = run(GetParam());
  const Evidence second = run(GetParam());
  EXPECT_GT(first.frames.size(), 2U * kDrives * kCycles / (GetParam() ? 20U : 1U));
  ASSERT_EQ(first.frames.size(), second.frames.size());
  for (std::size_t i = 0; i < first.frames.size(); ++i) {
    ASSERT_EQ(first.frames[i].frame, second.frames[i].frame) << "frame " << i;
    ASSERT_EQ(first.frames[i].time, second.frames[i].time) << "frame " << i;
  }
  EXPECT_TRUE(first.recording == second.recording) << "the signals differ";
  EXPECT_TRUE(first.capture == second.capture) << "the captures differ";
  EXPECT_EQ(first.frames.size() + first.sent, first.bus.frames) << "every frame was compared";
  EXPECT_EQ(first.bus.error_frames, 3U);
  ASSERT_EQ(first.speeds.size(), kDrives);
  for (unsigned drive = 0; drive < kDrives; ++drive) {
    EXPECT_GT(std::abs(first.speeds[drive]), 0.5) << "drive " << drive + 1 << " does not turn";
  }
}

TEST_P(Tmcc160Determinism, OneMilliampereMoreInOneDriveLeavesOtherEvidence) {
  const Evidence first = run(GetParam());
  const Evidence other = run(GetParam(), 1);
  EXPECT_FALSE(first.recording == other.recording);
  EXPECT_FALSE(first.capture == other.capture);
}

INSTANTIATE_TEST_SUITE_P(Bus, Tmcc160Determinism,
                         testing::Values(std::nullopt, std::optional<std::uint32_t>(1'000'000)),
                         [](const auto& of) { return of.param ? "Paced" : "Unlimited"; });

}  // namespace
}  // namespace stator::rack
