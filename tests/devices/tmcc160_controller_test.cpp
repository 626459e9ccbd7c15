// What the objects of the controllers show and decide, seen by SDO.

#include <cmath>

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {
namespace {

using AbortCode = dictionary::AbortCode;
using canopen::NmtState;
using tests::Tmcc160Module;
constexpr AbortCode kNoError{};
constexpr std::int64_t kMotorHalted = 1 << 4;
constexpr std::int64_t kItExceeded = 1 << 17;
constexpr std::int64_t kMoving = 1 << 14;

class Tmcc160Controller : public testing::Test {
 protected:
  explicit Tmcc160Controller(const Tmcc160Configuration& configuration = {})
      : module_(configuration) {
    module_.boot();
  }
  void write(std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
    EXPECT_EQ(module_.write(index, subindex, value), kNoError) << std::hex << index;
  }
  double value(std::uint16_t index, std::uint8_t subindex = 0) {
    return static_cast<double>(module_.read(index, subindex));
  }
  void turn(double rpm, int milliseconds = 1'500) {
    module_.enable(3);
    write(0x60FF, 0, static_cast<std::int64_t>(rpm));
    module_.wait(milliseconds);
  }

  Tmcc160Module module_;
};

TEST_F(Tmcc160Controller, ItsObjectsCannotBeMapped) {
  write(0x1800, 1, 0xC0000181);
  write(0x1A00, 0, 0);
  for (const std::uint32_t index : {0x2030U, 0x2040U, 0x2050U, 0x2060U, 0x2070U, 0x2080U}) {
    const auto bits = static_cast<std::uint32_t>(
        module_.device->dictionary().find(static_cast<std::uint16_t>(index), 1)->bits());
    EXPECT_EQ(module_.write(0x1A00, 1, index << 16 | 1U << 8 | bits), AbortCode::not_mappable);
  }
}

TEST_F(Tmcc160Controller, TheTorqueLoopIsShown) {
  module_.enable(10);
  write(0x2020, 1, 1'500);
  write(0x6071, 0, 2'500);
  module_.set("axis0.load_torque", -0.042);
  module_.wait(30);
  EXPECT_EQ(value(0x2030, 2), 2'500.0);
  EXPECT_EQ(value(0x2030, 3), 1'500.0);
  EXPECT_NEAR(value(0x2030, 1), 1'500.0, 80.0);
  EXPECT_NEAR(value(0x6077), value(0x2030, 1), 1.0);
  EXPECT_NEAR(value(0x2030, 6), 0.0, 150.0) << "the integral part has taken over";
  EXPECT_GT(value(0x2030, 7), 0.0);
  EXPECT_NEAR(value(0x2030, 8), 0.0, 150.0);
}

TEST_F(Tmcc160Controller, WithoutCurrentGainsNoCurrentFlows) {
  write(0x2030, 4, 0);
  write(0x2030, 5, 0);
  module_.enable(10);
  write(0x6071, 0, 1'000);
  module_.wait(50);
  EXPECT_NEAR(value(0x6077), 0.0, 100.0);
  EXPECT_NEAR(value(0x2030, 6), 1'000.0, 120.0) << "the whole set-point is error";
}

TEST_F(Tmcc160Controller, TheVelocityLoopIsShown) {
  turn(1'000, 250);
  EXPECT_EQ(value(0x2040, 2), 1'000.0);
  const double ramp = value(0x2040, 3);
  EXPECT_NEAR(ramp, 500.0, 20.0) << "a quarter of a second with 2000 rpm/s";
  module_.wait(1'000);
  EXPECT_EQ(value(0x2040, 3), 1'000.0);
  EXPECT_NEAR(value(0x2040, 1), 1'000.0, 50.0);
  EXPECT_EQ(value(0x2040, 1), value(0x606C));
  EXPECT_NEAR(value(0x2040, 7), 0.0, 50.0);
  EXPECT_GT(value(0x2040, 8), 0.0) << "friction needs current";
}

TEST_F(Tmcc160Controller, WithoutVelocityGainsTheMotorStands) {
  write(0x2040, 5, 0);
  write(0x2040, 6, 0);
  turn(1'000);
  EXPECT_EQ(value(0x606C), 0.0);
  EXPECT_NEAR(value(0x2040, 7), 1'000.0, 1.0);
}

TEST_F(Tmcc160Controller, MotorHaltedVelocityDecidesWhatCountsAsStandstill) {
  turn(300);
  EXPECT_EQ(module_.read(0x200D) & kMotorHalted, 0);
  EXPECT_NE(module_.read(0x6041) & kMoving, 0);
  write(0x2040, 4, 500);
  module_.wait(2);
  EXPECT_NE(module_.read(0x200D) & kMotorHalted, 0);
  EXPECT_EQ(module_.read(0x6041) & kMoving, 0);
}

TEST_F(Tmcc160Controller, ThePositionLoopIsShown) {
  write(0x2055, 0, 7);
  module_.enable(1);
  write(0x607A, 0, 20'000);
  module_.control(0x1F);
  module_.wait(450);
  EXPECT_EQ(value(0x2050, 2), 20'000.0);
  EXPECT_EQ(value(0x2050, 3), value(0x6062));
  EXPECT_GT(value(0x6062), 1'000.0);
  EXPECT_LT(value(0x6062), 20'000.0);
  EXPECT_NEAR(value(0x2050, 5), value(0x6062) - value(0x6064), 150.0);
}

TEST_F(Tmcc160Controller, PositionVelocityAndCurrentHaveTheSameValueUnderEachName) {
  write(0x2055, 0, 7);
  turn(700, 600);
  EXPECT_EQ(module_.read(0x2050, 1), module_.read(0x6064));
  EXPECT_EQ(module_.read(0x6063), module_.read(0x6064));
  EXPECT_GT(module_.read(0x6064), 4'000);
  EXPECT_EQ(module_.read(0x2040, 1), module_.read(0x606C));
  EXPECT_EQ(module_.read(0x2030, 1), module_.read(0x6077));
}

TEST_F(Tmcc160Controller, WithoutPositionGainTheMotorDoesNotCorrect) {
  write(0x2055, 0, 7);
  write(0x2050, 4, 0);
  module_.enable(1);
  module_.set("axis0.load_torque", 0.02);
  module_.wait(1'500);
  const double pushed = std::abs(value(0x6064));
  EXPECT_GT(pushed, 100.0);
  module_.set("axis0.load_torque", 0.0);
  module_.wait(1'500);
  EXPECT_GT(std::abs(value(0x6064)), 100.0);
  write(0x2050, 4, 300);
  module_.wait(2'000);
  EXPECT_LT(std::abs(value(0x6064)), pushed / 2.0);
}

TEST_F(Tmcc160Controller, EveryCommutationModeTurnsTheMotor) {
  for (const int mode : {6, 7, 8}) {
    Tmcc160Module module;
    module.boot();
    EXPECT_EQ(module.write(0x2055, 0, mode), kNoError);
    module.enable(3);
    EXPECT_EQ(module.write(0x60FF, 0, 300), kNoError);
    module.wait(1'500);
    EXPECT_NEAR(module.signal("axis0.shaft_speed") * 60.0, 300.0, 30.0) << mode;
  }
}

TEST_F(Tmcc160Controller, EncoderResolutionTurnsStepsIntoRevolutions) {
  Tmcc160Configuration configuration;
  configuration.axis.encoder.counts_per_revolution = 2'048;
  Tmcc160Module module(configuration);
  module.boot();
  EXPECT_EQ(module.write(0x2055, 0, 7), kNoError);
  EXPECT_EQ(module.write(0x608F, 1, 2'048), kNoError);
  EXPECT_EQ(module.read(0x608F, 2), 1);
  module.enable(3);
  EXPECT_EQ(module.write(0x60FF, 0, 600), kNoError);
  module.wait(1'500);
  EXPECT_NEAR(module.signal("axis0.shaft_speed") * 60.0, 600.0, 30.0);
  EXPECT_NEAR(static_cast<double>(module.read(0x6064)),
              2'048.0 * module.signal("axis0.shaft_position"), 20.0);
}

TEST_F(Tmcc160Controller, TheBrakeChopperKeepsLimitAndHysteresisWhereEnabled) {
  const auto conducts = [this](double volts) {
    module_.set("axis0.supply_voltage", volts);
    module_.wait(20);
    return module_.signal("axis0.brake_chopper") != 0.0;
  };
  EXPECT_FALSE(conducts(27.0)) << "2090h:01 = 0";
  write(0x2090, 1, 1);
  EXPECT_FALSE(conducts(25.0));
  EXPECT_TRUE(conducts(27.0));
  EXPECT_TRUE(conducts(25.9)) << "0.5 V of hysteresis";
  EXPECT_FALSE(conducts(25.0));
  write(0x2090, 2, 240);
  write(0x2090, 3, 20);
  EXPECT_TRUE(conducts(25.0));
  EXPECT_TRUE(conducts(22.6));
  EXPECT_FALSE(conducts(21.5));
}

TEST_F(Tmcc160Controller, AHallErrorShowsInItsFlag) {
  turn(300, 500);
  EXPECT_EQ(module_.read(0x200D) & 0x20, 0);
  for (const char* sensor : {"axis0.hall_fault_1", "axis0.hall_fault_2", "axis0.hall_fault_3"}) {
    module_.set(sensor, 1);
  }
  module_.wait(100);
  EXPECT_NE(module_.read(0x200D) & 0x20, 0);
}

/// A wheel that takes a second to get going, so that the current of a torque lasts.
class Tmcc160HeavyLoad : public Tmcc160Controller {
 protected:
  static Tmcc160Configuration with_wheel() {
    Tmcc160Configuration configuration;
    configuration.axis.load.inertia = 1e-3;
    return configuration;
  }
  Tmcc160HeavyLoad() : Tmcc160Controller(with_wheel()) {}
};

TEST_F(Tmcc160HeavyLoad, I2tTakesTheCurrentAwayAndCountsUntilItIsCleared) {
  write(0x2095, 1, 1'000);
  write(0x2095, 2, 1'000);
  module_.enable(10);
  write(0x6071, 0, 2'000);
  module_.wait(100);
  const double sum = value(0x2095, 3);
  EXPECT_NEAR(sum, 4.0 * 1'000.0 * (1.0 - std::exp(-0.1)), 60.0);
  EXPECT_EQ(module_.read(0x200D) & kItExceeded, 0);
  module_.wait(400);
  EXPECT_NE(module_.read(0x200D) & kItExceeded, 0);
  EXPECT_GE(module_.read(0x2095, 4), 1);
  EXPECT_NEAR(value(0x6077), 0.0, 100.0);
  EXPECT_EQ(module_.state(), 0x27U) << "no fault";
  write(0x6071, 0, 0);
  module_.wait(3'000);
  EXPECT_NE(module_.read(0x200D) & kItExceeded, 0) << "it stays";
  write(0x2095, 5, 0);
  module_.wait(2);
  EXPECT_EQ(module_.read(0x200D) & kItExceeded, 0);
  EXPECT_GE(module_.read(0x2095, 4), 1) << "the counter is cleared by writing it";
  write(0x2095, 4, 0);
  EXPECT_EQ(module_.read(0x2095, 4), 0);
}

TEST_F(Tmcc160HeavyLoad, ALongerTimeConstantTakesTheSumUpMoreSlowly) {
  write(0x2095, 1, 10'000);
  module_.enable(10);
  write(0x6071, 0, 2'000);
  module_.wait(100);
  EXPECT_NEAR(value(0x2095, 3), 4.0 * 10'000.0 * (1.0 - std::exp(-0.01)), 60.0);
}

TEST(Tmcc160NmtAndDrive, ControlwordsAreObeyedInPreOperationalAndOperational) {
  for (const bool operational : {false, true}) {
    Tmcc160Module module;
    module.boot(operational);
    module.enable(3);
    EXPECT_EQ(module.write(0x60FF, 0, 500), kNoError);
    module.wait(500);
    EXPECT_GT(module.read(0x606C), 300);
  }
}

TEST(Tmcc160NmtAndDrive, LeavingOperationalForPreOperationalKeepsTheDriveRunning) {
  Tmcc160Module module;
  module.boot(true);
  module.enable(3);
  EXPECT_EQ(module.write(0x60FF, 0, 500), kNoError);
  module.wait(500);
  module.nmt(128);
  module.wait(500);
  EXPECT_EQ(module.device->node().state(), NmtState::pre_operational);
  EXPECT_EQ(module.state(), 0x27U);
  EXPECT_NEAR(static_cast<double>(module.read(0x606C)), 500.0, 30.0);
  module.nmt(1);
  EXPECT_EQ(module.state(), 0x27U);
}

TEST(Tmcc160NmtAndDrive, StoppingTheNodeTouchesOnlyADriveInOperationEnabled) {
  for (const int last : {6, 7}) {
    Tmcc160Module module;
    module.boot(true);
    for (int word = 6; word <= last; ++word) {
      module.control(static_cast<std::uint16_t>(word));
    }
    const drive::PowerState before = module.device->axis().power_state();
    module.nmt(2);
    module.wait(50);
    EXPECT_EQ(module.device->axis().power_state(), before);
  }
  Tmcc160Module module;
  module.boot(true);
  module.enable(3);
  module.nmt(2);
  module.wait(50);
  EXPECT_EQ(module.device->axis().power_state(), drive::PowerState::fault);
  EXPECT_EQ(module.device->node().state(), NmtState::stopped);
  module.nmt(1);
  EXPECT_EQ(module.device->axis().power_state(), drive::PowerState::fault)
      << "starting the node resets no fault";
}

}  // namespace
}  // namespace stator::devices
