#include <cstddef>
#include <string>

#include <benchmark/benchmark.h>

#include "base/instruction_set.hpp"
#include "control/current_loop_batch.hpp"
#include "plant/servo_batch.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using benchmark::Counter;

constexpr base::SimDuration kPeriod = 20_us;

/// A motor with cogging and dry friction on a supply with capacitor; quantised currents and angle.
plant::ServoAxisParameters drive() {
  plant::ServoAxisParameters parameters;
  parameters.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  parameters.load.viscous_friction = 1e-4;
  parameters.inverter.dead_time = 100e-9;
  parameters.inverter.pwm_frequency = 50e3;
  parameters.current_sensing.resolution = 1e-3;
  parameters.current_sensing.range = 32.0;
  parameters.encoder.counts_per_revolution = 4096;
  return parameters;
}

control::CurrentLoopSettings loop_of(const plant::ServoAxisParameters& parameters) {
  return control::current_loop_for(parameters.motor.resistance, parameters.motor.direct_inductance,
                                   0.2 / kPeriod.seconds(), kPeriod.seconds());
}

void count(benchmark::State& bench, double steps, double limit) {
  bench.counters["steps_per_s"] = Counter(steps, Counter::kIsRate);
  bench.counters["times_real_time"] = Counter(steps * kPeriod.seconds(), Counter::kIsRate);
  bench.counters["of_limit"] = Counter(steps / limit, Counter::kIsRate);
}

/// Complete drives side by side: sampling, current loop, inverter, supply, motor; turning with
/// different torques. `range(0)` axes with the instruction set `range(1)`.
template <typename Number>
void batch(benchmark::State& bench, double limit) {
  const auto axes = static_cast<std::size_t>(bench.range(0));
  const auto instructions = static_cast<base::InstructionSet>(bench.range(1));
  if (!base::supported(instructions)) {
    bench.SkipWithError("this processor has no such instructions");
    return;
  }
  const plant::ServoAxisParameters parameters = drive();
  plant::ServoBatch<Number> plants(parameters, axes, kPeriod, instructions);
  control::CurrentLoopBatch<Number> loops(loop_of(parameters), axes, instructions);
  for (std::size_t n = 0; n < axes; ++n) {
    const double torque = 0.02 + 0.04 * static_cast<double>(n) / static_cast<double>(axes);
    loops.set_target(n, 0.0, 1.0 + torque / parameters.motor.torque_constant());
    plants.set_external_torque(n, -torque);
  }
  const auto pass = [&] {
    loops.step(plants.signals());
    plants.step();
  };
  for (int n = 0; n < 10'000; ++n) {
    pass();
  }
  for (auto _ : bench) {
    pass();
  }
  bench.counters["rpm"] = plants.motor(0).speed * 9.5493;
  count(bench, static_cast<double>(bench.iterations()) * static_cast<double>(axes), limit);
}

void Batch_Double(benchmark::State& bench) {
  batch<double>(bench, 50e6);
}
BENCHMARK(Batch_Double)->ArgsProduct({{64, 250, 1024}, {3}})->ArgsProduct({{256}, {0, 1, 2}});

void Batch_Float(benchmark::State& bench) {
  batch<float>(bench, 110e6);
}
BENCHMARK(Batch_Float)->ArgsProduct({{64, 250, 1024}, {3}})->ArgsProduct({{256}, {0, 1, 2}});

}  // namespace
