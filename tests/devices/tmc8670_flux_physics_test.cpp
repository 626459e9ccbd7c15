// Flux under load, at the limit of the voltage and beyond it, and where the energy of a motion
// goes: the FOC block on the plant at PWM rate, set through registers, against equations.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "devices/tmc8670_linear_drive.hpp"
#include "devices/tmc8670_stage_bench.hpp"

namespace stator::devices::tmc8670 {
namespace {

constexpr double kTolerance = 0.03;
constexpr int kTorqueMode = 1;
constexpr int kVelocityMode = 2;
constexpr double kCurrentLoop = 0.2;

StageBench drive(const plant::PwmAxisParameters& parameters,
                 const plant::ThreePhaseMotorParameters& motor) {
  StageBench bench(parameters, 3, motor.pole_pairs);
  bench.tune_currents(kCurrentLoop, motor.resistance, motor.quadrature_inductance);
  return bench;
}

TEST(FluxRegulation, KeepsItsTargetUnderLoadAndLeavesTheTorqueAlone) {
  const plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  for (const int flux : {-1500, 0, 1500}) {
    plant::PwmAxisParameters parameters = StageBench::stiff(motor);
    parameters.load.inertia = 1e-4;
    StageBench bench = drive(parameters, motor);
    bench.tune_outer(8000, 30, 0);
    bench.set(field("PID_FLUX_TARGET"), flux);
    bench.set(field("PID_VELOCITY_TARGET"), 1500);
    bench.set(field("MODE_MOTION"), kVelocityMode);
    bench.run(0.4);
    bench.stage.plant().set_external_torque(-0.06);
    bench.run(0.4);
    double direct = 0.0;
    double quadrature = 0.0;
    double speed = 0.0;
    constexpr int kPeriods = 5000;
    for (int k = 0; k < kPeriods; ++k) {
      bench.stage.step();
      const plant::PwmAxisObservation seen = bench.seen();
      direct += seen.direct_current / kPeriods;
      quadrature += seen.quadrature_current / kPeriods;
      speed += seen.speed / kPeriods;
    }
    EXPECT_NEAR(speed, 1500.0 * M_PI / 30.0, 0.5);
    const double expected = (0.06 + motor.viscous_friction * speed) / motor.torque_constant();
    EXPECT_NEAR(quadrature, expected, kTolerance * expected) << flux;
    // A shaft that turns while currents are computed: sampled and applied at one angle each, the
    // average of the period lies 0 A beside.
    EXPECT_NEAR(direct, flux * 1e-3, kTolerance * motor.rated_current) << flux;
    EXPECT_NEAR(bench.get(field("PID_FLUX_ACTUAL")), flux, 15);
  }
}

TEST(FluxRegulation, AStepOfTorqueOnATurningShaftDisturbsItAsTheCoupledEquationsSay) {
  const plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  constexpr double kInertia = 2e-4;
  constexpr double kStep = 2.0;  // A
  plant::PwmAxisParameters parameters = StageBench::stiff(motor);
  parameters.load.inertia = kInertia;
  StageBench bench = drive(parameters, motor);
  LinearDrive linear(
      motor, kInertia, StageBench::kPeriod,
      bench.tune_currents(kCurrentLoop, motor.resistance, motor.quadrature_inductance));
  bench.set(field("MODE_MOTION"), kTorqueMode);
  const auto both = [&](double target, int periods, auto each) {
    bench.set(field("PID_TORQUE_TARGET"), std::lround(1000.0 * target));
    linear.quadrature_target = target;
    for (int k = 0; k < periods; ++k) {
      bench.stage.step();
      linear.step();
      each();
    }
  };
  both(2.5, 15'000, [] {});
  both(0.0, 1000, [] {});
  const double at = bench.seen().speed;
  ASSERT_GT(at, 80.0);
  ASSERT_NEAR(at, linear.speed(), 0.01 * at);
  double deepest = 0.0;
  double expected = 0.0;
  double largest_difference = 0.0;
  both(kStep, 400, [&] {
    deepest = std::max(deepest, std::fabs(bench.seen().direct_current));
    expected = std::max(expected, std::fabs(linear.direct()));
    largest_difference = std::max(largest_difference,
                                  std::fabs(bench.seen().quadrature_current - linear.quadrature()));
  });
  EXPECT_GT(expected, 0.03);
  EXPECT_NEAR(deepest, expected, kTolerance * expected + 0.003);
  EXPECT_LT(largest_difference, kTolerance * kStep);
}

/// Speed, rad/s, at which a motor with the direct current `direct` (A) and the load `torque` (N m,
/// friction besides) uses the voltage `limit` (V) up:
///   (R id - w Lq iq)^2 + (R iq + w (Ld id + psi))^2 = U^2
double speed_on_ellipse(const plant::ThreePhaseMotorParameters& motor, double limit, double direct,
                        double torque) {
  const auto used = [&](double speed) {
    const double w = motor.pole_pairs * speed;
    const double quadrature = (torque + motor.viscous_friction * speed) / motor.torque_constant();
    return std::hypot(motor.resistance * direct - w * motor.quadrature_inductance * quadrature,
                      motor.resistance * quadrature +
                          w * (motor.direct_inductance * direct + motor.flux_linkage));
  };
  double low = 0.0;
  double high = 5000.0;
  for (int n = 0; n < 60; ++n) {
    const double middle = 0.5 * (low + high);
    (used(middle) < limit ? low : high) = middle;
  }
  return low;
}

struct AtTheLimit {
  double speed = 0.0;
  double direct = 0.0;
  double quadrature = 0.0;
  double voltage = 0.0;  ///< V
  bool limited = false;  ///< a flag of the limiter
};

/// As fast as it gets with a torque target that the voltage does not allow.
AtTheLimit as_fast_as_it_gets(std::int32_t limit, double direct, double torque) {
  plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  motor.viscous_friction = 2e-5;
  plant::PwmAxisParameters parameters = StageBench::stiff(motor);
  StageBench bench = drive(parameters, motor);
  bench.set(field("PIDOUT_UQ_UD_LIMITS"), limit);
  bench.set(field("PID_FLUX_TARGET"), std::lround(1000.0 * direct));
  bench.set(field("PID_TORQUE_TARGET"), 4000);
  bench.stage.plant().set_external_torque(-torque);
  bench.set(field("MODE_MOTION"), kTorqueMode);
  bench.run(1.5);
  AtTheLimit result;
  constexpr int kPeriods = 5000;
  for (int k = 0; k < kPeriods; ++k) {
    bench.stage.step();
    const plant::PwmAxisObservation seen = bench.seen();
    result.speed += seen.speed / kPeriods;
    result.direct += seen.direct_current / kPeriods;
    result.quadrature += seen.quadrature_current / kPeriods;
    result.voltage +=
        std::hypot(bench.get(field("FOC_UD_LIMITED")), bench.get(field("FOC_UQ_LIMITED"))) *
        StageBench::voltage_unit(3) / kPeriods;
  }
  result.limited = bench.get(field("IPARK_CIRLIM_LIMIT_U_Q")) != 0;
  return result;
}

TEST(VoltageLimit, FluxHasPriorityAndTheSpeedIsThatOfTheVoltageCircle) {
  plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  motor.viscous_friction = 2e-5;
  for (const std::int32_t limit : {16000, 23169, 32767}) {
    for (const double torque : {0.005, 0.05}) {
      const AtTheLimit found = as_fast_as_it_gets(limit, 0.0, torque);
      const double volts = limit * StageBench::voltage_unit(3);
      const double expected = speed_on_ellipse(motor, volts, 0.0, torque);
      EXPECT_NEAR(found.speed, expected, kTolerance * expected) << limit << ' ' << torque;
      EXPECT_NEAR(found.voltage, volts, 0.001 * volts);
      EXPECT_TRUE(found.limited);
      EXPECT_NEAR(found.direct, 0.0, kTolerance * motor.rated_current);
      const double quadrature =
          (torque + motor.viscous_friction * expected) / motor.torque_constant();
      EXPECT_NEAR(found.quadrature, quadrature, kTolerance * quadrature + 0.01);
    }
  }
}

TEST(NegativeFluxTarget, ReachesTheSpeedOfTheVoltageEllipse) {
  plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  motor.viscous_friction = 2e-5;
  constexpr std::int32_t kLimit = 23169;
  const double volts = kLimit * StageBench::voltage_unit(3);
  const double without = speed_on_ellipse(motor, volts, 0.0, 0.01);
  for (const double direct : {-1.0, -2.0, -3.0, -4.0}) {
    const AtTheLimit found = as_fast_as_it_gets(kLimit, direct, 0.01);
    const double expected = speed_on_ellipse(motor, volts, direct, 0.01);
    ASSERT_GT(expected, (1.0 - 0.05 * direct) * without);
    EXPECT_NEAR(found.speed, expected, kTolerance * expected) << direct;
    EXPECT_NEAR(found.direct, direct, -kTolerance * direct) << direct;
    EXPECT_NEAR(found.voltage, volts, 0.001 * volts) << direct;
  }
}

class EnergyOfAMotion : public testing::TestWithParam<plant::InverterModel> {};
INSTANTIATE_TEST_SUITE_P(Inverter, EnergyOfAMotion,
                         testing::Values(plant::InverterModel::averaged,
                                         plant::InverterModel::switched),
                         [](const auto& tested) {
                           return tested.param == plant::InverterModel::switched ? "Switched"
                                                                                 : "Averaged";
                         });

TEST_P(EnergyOfAMotion, IsInCopperLoadFrictionAndWhatMoves) {
  plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  motor.coulomb_friction = motor.static_friction = 3e-3;
  plant::PwmAxisParameters parameters = StageBench::stiff(motor);
  parameters.inverter_model = GetParam();
  parameters.inverter.on_resistance = 0.02;
  parameters.supply = {.capacitance = 2e-3, .source_resistance = 0.05};
  parameters.load.inertia = 1e-4;
  StageBench bench = drive(parameters, motor);
  bench.tune_outer(6000, 20, 0);
  bench.set(field("PID_TORQUE_FLUX_LIMITS"), 6000);
  bench.set(field("MODE_MOTION"), kVelocityMode);
  const double inertia = motor.rotor_inertia + parameters.load.inertia;
  const double resistance = motor.resistance + parameters.inverter.on_resistance;
  double copper = 0.0;
  double friction = 0.0;
  double load = 0.0;
  double moved = 0.0;
  double returned = 0.0;
  double torque = 0.0;
  plant::PwmAxisObservation before = bench.seen();
  const double supplied_before = before.supplied_energy;
  const auto squares = [](double a, double b) { return (a * a + a * b + b * b) / 3.0; };
  const auto motion = [&](std::int32_t rpm, double outside, double seconds) {
    bench.set(field("PID_VELOCITY_TARGET"), rpm);
    bench.stage.plant().set_external_torque(outside);
    torque = outside;
    for (std::int64_t k = std::llround(seconds / StageBench::kPeriod); k > 0; --k) {
      bench.stage.step();
      const plant::PwmAxisObservation after = bench.seen();
      const double h = StageBench::kPeriod;
      copper += 1.5 * resistance * h *
                (squares(before.direct_current, after.direct_current) +
                 squares(before.quadrature_current, after.quadrature_current));
      const double way = after.shaft_angle - before.shaft_angle;
      friction += motor.viscous_friction * h * squares(before.speed, after.speed) +
                  motor.coulomb_friction * std::fabs(way);
      load -= torque * way;
      const double taken = after.supplied_energy - before.supplied_energy;
      moved += std::fabs(taken);
      returned -= std::min(taken, 0.0);
      before = after;
    }
  };
  motion(2000, 0.0, 0.4);     // acceleration
  motion(2000, -0.05, 0.3);   // load
  motion(-1500, 0.0, 0.5);    // braking, reversal
  motion(-1500, -0.06, 0.3);  // a load that drives the motor
  motion(0, 0.0, 0.3);
  const double stored = 0.75 * motor.direct_inductance *
                            (before.direct_current * before.direct_current +
                             before.quadrature_current * before.quadrature_current) +
                        0.5 * inertia * before.speed * before.speed;
  const double supplied = before.supplied_energy - supplied_before;
  EXPECT_LT(std::fabs(supplied - copper - friction - load - stored), 1e-3 * moved);
  // Nothing of it is idle.
  EXPECT_GT(copper, 0.05 * moved);
  EXPECT_GT(friction, 0.02 * moved);
  EXPECT_GT(std::fabs(load), 0.01 * moved);
  EXPECT_GT(returned, 0.05 * moved);
}

}  // namespace
}  // namespace stator::devices::tmc8670
