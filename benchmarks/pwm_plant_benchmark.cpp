// Time of current loop and servo plant per PWM period of 20 us, for one axis and for batches.
#include <array>
#include <cstddef>
#include <cstdint>

#include <benchmark/benchmark.h>

#include "stator/base/instruction_set.hpp"
#include "stator/control/current_loop/current_loop_batch.hpp"
#include "stator/control/servo/current_controllers.hpp"
#include "stator/control/servo/space_vector.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/plant/batch/servo_batch.hpp"

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

/// A current loop of the control room's blocks on raw values of converter and encoder, as a chip or
/// a firmware would have it.
class CurrentLoop {
 public:
  CurrentLoop(double proportional, double integral) {
    controllers_.configure(static_cast<std::uint16_t>(256.0 * proportional),
                           static_cast<std::uint16_t>(65536.0 * integral));
    for (std::size_t n = 0; n < table_.size(); ++n) {
      table_[n] = base::sine_cosine((static_cast<double>(n) + 0.5) * base::kTwoPi / 1024.0);
    }
  }

  plant::PwmActuation step(const plant::PwmSensing& seen, double target) {
    const double u = seen.converter.currents[0] - 32'768.0;  // mA
    const double w = seen.converter.currents[1] - 32'768.0;
    const control::StatorVector current = control::clarke({u, -u - w, w});
    const base::SineCosine& angle = table_[static_cast<std::size_t>(seen.encoders[0].count & 1023)];
    const control::RotorVector rotor = control::park(current, angle);
    const control::Pair error{static_cast<double>(static_cast<std::int64_t>(-rotor.d)),
                              static_cast<double>(static_cast<std::int64_t>(target - rotor.q))};
    const control::Pair voltage = controllers_.step(error, 13.8e3 * 65'536.0);
    const auto duty = control::space_vector_duties(
        control::inverse_park({voltage[0], voltage[1]}, angle), 1.0 / (24e3 * 65'536.0));
    return {.bridge_enabled = true, .duty = {duty[0], duty[1], duty[2], 0.0}};
  }

 private:
  control::CurrentControllers controllers_;
  /// An electrical period has 1024 counts.
  std::array<base::SineCosine, 1024> table_{};
};

/// One drive by itself: raw values with noise, current loop, inverter with dead time, supply with
/// capacitor, motor with cogging and friction, halls and encoder.
void single(benchmark::State& bench, plant::InverterModel model, double dead_time, double limit) {
  const plant::ServoAxisParameters equal = drive();
  plant::PwmAxisParameters parameters;
  parameters.motor = equal.motor;
  parameters.load = equal.load;
  parameters.inverter = equal.inverter;
  parameters.inverter.dead_time = dead_time;
  parameters.inverter_model = model;
  parameters.converter.currents[0].noise = 5.0;
  parameters.converter.currents[1].noise = 5.0;
  plant::PwmAxis axis(parameters);
  CurrentLoop loop(0.6e-3 * 1e4, 0.36 * 1e4 * kPeriod.seconds());
  for (int n = 0; n < 20'000; ++n) {
    axis.step(loop.step(axis.sensing(), 1500.0), kPeriod);
  }
  for (auto _ : bench) {
    benchmark::DoNotOptimize(axis.step(loop.step(axis.sensing(), 1500.0), kPeriod));
  }
  bench.counters["rpm"] = axis.speed() * 9.5493;
  count(bench, static_cast<double>(bench.iterations()), limit);
}

void Single_Averaged(benchmark::State& bench) {
  single(bench, plant::InverterModel::averaged, 100e-9, 10e6);
}
BENCHMARK(Single_Averaged);

void Single_Switched(benchmark::State& bench) {
  single(bench, plant::InverterModel::switched, 100e-9, 4e6);
}
BENCHMARK(Single_Switched);

void Single_SwitchedWithoutDeadTime(benchmark::State& bench) {
  single(bench, plant::InverterModel::switched, 0.0, 4e6);
}
BENCHMARK(Single_SwitchedWithoutDeadTime);

}  // namespace
