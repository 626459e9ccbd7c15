// Line-to-line data of a motor's sheet converted to those of a phase, and named motors.
#include "stator/plant/motors/three_phase_motor.hpp"

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

TEST(ThreePhaseMotor, LineToLineValuesOfASheetBecomeThoseOfAPhase) {
  const ThreePhaseMotorParameters motor = *find_three_phase_motor("QBL4208-61-04-013");
  EXPECT_NEAR(motor.resistance, 0.36, 1e-12);
  EXPECT_NEAR(motor.direct_inductance, 0.6e-3, 1e-12);
  EXPECT_NEAR(motor.flux_linkage, 5.196e-3, 1e-6);  // 36 mV s/rad / (sqrt(3) 4)
  EXPECT_NEAR(motor.rotor_inertia, 48e-7, 1e-12);
  EXPECT_EQ(motor.cogging[0].order, 6);
}

TEST(ThreePhaseMotor, TorqueConstantOfBlockCommutationIsAMeanOverASixthOfAPeriod) {
  const ThreePhaseMotorParameters motor = *find_three_phase_motor("EC45-flat-70W");
  EXPECT_NEAR(motor.flux_linkage, 3.05e-3, 0.01e-3);
  EXPECT_NEAR(find_three_phase_motor("mj5208")->flux_linkage, 2.6e-3, 0.01e-3);
}

TEST(ThreePhaseMotor, RatedCurrentWarmsTheWindingToItsClass) {
  const ThreePhaseMotorParameters motor = *find_three_phase_motor("QBL4208-61-04-013");
  const double loss = 1.5 * motor.resistance * motor.rated_current * motor.rated_current *
                      (1.0 + motor.resistance_coefficient * 80.0);
  EXPECT_NEAR(loss * (motor.thermal.inner_to_outer + motor.thermal.outer_to_ambient), 80.0, 1e-9);
  EXPECT_EQ(find_three_phase_motor("EC45-flat-70W")->thermal.inner_to_outer, 6.64);
}

TEST(ThreePhaseMotor, NamesAreExact) {
  EXPECT_FALSE(find_three_phase_motor("QBL4208-61"));
  for (const ThreePhaseMotorSheet& sheet : three_phase_motor_sheets()) {
    EXPECT_TRUE(find_three_phase_motor(sheet.name)) << sheet.name;
  }
}

}  // namespace
}  // namespace stator::plant
