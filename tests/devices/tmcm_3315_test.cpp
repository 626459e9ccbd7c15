#include "devices/tmcm_3315/tmcm_3315.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/test_bus.hpp"

namespace stator::devices {
namespace {

using namespace base::literals;
using drive::PowerState;
using ethercat::AlState;
using Emergency = tests::TestBus::Emergency;

constexpr double kMicrostepsPerRevolution = 51'200.0;
constexpr std::uint32_t kDeviceStateAbort = 0x08000022;

/// Index of an object of motor `n`.
constexpr std::uint16_t of_motor(unsigned n, unsigned index) {
  return static_cast<std::uint16_t>(index + n * (index < 0x6000 ? 0x200 : 0x800));
}

class Tmcm3315Module : public testing::Test {
 protected:
  explicit Tmcm3315Module(const Tmcm3315Configuration& configuration = {}) {
    device_ = std::make_unique<Tmcm3315>(configuration);
    bus_ = std::make_unique<tests::TestBus>(*device_);
  }

  /// Operational without process data watchdog: SDOs alone drive the axes.
  void go_operational() {
    bus_->write(0x0420, {std::byte{0}, std::byte{0}});
    bus_->bring_to(AlState::operational);
  }
  template <typename T>
  void write(std::uint16_t index, T value, std::uint8_t subindex = 0) {
    EXPECT_EQ(bus_->download<T>(index, subindex, value), 0U) << std::hex << index;
  }
  void set_profile(unsigned motor, std::uint32_t velocity, std::uint32_t acceleration) {
    write<std::uint32_t>(of_motor(motor, 0x6081), velocity);
    write<std::uint32_t>(of_motor(motor, 0x6083), acceleration);
    write<std::uint32_t>(of_motor(motor, 0x6084), acceleration);
  }
  void enable(unsigned motor, std::int8_t mode) {
    write<std::int8_t>(of_motor(motor, 0x6060), mode);
    for (const int controlword : {6, 7, 15}) {
      control(motor, static_cast<std::uint16_t>(controlword));
    }
  }
  void control(unsigned motor, std::uint16_t controlword) {
    write<std::uint16_t>(of_motor(motor, 0x6040), controlword);
  }
  void start_move(unsigned motor, std::int32_t target) {
    write<std::int32_t>(of_motor(motor, 0x607A), target);
    control(motor, 31);
    control(motor, 15);
  }
  std::uint16_t statusword(unsigned motor = 0) {
    return bus_->upload<std::uint16_t>(of_motor(motor, 0x6041));
  }
  double signal(const std::string& name) {
    for (const Signal& candidate : device_->signals()) {
      if (candidate.name == name) {
        return candidate.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }
  double shaft_microsteps(unsigned motor = 0) {
    return signal("axis" + std::to_string(motor) + ".shaft_position") * kMicrostepsPerRevolution;
  }

  std::unique_ptr<Tmcm3315> device_;
  std::unique_ptr<tests::TestBus> bus_;
};

// Worked examples of the document

TEST_F(Tmcm3315Module, ProfilePositionExampleRunsAsWritten) {
  go_operational();
  set_profile(0, 51'200, 51'200);
  write<std::uint32_t>(0x2005, 3);
  write<std::int8_t>(0x6060, 1);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 1);
  control(0, 6);
  EXPECT_EQ(statusword() & 0x006F, 0x0021);
  control(0, 7);
  EXPECT_EQ(statusword() & 0x006F, 0x0023);
  control(0, 15);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::int32_t>(0x607A, 500'000);
  bus_->pass(10_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 0) << "no motion yet";
  control(0, 31);
  const base::SimTime start = bus_->now();
  bus_->pass(5_ms);
  EXPECT_EQ(statusword() & 0x5000, 0x5000) << "set-point in process, motor rotates";
  control(0, 15);
  EXPECT_EQ(statusword() & 0x5000, 0x4000);
  // 51200 pps with 51200 pps/s: 10.765625 s.
  bus_->pass(base::SimDuration(10'764'000'000) - (bus_->now() - start));
  EXPECT_EQ(statusword() & 0x0400, 0) << "not there yet";
  bus_->pass(3_ms);
  EXPECT_EQ(statusword() & 0x0400, 0x0400);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6064), 500'000);
}

TEST_F(Tmcm3315Module, ProfileVelocityExampleRunsAsWritten) {
  go_operational();
  set_profile(0, 0, 51'200);
  write<std::uint32_t>(0x2005, 3);
  enable(0, 3);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::int32_t>(0x60FF, 100'000);
  bus_->pass(1_s);
  EXPECT_EQ(statusword() & 0x4400, 0x4000);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x606C), 51'200, 100);
  bus_->pass(954_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x606C), 100'000) << "after 1.953125 s";
  EXPECT_EQ(statusword() & 0x0400, 0x0400);
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(2_s);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x606C), 0);
  EXPECT_EQ(statusword() & 0x4000, 0);
}

TEST_F(Tmcm3315Module, IdentityReadsAsTheDocumentPrintsIt) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1000), 0xFFFC0192U);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1001), 0U);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1018, 0), 3U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 1), 0x286U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 2), 3315U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 3), 0x00010009U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1A00, 2), 0x60640020U);
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x1C12, 1), 0x1600U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x6085), 51'200U);
  EXPECT_EQ(bus_->upload<std::int16_t>(0x606A), -1);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x6502), 0x3A5U);
}

TEST_F(Tmcm3315Module, DefaultProcessImageLiesAsTheExampleShows) {
  bus_->bring_to(AlState::operational);
  const std::array<unsigned, 30> image{0x0F, 0x00, 0x20, 0xA1, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00,
                                       0x06, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                                       0x0F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x60, 0x79, 0xFE, 0xFF};
  std::ranges::transform(image, bus_->outputs.begin(),
                         [](unsigned byte) { return static_cast<std::byte>(byte); });
  bus_->exchange();
  EXPECT_EQ(device_->dictionary().find(0x6040, 0)->value(), 15U);
  EXPECT_EQ(device_->dictionary().find(0x607A, 0)->signed_value(), 500'000);
  EXPECT_EQ(device_->dictionary().find(0x6840, 0)->value(), 6U);
  EXPECT_EQ(device_->dictionary().find(0x7040, 0)->value(), 15U);
  EXPECT_EQ(device_->dictionary().find(0x70FF, 0)->signed_value(), -100'000);
  EXPECT_EQ(device_->axis(1).axis().power_state(), PowerState::ready_to_switch_on);
  bus_->exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 10) & 0x006F, 0x0021)
      << "the answer is in the next inputs";
}

// Motion of the real motor

TEST_F(Tmcm3315Module, TenRevolutionsEndWithinOneMicrostep) {
  go_operational();
  const std::array<std::int32_t, 3> targets{512'000, -512'000, 512'000};
  for (unsigned motor = 0; motor < 3; ++motor) {
    set_profile(motor, 256'000, 512'000);
    enable(motor, 1);
    start_move(motor, targets[motor]);
  }
  bus_->pass(3_s);
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(statusword(motor) & 0x0400, 0x0400) << motor;
    EXPECT_NEAR(shaft_microsteps(motor), targets[motor], 1.0) << motor;
    EXPECT_EQ(bus_->upload<std::int32_t>(of_motor(motor, 0x6064)), targets[motor]);
  }
}

TEST_F(Tmcm3315Module, AnOverloadLosesWholeMultiplesOfFourFullSteps) {
  go_operational();
  set_profile(0, 51'200, 512'000);
  enable(0, 1);
  start_move(0, 512'000);
  bus_->pass(3_s);
  device_->axis(0).plant().set_external_torque(-1.5);  // the motor holds 0.52 Nm at this current
  bus_->pass(500_ms);
  device_->axis(0).plant().set_external_torque(0.0);
  bus_->pass(9_s);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6064), 512'000) << "open loop: nobody notices";
  const double lost = 512'000.0 - shaft_microsteps();
  EXPECT_GT(lost, 1000.0);
  EXPECT_NEAR(std::remainder(lost, 1024.0), 0.0, 16.0) << lost;
}

TEST_F(Tmcm3315Module, TheSameRunTwiceGivesTheSameSignals) {
  const auto run = [] {
    Tmcm3315Configuration configuration;
    configuration.axes[1].load.constant_torque = -0.1;
    Tmcm3315 device(configuration);
    tests::TestBus bus(device);
    bus.write(0x0420, {std::byte{0}, std::byte{0}});
    bus.bring_to(AlState::operational);
    bus.download<std::uint32_t>(0x6881, 0, 200'000);
    bus.download<std::uint32_t>(0x6883, 0, 800'000);
    bus.download<std::uint32_t>(0x6884, 0, 800'000);
    bus.download<std::int8_t>(0x6860, 0, 1);
    for (const int controlword : {6, 7, 15}) {
      bus.download<std::uint16_t>(0x6840, 0, static_cast<std::uint16_t>(controlword));
    }
    bus.download<std::int32_t>(0x687A, 0, 77'777);
    bus.download<std::uint16_t>(0x6840, 0, 31);
    std::vector<double> trace;
    for (int sample = 0; sample < 300; ++sample) {
      bus.pass(2_ms);
      for (const Signal& signal : device.signals()) {
        trace.push_back(signal.read());
      }
    }
    return trace;
  };
  EXPECT_EQ(run(), run());
}

TEST_F(Tmcm3315Module, CyclicPositionOverProcessDataMovesTheShaft) {
  bus_->bring_to(AlState::pre_operational);
  write<std::int8_t>(0x6060, 8);
  bus_->bring_to(AlState::operational);
  for (const int controlword : {6, 7, 15}) {
    base::store_le(bus_->outputs, 0, static_cast<std::uint16_t>(controlword));
    bus_->exchange();
    bus_->pass(1_ms);
  }
  for (int k = 1; k <= 2000; ++k) {
    base::store_le(bus_->outputs, 2, std::int32_t{20 * k});
    bus_->exchange();
    bus_->pass(980_us);  // and 20 us in the frames
  }
  bus_->pass_cyclically(20_ms);
  EXPECT_EQ(base::load_le<std::int32_t>(bus_->inputs, 2), 40'000);
  EXPECT_NEAR(shaft_microsteps(), 40'000.0, 10.0);
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 0) & 0x106F, 0x1027);
}

class Tmcm3315WithSync0 : public Tmcm3315Module {
 protected:
  /// Safe-Operational with a cycle of 1 ms from 2 ms after the present on.
  void activate_sync0() {
    const auto bytes = [](std::uint64_t value, std::size_t length) {
      tests::TestBus::Bytes result(8);
      base::store_le(result, 0, value);
      result.resize(length);
      return result;
    };
    bus_->bring_to(AlState::pre_operational);
    bus_->write(0x0420, bytes(0, 2));
    const std::uint64_t now = device_->controller().system_time(bus_->now());
    bus_->write(0x0990, bytes(now + 2'000'000, 8));
    bus_->write(0x09A0, bytes(1'000'000, 8));
    bus_->write(0x0980, bytes(0x0300, 2));  // AssignActivate of the mode DC_Sync0
    bus_->bring_to(AlState::safe_operational);
  }
  void go_operational() {
    activate_sync0();
    bus_->pass(3_ms);
    ASSERT_EQ(bus_->request(AlState::operational), 0x08);
  }
  base::SimDuration until_sync0() { return device_->controller().next_sync_edge(0) - bus_->now(); }
  std::uint64_t controlword() { return device_->dictionary().find(0x6040, 0)->value(); }
};

TEST_F(Tmcm3315WithSync0, OutputsAreTakenOverAndInputsGivenAtSync0) {
  go_operational();
  bus_->pass(until_sync0() + 200_us);
  base::store_le(bus_->outputs, 0, std::uint16_t{6});
  bus_->exchange();
  const base::SimDuration rest = until_sync0();
  bus_->pass(rest - 1_ns);
  EXPECT_EQ(controlword(), 0U);
  bus_->pass(1_ns);
  EXPECT_EQ(controlword(), 6U);
  bus_->exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 0) & 0x006F, 0x0021) << "Ready to switch on";
}

TEST_F(Tmcm3315WithSync0, CyclicPositionMovesTheShaftInStepWithSync0) {
  activate_sync0();
  bus_->pass(3_ms);
  write<std::int8_t>(0x6060, 8);
  ASSERT_EQ(bus_->request(AlState::operational), 0x08);
  for (const int controlword : {6, 7, 15}) {
    base::store_le(bus_->outputs, 0, static_cast<std::uint16_t>(controlword));
    bus_->exchange();
    bus_->pass(1_ms);
  }
  for (int k = 1; k <= 1000; ++k) {
    base::store_le(bus_->outputs, 2, std::int32_t{20 * k});
    bus_->exchange();
    bus_->pass(until_sync0() + 100_us);
  }
  bus_->pass(20_ms);
  EXPECT_NEAR(shaft_microsteps(), 20'000.0, 10.0);
  EXPECT_EQ(device_->stack().state(), AlState::operational);
}

TEST_F(Tmcm3315WithSync0, SwitchingSync0OffInOperationalStopsTheModule) {
  go_operational();
  bus_->write(0x0981, {std::byte{0}});
  bus_->pass(5_ms);
  EXPECT_EQ(device_->stack().state(), AlState::safe_operational);
  EXPECT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::fatal_sync_error);
}

// Network states

TEST_F(Tmcm3315Module, OperationIsEnabledOnlyInOperational) {
  bus_->bring_to(AlState::pre_operational);
  bus_->pass(1_ms);
  enable(0, 1);
  EXPECT_EQ(statusword() & 0x006F, 0x0023) << "held in Switched on";
  bus_->write(0x0420, {std::byte{0}, std::byte{0}});
  bus_->bring_to(AlState::safe_operational);
  EXPECT_EQ(statusword() & 0x026F, 0x0023);
  bus_->request(AlState::operational);
  bus_->pass(2_ms);
  EXPECT_EQ(statusword() & 0x026F, 0x0227) << "goes on, and is remote controlled";
}

TEST_F(Tmcm3315Module, LosingTheMasterStopsEveryMotorAndDisablesTheDrives) {
  bus_->bring_to(AlState::operational);
  for (unsigned motor = 0; motor < 3; ++motor) {
    write<std::uint32_t>(of_motor(motor, 0x6083), 200'000);
    write<std::uint32_t>(of_motor(motor, 0x6084), 200'000);
    write<std::int8_t>(of_motor(motor, 0x6060), 3);
  }
  for (const int controlword : {6, 7, 15}) {
    for (std::size_t motor = 0; motor < 3; ++motor) {
      base::store_le(bus_->outputs, 10 * motor, static_cast<std::uint16_t>(controlword));
      base::store_le(bus_->outputs, 10 * motor + 6, std::int32_t{50'000});
    }
    bus_->exchange();
  }
  bus_->pass_cyclically(1_s);
  EXPECT_NEAR(signal("axis2.velocity_demand"), 50'000.0, 1e-6);
  bus_->pass(150_ms);  // no frames: the watchdog of 100 ms expires
  EXPECT_EQ(device_->stack().state(), AlState::safe_operational);
  EXPECT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::sync_manager_watchdog);
  EXPECT_LT(signal("axis0.velocity_demand"), 50'000.0) << "on the ramp of 6085h";
  EXPECT_GT(signal("axis0.velocity_demand"), 0.0);
  bus_->pass(1_s);
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(device_->axis(motor).axis().power_state(), PowerState::switch_on_disabled);
    EXPECT_EQ(device_->axis(motor).axis().motion().velocity(), 0.0);
  }
}

TEST_F(Tmcm3315Module, SomeObjectsAreWritableInSwitchOnDisabledOnlyAxisByAxis) {
  go_operational();
  enable(0, 1);
  const std::array<std::uint16_t, 2> bytes_of_axis0{0x200B, 0x200C};
  EXPECT_EQ(bus_->download<std::uint32_t>(0x2005, 0, 3), kDeviceStateAbort);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x208C, 0, 0), kDeviceStateAbort);
  for (const std::uint16_t index : bytes_of_axis0) {
    EXPECT_EQ(bus_->download<std::uint8_t>(index, 1, 1), kDeviceStateAbort);
  }
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x2005), 0U) << "always readable";
  EXPECT_EQ(bus_->download<std::uint32_t>(0x2205, 0, 3), 0U) << "axis 1 is not enabled";
  control(0, 0);
  EXPECT_EQ(bus_->download<std::uint32_t>(0x2005, 0, 3), 0U);
}

TEST_F(Tmcm3315Module, AResetOfTheControllerRestartsTheFirmware) {
  go_operational();
  set_profile(0, 51'200, 51'200);
  enable(0, 1);
  for (const char key : {'R', 'E', 'S'}) {
    bus_->write(0x0040, {static_cast<std::byte>(key)});
  }
  EXPECT_EQ(device_->stack().state(), AlState::init);
  EXPECT_EQ(device_->dictionary().find(0x6081, 0)->value(), 0U) << "settings are volatile";
  EXPECT_EQ(device_->dictionary().find(0x1018, 2)->value(), 3315U);
  bus_->pass(1_ms);
  EXPECT_EQ(device_->axis(0).axis().power_state(), PowerState::switch_on_disabled);
}

// Encoder, units, counters

TEST_F(Tmcm3315Module, TheEncoderGivesTheActualPosition) {
  go_operational();
  write<std::int16_t>(0x606A, 0);
  write<std::uint32_t>(0x608F, 40'000, 1);
  set_profile(0, 51'200, 256'000);
  enable(0, 1);
  start_move(0, 51'200);
  bus_->pass(600_ms);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x606C), 51'200, 1000) << "measured";
  bus_->pass(2_s);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), 51'200, 2) << "40000 counts resolve 1.28";
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6063), bus_->upload<std::int32_t>(0x6064));
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 51'200);
}

class Tmcm3315WithReversedEncoder : public Tmcm3315Module {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration;
    configuration.axes[1].encoder.reversed = true;
    return configuration;
  }
  Tmcm3315WithReversedEncoder() : Tmcm3315Module(configuration()) {}
};

TEST_F(Tmcm3315WithReversedEncoder, DirectionOfRotationIsCorrectedBy200B) {
  go_operational();
  write<std::int16_t>(0x686A, 0);
  write<std::uint32_t>(0x688F, 40'000, 1);
  write<std::uint8_t>(0x220B, 1, 2);
  set_profile(1, 51'200, 256'000);
  enable(1, 1);
  start_move(1, 25'600);
  bus_->pass(2_s);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6864), 25'600, 2);
}

TEST_F(Tmcm3315Module, PositionIsInitialisedFromTheEncoderIfWanted) {
  go_operational();
  set_profile(0, 51'200, 512'000);
  enable(0, 1);
  start_move(0, 25'600);
  bus_->pass(2_s);
  control(0, 0);
  write<std::uint32_t>(0x608F, 20'000, 1);  // half the real resolution
  write<std::uint8_t>(0x200B, 0, 3);
  write<std::int16_t>(0x606A, 0);
  bus_->pass(1_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 25'600) << "200Bh:03 = 0 leaves the demand";
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), 51'200, 3);
  write<std::uint8_t>(0x200B, 1, 3);
  bus_->pass(1_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), bus_->upload<std::int32_t>(0x6064));
}

TEST_F(Tmcm3315Module, InternalUnitsAreFollowedByTheAccelerationIndex) {
  go_operational();
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x208E), 179);
  write<std::uint8_t>(0x208C, 0);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x208E), 0);
  set_profile(0, 0, 4 * 51'200);
  enable(0, 3);
  write<std::int32_t>(0x60FF, 256 * 10'000);
  bus_->pass(1_s);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x606C), 256 * 10'000);
  EXPECT_NEAR(signal("axis0.velocity_demand"), 10'000.0, 1e-9);
}

TEST_F(Tmcm3315Module, ResolutionScalesRevolutionsAndIsDisplayed) {
  go_operational();
  write<std::uint8_t>(0x2000, 4);  // 16 microsteps: 3200 per revolution
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x2107), 4);
  set_profile(0, 3200, 32'000);
  enable(0, 1);
  start_move(0, 3200);
  bus_->pass(2_s);
  EXPECT_NEAR(signal("axis0.shaft_position"), 1.0, 1e-3);
}

TEST_F(Tmcm3315Module, TheStepCounterIsConsistentOverItsSubindices) {
  go_operational();
  set_profile(0, 51'200, 512'000);
  enable(0, 1);
  start_move(0, 10'000);
  bus_->pass(1_s);
  start_move(0, 0);
  bus_->pass(1_s);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x210B, 1), 20'000U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x210B, 2), 0U);
  EXPECT_EQ(device_->dictionary().find(0x210B, 3)->value(), 20'000U);
}

TEST_F(Tmcm3315Module, CoilCurrentFollowsTheCurrentObjectsInStepsOfEight) {
  go_operational();
  write<std::uint8_t>(0x2003, 85);
  write<std::uint16_t>(0x2089, 10);  // 100 ms
  enable(0, 1);
  bus_->pass(50_ms);
  EXPECT_NEAR(signal("axis0.coil_current_a"), 11.0 / 32.0 * 3.0, 0.01);
  write<std::uint8_t>(0x2003, 87);
  bus_->pass(10_ms);
  EXPECT_NEAR(signal("axis0.coil_current_a"), 11.0 / 32.0 * 3.0, 0.01) << "same step of 32";
  bus_->pass(100_ms);
  EXPECT_NEAR(signal("axis0.coil_current_a"), 2.0 / 32.0 * 3.0, 0.01) << "standby, 2004h = 8";
  write<std::uint8_t>(0x2097, 0);
  bus_->pass(50_ms);
  EXPECT_NEAR(signal("axis0.coil_current_a"), 0.0, 1e-6) << "chopper off";
}

// Inputs and outputs

TEST_F(Tmcm3315Module, InputsAreShownInTheirBits) {
  go_operational();
  device_->set_digital_input(0, true);
  device_->set_digital_input(3, true);
  device_->set_analog_input(2, 40'000);
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x2702), 0x00090000U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x60FD), 0x00090000U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x270E, 3), 40'000U);
  write<std::uint32_t>(0x2205, 0x2C);  // axis 1: all three inverted
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x68FD), 0x00090007U);
}

TEST_F(Tmcm3315Module, OutputsNeedTheirMaskAndOperational) {
  go_operational();
  write<std::uint32_t>(0x2703, 0x000F0000, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), 0U) << "mask 0 blocks all";
  write<std::uint32_t>(0x2703, 0x00050000, 2);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), 0x00050000U);
  bus_->request(AlState::safe_operational);
  EXPECT_EQ(device_->digital_outputs(), 0U);
}

// Emergencies

TEST_F(Tmcm3315Module, AFollowingErrorAndItsResetAreTold) {
  go_operational();
  write<std::int16_t>(0x706A, 0);
  write<std::uint32_t>(0x708F, 40'000, 1);
  write<std::uint32_t>(0x7065, 2000);
  set_profile(2, 51'200, 512'000);
  enable(2, 1);
  start_move(2, 200'000);
  bus_->pass(500_ms);
  EXPECT_TRUE(bus_->take_emergencies().empty());
  device_->axis(2).plant().set_external_torque(-3.0);
  bus_->pass(500_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x11, 0x86, 0x21, 0x00, 0x02, 0x00, 0x00, 0x00}}));
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1001), 0x21);
  EXPECT_EQ(statusword(2) & 0x0008, 0x0008);
  device_->axis(2).plant().set_external_torque(0.0);
  bus_->pass(2_s);
  EXPECT_EQ(statusword(2) & 0x004F, 0x0008);
  control(2, 0x80);
  EXPECT_EQ(statusword(2) & 0x004F, 0x0040);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x00, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00}}));
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1001), 0x00);
}

class Tmcm3315WithSwitches : public Tmcm3315Module {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration;
    configuration.axes[1].left_switch = plant::PositionSwitch::left_at(-1.0);
    configuration.axes[1].right_switch = plant::PositionSwitch::right_at(1.0);
    return configuration;
  }
  Tmcm3315WithSwitches() : Tmcm3315Module(configuration()) {}
};

TEST_F(Tmcm3315WithSwitches, TouchingALimitSwitchStopsAndIsTold) {
  go_operational();
  write<std::uint32_t>(0x2214, 2'000'000);
  set_profile(1, 0, 256'000);
  enable(1, 3);
  write<std::int32_t>(0x68FF, 51'200);
  bus_->pass(2_s);
  EXPECT_NEAR(shaft_microsteps(1), 51'200.0, 1500.0);
  EXPECT_EQ(statusword(1) & 0x486F, 0x0827) << "stands, limit active, still enabled";
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x68FD), 0x00000002U);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x03, 0x01, 0x00, 0x00, 0x00}}));
  write<std::int32_t>(0x68FF, -51'200);
  bus_->pass(4_s);
  EXPECT_NEAR(shaft_microsteps(1), -51'200.0, 1500.0);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x04, 0x01, 0x00, 0x00, 0x00}}));
}

TEST_F(Tmcm3315WithSwitches, ADeactivatedLimitSwitchDoesNothing) {
  go_operational();
  write<std::uint32_t>(0x2205, 3);
  set_profile(1, 0, 256'000);
  enable(1, 3);
  write<std::int32_t>(0x68FF, 51'200);
  bus_->pass(3_s);
  EXPECT_GT(shaft_microsteps(1), 100'000.0);
  EXPECT_TRUE(bus_->take_emergencies().empty());
}

TEST_F(Tmcm3315Module, LeavingTheSoftwareLimitsIsTold) {
  go_operational();
  write<std::int32_t>(0x607D, 1000, 1);  // the axis stands at 0, outside
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x02, 0x00, 0x00, 0x00, 0x00}}));
  write<std::int32_t>(0x607D, -2000, 1);
  write<std::int32_t>(0x607D, -1000, 2);
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x01, 0x00, 0x00, 0x00, 0x00}}));
}

TEST_F(Tmcm3315Module, ProcessDataThatCannotBeTakenIsToldOnceAndKeepsTheOldValue) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint8_t>(0x1C12, 0);
  write<std::uint8_t>(0x1600, 0);
  write<std::uint32_t>(0x1600, 0x60600008, 1);
  write<std::uint32_t>(0x1600, 0x607A0020, 2);
  write<std::uint8_t>(0x1600, 2);
  write<std::uint8_t>(0x1C12, 1);
  bus_->set_output_length(5);
  bus_->bring_to(AlState::operational);
  bus_->outputs[0] = std::byte{2};
  bus_->exchange();
  bus_->exchange();
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6060), 0);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x20, 0x63, 0x21, 0x00, 0xFF, 0x00, 0x00, 0x00}}));
  bus_->outputs[0] = std::byte{1};
  bus_->exchange();
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6060), 1);
  bus_->outputs[0] = std::byte{2};
  bus_->exchange();
  EXPECT_EQ(bus_->take_emergencies().size(), 1U) << "re-armed by the good value";
}

TEST_F(Tmcm3315Module, TheReservedPositioningOptionIsRefused) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x60F2, 0, 3), 0x06090030U);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x60F2, 0, 2), 0U);
}

TEST_F(Tmcm3315Module, EverySignalHasANameOfItsOwn) {
  std::vector<std::string> names;
  for (const Signal& signal : device_->signals()) {
    names.push_back(signal.name);
  }
  EXPECT_EQ(names.size(), 51U);
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

}  // namespace
}  // namespace stator::devices
