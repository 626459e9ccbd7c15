// The formulas against numbers worked out by hand for a motor with round values.

#include "stator/experiment/equations.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace stator::experiment {
namespace {

/// Kt = 0.5 N m/A, R = 1 ohm, J = 1e-3 kg m^2, B = 0.01 N m s/rad, Tc = 0.1 N m, 24 V.
plant::StepperAxisParameters round_axis() {
  plant::StepperAxisParameters axis;
  axis.motor.pole_pairs = 50;
  axis.motor.resistance = 1.0;
  axis.motor.inductance = 2e-3;
  axis.motor.flux_linkage = 0.01;
  axis.motor.detent_torque = 0.05;
  axis.motor.rotor_inertia = 4e-4;
  axis.motor.viscous_friction = 4e-3;
  axis.motor.coulomb_friction = 0.04;
  axis.motor.static_friction = 0.05;
  axis.motor.stribeck_speed = 0.5;
  axis.motor.rated_current = 2.0;
  axis.load.inertia = 6e-4;
  axis.load.viscous_friction = 6e-3;
  axis.load.coulomb_friction = 0.06;
  axis.supply_voltage = 24.0;
  return axis;
}

TEST(Equations, AddLoadToMotor) {
  const Equations equations(round_axis());
  EXPECT_NEAR(equations.inertia(), 1e-3, 1e-12);
  EXPECT_NEAR(equations.viscous_friction(), 0.01, 1e-12);
  EXPECT_NEAR(equations.coulomb_friction(), 0.1, 1e-12);
  EXPECT_NEAR(equations.running_torque(10.0), 0.2, 1e-12);
  EXPECT_NEAR(equations.rated_current(), 2.0 * std::sqrt(2.0), 1e-12);
}

TEST(Equations, CornerSpeedIsWhereTheSupplyIsUsedUp) {
  // At 4 A: (4 + 0.5 w)^2 + (0.4 w)^2 = 576.
  const double corner = Equations(round_axis()).corner_speed(4.0);
  EXPECT_NEAR(std::pow(4.0 + 0.5 * corner, 2) + std::pow(0.4 * corner, 2), 576.0, 1e-9);
  EXPECT_GT(corner, 0.0);
  EXPECT_EQ(Equations(round_axis()).corner_speed(24.0), 0.0) << "resistance alone takes it";
}

TEST(Equations, PullOutTorqueOfAVoltage) {
  // w = 100 rad/s: Z = hypot(1, 10) = sqrt(101); Kt U / Z - Kt^2 w R / Z^2.
  const Equations equations(round_axis());
  EXPECT_NEAR(equations.impedance(100.0), std::sqrt(101.0), 1e-12);
  EXPECT_NEAR(equations.voltage_pull_out(100.0, 24.0), 12.0 / std::sqrt(101.0) - 25.0 / 101.0,
              1e-12);
  EXPECT_NEAR(equations.saturated_pull_out(100.0), equations.voltage_pull_out(100.0, 30.5577490736),
              1e-9);
}

TEST(Equations, SwingAroundAFullStep) {
  // Th + 4 Td = 1 + 0.2 at 2 A; w0 = sqrt(50 * 1.2 / 1e-3); B / 2J = 5 /s.
  const Equations equations(round_axis());
  EXPECT_NEAR(equations.natural_frequency(2.0), std::sqrt(60'000.0), 1e-9);
  EXPECT_NEAR(equations.decay_rate(), 5.0, 1e-12);
  EXPECT_NEAR(equations.logarithmic_decrement(2.0), 5.0 * base::kTwoPi / std::sqrt(60'000.0 - 25.0),
              1e-12);
  EXPECT_NEAR(equations.dry_deflection(2.0), 0.1 / 1.2, 1e-12);
}

TEST(Equations, AccelerationEndsAtTheSpeedAtWhichFrictionTakesAll) {
  // 1 N m at 2 A, 0.9 without dry friction: J/B = 0.1 s, final speed 90 rad/s.
  const Equations equations(round_axis());
  EXPECT_NEAR(equations.accelerated_speed(2.0, 0.1), 90.0 * (1.0 - std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(equations.acceleration_time(2.0, equations.accelerated_speed(2.0, 0.07)), 0.07,
              1e-12);
}

TEST(Equations, CoastDownEndsAtStandstill) {
  // Tc/B = 10 rad/s: from 90 rad/s it takes 0.1 s * ln(10).
  const Equations equations(round_axis());
  EXPECT_NEAR(equations.coasting_time(90.0), 0.1 * std::log(10.0), 1e-12);
  EXPECT_NEAR(equations.coasting_speed(90.0, 0.1), 100.0 * std::exp(-1.0) - 10.0, 1e-9);
  EXPECT_EQ(equations.coasting_speed(90.0, 1.0), 0.0);
}

TEST(Equations, StallGuardIsTheUnusedEmf) {
  // 10 rad/s: 5 V; half the pull-out torque leaves 2.5 V.
  const Equations equations(round_axis());
  EXPECT_NEAR(equations.stall_guard(10.0, 0.5, 2.0, 100.0), 250.0, 1e-9);
  EXPECT_EQ(equations.stall_guard(10.0, 2.0, 2.0, 100.0), 0.0);
  EXPECT_EQ(equations.stall_guard(1000.0, 0.0, 2.0, 100.0), 1023.0);
}

}  // namespace
}  // namespace stator::experiment
