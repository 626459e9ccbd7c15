// Faults that axes of every kind can have: shaft, brake, supply, heat, switches, encoder.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <type_traits>

#include <gtest/gtest.h>

#include "plant/commutated_pwm_axis.hpp"
#include "plant/ideal_commutator.hpp"
#include "plant/rotating_field.hpp"
#include "stator/plant/axes/axis_fault_inputs.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr std::int64_t kCounts = 4096;

/// Limit switches that nothing presses, a brake, an encoder.
template <typename Parameters>
Parameters equipped(Parameters parameters) {
  parameters.left_switch = PositionSwitch::left_at(-1e3);
  parameters.home_switch = PositionSwitch::home_between(-1e3, 1e3);
  parameters.home_switch.normally_closed = true;
  parameters.load.brake_torque = 5.0;
  return parameters;
}

/// Each turns its shaft forward with an ideal drive.
class StepperRig {
 public:
  StepperRig() : axis_(parameters()) { recover(); }
  void run(double seconds) {
    const auto steps = std::llround(seconds / RotatingField::kStep.seconds());
    for (auto n = steps; n > 0; --n) {
      field_->step(field_->speed() < 30.0 ? 150.0 : 0.0);
    }
  }
  /// The field begins anew, as that of a drive that is enabled again.
  void recover() { field_.emplace(axis_, 3.0); }
  StepperAxis& axis() { return axis_; }
  [[nodiscard]] double revolutions() const { return axis_.observe().shaft_revolutions; }
  [[nodiscard]] double speed() const { return axis_.observe().speed; }
  [[nodiscard]] std::int64_t count() const { return axis_.sensing().encoder_count; }
  [[nodiscard]] std::uint32_t passages() const { return axis_.sensing().encoder_index_passages; }
  [[nodiscard]] double voltage() const { return axis_.sensing().supply_voltage; }
  [[nodiscard]] const base::AxisSensing& sensing() const { return axis_.sensing(); }

 private:
  static StepperAxisParameters parameters() {
    StepperAxisParameters p;
    p.motor = *find_stepper_motor("QSH5718-55-30-098");
    p.encoder.counts_per_revolution = kCounts;
    return equipped(p);
  }
  StepperAxis axis_;
  std::optional<RotatingField> field_;
};

class ServoRig {
 public:
  ServoRig() : axis_(parameters()) {}
  void run(double seconds) {
    base::ServoActuation actuation{.bridge_enabled = true};
    for (auto n = std::llround(seconds * 20e3); n > 0; --n) {
      actuation.duty = commutated(axis_, 0.0, 2.0);
      axis_.step(actuation, 50_us);
    }
  }
  void recover() {}
  ServoAxis& axis() { return axis_; }
  [[nodiscard]] double revolutions() const { return axis_.observe().shaft_revolutions; }
  [[nodiscard]] double speed() const { return axis_.observe().speed; }
  [[nodiscard]] std::int64_t count() const { return axis_.sensing().encoder_count; }
  [[nodiscard]] std::uint32_t passages() const { return axis_.sensing().encoder_index_passages; }
  [[nodiscard]] double voltage() const { return axis_.sensing().supply_voltage; }
  [[nodiscard]] const base::ServoSensing& sensing() const { return axis_.sensing(); }

 private:
  static ServoAxisParameters parameters() {
    ServoAxisParameters p = equipped(textbook_axis());
    p.load.inertia = 5e-5;
    p.supply.source_resistance = 0.1;
    p.encoder.counts_per_revolution = kCounts;
    return p;
  }
  ServoAxis axis_;
};

class PwmRig {
 public:
  PwmRig() : axis_(parameters()) {}
  void run(double seconds) { plant::run(axis_, seconds, 2.0); }
  void recover() {}
  PwmAxis& axis() { return axis_; }
  [[nodiscard]] double revolutions() const { return axis_.revolutions(); }
  [[nodiscard]] double speed() const { return axis_.speed(); }
  [[nodiscard]] std::int64_t count() const { return axis_.sensing().encoders[0].count; }
  [[nodiscard]] std::uint32_t passages() const {
    return axis_.sensing().encoders[0].index_passages;
  }
  [[nodiscard]] double voltage() const { return axis_.supply_voltage(); }
  [[nodiscard]] const PwmSensing& sensing() const { return axis_.sensing(); }

 private:
  static PwmAxisParameters parameters() {
    PwmAxisParameters p = equipped(three_phase_axis());
    p.load.inertia = 5e-5;
    p.supply.source_resistance = 0.1;
    p.encoders[0].counts_per_revolution = kCounts;
    return p;
  }
  PwmAxis axis_;
};

template <typename Rig>
class AxisFaultsOf : public testing::Test {
 protected:
  /// Changes one thing, as an input does.
  template <typename Change>
  void change(Change set) {
    auto faults = rig_.axis().faults();
    set(faults.common);
    rig_.axis().set_faults(faults);
  }
  void mend() { rig_.axis().set_faults({}); }
  Rig rig_;
};
using Rigs = testing::Types<StepperRig, ServoRig, PwmRig>;
TYPED_TEST_SUITE(AxisFaultsOf, Rigs);

TYPED_TEST(AxisFaultsOf, ABlockedShaftStandsWhereItWasAndAFreedOneTurns) {
  auto& rig = this->rig_;
  rig.run(0.3);
  ASSERT_GT(rig.speed(), 10.0);
  const double at = rig.revolutions();
  this->change([](AxisFaults& f) { f.shaft.jam = Jam::blocked; });
  rig.axis().set_external_torque(900.0);
  rig.run(0.1);
  EXPECT_EQ(rig.speed(), 0.0);
  EXPECT_EQ(rig.revolutions(), at);
  rig.axis().set_external_torque(0.0);
  this->mend();
  rig.recover();
  rig.run(0.4);
  EXPECT_GT(rig.speed(), 10.0);
}

TYPED_TEST(AxisFaultsOf, AJamBetweenTwoPositionsEndsTheWayThere) {
  auto& rig = this->rig_;
  rig.run(0.3);
  const double at = rig.revolutions();
  this->change([&](AxisFaults& f) {
    f.shaft.jam_from = at - 1.0;
    f.shaft.jam_to = at + 0.25;
    f.shaft.jam = Jam::between;
  });
  rig.run(0.5);
  EXPECT_LT(rig.revolutions(), at + 0.27);
  EXPECT_GT(rig.revolutions(), at - 1.0);
}

TYPED_TEST(AxisFaultsOf, AJamThatDoesNotContainTheShaftHoldsItWhereItIs) {
  auto& rig = this->rig_;
  rig.run(0.3);
  const double at = rig.revolutions();
  this->change([](AxisFaults& f) {
    f.shaft.jam_from = -9.0;  // far behind
    f.shaft.jam_to = -8.0;
    f.shaft.jam = Jam::between;
  });
  rig.run(0.1);
  EXPECT_LT(rig.revolutions(), at + 0.05);
}

TYPED_TEST(AxisFaultsOf, FrictionAndADraggingBrakeStopTheShaft) {
  for (const bool drag : {false, true}) {
    auto& rig = this->rig_;
    rig.run(0.3);
    this->change(
        [&](AxisFaults& f) { (drag ? f.shaft.brake_drag : f.shaft.jamming_torque) = 8.0; });
    rig.run(0.2);
    EXPECT_NEAR(rig.speed(), 0.0, 0.5);
    this->mend();
    rig.recover();
  }
}

TYPED_TEST(AxisFaultsOf, ABrakeThatDoesNotReleaseHoldsThoughItsCoilIsFed) {
  auto& rig = this->rig_;
  rig.run(0.3);
  ASSERT_GT(rig.speed(), 10.0);
  this->change([](AxisFaults& f) { f.shaft.brake = BrakeFault::closed; });
  rig.run(0.2);
  EXPECT_NEAR(rig.speed(), 0.0, 0.5);
}

TYPED_TEST(AxisFaultsOf, ABrakeThatDoesNotHoldLetsALoadDrop) {
  auto& axis = this->rig_.axis();
  const auto rest = [&axis] {
    for (int n = 0; n < 2000; ++n) {
      if constexpr (requires { axis.step(PwmActuation{}, 50_us); }) {
        axis.step(PwmActuation{.brake_released = false}, 50_us);
      } else if constexpr (requires { axis.step(base::ServoActuation{}, 50_us); }) {
        base::ServoActuation actuation;
        actuation.brake_released = false;
        axis.step(actuation, 50_us);
      } else {
        axis.step(base::AxisActuation{.brake_released = false}, 50_us);
      }
    }
  };
  axis.set_external_torque(-3.0);
  rest();
  EXPECT_NEAR(this->rig_.revolutions(), 0.0, 1e-3);
  this->change([](AxisFaults& f) { f.shaft.brake = BrakeFault::open; });
  rest();
  EXPECT_LT(this->rig_.revolutions(), -0.1);
}

TYPED_TEST(AxisFaultsOf, MoreInertiaTakesLongerToTurn) {
  auto& axis = this->rig_.axis();
  double turned[2] = {};
  for (const bool heavy : {false, true}) {
    this->change([&](AxisFaults& f) { f.shaft.inertia = heavy ? 1e-3 : 0.0; });
    axis.set_external_torque(heavy ? 0.1 : 0.0);
    const double before = this->rig_.revolutions();
    if (heavy) {
      // 0.1 N m on 1.06e-3 kg m^2 for 0.1 s: 0.075 revolutions less friction.
      for (int n = 0; n < 2000; ++n) {
        if constexpr (requires { axis.step(PwmActuation{}, 50_us); }) {
          axis.step(PwmActuation{}, 50_us);
        } else if constexpr (requires { axis.step(base::ServoActuation{}, 50_us); }) {
          axis.step(base::ServoActuation{}, 50_us);
        } else {
          axis.step(base::AxisActuation{}, 50_us);
        }
      }
    }
    turned[heavy ? 1 : 0] = this->rig_.revolutions() - before;
  }
  EXPECT_EQ(turned[0], 0.0);
  EXPECT_GT(turned[1], 0.02);
  EXPECT_LT(turned[1], 0.085);
}

TYPED_TEST(AxisFaultsOf, ALostEncoderStandsAndGoesOnFromThereWhenItIsBack) {
  auto& rig = this->rig_;
  rig.run(0.3);
  const std::int64_t frozen = rig.count();
  const std::uint32_t passages = rig.passages();
  this->change([](AxisFaults& f) {
    f.encoders[0].lost = true;
    f.encoders[0].index_lost = true;
  });
  rig.run(0.5);
  EXPECT_EQ(rig.count(), frozen);
  EXPECT_EQ(rig.passages(), passages);
  const double at = rig.revolutions();
  this->mend();
  rig.run(0.3);
  EXPECT_NEAR(static_cast<double>(rig.count() - frozen), (rig.revolutions() - at) * kCounts, 2.0);
}

TYPED_TEST(AxisFaultsOf, ADeadChannelLetsTheCountGoUpAndDownByOne) {
  for (const std::uint8_t channel : {std::uint8_t{1}, std::uint8_t{2}}) {
    auto& rig = this->rig_;
    rig.run(0.3);
    const std::int64_t before = rig.count();
    this->change([&](AxisFaults& f) { f.encoders[0].dead_channel = channel; });
    std::int64_t lowest = before;
    std::int64_t highest = before;
    for (int n = 0; n < 1000; ++n) {
      rig.run(1e-4);
      lowest = std::min(lowest, rig.count());
      highest = std::max(highest, rig.count());
    }
    EXPECT_EQ(highest - lowest, 1) << int{channel};
    this->mend();
  }
}

TYPED_TEST(AxisFaultsOf, ASlippingDiscStaysBehindWithItsIndex) {
  auto& rig = this->rig_;
  rig.run(0.3);
  const double at = rig.revolutions();
  const std::int64_t count = rig.count();
  this->change([](AxisFaults& f) { f.encoders[0].slip = 0.25; });
  rig.run(0.5);
  const double turned = rig.revolutions() - at;
  ASSERT_GT(turned, 1.0);
  EXPECT_NEAR(static_cast<double>(rig.count() - count), 0.75 * turned * kCounts, 3.0);
  this->mend();
  // What has slipped stays; counts and index pulses fit each other again.
  const double mended = rig.revolutions();
  const std::int64_t then = rig.count();
  const std::uint32_t passages = rig.passages();
  rig.run(0.5);
  const double further = rig.revolutions() - mended;
  EXPECT_NEAR(static_cast<double>(rig.count() - then), further * kCounts, 3.0);
  EXPECT_NEAR(static_cast<double>(rig.passages() - passages), further, 1.0);
}

TYPED_TEST(AxisFaultsOf, ACouplingSlipsFromItsTorqueOnOnly) {
  auto& rig = this->rig_;
  this->change([](AxisFaults& f) {
    f.encoders[0].slip = 0.5;
    f.encoders[0].slip_torque = 50.0;
  });
  rig.run(0.5);
  EXPECT_NEAR(static_cast<double>(rig.count()), rig.revolutions() * kCounts, 2.0);
}

TYPED_TEST(AxisFaultsOf, NoiseStaysWithinItsCountsAndIsTheSameInACopy) {
  auto& rig = this->rig_;
  rig.run(0.1);
  this->change([](AxisFaults& f) { f.encoders[0].noise = 7.0; });
  TypeParam copy = rig;
  std::int64_t largest = 0;
  for (int n = 0; n < 500; ++n) {
    rig.run(1e-4);
    const double off = static_cast<double>(rig.count()) - rig.revolutions() * kCounts;
    EXPECT_LE(std::fabs(off), 9.0);
    largest = std::max(largest, std::int64_t{std::llround(std::fabs(off))});
  }
  EXPECT_GE(largest, 6);
  if constexpr (!std::is_same_v<TypeParam, StepperRig>) {  // whose field refers to the first axis
    for (int n = 0; n < 500; ++n) {
      copy.run(1e-4);
    }
    EXPECT_EQ(copy.count(), rig.count());
  }
}

TYPED_TEST(AxisFaultsOf, TheSourceSagsAndRisesAndComesBack) {
  auto& rig = this->rig_;
  rig.run(0.05);
  this->change([](AxisFaults& f) { f.supply.offset = -10.0; });
  rig.run(0.001);
  EXPECT_NEAR(rig.voltage(), 14.0, 0.5);
  rig.axis().set_supply_voltage(30.0);
  rig.run(0.01);
  EXPECT_NEAR(rig.voltage(), 20.0, 0.5);
  this->change([](AxisFaults& f) { f.supply.offset = -50.0; });
  rig.run(0.01);
  EXPECT_NEAR(rig.voltage(), 0.0, 0.5);
  this->mend();
  rig.run(0.05);
  EXPECT_NEAR(rig.voltage(), 30.0, 0.5);
}

TYPED_TEST(AxisFaultsOf, ABadContactTakesVoltageUnderLoadOnly) {
  auto& rig = this->rig_;
  rig.run(0.1);
  const double before = rig.voltage();
  this->change([](AxisFaults& f) { f.supply.resistance = 1.0; });
  double lowest = before;
  this->change([](AxisFaults& f) { f.shaft.jam = Jam::blocked; });
  for (int n = 0; n < 500; ++n) {
    rig.run(1e-4);
    lowest = std::min(lowest, rig.voltage());
  }
  EXPECT_LT(lowest, before - 0.2);
  this->mend();
  rig.run(0.1);
  EXPECT_NEAR(rig.voltage(), before, 0.2);
}

TYPED_TEST(AxisFaultsOf, HeatWarmsAndAWrongSensorTellsMore) {
  auto& rig = this->rig_;
  rig.run(0.05);
  const double cold = rig.sensing().driver_temperature;
  this->change([](AxisFaults& f) { f.heat.driver_reading = 80.0; });
  rig.run(0.05);
  EXPECT_NEAR(rig.sensing().driver_temperature, cold + 80.0, 2.0);
  this->change([](AxisFaults& f) { f.heat.driver_heat = 50.0; });
  rig.run(0.5);
  EXPECT_GT(rig.sensing().driver_temperature, cold + 100.0);
  this->change([](AxisFaults& f) { f.heat.driver_reading = 0.0; });
  EXPECT_GT(rig.axis().observe().driver_temperature, cold + 20.0);
  const double winding = rig.axis().observe().winding_temperature;
  this->change([](AxisFaults& f) { f.heat.motor_heat = 500.0; });
  rig.run(0.5);
  EXPECT_GT(rig.axis().observe().winding_temperature, winding + 4.0);
}

TYPED_TEST(AxisFaultsOf, AStuckSwitchTellsTheSameWhateverPressesIt) {
  auto& rig = this->rig_;
  rig.run(0.01);
  EXPECT_FALSE(rig.sensing().left_switch);
  EXPECT_FALSE(rig.sensing().home_switch) << "normally closed, pressed everywhere";
  this->change([](AxisFaults& f) {
    f.switches = {SwitchFault::pressed, SwitchFault::none, SwitchFault::released};
  });
  rig.run(0.01);
  EXPECT_TRUE(rig.sensing().left_switch);
  EXPECT_TRUE(rig.sensing().home_switch);
  rig.axis().press_left_switch(false);
  rig.run(0.01);
  EXPECT_TRUE(rig.sensing().left_switch);
  this->change([](AxisFaults& f) { f.switches = {SwitchFault::released}; });
  rig.axis().press_left_switch(true);
  rig.run(0.01);
  EXPECT_FALSE(rig.sensing().left_switch);
  this->mend();
  rig.run(0.01);
  EXPECT_TRUE(rig.sensing().left_switch) << "the hand still presses it";
}

TEST(AxisFaultInputs, EveryRowChangesSomethingAndZeroTakesItBack) {
  for (const AxisFaultInput& row : axis_fault_inputs()) {
    AxisFaults faults;
    row.apply(faults, row.maximum);
    EXPECT_NE(faults, AxisFaults{}) << row.name;
    row.apply(faults, 0.0);
    EXPECT_EQ(faults, AxisFaults{}) << row.name;
    EXPECT_LE(row.minimum, 0.0) << row.name;
  }
}

TEST(StepperAxisEncoder, LostCountsKeepTheLatchOfTheIndex) {
  StepperRig rig;
  rig.run(0.8);
  ASSERT_GT(rig.passages(), 0U);
  const std::int64_t latched = rig.sensing().encoder_index_count;
  rig.axis().lose_encoder_counts(100);
  rig.axis().set_faults({.common = {.shaft = {.jam = Jam::blocked}}});
  rig.run(1e-4);
  EXPECT_EQ(rig.sensing().encoder_index_count, latched);
  EXPECT_NEAR(static_cast<double>(rig.count()), rig.revolutions() * kCounts - 100.0, 1.0);
}

TEST(StepperAxisEncoder, ASnapshotWithFaultsGoesOnWithTheSameBits) {
  StepperRig rig;
  auto faults = rig.axis().faults();
  faults.common.encoders[0] = {.slip = 0.1, .noise = 3.0};
  faults.common.shaft.viscous_friction = 1e-3;
  faults.common.supply.resistance = 0.5;
  rig.axis().set_faults(faults);
  rig.run(0.3);
  const StepperAxisState snapshot = rig.axis().state();
  StepperAxis other(rig.axis().parameters());
  other.restore(snapshot);
  const base::AxisActuation actuation{.bridge_enabled = true, .coil_current_target = {2.0, -1.0}};
  for (int n = 0; n < 500; ++n) {
    const base::AxisSensing expected = rig.axis().step(actuation, 50_us);
    const base::AxisSensing seen = other.step(actuation, 50_us);
    ASSERT_EQ(seen.encoder_count, expected.encoder_count) << n;
    ASSERT_EQ(seen.coil_current, expected.coil_current) << n;
    ASSERT_EQ(seen.supply_voltage, expected.supply_voltage) << n;
  }
}

}  // namespace
}  // namespace stator::plant
