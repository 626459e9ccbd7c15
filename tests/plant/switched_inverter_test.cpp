// An inverter from edge to edge: dead time, capacitor, and the quick solution of whole periods.
#include "stator/plant/power/switched_inverter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "stator/plant/power/switched_turn.hpp"

namespace stator::plant {
namespace {

constexpr double kPeriod = 20e-6;

/// An edge as the inverter made it.
struct Stretch {
  double duration;
  std::array<double, 3> voltage;
};

/// Three windings with a current that does not change, which note what they get.
class ConstantCurrents {
 public:
  static constexpr std::size_t kBridges = 3;
  using Values = std::array<double, 3>;
  Values current{};
  std::vector<Stretch> stretches;

  [[nodiscard]] Values currents() const { return current; }
  [[nodiscard]] static Values slopes(const Values&) { return {}; }
  double pass(const Values& voltage, const ShaftInput&, double h) {
    stretches.push_back({h, voltage});
    double power = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      power += voltage[k] * current[k];
    }
    return power * h;
  }
  /// Mean voltage of terminal `k`.
  [[nodiscard]] double mean(std::size_t k) const {
    double sum = 0.0;
    for (const Stretch& stretch : stretches) {
      sum += stretch.voltage[k] * stretch.duration;
    }
    return sum / kPeriod;
  }
};

struct Bench {
  InverterParameters inverter{.on_resistance = 0.0, .pwm_frequency = 1.0 / kPeriod};
  Supply supply{SupplyParameters{}};
  SupplyState state;
  ConstantCurrents winding;

  double pass(const std::array<double, 3>& duty) {
    return switch_period(winding, inverter, supply, state, duty, {}, false, kPeriod);
  }
};

TEST(SwitchedInverter, MakesSevenStretchesCentredInThePeriod) {
  Bench bench;
  bench.pass({0.7, 0.5, 0.2});
  const std::array<double, 7> expected{3e-6, 2e-6, 3e-6, 4e-6, 3e-6, 2e-6, 3e-6};
  ASSERT_EQ(bench.winding.stretches.size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) {
    EXPECT_NEAR(bench.winding.stretches[n].duration, expected[n], 1e-15) << n;
  }
  EXPECT_EQ(bench.winding.stretches[0].voltage, (std::array{0.0, 0.0, 0.0}));
  EXPECT_EQ(bench.winding.stretches[2].voltage, (std::array{24.0, 24.0, 0.0}));
  EXPECT_EQ(bench.winding.stretches[3].voltage, (std::array{24.0, 24.0, 24.0}));
}

TEST(SwitchedInverter, WithoutDeadTimeGivesTheVoltagesOfTheDuties) {
  Bench bench;
  bench.winding.current = {3.0, -1.0, -2.0};
  bench.pass({0.71, 0.0, 1.0});
  EXPECT_NEAR(bench.winding.mean(0), 0.71 * 24.0, 1e-12);
  EXPECT_EQ(bench.winding.mean(1), 0.0);
  EXPECT_NEAR(bench.winding.mean(2), 24.0, 1e-12);
}

TEST(SwitchedInverter, DeadTimeTakesVoltageFromCurrentsIntoTheMotorAndAddsItToOthers) {
  Bench bench;
  bench.inverter.dead_time = 400e-9;
  bench.winding.current = {3.0, -3.0, 0.5};
  const double energy = bench.pass({0.5, 0.5, 0.8});
  // Vb td / T, and a diode's drop during both dead times.
  const double drop = 24.0 * 0.02 + 0.7 * 2.0 * 0.02;
  EXPECT_NEAR(bench.winding.mean(0), 12.0 - drop, 1e-9);
  EXPECT_NEAR(bench.winding.mean(1), 12.0 + drop, 1e-9);
  EXPECT_NEAR(bench.winding.mean(2), 0.8 * 24.0 - drop, 1e-9);
  // The supply gives what the terminals take and the diodes lose.
  const double terminals =
      3.0 * (bench.winding.mean(0) - bench.winding.mean(1)) + 0.5 * bench.winding.mean(2);
  const double diodes = 0.7 * 0.02 * 2.0 * (3.0 + 3.0 + 0.5);
  EXPECT_NEAR(energy / kPeriod, terminals + diodes, 1e-9);
}

TEST(SwitchedInverter, APulseShorterThanTheDeadTimeVanishes) {
  Bench bench;
  bench.inverter.dead_time = 400e-9;
  bench.winding.current = {3.0, -3.0, 0.0};
  bench.pass({0.01, 0.5, 0.5});
  EXPECT_EQ(bench.winding.mean(0), 0.0);
}

TEST(SwitchedInverter, TheCapacitorGivesWhatTheBridgeTakes) {
  Bench bench;
  bench.supply = Supply({.capacitance = 100e-6});
  bench.state = {.source = 0.0, .voltage = 24.0};
  bench.winding.current = {4.0, -2.0, -2.0};
  double taken = 0.0;
  for (int n = 0; n < 25; ++n) {
    taken += bench.pass({0.7, 0.4, 0.3});
  }
  const double lost = 0.5 * 100e-6 * (24.0 * 24.0 - bench.state.voltage * bench.state.voltage);
  EXPECT_NEAR(taken, lost, 1e-9 * lost);
  EXPECT_LT(bench.state.voltage, 22.0);
  EXPECT_GT(bench.state.voltage, 10.0);
}

ThreePhaseMotorParameters plain_motor() {
  ThreePhaseMotorParameters motor = *find_three_phase_motor("QBL4208-61-04-013");
  motor.cogging = {};
  return motor;
}

std::array<double, 3> commutated(const ThreePhaseWinding& winding, double voltage) {
  const base::SineCosine z = winding.direction();
  const auto phases = phase_values({-voltage * z.sine, voltage * z.cosine});
  return {0.5 + phases[0] / 24.0, 0.5 + phases[1] / 24.0, 0.5 + phases[2] / 24.0};
}

TEST(SwitchedInverter, SampledCurrentsAreThoseOfTheAveragedInverter) {
  const InverterParameters inverter{.pwm_frequency = 1.0 / kPeriod};
  ThreePhaseWinding switched(plain_motor(), {}, inverter, 0.0);
  ThreePhaseWinding averaged(plain_motor(), {}, inverter, 0.0);
  Supply supply(SupplyParameters{});
  SupplyState state;
  double worst = 0.0;
  for (int n = 0; n < 10'000; ++n) {
    const auto duty = commutated(averaged, 8.0);
    switch_period(switched, inverter, supply, state, duty, {}, false, kPeriod);
    average_period(averaged, nullptr, supply, state, duty, {}, false, kPeriod);
    worst = std::max(worst, std::fabs(switched.currents()[0] - averaged.currents()[0]));
  }
  EXPECT_GT(switched.speed(), 200.0);
  // Of 0.1 A of ripple, in currents of up to 20 A, hardly any is seen at the sampling points.
  EXPECT_LT(worst, 0.02);
}

/// The largest difference of a current between the quick solution of whole periods and the one from
/// edge to edge, as a part of rated current.
double quick_solution_error(double capacitance, bool cogging) {
  const InverterParameters inverter{.pwm_frequency = 1.0 / kPeriod};
  ThreePhaseMotorParameters motor = plain_motor();
  if (cogging) {
    motor = *find_three_phase_motor("QBL4208-61-04-013");
  }
  ThreePhaseWinding exact(motor, {}, inverter, 0.0);
  ThreePhaseWinding quick(motor, {}, inverter, 0.0);
  exact.state().speed = 150.0;
  quick.state().speed = 150.0;
  Supply supply({.capacitance = capacitance, .source_resistance = 0.05});
  SupplyState exact_state;
  SupplyState quick_state;
  double worst = 0.0;
  for (int n = 0; n < 10'000; ++n) {
    const auto duty = commutated(exact, 6.0 - 4.0 * (n % 5'000) / 5'000.0);
    switch_period(exact, inverter, supply, exact_state, duty, {}, false, kPeriod);
    EXPECT_TRUE(
        turn_switched(quick, inverter, supply, quick_state, duty, {}, false, kPeriod).has_value());
    exact.refresh();
    quick.refresh();
    for (std::size_t k = 0; k < 3; ++k) {
      worst = std::max(worst, std::fabs(exact.currents()[k] - quick.currents()[k]));
    }
  }
  return worst / motor.rated_current;
}

TEST(SwitchedInverter, QuickSolutionOfAPeriodIsRightToSomeMillionthsOfRatedCurrent) {
  EXPECT_LT(quick_solution_error(0.0, false), 3e-6);
  EXPECT_LT(quick_solution_error(470e-6, false), 3e-6);
  EXPECT_LT(quick_solution_error(470e-6, true), 3e-4);
}

TEST(SwitchedInverter, QuickSolutionLeavesAloneWhatItCannotDo) {
  const InverterParameters inverter{.pwm_frequency = 1.0 / kPeriod};
  Supply supply(SupplyParameters{});
  SupplyState state;
  ThreePhaseWinding standing(plain_motor(), {}, inverter, 0.0);
  EXPECT_FALSE(
      turn_switched(standing, inverter, supply, state, {0.6, 0.5, 0.5}, {}, false, kPeriod));
  ThreePhaseWinding reversing(plain_motor(), {}, inverter, 0.0);
  reversing.state().speed = 1e-3;
  const SynchronousMotorState before = reversing.state();
  EXPECT_FALSE(turn_switched(reversing, inverter, supply, state, {0.5, 0.5, 0.5}, {.torque = -0.1},
                             false, kPeriod));
  EXPECT_EQ(reversing.state(), before);
  ThreePhaseMotorParameters salient = plain_motor();
  salient.quadrature_inductance *= 2.0;
  ThreePhaseWinding other(salient, {}, inverter, 0.0);
  other.state().speed = 100.0;
  EXPECT_FALSE(turn_switched(other, inverter, supply, state, {0.5, 0.5, 0.5}, {}, false, kPeriod));
}

TEST(SwitchedInverter, QuickSolutionTakesTheEnergyThatTheMotorGets) {
  // Through dead time, against a load, speeding up and braking: what the bridge took is what the
  // slower way finds.
  InverterParameters inverter{.pwm_frequency = 1.0 / kPeriod, .dead_time = 300e-9};
  ThreePhaseWinding exact(plain_motor(), {}, inverter, 0.0);
  ThreePhaseWinding quick(plain_motor(), {}, inverter, 0.0);
  exact.state().speed = 200.0;
  quick.state().speed = 200.0;
  Supply supply({.capacitance = 470e-6, .source_resistance = 0.05});
  SupplyState exact_state;
  SupplyState quick_state;
  double taken = 0.0;
  double expected = 0.0;
  double moved = 0.0;
  for (int n = 0; n < 20'000; ++n) {
    const auto duty = commutated(exact, n % 8'000 < 4'000 ? 8.0 : 3.0);
    const ShaftInput shaft{.torque = -0.02};
    const double energy =
        switch_period(exact, inverter, supply, exact_state, duty, shaft, false, kPeriod);
    expected += energy;
    moved += std::fabs(energy);
    taken += *turn_switched(quick, inverter, supply, quick_state, duty, shaft, false, kPeriod);
    exact.refresh();
    quick.refresh();
  }
  EXPECT_NEAR(taken, expected, 1e-3 * moved);
  EXPECT_NEAR(quick.speed(), exact.speed(), 1e-3 * exact.speed());
}

TEST(SwitchedInverter, RippleOfAWindingHasTheSizeOfItsFormula) {
  DcMotorParameters motor;
  motor.resistance = 0.01;
  motor.static_friction = 100.0;
  motor.coulomb_friction = 100.0;
  const InverterParameters inverter{.on_resistance = 0.0, .pwm_frequency = 1.0 / kPeriod};
  /// Notes the range of the current between the edges.
  class Watched : public DcWinding {
   public:
    using DcWinding::DcWinding;
    double pass(const Values& voltage, const ShaftInput& shaft, double h) {
      const double energy = DcWinding::pass(voltage, shaft, h);
      lowest = std::min(lowest, currents()[0]);
      highest = std::max(highest, currents()[0]);
      return energy;
    }
    double lowest = 1e9;
    double highest = -1e9;
  };
  Watched winding(motor, {}, inverter, 0.0);
  Supply supply(SupplyParameters{});
  SupplyState state;
  // Against a duty of 0 the terminal voltage is that of one half bridge: di = Vb T d (1 - d) / L.
  const double mean = 0.3 * 24.0;
  winding.state().current = mean / motor.resistance;
  switch_period(winding, inverter, supply, state, {0.3, 0.0}, {}, false, kPeriod);
  const double expected = 24.0 * kPeriod * 0.3 * 0.7 / motor.inductance;
  EXPECT_NEAR(winding.highest - winding.lowest, expected, 1e-3 * expected);
}

}  // namespace
}  // namespace stator::plant
