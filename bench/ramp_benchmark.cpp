#include <cstdint>

#include <benchmark/benchmark.h>

#include "base/random.hpp"
#include "control/microstep_sequencer.hpp"
#include "control/ramp_generator.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;

constexpr base::SimDuration kTick = 50_us;
constexpr control::RampLimits kLimits{
    .velocity = 200'000.0, .acceleration = 1e6, .deceleration = 5e5};

/// One tick at constant velocity. Target: 5 ns.
void RampGenerator_TickInCruise(benchmark::State& bench) {
  control::RampGenerator ramp;
  ramp.move_at_velocity(100'000.0, kLimits);
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
      ramp.move_to(target, kLimits);
    }
    ramp.advance(kTick);
    benchmark::DoNotOptimize(ramp.motor_microsteps());
  }
}
BENCHMARK(RampGenerator_TickOfMoves);

/// A new random target in flight. Target: 1 us at worst.
void RampGenerator_Retarget(benchmark::State& bench) {
  control::RampGenerator ramp;
  base::Random random(1);
  for (auto _ : bench) {
    ramp.move_to(static_cast<std::int64_t>(random.below(1'000'000)), kLimits);
    ramp.advance(kTick);
  }
}
BENCHMARK(RampGenerator_Retarget);

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
