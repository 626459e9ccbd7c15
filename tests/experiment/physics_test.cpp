// What a motor with its load does on the bench, against the closed formulas: 2 % for each of two
// motors at two supplies. The cases run through the same code as `stator simulate`.

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/experiment/equations.hpp"
#include "stator/experiment/experiment.hpp"

namespace stator::experiment {
namespace {

constexpr double kTolerance = 0.02;

struct Bench {
  const char* motor;
  double supply;  ///< V
};

void PrintTo(const Bench& bench, std::ostream* out) {
  *out << bench.motor << " at " << bench.supply << " V";
}

class Physics : public testing::TestWithParam<Bench> {
 public:
  [[nodiscard]] static BenchSetup setup() {
    BenchSetup setup;
    setup.axis.motor = *plant::find_stepper_motor(GetParam().motor);
    setup.axis.supply_voltage = GetParam().supply;
    setup.module = devices::products().find("tmcm-3315");
    return setup;
  }
  /// Every judged quantity lies within the tolerance, and at least `quantities` are judged.
  static Result expect_as_equations(const std::string& name, const BenchSetup& setup,
                                    int quantities, const Choices& choices = {}) {
    Result result = require_experiment(name).run(setup, choices);
    int judged = 0;
    for (const Comparison& comparison : result.comparisons) {
      if (comparison.judged) {
        ++judged;
        EXPECT_LE(std::fabs(comparison.deviation()), kTolerance)
            << comparison.quantity << ": " << comparison.measured << ", equation "
            << comparison.equation << " " << comparison.unit;
      }
    }
    EXPECT_GE(judged, quantities);
    return result;
  }
};

TEST_P(Physics, FreeAccelerationIsTorqueOverInertia) {
  expect_as_equations("free-acceleration", setup(), 5);
}

TEST_P(Physics, CoastDownIsThatOfDryAndViscousFriction) {
  BenchSetup loaded = setup();
  loaded.axis.load.coulomb_friction = 0.02;
  loaded.axis.load.viscous_friction = 1e-3;
  loaded.axis.load.inertia = 2e-4;
  expect_as_equations("coast-down", loaded, 4);
}

TEST_P(Physics, PullOutTorqueFollowsTheCurrentBelowAndTheSquareWaveAboveTheCorner) {
  const Result result = expect_as_equations("pull-out", setup(), 5, {{"points", 9}});
  const Equations equations(setup().axis);
  const double current = equations.rated_current();
  const Panel& panel = result.panels.front();
  int between = 0;
  for (std::size_t n = 0; n < panel.x.size(); ++n) {
    const double speed = panel.x[n] * base::kTwoPi;
    const double torque = panel.curves.front().values[n];
    if (std::isnan(torque) || speed < equations.corner_speed(current)) {
      continue;
    }
    ++between;
    EXPECT_LT(torque, 1.01 * std::min(equations.regulated_pull_out(current),
                                      equations.saturated_pull_out(speed)))
        << panel.x[n] << " rev/s";
    EXPECT_GT(torque, 0.99 * std::min(equations.regulated_pull_out(current),
                                      equations.voltage_pull_out(speed, GetParam().supply)))
        << panel.x[n] << " rev/s";
  }
  EXPECT_GE(between, 4);
}

TEST_P(Physics, TheRotorSwingsAndSettlesAsTheLinearEquationOfMotionSays) {
  expect_as_equations("resonance", setup(), 3);
}

TEST_P(Physics, LoadInertiaAndFrictionSlowAndDampTheSwing) {
  BenchSetup loaded = setup();
  loaded.axis.load.inertia = 1e-4;
  loaded.axis.load.viscous_friction = 5e-3;
  expect_as_equations("resonance", loaded, 3);
}

TEST_P(Physics, StallGuardFallsInAStraightLineToZeroAtPullOut) {
  const Result result = expect_as_equations("stall-guard", setup(), 8, {{"points", 8}});
  EXPECT_GT(result.comparisons.front().measured, 200.0);
  EXPECT_LT(result.comparisons.back().measured, 0.1 * result.comparisons.front().measured);
}

TEST_P(Physics, RunBoostAndStandbyCurrentAreThoseOfTheSettings) {
  expect_as_equations("standby", setup(), 10);
}

TEST_P(Physics, AMoveTakesTheTimeOfItsTrapezoidAndTheLoadAngleOfItsTorque) {
  BenchSetup loaded = setup();
  loaded.axis.load.inertia = 1e-4;
  loaded.axis.load.viscous_friction = 2e-3;
  loaded.axis.load.coulomb_friction = 0.05;
  expect_as_equations("move", loaded, 5);
}

/// The same for three-phase motors.
class ServoPhysics : public testing::TestWithParam<Bench> {
 protected:
  [[nodiscard]] static BenchSetup setup() {
    BenchSetup setup;
    setup.servo.motor = *plant::find_three_phase_motor(GetParam().motor);
    setup.servo.supply_voltage = GetParam().supply;
    return setup;
  }
  static Result expect_as_equations(const std::string& name, const BenchSetup& setup,
                                    int quantities, const Choices& choices = {}) {
    return Physics::expect_as_equations(name, setup, quantities, choices);
  }
};

TEST_P(ServoPhysics, EmfIsThatOfTheFluxAndFrictionAloneSlowsTheShaft) {
  BenchSetup loaded = setup();
  loaded.servo.load.coulomb_friction = 0.01;
  loaded.servo.load.viscous_friction = 1e-5;
  loaded.servo.load.inertia = 1e-4;
  expect_as_equations("back-emf", loaded, 8);
}

TEST_P(ServoPhysics, TorqueEfficiencyAndNoLoadSpeedFollowFromVoltage) {
  expect_as_equations("torque-speed", setup(), 15, {{"points", 9}});
}

TEST_P(ServoPhysics, TorqueOfASalientMotorFollowsFromBothCurrents) {
  BenchSetup salient = setup();
  salient.servo.motor.quadrature_inductance *= 1.5;
  expect_as_equations("torque-speed", salient, 15, {{"points", 9}});
}

TEST_P(ServoPhysics, CurrentLoopAnswersAStepAsTheLinearModel) {
  expect_as_equations("current-step", setup(), 8);
}

TEST_P(ServoPhysics, VelocityLoopAnswersAStepAsTheLinearModel) {
  expect_as_equations("velocity-step", setup(), 8);
  BenchSetup loaded = setup();
  loaded.servo.load.inertia = loaded.servo.motor.rotor_inertia;
  expect_as_equations("velocity-step", loaded, 8);
}

TEST_P(ServoPhysics, PositionLoopAnswersAStepAsTheLinearModel) {
  expect_as_equations("position-step", setup(), 8);
}

TEST_P(ServoPhysics, BrakingRaisesTheSupplyUntilTheChopperHoldsIt) {
  BenchSetup loaded = setup();
  loaded.servo.load.inertia = 1e-5;
  const Result result = expect_as_equations("regeneration", loaded, 6);
  EXPECT_GT(result.panels.front().curves.front().values.back(), 1.3 * GetParam().supply);
}

INSTANTIATE_TEST_SUITE_P(
    TwoMotorsTwoSupplies, ServoPhysics,
    testing::Values(Bench{"QBL4208-61-04-013", 24.0}, Bench{"QBL4208-61-04-013", 36.0},
                    Bench{"EC45-flat-70W", 24.0}, Bench{"EC45-flat-70W", 36.0}),
    [](const testing::TestParamInfo<Bench>& bench) {
      std::string name = bench.param.motor;
      std::erase(name, '-');
      return name + "At" + std::to_string(static_cast<int>(bench.param.supply)) + "V";
    });

TEST(ServoExperiments, SayWhatCannotBeMeasuredAndWhatToChange) {
  const auto refusal = [](const char* name, const Choices& choices) -> std::string {
    try {
      static_cast<void>(require_experiment(name).run({}, choices));
    } catch (const ExperimentError& error) {
      return error.what();
    }
    return "measured";
  };
  EXPECT_NE(refusal("back-emf", {{"initial-speed", 20'000.0}}).find("lower --initial-speed"),
            std::string::npos);
  EXPECT_NE(refusal("torque-speed", {{"voltage", 20.0}}).find("lower --voltage"),
            std::string::npos);
  EXPECT_NE(refusal("current-step", {{"step", 60.0}}).find("lower --step"), std::string::npos);
  EXPECT_NE(refusal("regeneration", {{"current", 80.0}}).find("smaller --current"),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    TwoMotorsTwoSupplies, Physics,
    testing::Values(Bench{"QSH5718-41-30-047", 24.0}, Bench{"QSH5718-41-30-047", 48.0},
                    Bench{"QSH5718-55-30-098", 24.0}, Bench{"QSH5718-55-30-098", 48.0}),
    [](const testing::TestParamInfo<Bench>& bench) {
      std::string name = bench.param.motor;
      std::erase(name, '-');
      return name + "At" + std::to_string(static_cast<int>(bench.param.supply)) + "V";
    });

}  // namespace
}  // namespace stator::experiment
