// Internal units: 208Ch = 0 takes 208Eh with it; velocities then have 8 fractional bits and
// accelerations 2.

#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

class Tmcm3315Units : public Tmcm3315Module {
 protected:
  Tmcm3315Units() {
    go_operational();
    for (unsigned motor = 0; motor < 3; ++motor) {
      write<std::uint8_t>(of_motor(motor, 0x208C), 0);
    }
  }
  const drive::StepperSettings& settings(unsigned motor) {
    bus_->pass(2_ms);
    return device_->axis(motor).axis().stepper_settings();
  }
  const control::RampGenerator& ramp() { return device_->axis(0).axis().motion().ramp(); }
};

TEST_F(Tmcm3315Units, InternalUnitsHoldForTheThresholdsOfTheDriver) {
  for (unsigned motor = 0; motor < 3; ++motor) {
    write<std::uint32_t>(of_motor(motor, 0x20A4), 256 * (1000 + motor));
    write<std::uint32_t>(of_motor(motor, 0x20A5), 256 * (2000 + motor));
    write<std::uint32_t>(of_motor(motor, 0x20B0), 256 * (3000 + motor));
    const drive::DriverSettings& driver = settings(motor).driver;
    EXPECT_EQ(driver.stall_velocity, 1000.0 + motor);
    EXPECT_EQ(driver.cool_step_velocity, 2000.0 + motor);
    EXPECT_EQ(driver.stealth_chop.threshold_velocity, 3000.0 + motor);
  }
}

TEST_F(Tmcm3315Units, InternalUnitsHoldForTheVelocitiesOfTheClosedLoop) {
  for (unsigned motor = 0; motor < 3; ++motor) {
    write<std::uint32_t>(of_motor(motor, 0x2034), 256 * (1000 + motor));
    write<std::uint32_t>(of_motor(motor, 0x2035), 256 * (2000 + motor));
    write<std::uint32_t>(of_motor(motor, 0x202F), 256 * (3000 + motor));
    const control::ClosedLoopSettings& loop = settings(motor).closed_loop;
    EXPECT_EQ(loop.weakening_start, 1000.0 + motor);
    EXPECT_EQ(loop.weakening_range, 2000.0 + motor);
    EXPECT_EQ(loop.catch_up_velocity, 3000.0 + motor);
  }
}

TEST_F(Tmcm3315Units, InternalUnitsHoldForSpeedsAndAccelerationOfHoming) {
  write<std::int8_t>(0x6098, 17);
  write<std::uint32_t>(0x6099, 256 * 20'000, 1);
  write<std::uint32_t>(0x6099, 256 * 5'000, 2);
  write<std::uint32_t>(0x609A, 4 * 100'000);
  enable(0, 6);
  control(0, 31);
  bus_->pass(100_ms);
  EXPECT_NEAR(ramp().velocity(), -10'000.0, 200.0) << "100000 pps/s";
  bus_->pass(200_ms);
  EXPECT_EQ(ramp().velocity(), -20'000.0);
  write<std::int8_t>(0x6098, 34);
  control(0, 15);
  bus_->pass(300_ms);
  write<std::int16_t>(0x606A, -1);
  control(0, 31);
  bus_->pass(300_ms);
  EXPECT_EQ(ramp().velocity(), 5'000.0) << "6099h:02";
}

TEST_F(Tmcm3315Units, InternalUnitsHoldForQuickStopAndOffsetOfVelocity) {
  write<std::uint32_t>(0x6085, 4 * 40'000);
  write<std::int32_t>(0x60B1, 256 * 2'000);
  enable(0, 9);
  write<std::int32_t>(0x60FF, 256 * 10'000);
  bus_->pass(10_ms);
  EXPECT_NEAR(ramp().velocity(), 12'000.0, 1e-6);
  control(0, 2);
  bus_->pass(100_ms);
  EXPECT_NEAR(ramp().velocity(), 8'000.0, 100.0) << "40000 pps/s";
}

}  // namespace
}  // namespace stator::devices
