// Time of a plant step of a stepper axis with its load, and of parts of such a step.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/base/trigonometry.hpp"
#include "stator/devices/tmcm_3315/axis_unit.hpp"
#include "stator/devices/tmcm_3315/objects.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

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

/// Up to three axes of a TMCM-3315 in closed loop, turning: firmware, driver and plant without a
/// bus.
class ClosedLoopAxes {
 public:
  explicit ClosedLoopAxes(int count) {
    devices::tmcm_3315::add_objects(dictionary_);
    for (std::uint8_t n = 0; n < count; ++n) {
      axes_.push_back(std::make_unique<devices::tmcm_3315::AxisUnit>(
          dictionary_, n, axis_with_load(), devices::tmcm_3315::AxisUnitConfiguration{},
          base::EventReporter()));
      start(n);
    }
    for (int k = 0; k < 500; ++k) {  // initialisation and acceleration
      pass_millisecond();
    }
    for (const auto& axis : axes_) {
      if (!axis->axis().closed_loop().active() || axis->plant().state().motor.speed < 50.0) {
        std::abort();
      }
    }
  }

  void pass_millisecond() {
    for (const auto& axis : axes_) {
      for (int step = 0; step < 20; ++step) {
        axis->step(kStep);
      }
    }
    tick();
  }
  void tick() {
    now_ += 1_ms;
    for (const auto& axis : axes_) {
      axis->tick(now_, 0);
    }
  }
  [[nodiscard]] devices::tmcm_3315::AxisUnit& axis(std::size_t n) { return *axes_[n]; }

 private:
  void start(std::uint8_t n) {
    const auto write = [&](unsigned index, std::uint8_t subindex, std::int64_t value) {
      const unsigned offset = n * (index < 0x6000 ? 0x200U : 0x800U);
      dictionary::Entry& entry =
          *dictionary_.find(static_cast<std::uint16_t>(index + offset), subindex);
      entry.set_value(static_cast<std::uint64_t>(value));
    };
    write(0x2003, 0, 255);
    write(0x606A, 0, 0);
    write(0x608F, 1, 40'000);
    write(0x2021, 0, 65'536);
    write(0x2022, 0, 255);
    write(0x2029, 0, 100);
    write(0x2030, 0, 1000);
    write(0x2031, 0, 10'000);
    write(0x2034, 0, 300'000);
    write(0x2035, 0, 1'600'000);
    write(0x202B, 0, 3000);
    write(0x202C, 0, 20);
    write(0x202D, 0, 2000);
    write(0x2020, 0, 1);
    write(0x6083, 0, 2'000'000);
    write(0x6084, 0, 2'000'000);
    devices::tmcm_3315::AxisUnit& axis = *axes_[n];
    axis.set_network_operational(true, now_);
    const auto command = [&](unsigned index, std::int64_t value) {
      const auto object = static_cast<std::uint16_t>(index + n * 0x800U);
      static_cast<void>(dictionary_.write_from_pdo(*dictionary_.find(object, 0),
                                                   static_cast<std::uint64_t>(value)));
      axis.apply(now_);
    };
    command(0x6060, 3);
    for (const int controlword : {6, 7, 15}) {
      command(0x6040, controlword);
    }
    for (int k = 0; k < 200 && !axis.axis().closed_loop().active(); ++k) {
      pass_millisecond();
    }
    command(0x60FF, 512'000);  // 10 rev/s
  }

  dictionary::Dictionary dictionary_;
  std::vector<std::unique_ptr<devices::tmcm_3315::AxisUnit>> axes_;
  base::SimTime now_;
};

/// A complete axis in closed loop at 10 rev/s: one step of ramp, commutation, driver, motor, load,
/// encoder and switches, and every twentieth time the firmware loop of 1 ms. Target: 200 ns, 0.4 %
/// of a core.
void ClosedLoopAxis_Step(benchmark::State& bench) {
  ClosedLoopAxes axes(1);
  int steps = 0;
  for (auto _ : bench) {
    axes.axis(0).step(kStep);
    if (++steps == 20) {
      steps = 0;
      axes.tick();
    }
  }
  using benchmark::Counter;
  const double simulated = static_cast<double>(bench.iterations()) * kStep.seconds();
  bench.counters["% of a core"] = Counter(0.01 * simulated, Counter::kIsRate | Counter::kInvert);
  bench.counters["of 0.4 %"] = Counter(0.004 * simulated, Counter::kIsRate | Counter::kInvert);
}
BENCHMARK(ClosedLoopAxis_Step);

/// A millisecond of 200 such axes. Target: a real-time factor of 1.
void ClosedLoopAxes_200_Millisecond(benchmark::State& bench) {
  std::vector<std::unique_ptr<ClosedLoopAxes>> modules;
  for (int axes = 200; axes > 0; axes -= 3) {
    modules.push_back(std::make_unique<ClosedLoopAxes>(std::min(axes, 3)));
  }
  for (auto _ : bench) {
    for (const auto& module : modules) {
      module->pass_millisecond();
    }
  }
  bench.counters["real-time factor"] = benchmark::Counter(
      static_cast<double>(bench.iterations()) * 1e-3, benchmark::Counter::kIsRate);
}
BENCHMARK(ClosedLoopAxes_200_Millisecond)->Unit(benchmark::kMicrosecond);

}  // namespace
