// What the pauses of the PWM engine take from the motor.

#include <variant>

#include <gtest/gtest.h>

#include "devices/tmc8670_stage_bench.hpp"

namespace stator::devices::tmc8670 {
namespace {

using control::foc::field;

constexpr std::int32_t kVoltageMode = 8;
constexpr std::int32_t kOpenLoopAngle = 2;

/// A PMSM on a stiff supply, without pauses.
StageBench bench_with(double dead_time_of_stage = 0.0) {
  plant::PwmAxisParameters axis = StageBench::stiff(StageBench::textbook_motor());
  axis.inverter.dead_time = dead_time_of_stage;
  const plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  return {axis, 3, motor.pole_pairs};
}
void set_pauses(StageBench& bench) {
  bench.set(field("PWM_BBM_H"), 20);
  bench.set(field("PWM_BBM_L"), 20);
}

/// A in D with `voltage_word` at a rotor that has come to rest along phase U.
double current_at_rest(StageBench& bench, std::int32_t voltage_word) {
  bench.set(field("PHI_E_SELECTION"), kOpenLoopAngle);
  bench.set(field("UD_EXT"), voltage_word);
  bench.set(field("MODE_MOTION"), kVoltageMode);
  bench.run(2.0);
  return bench.stage.plant().currents()[0];
}

/// V of the supply and share of a period of 200 ns: each terminal loses the supply and twice a
/// diode's drop for that share against its current; in U against V and W that is 4/3 of it.
double expected_loss(const plant::InverterParameters& inverter, double supply, double period) {
  return 4.0 / 3.0 * 200e-9 / period * (supply + 2.0 * inverter.diode_drop);
}

TEST(Tmc8670DeadTime, TakesItsShareOfThePeriodFromTheVoltage) {
  constexpr std::int32_t kWord = 3000;
  for (const std::int32_t maxcnt : {1999, 3999}) {
    StageBench with = bench_with();
    StageBench without = bench_with();
    for (StageBench* bench : {&with, &without}) {
      bench->set(field("PWM_MAXCNT"), maxcnt);
    }
    set_pauses(with);
    const double less = current_at_rest(without, kWord) - current_at_rest(with, kWord);
    const plant::PwmAxisParameters& axis = with.stage.plant().parameters();
    const auto& motor = std::get<plant::ThreePhaseMotorParameters>(axis.motor);
    const double resistance = motor.resistance + axis.inverter.on_resistance;
    const double loss = expected_loss(axis.inverter, StageBench::kSupply, (maxcnt + 1) * 1e-8);
    EXPECT_NEAR(less * resistance, loss, 0.03 * loss) << maxcnt;
  }
}

TEST(Tmc8670DeadTime, TheLongerOfChipAndStageCounts) {
  StageBench by_chip = bench_with();
  set_pauses(by_chip);
  const double current = current_at_rest(by_chip, 3000);
  StageBench by_stage = bench_with(200e-9);
  EXPECT_EQ(current_at_rest(by_stage, 3000), current);
  StageBench by_both = bench_with(100e-9);
  set_pauses(by_both);
  EXPECT_EQ(current_at_rest(by_both, 3000), current);
}

}  // namespace
}  // namespace stator::devices::tmc8670
