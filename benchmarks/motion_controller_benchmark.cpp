// Time per period of the TMCM-142's motion controller, a hundred modules in turn, against a limit
// of 100 ns.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/control/motion_controller/motion_controller.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using control::motion_controller::MotionController;
using control::motion_controller::Settings;

constexpr base::SimDuration kPeriod = 100_us;
constexpr double kLimit = 100e-9;  // s a period: a hundred modules take 10 % of a core

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// One period of a module after the other, of a hundred, so that each finds its memory as it would
/// in a rack. "of_limit" is the share of 100 ns in the least of many batches.
template <typename Prepare, typename Act>
void measure_periods(benchmark::State& bench, const Prepare& prepare, const Act& act) {
  constexpr std::size_t kModules = 100;
  std::vector<MotionController> modules(kModules);
  base::AxisSensing sensing;
  sensing.left_switch = sensing.right_switch = true;
  for (MotionController& module : modules) {
    prepare(module);
    for (int i = 0; i < 2'000; ++i) {
      module.advance(sensing, kPeriod);
    }
  }
  double least = 1.0;
  for (auto _ : bench) {
    const auto begin = std::chrono::steady_clock::now();
    for (MotionController& module : modules) {
      act(module, sensing);
      module.advance(sensing, kPeriod);
      benchmark::DoNotOptimize(module.table_position());
    }
    least = std::min(least, seconds_since(begin) / kModules);
  }
  bench.SetItemsProcessed(bench.iterations() * static_cast<std::int64_t>(kModules));
  bench.counters["least_ns"] = least * 1e9;
  bench.counters["of_limit"] = least / kLimit;
}

void MotionController_PeriodAtRest(benchmark::State& bench) {
  measure_periods(
      bench, [](MotionController&) {}, [](MotionController&, base::AxisSensing&) {});
}
BENCHMARK(MotionController_PeriodAtRest);

void MotionController_PeriodInMotion(benchmark::State& bench) {
  measure_periods(
      bench, [](MotionController& module) { module.rotate(5'000'000); },
      [](MotionController&, base::AxisSensing&) {});
}
BENCHMARK(MotionController_PeriodInMotion);

/// Encoder and ramp move, the regulator has an error: twelve or thirteen updates of it a period.
void MotionController_PeriodOfTheRegulator(benchmark::State& bench) {
  measure_periods(
      bench,
      [](MotionController& module) {
        Settings settings = module.settings();
        settings.regulator = {.p = 1'000,
                              .i = 10,
                              .d = 10,
                              .integral_clip = 100,
                              .velocity_clip = 10'000'000,
                              .enabled = true};
        module.configure(settings);
        module.rotate(5'000'000);
      },
      [](MotionController& module, base::AxisSensing& sensing) {
        sensing.encoder_count = module.position() - 100;
      });
}
BENCHMARK(MotionController_PeriodOfTheRegulator);

/// Moves to and fro, planning included.
void MotionController_PeriodOfMoves(benchmark::State& bench) {
  measure_periods(
      bench, [](MotionController&) {},
      [](MotionController& module, base::AxisSensing&) {
        if (module.at_rest()) {
          module.move_to(module.position() > 500 ? 0 : 1'000);
        }
      });
}
BENCHMARK(MotionController_PeriodOfMoves);

void MotionController_CoilPhases(benchmark::State& bench) {
  MotionController module;
  int entry = 0;
  for (auto _ : bench) {
    module.set_table_position(entry++ & 8191);
    benchmark::DoNotOptimize(module.table_phases());
  }
}
BENCHMARK(MotionController_CoilPhases);

}  // namespace
