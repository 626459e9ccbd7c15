// The experiment coast-down: a stepper without current is let go at a speed, and friction alone
// brakes it.
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "stator/experiment/equations.hpp"
#include "stator/experiment/field_bench.hpp"
#include "stator/experiment/measurements.hpp"

namespace stator::experiment {

namespace {

constexpr Option kInitialSpeed{.name = "initial-speed",
                               .unit = "rev/s",
                               .help =
                                   "Speed at which the motor is let go; else 80 % of that at "
                                   "which it feeds the supply",
                               .minimum = 0.01,
                               .maximum = 1000.0,
                               .preset = {}};
constexpr std::array kCoastDownOptions{kInitialSpeed, kStep};
constexpr int kSamples = 400;
/// Speeds compared, as parts of the initial one.
constexpr std::array kParts{0.8, 0.6, 0.4, 0.3, 0.2, 0.1};
/// Below so many times the speed at which the detent torque catches the rotor, its ripple shows.
constexpr double kClearOfDetent = 3.0;

}  // namespace

std::span<const Option> coast_down_options() {
  return kCoastDownOptions;
}

Result measure_coast_down(const BenchSetup& setup, const Values& values) {
  const plant::StepperAxisParameters axis = uncoupled(setup.axis);
  const Equations equations(axis);
  const double feeding = axis.supply_voltage / equations.torque_constant();
  const double initial =
      values.contains("initial-speed") ? values["initial-speed"] * base::kTwoPi : 0.8 * feeding;
  if (initial >= feeding) {
    throw ExperimentError(fmt::format(
        "coast-down: from {:.3g} rev/s on the motor feeds the supply of {:g} V through the diodes; "
        "choose a lower --initial-speed",
        feeding / base::kTwoPi, axis.supply_voltage));
  }
  if (equations.running_torque(0.0) <= 0.0) {
    throw ExperimentError(
        "coast-down: the load drives the shaft harder than dry friction holds it, so it never "
        "stops; choose a smaller --load-torque");
  }
  FieldBench bench(axis, 0.0, microseconds(values["step"]));
  bench.spin(initial);

  // Potential of the detent torque from valley to crest: 2 Td / (4 p).
  const double caught =
      std::sqrt(axis.motor.detent_torque / (axis.motor.pole_pairs * equations.inertia()));
  const double end = equations.coasting_time(initial);
  Panel speed{"time", "ms", "shaft speed", "rev/s", {}, {{"measured", {}, {}}, {}}};
  speed.curves[1] = {"(ω₀ + Tc/B) exp(-B t/J) - Tc/B", Curve::Style::equation, {}};
  Result result;
  result.title = "Coast-down: friction alone";

  const auto steps = static_cast<int>(std::ceil(1.05 * end / bench.step()));
  const int every = std::max(1, steps / kSamples);
  std::size_t part = 0;
  double stopped = std::numeric_limits<double>::quiet_NaN();
  for (int n = 0; n <= steps; ++n) {
    const double time = n * bench.step();
    const double seen = bench.plant().state().motor.speed;
    const double expected = equations.coasting_speed(initial, time);
    if (part < kParts.size() && expected <= kParts[part] * initial) {
      result.comparisons.push_back({.quantity = fmt::format("speed after {:.1f} ms", time * 1e3),
                                    .unit = "rev/s",
                                    .measured = seen / base::kTwoPi,
                                    .equation = expected / base::kTwoPi,
                                    .judged = expected > kClearOfDetent * caught});
      ++part;
    }
    if (std::isnan(stopped) && seen <= 0.0) {
      stopped = time;
    }
    if (n % every == 0) {
      values.reached(n, steps);
      speed.x.push_back(time * 1e3);
      speed.curves[0].values.push_back(seen / base::kTwoPi);
      speed.curves[1].values.push_back(expected / base::kTwoPi);
    }
    bench.release();
  }
  result.comparisons.push_back({.quantity = "time until it turns back or stops",
                                .unit = "s",
                                .measured = stopped,
                                .equation = end,
                                .judged = axis.motor.detent_torque == 0.0});
  result.remarks.push_back(fmt::format(
      "B = {:.3g} N m s/rad, Tc = {:.3g} N m, J = {:.3g} kg m². Detent torque, which the equation "
      "does not have, shows below {:.2f} rev/s and catches the rotor at about {:.2f} rev/s.",
      equations.viscous_friction(), equations.coulomb_friction(), equations.inertia(),
      kClearOfDetent * caught / base::kTwoPi, caught / base::kTwoPi));
  result.panels = {speed};
  return result;
}

}  // namespace stator::experiment
