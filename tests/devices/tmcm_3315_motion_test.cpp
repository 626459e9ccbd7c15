// Motion of the real motor; encoder, units, counters, currents.

#include <array>
#include <cmath>
#include <vector>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

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
      for (const product::Signal& signal : device.signals()) {
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

TEST_F(Tmcm3315Module, TheEncoderGivesTheActualPosition) {
  go_operational();
  use_encoder();
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

}  // namespace
}  // namespace stator::devices
