// That each motor model neither loses nor creates energy under random voltages and loads.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "energy_ledger.hpp"
#include "stator/base/random.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/plant/power/switched_inverter.hpp"

namespace stator::plant {
namespace {

constexpr double kPeriod = 20e-6;

InverterParameters stage() {
  return {.on_resistance = 0.02, .pwm_frequency = 1.0 / kPeriod, .dead_time = 300e-9};
}

ThreePhaseMotorParameters three_phase() {
  ThreePhaseMotorParameters motor = *find_three_phase_motor("QBL4208-61-04-013");
  motor.cogging = {};
  motor.static_friction = motor.coulomb_friction;
  return motor;
}

ThreePhaseMotorParameters salient() {
  ThreePhaseMotorParameters motor = three_phase();
  motor.quadrature_inductance = 1.1e-3;
  return motor;
}

ThreePhaseMotorParameters trapezoidal() {
  ThreePhaseMotorParameters motor = three_phase();
  motor.back_emf.trapezoidal_share = 1.0;
  return motor;
}

StepperMotorParameters stepper() {
  StepperMotorParameters motor = *find_stepper_motor("QSH5718-55-30-098");
  motor.static_friction = motor.coulomb_friction;
  return motor;
}

DcMotorParameters dc() {
  DcMotorParameters motor;
  motor.static_friction = motor.coulomb_friction;
  return motor;
}

/// Duties for a voltage vector of the size `u` across and `v` along the magnets, of 24 V.
ThreePhaseWinding::Values duties(const ThreePhaseWinding& w, double u, double v) {
  const base::SineCosine z = w.direction();
  const auto phases = phase_values({v * z.cosine - u * z.sine, v * z.sine + u * z.cosine});
  return {0.5 + phases[0] / 24.0, 0.5 + phases[1] / 24.0, 0.5 + phases[2] / 24.0};
}
TwoPhaseWinding::Values duties(const TwoPhaseWinding& w, double u, double v) {
  const base::SineCosine z = w.direction();
  const double alpha = (v * z.cosine - u * z.sine) / 48.0;
  const double beta = (v * z.sine + u * z.cosine) / 48.0;
  return {0.5 + alpha, 0.5 - alpha, 0.5 + beta, 0.5 - beta};
}
DcWinding::Values duties(const DcWinding&, double u, double) {
  return {0.5 + u / 48.0, 0.5 - u / 48.0};
}

/// A second of random voltages and loads. What the terminals took less what is in heat, load, shaft
/// and field, as a share of all that went through the terminals.
template <typename Winding, typename Motor>
double unbalanced(const Motor& motor, InverterModel model, std::uint64_t seed) {
  MechanicalLoad load;
  load.inertia = motor.rotor_inertia;
  load.viscous_friction = 1e-4;
  Audited<Winding> winding(motor, load, stage(), 0.1);
  winding.viscous_friction = motor.viscous_friction + load.viscous_friction;
  winding.coulomb_friction = motor.coulomb_friction;
  Supply supply({.capacitance = 470e-6, .source_resistance = 0.05});
  SupplyState state;
  base::Random random(seed);
  const DeadTime dead_time(stage(), winding.inductance(), kPeriod);
  const double before = LedgerOf::stored(winding);
  double u = 0.0;
  double v = 0.0;
  ShaftInput shaft;
  for (int n = 0; n < 50'000; ++n) {
    if (n % 1000 == 0) {
      u = 20.0 * random.uniform() - 10.0;
      v = 4.0 * random.uniform() - 2.0;
      shaft.torque = 0.04 * random.uniform() - 0.02;
    }
    const auto duty = duties(winding, u, v);
    if (model == InverterModel::switched) {
      switch_period(winding, stage(), supply, state, duty, shaft, false, kPeriod);
    } else {
      average_period(winding, &dead_time, supply, state, duty, shaft, false, kPeriod);
    }
    winding.refresh();
  }
  const EnergyLedger& ledger = winding.ledger;
  const double rest = ledger.supplied - ledger.copper - ledger.friction - ledger.load -
                      (LedgerOf::stored(winding) - before);
  EXPECT_GT(ledger.copper, 0.01 * ledger.moved);
  EXPECT_GT(ledger.friction, 1e-3 * ledger.moved);
  return std::fabs(rest) / ledger.moved;
}

class EnergyBalance : public testing::TestWithParam<InverterModel> {};

TEST_P(EnergyBalance, OfAThreePhaseMotorClosesToATenthOfAPerMille) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    EXPECT_LT(unbalanced<ThreePhaseWinding>(three_phase(), GetParam(), seed), 1e-4);
  }
}

TEST_P(EnergyBalance, OfASalientMotorClosesToATenthOfAPerMille) {
  EXPECT_LT(unbalanced<ThreePhaseWinding>(salient(), GetParam(), 4), 1e-4);
}

TEST_P(EnergyBalance, OfABrushlessDcMotorWithTrapezoidalEmfClosesToAPerMille) {
  EXPECT_LT(unbalanced<ThreePhaseWinding>(trapezoidal(), GetParam(), 5), 1e-3);
}

TEST_P(EnergyBalance, OfAStepperMotorClosesToATenthOfAPerMille) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    EXPECT_LT(unbalanced<TwoPhaseWinding>(stepper(), GetParam(), seed), 1e-4);
  }
}

TEST_P(EnergyBalance, OfADcMotorClosesToATenthOfAPerMille) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    EXPECT_LT(unbalanced<DcWinding>(dc(), GetParam(), seed), 1e-4);
  }
}

INSTANTIATE_TEST_SUITE_P(Inverter, EnergyBalance,
                         testing::Values(InverterModel::averaged, InverterModel::switched),
                         [](const auto& tested) {
                           return tested.param == InverterModel::switched ? "Switched" : "Averaged";
                         });

}  // namespace
}  // namespace stator::plant
