// What a motor with its load does on the bench, against the closed formulas: 2 % for each of two
// motors at two supplies. The cases run through the same code as `stator simulate`.

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "experiment/equations.hpp"
#include "experiment/experiment.hpp"

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
 protected:
  [[nodiscard]] static BenchSetup setup() {
    BenchSetup setup;
    setup.axis.motor = *plant::find_stepper_motor(GetParam().motor);
    setup.axis.supply_voltage = GetParam().supply;
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
