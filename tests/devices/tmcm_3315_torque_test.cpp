// Cyclic synchronous torque (mode 10) on the real motor.

#include <cmath>
#include <memory>

#include "devices/closed_loop_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

constexpr double kTorqueConstant = 50 * 4.62e-3;  // N m/A of the motor's vector
constexpr double kInertia = 2.09e-5 + 4e-4;       // kg m^2 with the load

/// Axis 0 turns a mass without friction, closed loop with beta alone, in mode 10.
class TorqueModule : public ClosedLoopModule {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration = with_encoder(40'000);
    plant::StepperAxisParameters& axis = configuration.axes[0];
    axis.load.inertia = 4e-4;
    axis.motor.viscous_friction = 0.0;
    axis.motor.coulomb_friction = 0.0;
    axis.motor.static_friction = 0.0;
    return configuration;
  }
  TorqueModule() : ClosedLoopModule(configuration()) {}

  void start(std::int8_t mode = 10) {
    go_operational();
    prepare();
    set_profile(0, 51'200, 512'000);
    enable(0, mode);
    write<std::uint8_t>(0x2020, 1);
    await_initialisation();
  }
  void prepare() {
    write_example();
    write<std::uint32_t>(0x608F, 40'000, 1);
    write<std::uint8_t>(0x2003, 255);
    write<std::uint8_t>(0x2036, 0);
  }
  void torque(int milliamperes) {
    write<std::int16_t>(0x6071, static_cast<std::int16_t>(milliamperes));
  }
  double speed() { return plant().observe().speed; }
};

TEST_F(TorqueModule, AcceleratesAFreeShaftWithTorqueOverInertia) {
  start();
  for (const int milliamperes : {700, -1100}) {
    torque(milliamperes);
    bus_->pass(10_ms);
    const double before = speed();
    const base::SimTime then = bus_->now();
    bus_->pass(50_ms);
    const double acceleration = (speed() - before) / (bus_->now() - then).seconds();
    const double expected = milliamperes * 1e-3 * kTorqueConstant / kInertia;
    EXPECT_NEAR(acceleration, expected, 0.02 * std::fabs(expected));
    EXPECT_NEAR(bus_->upload<std::int16_t>(0x6077), milliamperes, 0.03 * std::abs(milliamperes));
  }
}

TEST_F(TorqueModule, TheOffsetIsAddedAndBothAreInMilliamperes) {
  start();
  torque(1000);
  write<std::int16_t>(0x60B2, -400);
  bus_->pass(20_ms);
  EXPECT_NEAR(bus_->upload<std::int16_t>(0x6077), 600, 20);
  EXPECT_NEAR(plant().observe().electromagnetic_torque, 0.6 * kTorqueConstant, 0.01);
  EXPECT_EQ(statusword() & 0x3400, 0x1000) << "bit 12 used; 10 and 13 reserved";
}

TEST_F(TorqueModule, RunCurrentIsTheUpperEnd) {
  start();
  write<std::uint8_t>(0x2003, 85);
  torque(30'000);
  bus_->pass(20_ms);
  EXPECT_NEAR(bus_->upload<std::int16_t>(0x6077), 1031, 30);
}

TEST_F(TorqueModule, ANewTorqueIsReachedWithinTheInterpolationPeriod) {
  start();
  write<std::uint8_t>(0x60C2, 20, 1);  // 20 ms
  torque(1000);
  bus_->pass(10_ms);
  EXPECT_NEAR(plant().observe().electromagnetic_torque, 0.5 * kTorqueConstant,
              0.12 * kTorqueConstant);
  bus_->pass(15_ms);
  EXPECT_NEAR(plant().observe().electromagnetic_torque, kTorqueConstant, 0.03 * kTorqueConstant);
}

TEST_F(TorqueModule, WithoutClosedLoopTheTargetIsIgnored) {
  go_operational();
  prepare();
  enable(0, 10);
  torque(1000);
  bus_->pass(300_ms);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 10);
  EXPECT_EQ(statusword() & 0x5000, 0) << "ignored, motor stands";
  EXPECT_EQ(bus_->upload<std::int16_t>(0x6077), 0);
  EXPECT_NEAR(shaft_microsteps(), 0.0, 5.0);
  write<std::uint8_t>(0x2020, 1);
  await_initialisation();
  bus_->pass(50_ms);
  EXPECT_EQ(statusword() & 0x5000, 0x5000);
  write<std::uint8_t>(0x2020, 0);
  bus_->pass(500_ms);
  EXPECT_EQ(statusword() & 0x5000, 0);
}

TEST_F(TorqueModule, ActualValuesComeFromTheEncoderAndTheDemandFollowsTheRotor) {
  start();
  write<std::uint32_t>(0x6065, 50);
  torque(300);
  bus_->pass(200_ms);
  const double velocity = speed() / base::kTwoPi * 51'200.0;
  EXPECT_GT(velocity, 200'000.0);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x606C), velocity, 20'000.0) << "8 ms old";
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6062), bus_->upload<std::int32_t>(0x6064), 500)
      << "one period apart";
  EXPECT_EQ(statusword() & 0x006F, 0x0027) << "following errors are none of a torque mode";
}

TEST_F(TorqueModule, HaltBrakesAndHoldsAndItsEndResumes) {
  start();
  torque(300);
  bus_->pass(100_ms);
  control(0, 0x010F);
  bus_->pass(2_ms);
  EXPECT_EQ(statusword() & 0x1000, 0);
  bus_->pass(2_s);
  EXPECT_NEAR(speed(), 0.0, 1.5);
  EXPECT_EQ(statusword() & 0x5000, 0);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6062), bus_->upload<std::int32_t>(0x6064), 200);
  const double halted = shaft_microsteps();
  control(0, 0x000F);
  bus_->pass(100_ms);
  EXPECT_GT(shaft_microsteps(), halted + 1000.0);
  EXPECT_EQ(statusword() & 0x1000, 0x1000);
}

TEST_F(TorqueModule, QuickStopBrakesOnItsRamp) {
  start();
  write<std::uint32_t>(0x6085, 1'000'000);
  torque(300);
  bus_->pass(100_ms);
  const double fast = speed() / base::kTwoPi * 51'200.0;
  control(0, 0x0002);
  bus_->pass(
      static_cast<base::SimDuration>(static_cast<std::int64_t>(fast / 1'000'000.0 * 0.5 * 1e9)));
  EXPECT_NEAR(speed() / base::kTwoPi * 51'200.0, 0.5 * fast, 0.1 * fast);
  EXPECT_EQ(statusword() & 0x006F, 0x0007);
  bus_->pass(1_s);
  EXPECT_EQ(statusword() & 0x004F, 0x0040);
}

TEST_F(TorqueModule, ASoftwareLimitStopsAndHoldsTheAxisAndTheWayBackIsFree) {
  start();
  write<std::int32_t>(0x607D, 20'000, 2);
  torque(200);
  bus_->pass(2_s);
  EXPECT_NEAR(shaft_microsteps(), 20'000.0, 60.0);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 20'000);
  EXPECT_EQ(statusword() & 0x1800, 0x0800) << "internal limit, target ignored";
  torque(-200);
  bus_->pass(100_ms);
  EXPECT_LT(shaft_microsteps(), 18'000.0);
  EXPECT_EQ(statusword() & 0x1000, 0x1000);
}

TEST_F(TorqueModule, ALimitSwitchStopsAndHoldsTheAxisAndTheWayBackIsFree) {
  Tmcm3315Configuration with_switch = configuration();
  with_switch.axes[0].right_switch = plant::PositionSwitch::right_at(0.5);
  renew(with_switch);
  start();
  write<std::uint32_t>(0x2014, 512'000);
  torque(200);
  bus_->pass(2_s);
  const double held = shaft_microsteps();
  EXPECT_GT(held, 25'600.0);
  EXPECT_LT(held, 100'000.0);
  EXPECT_NEAR(speed(), 0.0, 1.5);
  EXPECT_EQ(statusword() & 0x1800, 0x0800);
  bus_->pass(1_s);
  EXPECT_NEAR(shaft_microsteps(), held, 100.0) << "no torque toward the switch";
  torque(-200);
  bus_->pass(200_ms);
  EXPECT_LT(shaft_microsteps(), held - 2000.0);
}

TEST_F(TorqueModule, ModesChangeInFlightByTheSlowDownRampWithoutAJump) {
  start();
  torque(300);
  bus_->pass(100_ms);
  write<std::int8_t>(0x6060, 1);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 10) << "brakes first";
  bus_->pass(2_s);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 1);
  const std::int32_t demand = bus_->upload<std::int32_t>(0x6062);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6064), demand, 200);
  write<std::int32_t>(0x607A, demand + 10'000);
  control(0, 31);
  bus_->pass(2_s);
  EXPECT_NEAR(shaft_microsteps(), demand + 10'000.0, 200.0);
  control(0, 15);
  write<std::int8_t>(0x6060, 10);
  bus_->pass(20_ms);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 10);
  EXPECT_EQ(statusword() & 0x1000, 0x1000);
}

TEST_F(TorqueModule, TorqueActualIsTheLoadsInEveryMode) {
  start(1);
  load(-0.2);
  bus_->pass(3_s);
  const double torque = plant().observe().electromagnetic_torque;
  EXPECT_NEAR(bus_->upload<std::int16_t>(0x6077), 1e3 * torque / kTorqueConstant, 30.0);
  write<std::uint8_t>(0x2020, 0);
  bus_->pass(5_ms);
  EXPECT_EQ(bus_->upload<std::int16_t>(0x6077), 0) << "the rotor's angle is not known";
}

}  // namespace
}  // namespace stator::devices
