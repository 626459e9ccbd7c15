#include "stator/control/stepper/stall_guard.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"

namespace stator::control {
namespace {

/// An ideal motor: EMF 5 V, 2 A, the given sine of the load angle.
class Motor {
 public:
  static constexpr int kStepsPerFullStep = 50;

  /// Turns by full steps; collects the measurements made.
  std::vector<int> turn(int full_steps, double load) {
    std::vector<int> measurements;
    for (int n = 0; n < full_steps * kStepsPerFullStep; ++n) {
      const base::SineCosine x =
          base::sine_cosine(0.5 * base::kPi * (position_ + 0.5) / kStepsPerFullStep);
      position_ += forward ? 1 : -1;
      base::AxisSensing sensing;
      sensing.coil_current = {2.0 * x.cosine, 2.0 * x.sine};
      sensing.induced_voltage = forward ? 5.0 : -5.0;
      sensing.converted_power = 10.0 * load;
      sensing.current_regulated = n % 10 >= unregulated_tenths;
      if (chip.advance(settings, sensing.coil_current, forward, sensing)) {
        measurements.push_back(chip.value());
      }
    }
    return measurements;
  }

  StallGuard chip;
  StallGuardSettings settings;
  bool forward = true;
  int unregulated_tenths = 0;

 private:
  int position_ = 0;
};

TEST(StallGuard, MeasuresTheUnusedEmfOncePerFullStep) {
  Motor motor;
  EXPECT_EQ(motor.turn(1, 0.0), std::vector<int>()) << "not seen from its begin";
  EXPECT_EQ(motor.turn(10, 0.0), std::vector<int>(9, 500));
  const std::vector<int> loaded = motor.turn(4, 0.5);
  EXPECT_EQ(loaded.back(), 250);
  EXPECT_NEAR(motor.turn(4, 0.999).back(), 0, 1);
}

TEST(StallGuard, WorksBackwardsToo) {
  Motor motor;
  motor.forward = false;
  motor.turn(4, 0.4);
  EXPECT_NEAR(motor.chip.value(), 300, 1);
}

TEST(StallGuard, TheFilterMakesOneMeasurementOfFourFullSteps) {
  Motor motor;
  motor.settings.filter = true;
  EXPECT_EQ(motor.turn(18, 0.2).size(), 4U);
  EXPECT_NEAR(motor.chip.value(), 400, 1);
}

TEST(StallGuard, AHigherThresholdIsLessSensitive) {
  Motor motor;
  motor.settings.threshold = 10;
  motor.turn(3, 0.5);
  EXPECT_EQ(motor.chip.value(), 330);
  motor.settings.threshold = -63;
  motor.turn(3, 0.5);
  EXPECT_EQ(motor.chip.value(), 0);
  motor.settings.threshold = 63;
  motor.turn(3, -0.5);
  EXPECT_EQ(motor.chip.value(), 1023);
}

TEST(StallGuard, TimeWithoutRegulationCountsAsNothing) {
  Motor motor;
  motor.unregulated_tenths = 5;
  motor.turn(4, 0.0);
  EXPECT_EQ(motor.chip.value(), 250);
}

TEST(StallGuard, AResetForgetsValueAndFullStep) {
  Motor motor;
  motor.turn(4, 0.0);
  motor.chip.reset();
  EXPECT_EQ(motor.chip.value(), 0);
  EXPECT_TRUE(motor.turn(1, 0.0).empty());
}

}  // namespace
}  // namespace stator::control
