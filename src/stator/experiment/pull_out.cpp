// The experiment pull-out: at each speed the torque at which a stepper falls out of step.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "stator/experiment/equations.hpp"
#include "stator/experiment/field_bench.hpp"
#include "stator/experiment/measurements.hpp"

namespace stator::experiment {

namespace {

constexpr Option kFrom{.name = "from",
                       .unit = "rev/s",
                       .help =
                           "Lowest speed; else twice that at which detent torque meets the "
                           "rotor's resonance",
                       .minimum = 0.01,
                       .maximum = 1000.0,
                       .preset = {}};
constexpr Option kTo{.name = "to",
                     .unit = "rev/s",
                     .help =
                         "Highest speed; else where following the target takes three times the "
                         "supply",
                     .minimum = 0.01,
                     .maximum = 1000.0,
                     .preset = {}};
constexpr Option kPoints{.name = "points",
                         .unit = "",
                         .help = "Speeds at which is measured",
                         .minimum = 2.0,
                         .maximum = 200.0,
                         .preset = 17.0};
constexpr Option kDamper{.name = "damper",
                         .unit = "N m s/rad",
                         .help = "Inertia damper on the shaft; else a quarter of critical damping",
                         .minimum = 0.0,
                         .maximum = 10.0,
                         .preset = {}};
constexpr std::array kPullOutOptions{kCurrent, kFrom, kTo, kPoints, kDamper, kStep};

constexpr double kDampingRatio = 0.25;
constexpr double kSaturated = 2.0;  ///< regulator demand from which on voltages are square waves
constexpr double kDrawn = 3.0;      ///< and up to which is measured if nothing else is said

/// Runs up from speed to speed and loads the motor at each until it falls out of step.
class PullOutBench {
 public:
  PullOutBench(plant::StepperAxisParameters axis, double current, double damper,
               base::SimDuration step)
      : equations_(axis),
        current_(current),
        damper_(damper),
        bench_(damped(axis, damper), current, step) {}

  /// Motor torque at which the rotor falls out of step at `speed`; nothing if it does so unloaded.
  /// Speeds must rise from call to call.
  std::optional<double> measure(double speed) {
    if (!reach(speed)) {
      return std::nullopt;
    }
    const FieldBench::Snapshot unloaded = bench_.snapshot();
    const double full = equations_.regulated_pull_out(current_);
    const double rough = load_until_lost(0.0, 0.5 * full);
    bench_.restore(unloaded);
    approach(0.95 * rough, 0.5 * full);
    const double load = load_until_lost(0.95 * rough, 0.02 * full);
    bench_.restore(unloaded);
    return load + equations_.running_torque(speed);
  }

 private:
  static plant::StepperAxisParameters damped(plant::StepperAxisParameters axis, double damper) {
    axis.load.viscous_friction += damper;
    return axis;
  }

  void turn(double load) {
    // The damper's flywheel turns with the field: its torque is 0 but for oscillations.
    bench_.plant().set_external_torque(damper_ * bench_.speed() - load);
    bench_.turn();
  }
  [[nodiscard]] bool in_step() const { return std::fabs(bench_.lag()) < base::kPi; }

  bool reach(double speed) {
    const double torque =
        std::min(equations_.regulated_pull_out(current_), equations_.saturated_pull_out(speed));
    const double acceleration = 0.2 * torque / equations_.inertia();
    const double time = std::max(kShortestRun, (speed - bench_.speed()) / acceleration);
    const double start = bench_.speed();
    const auto steps = static_cast<int>(time / bench_.step());
    for (int n = 1; n <= steps; ++n) {
      bench_.set_speed(start + (speed - start) * n / steps);
      turn(0.0);
    }
    for (int n = 0; n < static_cast<int>(kSettling / bench_.step()); ++n) {
      turn(0.0);
    }
    return in_step();
  }

  void approach(double load, double rate) {
    const double change = rate * bench_.step();
    const auto steps = static_cast<int>(std::ceil(load / change));
    for (int n = 0; n < steps; ++n) {
      turn(n * change);
    }
  }

  double load_until_lost(double load, double rate) {
    while (in_step()) {
      load += rate * bench_.step();
      turn(load);
    }
    return load;
  }

  static constexpr double kShortestRun = 0.05;  ///< s from one speed to the next
  static constexpr double kSettling = 0.2;      ///< s at a new speed

  Equations equations_;
  double current_;
  double damper_;
  FieldBench bench_;
};

struct Range {
  double from;  ///< rad/s
  double to;
};

/// Speed from which on the regulator demand is at least `demand`, rad/s.
double speed_of_demand(const plant::StepperAxisParameters& axis, double current, double demand) {
  const double impedance = demand * axis.supply_voltage / current;
  const double resistance = axis.motor.resistance;
  return impedance <= resistance ? 0.0
                                 : std::sqrt(impedance * impedance - resistance * resistance) /
                                       (axis.motor.pole_pairs * axis.motor.inductance);
}

Range range_of(const plant::StepperAxisParameters& axis, const Equations& equations, double current,
               const Values& values) {
  const double detent_resonance =
      equations.natural_frequency(current) / (4.0 * axis.motor.pole_pairs);
  const Range range{
      values.value_or("from", 2.0 * detent_resonance / base::kTwoPi) * base::kTwoPi,
      values.value_or("to", speed_of_demand(axis, current, kDrawn) / base::kTwoPi) * base::kTwoPi};
  if (range.from >= range.to) {
    throw ExperimentError(
        fmt::format("pull-out: --from ({:.3g} rev/s) must lie below --to ({:.3g} rev/s)",
                    range.from / base::kTwoPi, range.to / base::kTwoPi));
  }
  return range;
}

/// The curves of the equations, on a fine grid of their own.
void add_equations(Panel& panel, const Equations& equations, double current, double supply) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double corner = equations.corner_speed(current);
  const double regulated = equations.regulated_pull_out(current);
  Curve below{"Kt I, up to the corner speed", Curve::Style::equation, {}};
  Curve above{"4/π Kt V/Z - Kt² ω R/Z²", Curve::Style::equation, {}};
  Curve circular{"Kt V/Z - Kt² ω R/Z² (sine waves)", Curve::Style::equation, {}};
  const double highest = 1.25 * regulated;
  const auto shown = [&](double torque) { return torque <= highest ? torque : kNone; };
  for (const double revolutions : panel.x) {
    const double speed = revolutions * base::kTwoPi;
    below.values.push_back(speed <= corner ? regulated : kNone);
    above.values.push_back(shown(equations.saturated_pull_out(speed)));
    circular.values.push_back(shown(equations.voltage_pull_out(speed, supply)));
  }
  panel.curves.insert(panel.curves.end(), {below, above, circular});
}

}  // namespace

std::span<const Option> pull_out_options() {
  return kPullOutOptions;
}

Result measure_pull_out(const BenchSetup& setup, const Values& values) {
  const plant::StepperAxisParameters axis = uncoupled(setup.axis);
  const Equations equations(axis);
  const double current = values.value_or("current", equations.rated_current());
  const double corner = equations.corner_speed(current);
  const Range range = range_of(axis, equations, current, values);
  const double damper = values.value_or(
      "damper", 2.0 * kDampingRatio * equations.inertia() * equations.natural_frequency(current));
  PullOutBench bench(axis, current, damper, microseconds(values["step"]));

  constexpr int kLinesPerPoint = 8;  // the equations are drawn finer than is measured
  const auto points = static_cast<int>(values["points"]);
  Panel panel{"speed", "rev/s", "pull-out torque", "N m", {}, {}};
  panel.from_zero = true;
  Curve measured{"measured", Curve::Style::measured_points, {}};
  Result result;
  result.title = "Pull-out torque over speed";
  for (int n = 0; n <= kLinesPerPoint * (points - 1); ++n) {
    const double speed = range.from + (range.to - range.from) * n / (kLinesPerPoint * (points - 1));
    panel.x.push_back(speed / base::kTwoPi);
    measured.values.push_back(std::numeric_limits<double>::quiet_NaN());
    if (n % kLinesPerPoint != 0) {
      continue;
    }
    values.reached(n, kLinesPerPoint * (points - 1));
    const std::optional<double> torque = bench.measure(speed);
    if (!torque) {
      result.remarks.push_back(fmt::format(
          "At {:.2f} rev/s the motor falls out of step without load.", speed / base::kTwoPi));
      break;
    }
    measured.values.back() = *torque;
    const bool saturated = equations.regulator_demand(speed, current) >= kSaturated;
    const double regulated = equations.regulated_pull_out(current);
    result.comparisons.push_back(
        {.quantity = fmt::format("pull-out torque at {:.2f} rev/s", speed / base::kTwoPi),
         .unit = "N m",
         .measured = *torque,
         .equation =
             speed <= corner ? regulated : std::min(regulated, equations.saturated_pull_out(speed)),
         .judged = speed <= corner || saturated});
  }
  add_equations(panel, equations, current, axis.supply_voltage);
  panel.curves.insert(panel.curves.begin(), measured);
  result.remarks.push_back(fmt::format(
      "{:.3g} A, {:g} V: Kt I holds up to the corner speed, {:.2f} rev/s; square waves from {:.2f} "
      "rev/s on, where the regulator would need twice the supply.",
      current, axis.supply_voltage, corner / base::kTwoPi,
      speed_of_demand(axis, current, kSaturated) / base::kTwoPi));
  result.remarks.push_back(fmt::format(
      "Torque of the motor: load and friction. An inertia damper of {:.3g} N m s/rad keeps the "
      "rotor from swinging itself out of step.",
      damper));
  result.panels = {panel};
  return result;
}

}  // namespace stator::experiment
