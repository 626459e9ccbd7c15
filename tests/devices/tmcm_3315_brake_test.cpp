// The automatic brake control (2002h, 200Ah, 200Ch) with a weight hanging at the motor.

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

constexpr std::uint32_t kOut0 = 1U << 16;
constexpr std::uint32_t kOut1 = 1U << 17;

/// A weight that falls backwards and a motor whose current needs some milliseconds.
Tmcm3315Configuration with_hanging_load() {
  Tmcm3315Configuration configuration;
  plant::StepperAxisParameters& axis = configuration.axes[0];
  axis.supply_voltage = 12.0;
  axis.motor.inductance = 50e-3;
  axis.load.inertia = 1e-4;
  axis.load.constant_torque = -0.3;
  axis.load.brake_torque = 2.0;
  return configuration;
}

class BrakeBench : public Tmcm3315Module {
 protected:
  explicit BrakeBench(const Tmcm3315Configuration& configuration = with_hanging_load())
      : Tmcm3315Module(configuration) {
    go_operational();
    write<std::uint8_t>(0x2003, 255);
    write<std::uint8_t>(0x2004, 255);
  }
  /// Current opens the brake, as with most.
  void feed_to_release(std::uint8_t current = 255) { write<std::uint8_t>(0x200C, current, 2); }
  void set_delays(std::uint16_t hold_current, std::uint16_t release, std::uint16_t apply) {
    write<std::uint16_t>(0x200A, hold_current);
    write<std::uint16_t>(0x2002, apply, 1);
    write<std::uint16_t>(0x2002, release, 2);
  }
  [[nodiscard]] PowerState state() const { return device_->axis(0).axis().power_state(); }
  /// Revolutions by which the load hangs lower than where it was at the start.
  double sag() { return -signal("axis0.shaft_position"); }
};

TEST_F(BrakeBench, AClosedBrakeHoldsTheWeightWithoutPower) {
  bus_->pass(500_ms);
  EXPECT_LT(sag(), 1e-6);
}

TEST_F(BrakeBench, ReleasedBeforeTheHoldCurrentIsReached_TheWeightFalls) {
  feed_to_release();
  enable(0, 1);
  bus_->pass(300_ms);
  EXPECT_GT(sag(), 0.5);
}

TEST_F(BrakeBench, EnableDriveDelay_LetsTheHoldCurrentComeFirst) {
  feed_to_release();
  set_delays(50, 0, 0);
  enable(0, 1);
  bus_->pass(500_ms);
  EXPECT_EQ(state(), PowerState::operation_enabled);
  EXPECT_EQ(signal("axis0.brake_open"), 1.0);
  EXPECT_LT(sag(), 0.005) << "less than a full step: the load angle alone";
}

TEST_F(BrakeBench, EnablingFollowsTheSequence_CommandsWaitUntilItIsOver) {
  feed_to_release(200);
  set_delays(20, 30, 0);
  enable(0, 1);
  EXPECT_EQ(state(), PowerState::switched_on);
  EXPECT_EQ(signal("output0"), 0.0);
  bus_->pass(15_ms);
  EXPECT_GT(signal("axis0.coil_current_a") + signal("axis0.coil_current_b"), 0.1);
  EXPECT_EQ(signal("output0"), 0.0) << "20 ms from the power stage to the brake";
  control(0, 6);
  bus_->pass(10_ms);
  EXPECT_DOUBLE_EQ(signal("output0"), 200.0 / 255.0);
  EXPECT_EQ(state(), PowerState::switched_on) << "30 ms from the brake to Operation enabled";
  bus_->pass(20_ms);
  EXPECT_EQ(state(), PowerState::switched_on);
  bus_->pass(10_ms);
  EXPECT_EQ(state(), PowerState::ready_to_switch_on)
      << "Shutdown waited until Operation enabled was reached";
}

TEST_F(BrakeBench, WithoutDelays_TheStatesFollowAtOnce) {
  enable(0, 1);
  EXPECT_EQ(state(), PowerState::operation_enabled);
  control(0, 0);
  EXPECT_EQ(state(), PowerState::switch_on_disabled);
}

TEST_F(BrakeBench, EitherPolarityIsFed) {
  write<std::uint8_t>(0x200C, 51, 1);
  write<std::uint8_t>(0x200C, 0, 2);
  bus_->pass(2_ms);
  EXPECT_DOUBLE_EQ(signal("output0"), 0.2) << "applied: 51 of 255";
  enable(0, 1);
  EXPECT_DOUBLE_EQ(signal("output0"), 0.0) << "released";
}

TEST_F(BrakeBench, ABrakeOutputIsNotSwitchedBy2703h) {
  write<std::uint32_t>(0x2703, 0x000F0000, 2);
  write<std::uint32_t>(0x2703, kOut0 | kOut1, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), kOut0 | kOut1) << "no automatic brake control";
  feed_to_release();
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), kOut1) << "the brake of axis 0 is applied";
  enable(0, 1);
  EXPECT_EQ(device_->digital_outputs(), kOut0 | kOut1);
  write<std::uint32_t>(0x2703, kOut1, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), kOut0 | kOut1) << "still released";
  control(0, 0);
  write<std::uint8_t>(0x200C, 0, 2);
  write<std::uint32_t>(0x2703, kOut0, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), kOut0) << "2703h has it back";
}

TEST_F(BrakeBench, EachAxisHasTheOutputOfItsNumber) {
  for (unsigned motor = 0; motor < 3; ++motor) {
    write<std::uint8_t>(of_motor(motor, 0x200C), static_cast<std::uint8_t>(10 + motor), 1);
  }
  bus_->pass(2_ms);
  EXPECT_DOUBLE_EQ(signal("output0"), 10 / 255.0);
  EXPECT_DOUBLE_EQ(signal("output1"), 11 / 255.0);
  EXPECT_DOUBLE_EQ(signal("output2"), 12 / 255.0);
  EXPECT_DOUBLE_EQ(signal("output3"), 0.0);
}

TEST_F(BrakeBench, TooLittleCurrentDoesNotOpenTheBrake) {
  feed_to_release(100);  // the bench's brake pulls from 50 % on
  enable(0, 1);
  bus_->pass(100_ms);
  EXPECT_EQ(signal("axis0.brake_open"), 0.0);
  EXPECT_LT(sag(), 1e-6);
}

/// The armature needs its time as well.
class SlowBrake : public BrakeBench {
 protected:
  SlowBrake() : BrakeBench(slow()) {}
  static Tmcm3315Configuration slow() {
    Tmcm3315Configuration configuration = with_hanging_load();
    configuration.axes[0].motor.inductance = 2.1e-3;
    configuration.axes[0].brake.apply_time = 30_ms;
    configuration.axes[0].brake.release_time = 40_ms;
    return configuration;
  }
  void enable_and_wait() {
    enable(0, 1);
    bus_->pass(200_ms);
    ASSERT_EQ(state(), PowerState::operation_enabled);
    sag_before_ = sag();
    ASSERT_LT(sag_before_, 0.01);
  }
  double sag_before_ = 0.0;
};

TEST_F(SlowBrake, PowerStageOffBeforeTheBrakeHolds_TheWeightFallsUntilItDoes) {
  feed_to_release();
  enable_and_wait();
  control(0, 0);
  EXPECT_EQ(state(), PowerState::switch_on_disabled);
  bus_->pass(300_ms);
  EXPECT_GT(sag() - sag_before_, 0.05);
}

// Every way out of an enabled drive: Shutdown, Disable voltage, Disable operation, Quick stop.
TEST_F(SlowBrake, BrakeDelay_HoldsTheWeightHoweverTheDriveIsDisabled) {
  feed_to_release();
  set_delays(10, 50, 40);
  for (const int command : {6, 0, 7, 2}) {
    SCOPED_TRACE(command);
    enable_and_wait();
    control(0, static_cast<std::uint16_t>(command));
    bus_->pass(1_ms);
    EXPECT_EQ(signal("output0"), 0.0) << "applied at once";
    bus_->pass(37_ms);
    EXPECT_TRUE(device_->axis(0).axis().bridge_enabled()) << "held until the brake has closed";
    bus_->pass(4_ms);
    EXPECT_FALSE(device_->axis(0).axis().bridge_enabled());
    bus_->pass(300_ms);
    EXPECT_LT(sag(), 0.01);
    control(0, 0);
  }
}

TEST_F(SlowBrake, LosingTheMasterStopsTheMotorBeforeItsBrakeIsApplied) {
  feed_to_release();
  set_delays(10, 50, 40);
  write<std::uint32_t>(0x6085, 512'000);
  set_profile(0, 102'400, 1'024'000);
  enable_and_wait();
  start_move(0, 512'000);
  bus_->pass(500_ms);
  bus_->request(AlState::init);
  bus_->pass(100_ms);
  EXPECT_EQ(signal("output0"), 1.0) << "a brake is no brake for a moving load";
  bus_->pass(1'000_ms);
  EXPECT_EQ(signal("output0"), 0.0);
  EXPECT_EQ(state(), PowerState::switch_on_disabled);
  const double position = signal("axis0.shaft_position");
  bus_->pass(500_ms);
  EXPECT_NEAR(signal("axis0.shaft_position"), position, 1e-6);
}

TEST_F(SlowBrake, AMoveStartedBeforeTheBrakeHasOpened_LosesSteps) {
  set_profile(0, 512'000, 51'200'000);
  feed_to_release();
  set_delays(10, 0, 0);
  enable(0, 1);
  bus_->pass(11_ms);
  ASSERT_EQ(state(), PowerState::operation_enabled);
  start_move(0, 51'200);
  bus_->pass(1'000_ms);
  EXPECT_GT(std::abs(signal("axis0.following_error")), 1'000.0);
}

TEST_F(SlowBrake, AModuleWithoutSupplyAppliesItsBrake) {
  feed_to_release();
  set_delays(10, 50, 40);
  enable_and_wait();
  device_->set_power(false, bus_->now());
  EXPECT_EQ(signal("output0"), 0.0);
  bus_->pass(500_ms);
  EXPECT_EQ(signal("axis0.brake_open"), 0.0);
}

/// The brake of axis 0 hangs at OUT3 and is closed by current: nothing of the automatic control.
class BrakeAtOutput3 : public BrakeBench {
 protected:
  BrakeAtOutput3() : BrakeBench(wired()) {}
  static Tmcm3315Configuration wired() {
    Tmcm3315Configuration configuration = with_hanging_load();
    configuration.axes[0].brake.output = 3;
    return configuration;
  }
};

TEST_F(BrakeAtOutput3, IsTheMastersBusiness) {
  enable(0, 1);
  bus_->pass(100_ms);
  write<std::uint32_t>(0x2703, 1U << 19, 2);
  write<std::uint32_t>(0x2703, 1U << 19, 1);
  bus_->pass(100_ms);
  EXPECT_EQ(signal("axis0.brake_open"), 1.0);
  EXPECT_LT(sag(), 0.005);
  write<std::uint32_t>(0x2703, 0, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(signal("axis0.brake_open"), 0.0);
}

}  // namespace
}  // namespace stator::devices
