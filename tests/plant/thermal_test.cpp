// Temperatures of motor and driver stage against the solution of their equations.

#include <cmath>

#include <gtest/gtest.h>

#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

/// Both temperatures after `time` with constant power: eigenvalues of the two-body equations.
ThermalState two_exponentials(const ThermalParameters& p, double power, double ambient,
                              double time) {
  const double a = 1.0 / (p.inner_capacity * p.inner_to_outer);
  const double b = 1.0 / (p.outer_capacity * p.inner_to_outer);
  const double c = b + 1.0 / (p.outer_capacity * p.outer_to_ambient);
  const double root = std::sqrt((a - c) * (a - c) + 4.0 * a * b);
  const double fast = 0.5 * (-(a + c) - root);
  const double slow = 0.5 * (-(a + c) + root);
  // Distance from the final state; along an eigenvector (1, 1 + lambda / a).
  const double inner = -power * (p.inner_to_outer + p.outer_to_ambient);
  const double outer = -power * p.outer_to_ambient;
  const double slow_part = (outer - inner * (1.0 + fast / a)) / ((slow - fast) / a);
  const double fast_part = inner - slow_part;
  const double s = slow_part * std::exp(slow * time);
  const double f = fast_part * std::exp(fast * time);
  return {ambient - inner + s + f, ambient - outer + s * (1.0 + slow / a) + f * (1.0 + fast / a)};
}

TEST(TwoBodyThermal, FollowsTheTwoExponentialsWhateverTheStep) {
  const ThermalParameters p{.inner_capacity = 6.5,
                            .outer_capacity = 50.0,
                            .inner_to_outer = 2.0,
                            .outer_to_ambient = 5.0};
  for (const double step : {1e-3, 0.5, 30.0}) {
    const TwoBodyThermal thermal(p, step);
    ThermalState state;
    const int steps = static_cast<int>(std::lround(60.0 / step));
    for (int n = 0; n < steps; ++n) {
      thermal.advance(state, 8.0, 25.0);
    }
    const ThermalState expected = two_exponentials(p, 8.0, 25.0, 60.0);
    EXPECT_NEAR(state.inner, expected.inner, 1e-6) << step;
    EXPECT_NEAR(state.outer, expected.outer, 1e-6) << step;
  }
}

StepperAxisParameters cold_resistance() {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.motor.temperature_coefficient = 0.0;
  return parameters;
}

constexpr base::AxisActuation kHold{.bridge_enabled = true, .coil_current_target = {3.0, 2.0}};

void hold(StepperAxis& axis, int seconds) {
  for (int n = 0; n < seconds * 20'000; ++n) {
    axis.step(kHold, 50_us);
  }
}

TEST(Temperatures, AHoldingMotorHeatsOnTheTwoExponentials) {
  StepperAxis axis(cold_resistance());
  const StepperMotorParameters& motor = axis.parameters().motor;
  const double power = motor.resistance * (3.0 * 3.0 + 2.0 * 2.0);
  double time = 0.0;
  for (const int seconds : {5, 20, 100}) {
    hold(axis, seconds);
    time += seconds;
    const ThermalState expected = two_exponentials(motor.thermal, power, 25.0, time);
    EXPECT_NEAR(axis.observe().winding_temperature, expected.inner, 0.002 * expected.inner);
    EXPECT_NEAR(axis.observe().housing_temperature, expected.outer, 0.002 * expected.outer);
  }
}

TEST(Temperatures, TheDriverStageHeatsWithItsLosses) {
  StepperAxis axis(cold_resistance());
  const DriverStageParameters& driver = axis.parameters().driver;
  const double power =
      driver.on_resistance * 13.0 + driver.switching_share * 24.0 * std::sqrt(13.0);
  hold(axis, 10);
  const ThermalState expected = two_exponentials(driver.thermal, power, 25.0, 10.0);
  EXPECT_NEAR(axis.observe().driver_temperature, expected.inner, 0.05);
  EXPECT_EQ(axis.sense().driver_temperature, axis.observe().driver_temperature);
  EXPECT_GT(expected.inner, 30.0);
}

TEST(Temperatures, RatedCurrentWarmsTheWindingByEightyKelvin) {
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    const StepperMotorParameters motor = parameters_of(sheet);
    const TwoBodyThermal thermal(motor.thermal, 10.0);
    ThermalState state;
    for (int n = 0; n < 10'000; ++n) {
      const double resistance =
          motor.resistance * (1.0 + motor.temperature_coefficient * (state.inner - 25.0));
      thermal.advance(state, 2.0 * resistance * motor.rated_current * motor.rated_current, 25.0);
    }
    EXPECT_NEAR(state.inner, 105.0, 0.1) << sheet.name;
  }
}

TEST(Temperatures, TheResistanceFollowsTheWinding) {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.ambient_temperature = 75.0;
  StepperAxis axis(parameters);
  EXPECT_NEAR(axis.resistance(), 0.8 * (1.0 + 0.00393 * 50.0), 1e-12);
  // Half of the supply on a phase that stands: the current is U/R of the warm winding.
  base::AxisActuation actuation{.bridge_enabled = true, .voltage_mode = true};
  actuation.coil_duty = {0.1, 0.0};
  for (int n = 0; n < 20'000; ++n) {
    axis.step(actuation, 50_us);
  }
  EXPECT_GT(axis.resistance(), 0.8 * (1.0 + 0.00393 * 50.0));
  EXPECT_NEAR(axis.observe().coil_current[0], 2.4 / axis.resistance(), 1e-4);
}

TEST(Temperatures, AMotorWithoutCurrentCoolsDownToTheAir) {
  StepperAxis axis(cold_resistance());
  hold(axis, 30);
  const double warm = axis.observe().winding_temperature;
  ASSERT_GT(warm, 30.0);
  axis.set_ambient_temperature(10.0);
  for (int n = 0; n < 10'000; ++n) {
    axis.step({}, 1_s);
  }
  EXPECT_NEAR(axis.observe().winding_temperature, 10.0, 1e-3);
  EXPECT_NEAR(axis.observe().driver_temperature, 10.0, 1e-3);
}

}  // namespace
}  // namespace stator::plant
