#include <algorithm>
#include <array>

#include <benchmark/benchmark.h>

#include "base/trigonometry.hpp"
#include "plant/stepper_axis.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;

constexpr base::SimDuration kStep = 50_us;

plant::StepperAxisParameters axis_with_load() {
  plant::StepperAxisParameters parameters;
  parameters.motor = *plant::find_stepper_motor("QSH5718-55-30-098");
  parameters.load.inertia = 2e-5;
  parameters.load.coulomb_friction = 0.02;
  return parameters;
}

/// Current targets of one electrical period, as a sequencer has them in a table.
std::array<std::array<double, 2>, 4096> sequencer_table(double amplitude) {
  std::array<std::array<double, 2>, 4096> table{};
  for (std::size_t i = 0; i < table.size(); ++i) {
    const base::SineCosine direction =
        base::sine_cosine(base::kTwoPi * static_cast<double>(i) / 4096);
    table[i] = {amplitude * direction.cosine, amplitude * direction.sine};
  }
  return table;
}

/// One plant step of 50 us: chopper, motor, load, encoder, switches, sensors. The current vector
/// turns at `range` tenths of a revolution per second. Target: 150 ns, 0.3 % of a core.
void StepperAxis_Step(benchmark::State& bench) {
  plant::StepperAxis axis(axis_with_load());
  const auto table = sequencer_table(4.2);
  base::AxisActuation actuation;
  actuation.bridge_enabled = true;
  const double target =
      5.0 * static_cast<double>(bench.range(0)) * kStep.seconds();  // periods/step
  double advance = 0.0;
  double periods = 0.0;
  for (auto _ : bench) {
    advance = std::min(target, advance + 1e-6);
    periods += advance;
    periods = periods >= 1.0 ? periods - 1.0 : periods;
    actuation.coil_current_target = table[static_cast<std::size_t>(periods * 4096.0)];
    benchmark::DoNotOptimize(axis.step(actuation, kStep));
  }
  bench.counters["rev/s"] = axis.state().motor.speed / base::kTwoPi;
  bench.counters["real-time factor"] = benchmark::Counter(
      static_cast<double>(bench.iterations()) * kStep.seconds(), benchmark::Counter::kIsRate);
}
BENCHMARK(StepperAxis_Step)->Arg(0)->Arg(10)->Arg(50)->Arg(100);

/// The motor equations alone, voltages held, at 10 rad/s.
void HybridStepper_Step(benchmark::State& bench) {
  const plant::HybridStepper motor(axis_with_load().motor, axis_with_load().load);
  plant::HybridStepperState start;
  start.speed = 10.0;
  plant::HybridStepperInput input;
  input.voltage = {3.0, -2.0};
  plant::HybridStepperState state = start;
  int steps = 0;
  for (auto _ : bench) {
    if (++steps == 100) {  // before it comes to rest
      steps = 0;
      state = start;
    }
    motor.step(state, input, kStep.seconds());
    benchmark::DoNotOptimize(state);
  }
}
BENCHMARK(HybridStepper_Step);

}  // namespace
