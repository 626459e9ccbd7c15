// The experiment back-emf: a servo motor coasts down, and the EMF between two of its lines is
// compared with the equation.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "stator/experiment/measurements.hpp"
#include "stator/experiment/servo_bench.hpp"
#include "stator/experiment/servo_equations.hpp"

namespace stator::experiment {

namespace {

constexpr Option kInitialSpeed{.name = "initial-speed",
                               .unit = "rpm",
                               .help =
                                   "Speed at which the motor is let go; else 80 % of that at "
                                   "which it feeds the supply",
                               .minimum = 1.0,
                               .maximum = 100'000.0,
                               .preset = {}};
constexpr std::array kBackEmfOptions{kInitialSpeed, kStep};
constexpr int kSamples = 400;
constexpr double kRpm = base::kPi / 30.0;
constexpr std::array kParts{0.9, 0.8, 0.6, 0.4, 0.3, 0.2};
/// Below so many times the speed at which cogging catches the rotor, its ripple shows.
constexpr double kClearOfCogging = 3.0;

/// Highest EMF between two lines that a shaft turning at `speed` shows in an electrical period.
double peak_emf(const plant::ServoAxisParameters& axis, double speed) {
  constexpr int kAngles = 360;
  double peak = 0.0;
  for (int n = 0; n < kAngles; ++n) {
    plant::ServoAxisParameters turned = axis;
    turned.initial_revolutions = n / (static_cast<double>(kAngles) * axis.motor.pole_pairs);
    CommutatorBench bench(turned, base::SimDuration(50'000));
    bench.spin(speed);
    const std::array<double, 3> emf = bench.plant().observe().back_emf;
    peak = std::max(peak, emf[1] - emf[0]);
  }
  return peak;
}

}  // namespace

std::span<const Option> back_emf_options() {
  return kBackEmfOptions;
}

Result measure_back_emf(const BenchSetup& setup, const Values& values) {
  const plant::ServoAxisParameters axis = uncoupled(setup.servo);
  const ServoEquations equations(axis);
  const double feeding = axis.supply_voltage / equations.line_to_line_emf(1.0);
  const double initial =
      values.contains("initial-speed") ? values["initial-speed"] * kRpm : 0.8 * feeding;
  if (initial >= feeding) {
    throw ExperimentError(fmt::format(
        "back-emf: from {:.0f} rpm on the motor feeds the supply of {:g} V through the diodes; "
        "choose a lower --initial-speed",
        feeding / kRpm, axis.supply_voltage));
  }
  if (equations.coulomb_friction() <= axis.load.constant_torque) {
    throw ExperimentError(
        "back-emf: the load drives the shaft harder than dry friction holds it, so it never "
        "stops; choose a smaller --load-torque");
  }
  const plant::CoggingHarmonic& cogging = axis.motor.cogging.front();
  // Potential of the cogging torque from valley to crest: 2 A / (order p).
  const double caught = std::sqrt(4.0 * cogging.amplitude /
                                  (cogging.order * axis.motor.pole_pairs * equations.inertia()));
  CommutatorBench bench(axis, microseconds(values["step"]));
  bench.spin(initial);
  const double end = equations.slowing_time(initial, 0.0);
  Result result;
  result.title = "Coast-down: the EMF between two lines, and friction alone";
  Panel speed{"time", "ms", "shaft speed", "rpm", {}, {{"measured", {}, {}}, {}}};
  speed.curves[1] = {"(ω₀ + Tc/B) exp(-B t/J) - Tc/B", Curve::Style::equation, {}};
  Panel emf{"speed", "rpm", "EMF between two lines", "V", {}, {{}, {}}};
  emf.curves = {{"measured peak", Curve::Style::measured_points, {}},
                {"√3 p ψ ω", Curve::Style::equation, {}}};
  emf.from_zero = true;

  const auto steps = static_cast<int>(std::ceil(1.05 * end / bench.step()));
  const int every = std::max(1, steps / kSamples);
  std::size_t part = 0;
  for (int n = 0; n <= steps; ++n) {
    const double seen = bench.plant().state().motor.speed;
    const double expected = equations.slowing_speed(initial, 0.0, n * bench.step());
    if (part < kParts.size() && expected <= kParts[part] * initial) {
      result.comparisons.push_back(
          {.quantity = fmt::format("speed after {:.1f} ms", n * bench.step() * 1e3),
           .unit = "rpm",
           .measured = seen / kRpm,
           .equation = expected / kRpm,
           .judged = expected > kClearOfCogging * caught});
      const double peak = peak_emf(axis, seen);
      result.comparisons.push_back(
          {.quantity = fmt::format("EMF at {:.0f} rpm, peak between two lines", seen / kRpm),
           .unit = "V",
           .measured = peak,
           .equation = equations.line_to_line_emf(seen),
           .judged = axis.motor.back_emf.sinusoidal()});
      emf.x.push_back(seen / kRpm);
      emf.curves[0].values.push_back(peak);
      emf.curves[1].values.push_back(equations.line_to_line_emf(seen));
      ++part;
    }
    if (n % every == 0) {
      values.reached(n, steps);
      speed.x.push_back(n * bench.step() * 1e3);
      speed.curves[0].values.push_back(seen / kRpm);
      speed.curves[1].values.push_back(expected / kRpm);
    }
    bench.release();
  }
  result.remarks.push_back(fmt::format(
      "ψ = {:.3g} V s, p = {}, B = {:.3g} N m s/rad, Tc = {:.3g} N m, J = {:.3g} kg m². Cogging, "
      "which the equation does not have, catches the rotor at about {:.0f} rpm.",
      axis.motor.flux_linkage, axis.motor.pole_pairs, equations.viscous_friction(),
      equations.coulomb_friction(), equations.inertia(), caught / kRpm));
  result.panels = {emf, speed};
  return result;
}

}  // namespace stator::experiment
