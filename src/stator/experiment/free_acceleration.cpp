// The experiment free-acceleration: the field leads a stepper's rotor by 90 degrees from standstill
// on.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "stator/experiment/equations.hpp"
#include "stator/experiment/field_bench.hpp"
#include "stator/experiment/measurements.hpp"

namespace stator::experiment {

namespace {

constexpr std::array kFreeAccelerationOptions{kCurrent, kStep};
constexpr int kSamples = 400;
constexpr int kStarts = 8;
constexpr double kBeyondCorner = 1.8;  ///< times the time to the corner speed that are shown
constexpr std::array kParts{0.2, 0.4, 0.6, 0.8, 1.0};  ///< of that time that are compared

/// Speed and torque over time, one value per step.
struct Trace {
  std::vector<double> speed;
  std::vector<double> torque;
};

/// Mean of starts from places spread over a period of the detent torque, which helps some and
/// hinders others.
Trace mean_start(plant::StepperAxisParameters axis, double current, base::SimDuration step,
                 std::size_t steps, const Values& values) {
  Trace mean{std::vector<double>(steps), std::vector<double>(steps)};
  for (int start = 0; start < kStarts; ++start) {
    values.reached(start, kStarts);
    axis.initial_revolutions = start / (4.0 * kStarts * axis.motor.pole_pairs);
    FieldBench bench(axis, current, step);
    bench.build_up_current();
    for (std::size_t n = 0; n < steps; ++n) {
      const plant::StepperAxisObservation seen = bench.plant().observe();
      mean.speed[n] += seen.speed / kStarts;
      mean.torque[n] += seen.electromagnetic_torque / kStarts;
      bench.lead();
    }
  }
  return mean;
}

}  // namespace

std::span<const Option> free_acceleration_options() {
  return kFreeAccelerationOptions;
}

/// The shaft is held by a brake until the current flows, then let go; from there the field leads
/// the rotor by a right angle all the time, as an ideal commutation would.
Result measure_free_acceleration(const BenchSetup& setup, const Values& values) {
  plant::StepperAxisParameters axis = uncoupled(setup.axis);
  const Equations equations(axis);
  const double current = values.value_or("current", equations.rated_current());
  const double corner = equations.corner_speed(current);
  if (corner <= 0.0 || equations.running_torque(0.0) >= equations.regulated_pull_out(current)) {
    throw ExperimentError(fmt::format(
        "free-acceleration: {:g} V cannot drive {:g} A through the winding, or load and "
        "friction hold the shaft; choose another --current or --supply",
        axis.supply_voltage, current));
  }
  const double corner_time = equations.acceleration_time(current, corner);
  const double end = kBeyondCorner * corner_time;

  axis.load.brake_torque = 10.0 * equations.regulated_pull_out(current);
  const base::SimDuration step = microseconds(values["step"]);
  const auto steps = static_cast<std::size_t>(std::ceil(end / step.seconds())) + 1;
  const Trace seen = mean_start(axis, current, step, steps, values);

  Panel speed{"time", "ms", "shaft speed", "rev/s", {}, {{"measured", {}, {}}, {}}};
  Panel torque{"time", "ms", "motor torque", "N m", {}, {{"measured", {}, {}}, {}}};
  torque.from_zero = true;
  speed.curves[1] = {"∫ (Kt I - Tc - B ω) / J dt", Curve::Style::equation, {}};
  torque.curves[1] = {"Kt I", Curve::Style::equation, {}};
  Result result;
  result.title = "Free acceleration with the field 90° ahead of the rotor";

  for (const double part : kParts) {
    const auto n = static_cast<std::size_t>(part * corner_time / step.seconds());
    const double time = static_cast<double>(n) * step.seconds();
    result.comparisons.push_back({fmt::format("speed after {:.2f} ms", time * 1e3), "rev/s",
                                  seen.speed[n] / base::kTwoPi,
                                  equations.accelerated_speed(current, time) / base::kTwoPi});
  }
  const std::size_t every = std::max<std::size_t>(1, steps / kSamples);
  for (std::size_t n = 0; n < steps; n += every) {
    const double time = static_cast<double>(n) * step.seconds();
    speed.x.push_back(time * 1e3);
    speed.curves[0].values.push_back(seen.speed[n] / base::kTwoPi);
    speed.curves[1].values.push_back(equations.accelerated_speed(current, time) / base::kTwoPi);
    torque.x.push_back(time * 1e3);
    torque.curves[0].values.push_back(seen.torque[n]);
    torque.curves[1].values.push_back(equations.regulated_pull_out(current));
  }
  result.remarks.push_back(fmt::format(
      "{:.3g} A, {:g} V, inertia {:.3g} kg m²: the supply suffices up to the corner speed, {:.2f} "
      "rev/s, reached after {:.2f} ms; the equation ends there.",
      current, axis.supply_voltage, equations.inertia(), corner / base::kTwoPi, corner_time * 1e3));
  result.panels = {speed, torque};
  return result;
}

}  // namespace stator::experiment
