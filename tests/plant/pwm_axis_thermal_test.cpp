#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "plant/commutated_pwm_axis.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

/// Holds a constant current for 20 s; temperatures against the two bodies alone.
void expect_heat(PwmAxisParameters p, const std::array<double, 4>& duty, double squares_of_phases,
                 double terminals_per_phase, double resistance, const ThermalParameters& motor) {
  p.load.brake_torque = 100.0;
  p.ambient_temperature = 40.0;
  PwmAxis axis(p);
  const PwmActuation actuation{.bridge_enabled = true, .duty = duty, .brake_released = false};
  constexpr double kSeconds = 20.0;
  for (int n = 0; n < static_cast<int>(kSeconds * 10e3); ++n) {
    axis.step(actuation, 100_us);
  }
  ThermalState winding{40.0, 40.0};
  ThermalState stage = winding;
  const InverterParameters& inverter = p.inverter;
  const double terminals = terminals_per_phase * squares_of_phases;
  const TwoBodyThermal of_motor(motor, 0.01);
  const TwoBodyThermal of_stage(inverter.thermal, 0.01);
  for (int n = 0; n < static_cast<int>(kSeconds * 100.0); ++n) {
    of_motor.advance(winding, resistance * squares_of_phases, 40.0);
    of_stage.advance(
        stage,
        inverter.on_resistance * terminals + inverter.switching_share * 24.0 * std::sqrt(terminals),
        40.0);
  }
  ASSERT_GT(winding.inner, 41.0);
  ASSERT_GT(stage.inner, 40.3);
  const PwmAxisObservation seen = axis.observe();
  EXPECT_NEAR(seen.winding_temperature - 40.0, winding.inner - 40.0, 0.01 * (winding.inner - 40.0));
  EXPECT_NEAR(seen.housing_temperature - 40.0, winding.outer - 40.0, 0.01 * (winding.outer - 40.0));
  EXPECT_NEAR(seen.driver_temperature - 40.0, stage.inner - 40.0, 0.01 * (stage.inner - 40.0));
  EXPECT_NEAR(seen.board_temperature - 40.0, stage.outer - 40.0, 0.01 * (stage.outer - 40.0));
  EXPECT_EQ(axis.sensing().winding_temperature, seen.winding_temperature);
  EXPECT_EQ(axis.sensing().driver_temperature, seen.driver_temperature);
}

TEST(PwmAxisHeat, WarmsWindingAndStageAsTheirLossesSay) {
  // Without a coefficient the power is constant: u^2 / R of the winding with its transistors.
  auto servo = *find_three_phase_motor("QBL4208-61-04-013");
  servo.resistance_coefficient = 0.0;
  double r = servo.resistance + 0.01;
  const double u = 24.0 * 0.05;
  double i = u * (2.0 / 3.0) / r;
  expect_heat(stiff(servo), {0.55, 0.5, 0.5}, 1.5 * i * i, 1.0, servo.resistance, servo.thermal);

  auto two_phase = *find_stepper_motor("QSH5718-55-30-098");
  two_phase.temperature_coefficient = 0.0;
  r = two_phase.resistance + 0.02;
  i = 2.0 * u / r;
  expect_heat(stiff(two_phase), {0.55, 0.45, 0.55, 0.45}, 2.0 * i * i, 2.0, two_phase.resistance,
              two_phase.thermal);

  DcMotorParameters brushed;
  brushed.resistance_coefficient = 0.0;
  r = brushed.resistance + 0.02;
  i = 2.0 * u / r;
  expect_heat(stiff(brushed), {0.55, 0.45}, i * i, 2.0, brushed.resistance, brushed.thermal);
}

TEST(PwmAxisHeat, AWarmMotorTakesLessCurrentAndItsMagnetsGiveLessTorque) {
  for (const PwmAxisParameters& p : {three_phase_axis(), stepper_axis(), dc_axis()}) {
    const auto current = [&p](double celsius) {
      PwmAxisParameters parameters = p;
      parameters.ambient_temperature = celsius;
      parameters.load.brake_torque = 100.0;
      PwmAxis axis(parameters);
      for (int n = 0; n < 2000; ++n) {
        PwmActuation actuation = commutated(axis, 0.5);
        actuation.brake_released = false;
        axis.step(actuation, kCommutationPeriod);
      }
      const PwmAxisObservation seen = axis.observe();
      return std::array{seen.quadrature_current, seen.electromagnetic_torque};
    };
    const auto [cold, torque] = current(25.0);
    const auto [hot, hot_torque] = current(75.0);
    // Less than in proportion to the winding alone, as transistors stay what they are.
    EXPECT_NEAR(hot / cold, 1.0 / (1.0 + 0.00393 * 50.0), 0.006);
    if (!std::holds_alternative<StepperMotorParameters>(p.motor)) {
      const double coefficient =
          std::holds_alternative<DcMotorParameters>(p.motor) ? -0.002 : -0.0011;
      EXPECT_NEAR((hot_torque / hot) / (torque / cold), 1.0 + coefficient * 50.0, 1e-3);
    }
  }
}

TEST(PwmAxisHeat, ConvertersDriftWithTheBoard) {
  PwmAxisParameters p = three_phase_axis();
  p.converter.currents[0].drift = 2.0;
  PwmAxis axis(p);
  axis.set_ambient_temperature(65.0);
  for (int n = 0; n < 100'000; ++n) {
    axis.step({}, 100_us);
  }
  const double board = axis.observe().board_temperature;
  EXPECT_GT(board, 27.0);
  EXPECT_NEAR(axis.sensing().converter.currents[0], 32'768.0 + 2.0 * (board - 25.0), 1.0);
}

TEST(PwmAxisObservation, TellsTorquesThatTheAccelerationConfirms) {
  for (PwmAxisParameters p : {three_phase_axis(), stepper_axis(), dc_axis()}) {
    p.load.inertia = 2e-5;
    p.load.constant_torque = -0.002;
    double inertia = p.load.inertia;
    double viscous = 0.0;
    double coulomb = 0.0;
    std::visit(
        [&](auto& motor) {
          motor.static_friction = motor.coulomb_friction;
          inertia += motor.rotor_inertia;
          viscous = motor.viscous_friction;
          coulomb = motor.coulomb_friction;
        },
        p.motor);
    PwmAxis axis(p);
    axis.set_external_torque(-0.003);
    run(axis, 0.02, 4.0);
    double impulse = 0.0;
    const PwmAxisObservation first = axis.observe();
    PwmAxisObservation seen = first;
    for (int n = 0; n < 1000; ++n) {
      const double before = seen.electromagnetic_torque + seen.cogging_torque;
      axis.step(commutated(axis, 8.0), 2_us);
      seen = axis.observe();
      const double after = seen.electromagnetic_torque + seen.cogging_torque;
      impulse +=
          2e-6 * (0.5 * (before + after) + seen.load_torque - viscous * seen.speed - coulomb);
      EXPECT_DOUBLE_EQ(seen.load_torque, -0.005);
    }
    EXPECT_GT(seen.speed, 1.05 * first.speed);
    EXPECT_NEAR(inertia * (seen.speed - first.speed), impulse, 2e-3 * impulse);
    EXPECT_NEAR(seen.shaft_angle, axis.revolutions() * base::kTwoPi, 1e-12);
  }
}

}  // namespace
}  // namespace stator::plant
