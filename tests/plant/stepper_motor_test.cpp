// Motor data of a sheet converted to SI, and named stepper motors.
#include "stator/plant/motors/stepper_motor.hpp"

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

TEST(StepperMotor, NamedMotorHasTheHoldingTorqueOfItsSheet) {
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    const auto motor = find_stepper_motor(sheet.name);
    ASSERT_TRUE(motor.has_value()) << sheet.name;
    EXPECT_NEAR(motor->holding_torque(), sheet.holding_torque, 1e-12) << sheet.name;
    EXPECT_EQ(motor->pole_pairs, 50) << sheet.name;
  }
}

TEST(StepperMotor, FluxLinkageFollowsFromHoldingTorqueAndRatedCurrent) {
  EXPECT_NEAR(find_stepper_motor("QSH5718-41-30-047")->flux_linkage, 2.22e-3, 5e-6);
  EXPECT_NEAR(find_stepper_motor("QSH5718-55-30-098")->flux_linkage, 4.62e-3, 5e-6);
  EXPECT_NEAR(find_stepper_motor("QSH5718-79-30-163")->flux_linkage, 7.68e-3, 5e-6);
  EXPECT_NEAR(find_stepper_motor("QSH6018-86-28-310")->flux_linkage, 15.7e-3, 5e-5);
}

TEST(StepperMotor, UnitsOfTheSheetBecomeSi) {
  const auto motor = find_stepper_motor("QSH5718-55-30-098");
  EXPECT_DOUBLE_EQ(motor->inductance, 2.1e-3);
  EXPECT_DOUBLE_EQ(motor->rotor_inertia, 2.09e-5);
}

TEST(StepperMotor, UnknownNameIsNotFound) {
  EXPECT_FALSE(find_stepper_motor("QSH5718").has_value());
}

}  // namespace
}  // namespace stator::plant
