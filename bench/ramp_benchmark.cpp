#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

#include <benchmark/benchmark.h>

#include "base/random.hpp"
#include "control/microstep_sequencer.hpp"
#include "control/ramp_generator.hpp"

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

/// One tick at constant velocity. Target: 5 ns.
void RampGenerator_TickInCruise(benchmark::State& bench) {
  control::RampGenerator ramp;
  ramp.move_at_velocity(100'000.0, kTrapezoid);
  ramp.advance(1_s);
  for (auto _ : bench) {
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  }
}
BENCHMARK(RampGenerator_TickInCruise);

/// One tick of complete moves to and fro, planning included.
void RampGenerator_TickOfMoves(benchmark::State& bench) {
  control::RampGenerator ramp;
  std::int64_t target = 51'200;
  for (auto _ : bench) {
    if (ramp.at_rest()) {
      target = -target;
      ramp.move_to(target, kTrapezoid);
    }
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  }
}
BENCHMARK(RampGenerator_TickOfMoves);

/// One tick of a cubic.
void RampGenerator_TickInBow(benchmark::State& bench) {
  control::RampLimits slow = kBows;
  slow.jerk.fill(1e-3);  // a bow without end
  control::RampGenerator ramp;
  ramp.move_at_velocity(100'000.0, slow);
  for (auto _ : bench) {
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  }
}
BENCHMARK(RampGenerator_TickInBow);

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

/// The dearest of many random changes of target and limits in flight. Each is timed as the least of
/// several batches, so that what else the machine does drops out. "of_limit" is its share of 1 us.
void RampGenerator_DearestRetarget(benchmark::State& bench, control::RampShape shape) {
  constexpr int kChanges = 2'000;
  constexpr int kBatches = 5;
  constexpr int kBatch = 20;
  constexpr double kLimit = 1e-6;
  double dearest = 0.0;
  double sum = 0.0;
  for (auto _ : bench) {
    base::Random random(7);
    dearest = 0.0;
    sum = 0.0;
    control::RampGenerator ramp;
    for (int change = 0; change < kChanges; ++change) {
      const control::RampLimits limits = random_limits(random, shape);
      const auto way = static_cast<std::int64_t>(decades(random, 1.0, 1e7));
      const std::int64_t target = ramp.position().microsteps + (random.below(2) == 0 ? way : -way);
      const control::RampState start = ramp.state();
      double least = 1.0;
      for (int batch = 0; batch < kBatches; ++batch) {
        double seconds = 0.0;
        for (int i = 0; i < kBatch; ++i) {
          ramp.restore(start);
          const auto begin = std::chrono::steady_clock::now();
          ramp.move_to(target, limits);
          seconds +=
              std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        }
        least = std::min(least, seconds / kBatch);
      }
      dearest = std::max(dearest, least);
      sum += least;
      ramp.advance(base::SimDuration(
          static_cast<std::int64_t>(random.uniform() * ramp.remaining_time() * 1e9)));
    }
  }
  bench.counters["max_ns"] = dearest * 1e9;
  bench.counters["mean_ns"] = sum / kChanges * 1e9;
  bench.counters["of_limit"] = dearest / kLimit;
}
BENCHMARK_CAPTURE(RampGenerator_DearestRetarget, six_point, control::RampShape::six_point)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(RampGenerator_DearestRetarget, s_shaped, control::RampShape::s_shaped)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

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
