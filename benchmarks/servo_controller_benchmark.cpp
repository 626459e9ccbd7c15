// Time per period of the TMCC160's servo controller in each commutation mode and loop, against a
// limit of 30 ns.
#include <algorithm>
#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>

#include "stator/control/servo/servo_controller.hpp"
#include "stator/plant/axes/servo_axis.hpp"

namespace {

using namespace stator;

constexpr double kLimit = 30e-9;  // s per period of the current loop

/// A drive that has been turning at 1500 rpm for a second and what its sensors tell in the 400
/// periods after that, so that a benchmark can repeat them without the cost of a plant.
struct Recording {
  control::ServoController controller;
  control::ServoSetPoint set_point;
  std::vector<base::ServoSensing> periods;
};

Recording recording_of(control::ServoCommutation commutation, control::ServoLoop loop) {
  plant::ServoAxisParameters parameters;
  parameters.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  parameters.load.inertia = 5e-6;
  parameters.encoder.counts_per_revolution = 4000;
  plant::ServoAxis axis(parameters);
  Recording recording;
  control::ServoControllerSettings settings;
  settings.commutation = commutation;
  settings.hall_interpolated = true;
  recording.controller.configure(settings);
  recording.set_point.loop = loop;
  recording.set_point.torque = 0.25;
  recording.set_point.velocity = 1500.0;
  const auto pass = [&] {
    axis.step(recording.controller.step(recording.set_point, axis.sensing()),
              control::ServoController::kPeriod);
  };
  constexpr int kSecond = 20'000;
  for (int k = 0; k < kSecond; ++k) {
    recording.set_point.velocity = std::min(1500.0, 0.1 * k);
    if (loop == control::ServoLoop::position) {
      recording.set_point.position = {recording.controller.position(), 0.0};
    }
    pass();
  }
  Recording result = recording;
  for (int k = 0; k < 400; ++k) {
    result.periods.push_back(axis.sensing());
    pass();
  }
  return result;
}

/// One period of the current loop, outer loops included. Target: 30 ns.
void ServoController_Step(benchmark::State& bench, control::ServoCommutation commutation,
                          control::ServoLoop loop) {
  const Recording recording = recording_of(commutation, loop);
  control::ServoController controller = recording.controller;
  std::size_t k = 0;
  for (auto _ : bench) {
    benchmark::DoNotOptimize(controller.step(recording.set_point, recording.periods[k]));
    if (++k == recording.periods.size()) {
      k = 0;
      controller = recording.controller;
    }
  }
  using benchmark::Counter;
  bench.counters["of_limit"] = Counter(static_cast<double>(bench.iterations()) * kLimit,
                                       Counter::kIsRate | Counter::kInvert);
}
BENCHMARK_CAPTURE(ServoController_Step, off, control::ServoCommutation::hall,
                  control::ServoLoop::off);
BENCHMARK_CAPTURE(ServoController_Step, hall_torque, control::ServoCommutation::hall,
                  control::ServoLoop::torque);
BENCHMARK_CAPTURE(ServoController_Step, hall_velocity, control::ServoCommutation::hall,
                  control::ServoLoop::velocity);
BENCHMARK_CAPTURE(ServoController_Step, encoder_position, control::ServoCommutation::encoder,
                  control::ServoLoop::position);
BENCHMARK_CAPTURE(ServoController_Step, controlled_velocity, control::ServoCommutation::controlled,
                  control::ServoLoop::velocity);

}  // namespace
