// Time of a tick of the ramp generator and of a new target, for each shape of ramp, against limits.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/base/random.hpp"
#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/control/stepper/microstep_sequencer.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;

constexpr base::SimDuration kTick = 50_us;
constexpr control::RampLimits kTrapezoid{
    .velocity = 200'000.0, .acceleration = 1e6, .deceleration = 5e5};
constexpr control::RampLimits kSixPoint{.velocity = 200'000.0,
                                        .acceleration = 1e6,
                                        .deceleration = 5e5,
                                        .start_velocity = 500.0,
                                        .start_acceleration = 2e5,
                                        .break_velocity = 50'000.0,
                                        .final_deceleration = 3e5,
                                        .end_velocity = 1'000.0};
constexpr control::RampLimits kBows{.velocity = 200'000.0,
                                    .acceleration = 1e6,
                                    .deceleration = 5e5,
                                    .shape = control::RampShape::s_shaped,
                                    .jerk = {1e7, 2e7, 5e6, 1e7}};

constexpr double kTickLimit = 5e-9;      // s
constexpr double kRetargetLimit = 1e-6;  // s

/// Repeats, so that the least says what the code takes and the median what the machine made of it.
void repeat(benchmark::internal::Benchmark* bench) {
  bench->Repetitions(9)->ReportAggregatesOnly(true)->ComputeStatistics(
      "min",
      [](const std::vector<double>& all) { return *std::min_element(all.begin(), all.end()); });
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// The time is that of a tick and its loop, as the machine had it. "of_limit" is the share of 5 ns
/// that it takes in the least of many short batches, so that what else the machine does drops out;
/// the loop is not subtracted.
template <typename Tick>
void measure_ticks(benchmark::State& bench, const Tick& tick) {
  for (auto _ : bench) {
    tick();
  }
  constexpr int kBatches = 1'000;
  constexpr int kBatch = 1'000;
  double least = 1.0;
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kBatch; ++i) {
      tick();
    }
    least = std::min(least, seconds_since(begin) / kBatch);
  }
  bench.counters["least_ns"] = least * 1e9;
  bench.counters["of_limit"] = least / kTickLimit;
}

/// One tick at constant velocity.
void RampGenerator_TickInCruise(benchmark::State& bench) {
  control::RampGenerator ramp;
  ramp.move_at_velocity(100'000.0, kTrapezoid);
  ramp.advance(1_s);
  measure_ticks(bench, [&] {
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  });
}
BENCHMARK(RampGenerator_TickInCruise)->MinTime(0.1)->Apply(repeat);

/// One tick of complete moves to and fro, planning included.
void RampGenerator_TickOfMoves(benchmark::State& bench) {
  control::RampGenerator ramp;
  std::int64_t target = 51'200;
  measure_ticks(bench, [&] {
    if (ramp.at_rest()) {
      target = -target;
      ramp.move_to(target, kTrapezoid);
    }
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  });
}
BENCHMARK(RampGenerator_TickOfMoves)->MinTime(0.1)->Apply(repeat);

/// One tick of a cubic.
void RampGenerator_TickInBow(benchmark::State& bench) {
  control::RampLimits slow = kBows;
  slow.jerk.fill(1e-3);  // a bow without end
  control::RampGenerator ramp;
  ramp.move_at_velocity(100'000.0, slow);
  measure_ticks(bench, [&] {
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  });
}
BENCHMARK(RampGenerator_TickInBow)->MinTime(0.1)->Apply(repeat);

/// A new random target in flight.
void RampGenerator_Retarget(benchmark::State& bench, const control::RampLimits& limits) {
  control::RampGenerator ramp;
  base::Random random(1);
  for (auto _ : bench) {
    ramp.move_to(static_cast<std::int64_t>(random.below(1'000'000)), limits);
    ramp.advance(kTick);
  }
}
BENCHMARK_CAPTURE(RampGenerator_Retarget, trapezoid, kTrapezoid);
BENCHMARK_CAPTURE(RampGenerator_Retarget, six_point, kSixPoint);
BENCHMARK_CAPTURE(RampGenerator_Retarget, s_shaped, kBows);

double decades(base::Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

control::RampLimits random_limits(base::Random& random, control::RampShape shape) {
  control::RampLimits limits{.velocity = decades(random, 1e2, 8e6),
                             .acceleration = decades(random, 1e3, 4e6),
                             .deceleration = decades(random, 1e3, 4e6),
                             .shape = shape,
                             .start_velocity = 100.0,
                             .start_acceleration = decades(random, 1e3, 4e6),
                             .break_velocity = decades(random, 1e2, 1e5),
                             .final_deceleration = decades(random, 1e3, 4e6),
                             .end_velocity = 200.0};
  for (double& jerk : limits.jerk) {
    jerk = decades(random, 1e3, 4e11);
  }
  return limits;
}

/// Seconds that `action` takes, the clock's own time included: the least of several batches, so
/// that what else the machine does drops out. `prepare` comes before each and is not timed.
template <typename Prepare, typename Action>
double least_time(const Prepare& prepare, const Action& action) {
  constexpr int kBatches = 9;
  constexpr int kBatch = 20;
  double least = 1.0;
  for (int batch = 0; batch < kBatches; ++batch) {
    double seconds = 0.0;
    for (int i = 0; i < kBatch; ++i) {
      prepare();
      const auto begin = std::chrono::steady_clock::now();
      action();
      seconds += seconds_since(begin);
    }
    least = std::min(least, seconds / kBatch);
  }
  return least;
}

/// The dearest of many random changes of target and limits in flight. What reading the clock takes
/// is measured in the same way and subtracted; "clock_ns" tells it. "of_limit" is the dearest's
/// share of 1 us.
void RampGenerator_DearestRetarget(benchmark::State& bench, control::RampShape shape) {
  constexpr int kChanges = 2'000;
  double clock = 1.0;
  double dearest = 0.0;
  double sum = 0.0;
  for (auto _ : bench) {
    base::Random random(7);
    control::RampGenerator ramp;
    for (int change = 0; change < kChanges; ++change) {
      const control::RampLimits limits = random_limits(random, shape);
      const auto way = static_cast<std::int64_t>(decades(random, 1.0, 1e7));
      const std::int64_t target = ramp.position().microsteps + (random.below(2) == 0 ? way : -way);
      const control::RampState start = ramp.state();
      const double least =
          least_time([&] { ramp.restore(start); }, [&] { ramp.move_to(target, limits); });
      dearest = std::max(dearest, least);
      sum += least;
      clock = std::min(clock, least_time([] {}, [] {}));
      ramp.advance(base::SimDuration(
          static_cast<std::int64_t>(random.uniform() * ramp.remaining_time() * 1e9)));
    }
  }
  bench.counters["max_ns"] = (dearest - clock) * 1e9;
  bench.counters["mean_ns"] = (sum / kChanges - clock) * 1e9;
  bench.counters["clock_ns"] = clock * 1e9;
  bench.counters["of_limit"] = (dearest - clock) / kRetargetLimit;
}
BENCHMARK_CAPTURE(RampGenerator_DearestRetarget, six_point, control::RampShape::six_point)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->Apply(repeat);
BENCHMARK_CAPTURE(RampGenerator_DearestRetarget, s_shaped, control::RampShape::s_shaped)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->Apply(repeat);

/// A csp target every tick.
void RampGenerator_FollowPosition(benchmark::State& bench) {
  control::RampGenerator ramp;
  std::int64_t target = 0;
  for (auto _ : bench) {
    target += 7;
    ramp.follow_position(target, kTick);
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  }
}
BENCHMARK(RampGenerator_FollowPosition);

void MicrostepSequencer_CoilCurrents(benchmark::State& bench) {
  const control::MicrostepSequencer sequencer;
  std::int64_t position = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(sequencer.coil_currents(position, 3.0));
    position += 7;
  }
}
BENCHMARK(MicrostepSequencer_CoilCurrents);

}  // namespace
