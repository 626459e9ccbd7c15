// Broken cables and shorts.

#include <gtest/gtest.h>

#include "plant/rotating_field.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr base::AxisActuation kBoth{.bridge_enabled = true, .coil_current_target = {2.0, 2.0}};

StepperAxis energised() {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  StepperAxis axis(parameters);
  for (int n = 0; n < 2000; ++n) {
    axis.step(kBoth, 50_us);
  }
  return axis;
}

TEST(StepperAxisFaults, AnOpenPhaseCarriesNoCurrentAndTheOtherGoesOn) {
  StepperAxis axis = energised();
  axis.set_faults({.open = {true, false}});
  axis.step(kBoth, 50_us);
  EXPECT_EQ(axis.observe().coil_current[0], 0.0);
  EXPECT_NEAR(axis.observe().coil_current[1], 2.0, 0.01);
  axis.set_faults({});
  for (int n = 0; n < 200; ++n) {
    axis.step(kBoth, 50_us);
  }
  EXPECT_NEAR(axis.observe().coil_current[0], 2.0, 0.01);
}

TEST(StepperAxisFaults, AShortTakesTheVoltageAndIsSeenWhileTheBridgeIsOn) {
  StepperAxis axis = energised();
  axis.set_faults({.shorted = {false, true}});
  base::AxisSensing sensing;
  for (int n = 0; n < 600; ++n) {
    sensing = axis.step(kBoth, 50_us);
  }
  EXPECT_NEAR(sensing.coil_current[0], 2.0, 0.01);
  EXPECT_NEAR(sensing.coil_current[1], 0.0, 0.01) << "30 ms are eleven times L / R";
  EXPECT_FALSE(sensing.overcurrent[0]);
  EXPECT_TRUE(sensing.overcurrent[1]);
  EXPECT_FALSE(sensing.overcurrent_high_side);
  EXPECT_FALSE(axis.step({}, 50_us).overcurrent[1]);
}

TEST(StepperAxisFaults, AShortOfTheStageTakesBothVoltages) {
  StepperAxis axis = energised();
  axis.set_faults({.high_side = true});
  base::AxisSensing sensing;
  for (int n = 0; n < 400; ++n) {
    sensing = axis.step(kBoth, 50_us);
  }
  EXPECT_NEAR(sensing.coil_current[0], 0.0, 0.01);
  EXPECT_NEAR(sensing.coil_current[1], 0.0, 0.01);
  EXPECT_TRUE(sensing.overcurrent_high_side);
}

}  // namespace
}  // namespace stator::plant
