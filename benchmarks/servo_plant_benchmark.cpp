// Time of a servo axis step of 50 us at several voltages and loads, against a limit of 40 ns.
#include <array>

#include <benchmark/benchmark.h>

#include "stator/plant/axes/servo_axis.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;

constexpr base::SimDuration kStep = 50_us;
constexpr double kLimit = 40e-9;  // s per step

/// Duties that put `voltage` on the q axis: what an ideal commutator would do.
std::array<double, 3> commutated(const plant::ServoAxis& axis, double voltage) {
  const base::SineCosine& direction = axis.state().motor.direction;
  const std::array<double, 3> phase =
      plant::phase_values({-voltage * direction.sine, voltage * direction.cosine});
  const double scale = 1.0 / axis.sensing().supply_voltage;
  return {0.5 + phase[0] * scale, 0.5 + phase[1] * scale, 0.5 + phase[2] * scale};
}

void run(benchmark::State& bench, const plant::ServoAxisParameters& parameters) {
  plant::ServoAxis axis(parameters);
  base::ServoActuation actuation{.bridge_enabled = true};
  const auto voltage = static_cast<double>(bench.range(0));
  for (int n = 0; n < 20'000; ++n) {
    actuation.duty = commutated(axis, voltage);
    axis.step(actuation, kStep);
  }
  for (auto _ : bench) {
    actuation.duty = commutated(axis, voltage);
    benchmark::DoNotOptimize(axis.step(actuation, kStep));
  }
  using benchmark::Counter;
  bench.counters["rpm"] = axis.state().motor.speed * 9.5493;
  bench.counters["of_limit"] = Counter(static_cast<double>(bench.iterations()) * kLimit,
                                       Counter::kIsRate | Counter::kInvert);
}

/// One step of 50 us of inverter, supply with capacitor, motor with cogging, Hall sensors and
/// encoder, turning at `range` volts. Limit: 40 ns.
void ServoAxis_Step(benchmark::State& bench) {
  plant::ServoAxisParameters parameters;
  parameters.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  run(bench, parameters);
}
BENCHMARK(ServoAxis_Step)->Arg(2)->Arg(10);

/// The same with dead time and noise in the measured currents.
void ServoAxis_StepWithImperfectElectronics(benchmark::State& bench) {
  plant::ServoAxisParameters parameters;
  parameters.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  parameters.inverter.dead_time = 100e-9;
  parameters.current_sensing.noise = 0.01;
  parameters.current_sensing.resolution = 0.01;
  run(bench, parameters);
}
BENCHMARK(ServoAxis_StepWithImperfectElectronics)->Arg(10);

/// The same with a trapezoidal EMF.
void ServoAxis_StepTrapezoidal(benchmark::State& bench) {
  plant::ServoAxisParameters parameters;
  parameters.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  parameters.motor.back_emf.trapezoidal_share = 1.0;
  run(bench, parameters);
}
BENCHMARK(ServoAxis_StepTrapezoidal)->Arg(10);

/// A shaft that stands with its bridge switched off.
void ServoAxis_Settled(benchmark::State& bench) {
  plant::ServoAxis axis({});
  for (auto _ : bench) {
    benchmark::DoNotOptimize(axis.step({}, kStep));
  }
}
BENCHMARK(ServoAxis_Settled);

}  // namespace
