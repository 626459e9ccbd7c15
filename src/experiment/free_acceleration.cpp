#include <array>
#include <cmath>

#include <fmt/format.h>

#include "experiment/equations.hpp"
#include "experiment/field_bench.hpp"
#include "experiment/measurements.hpp"

namespace stator::experiment {

namespace {

constexpr std::array kOptions{kCurrent, kStep};
constexpr int kSamples = 400;
constexpr double kBeyondCorner = 1.8;  ///< times the time to the corner speed that are shown

}  // namespace

constinit const std::span<const Option> kFreeAccelerationOptions = kOptions;

/// The shaft is held by a brake until the current flows, then let go; from there the field leads
/// the rotor by a right angle all the time, as an ideal commutation would.
Result measure_free_acceleration(const Setup& setup, const Values& values) {
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
  // Half-way between valley and crest of the detent torque's potential: on the way it gives as much
  // as it takes.
  axis.initial_revolutions = 1.0 / (16.0 * axis.motor.pole_pairs);
  FieldBench bench(axis, current, microseconds(values["step"]));
  bench.build_up_current();

  Panel speed{"time", "ms", "shaft speed", "rev/s", {}, {{"measured", {}, {}}, {}}};
  Panel torque{"time", "ms", "motor torque", "N m", {}, {{"measured", {}, {}}, {}}};
  speed.curves[1] = {"∫ (Kt I - Tc - B ω) / J dt", Curve::Style::equation, {}};
  torque.curves[1] = {"Kt I", Curve::Style::equation, {}};
  Result result;
  result.title = "Free acceleration with the field 90° ahead of the rotor";

  const auto steps = static_cast<int>(std::ceil(end / bench.step()));
  const int every = std::max(1, steps / kSamples);
  int part = 1;  // fifths of the time to the corner compared so far
  for (int n = 0; n <= steps; ++n) {
    const double time = n * bench.step();
    const plant::StepperAxisObservation seen = bench.plant().observe();
    const double expected = equations.accelerated_speed(current, time);
    if (part <= 5 && time >= 0.2 * part * corner_time) {
      result.comparisons.push_back({fmt::format("speed after {:.2f} ms", time * 1e3), "rev/s",
                                    seen.speed / base::kTwoPi, expected / base::kTwoPi});
      ++part;
    }
    if (n % every == 0) {
      speed.x.push_back(time * 1e3);
      speed.curves[0].values.push_back(seen.speed / base::kTwoPi);
      speed.curves[1].values.push_back(expected / base::kTwoPi);
      torque.x.push_back(time * 1e3);
      torque.curves[0].values.push_back(seen.electromagnetic_torque);
      torque.curves[1].values.push_back(equations.regulated_pull_out(current));
    }
    bench.lead();
  }
  result.remarks.push_back(fmt::format(
      "{:g} A, {:g} V, inertia {:.3g} kg m²: the supply suffices up to the corner speed, {:.2f} "
      "rev/s, reached after {:.2f} ms; the equation ends there.",
      current, axis.supply_voltage, equations.inertia(), corner / base::kTwoPi, corner_time * 1e3));
  result.panels = {speed, torque};
  return result;
}

}  // namespace stator::experiment
