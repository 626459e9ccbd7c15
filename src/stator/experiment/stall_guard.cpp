// The experiment stall-guard: the StallGuard2 value of a turning stepper over the torque of a
// brake.
#include "stator/control/stepper/stall_guard.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "stator/experiment/equations.hpp"
#include "stator/experiment/field_bench.hpp"
#include "stator/experiment/measurements.hpp"
#include "stator/experiment/module_bench.hpp"

namespace stator::experiment {

namespace {

constexpr std::array kStallGuardOptions{
    Option{.name = "speed",
           .unit = "rev/s",
           .help = "Speed at which is measured; else that of half the largest value",
           .minimum = 0.1,
           .maximum = 100.0,
           .preset = {}},
    Option{.name = "run",
           .unit = "",
           .help = "Run current, 2003h",
           .minimum = 0.0,
           .maximum = 255.0,
           .preset = 255.0},
    Option{.name = "threshold",
           .unit = "",
           .help = "StallGuard2 threshold, 209Eh",
           .minimum = -63.0,
           .maximum = 63.0,
           .preset = 0.0},
    Option{.name = "points",
           .unit = "",
           .help = "Loads at which is measured",
           .minimum = 2.0,
           .maximum = 200.0,
           .preset = 20.0},
};

constexpr std::int8_t kProfileVelocity = 3;
constexpr double kDampingRatio = 0.25;
constexpr double kAccelerationTime = 0.5;  // s
constexpr double kSettling = 0.2;          // s after each change of load
constexpr double kMeasuring = 0.5;         // s
constexpr double kHeaviest = 0.97;         // of the pull-out torque

/// A module that turns its motor, against a brake, with an inertia damper on the shaft.
class LoadedModule {
 public:
  LoadedModule(const BenchSetup& setup, double damper, double speed)
      : module_(damped(setup, damper)), damper_(damper), speed_(speed) {}

  void start(int run, int threshold) {
    module_.write<std::uint8_t>(0x2003, static_cast<std::uint8_t>(run));
    module_.write<std::uint8_t>(0x209D, 1);  // one measurement of four full steps
    module_.write<std::int8_t>(0x209E, static_cast<std::int8_t>(threshold));
    module_.enable(kProfileVelocity);
    const double revolutions = speed_ / base::kTwoPi;
    module_.turn(revolutions, revolutions / kAccelerationTime);
    pass(1.2 * kAccelerationTime, 0.0);
  }
  /// Mean of 2101h under `load`, N m.
  double measure(double load) {
    pass(kSettling, load);
    return pass(kMeasuring, load);
  }
  [[nodiscard]] const std::string& name() const { return module_.name(); }
  [[nodiscard]] bool in_step() { return module_.plant().state().motor.speed > 0.5 * speed_; }

 private:
  static BenchSetup damped(BenchSetup setup, double damper) {
    setup.axis.load.viscous_friction += damper;
    return setup;
  }

  double pass(double seconds, double load) {
    double sum = 0.0;
    const auto samples = static_cast<int>(std::lround(seconds / module_.period()));
    for (int n = 0; n < samples; ++n) {
      // The damper's flywheel turns with the set-point: its torque is 0 but for oscillations.
      const double flywheel = module_.demand_speed() * base::kTwoPi;
      module_.plant().set_external_torque(damper_ * flywheel - load);
      module_.step();
      sum += static_cast<double>(module_.read(0x2101));
    }
    return sum / samples;
  }

  ModuleBench module_;
  double damper_;
  double speed_;
};

}  // namespace

std::span<const Option> stall_guard_options() {
  return kStallGuardOptions;
}

Result measure_stall_guard(const BenchSetup& setup, const Values& values) {
  const BenchSetup bench{.axis = uncoupled(setup.axis),
                         .full_scale_current = setup.full_scale_current,
                         .module = setup.module};
  const Equations equations(bench.axis);
  const int run = static_cast<int>(values["run"]);
  const int threshold = static_cast<int>(values["threshold"]);
  const double current = current_of_setting(run, bench.full_scale_current);
  const double corner = equations.corner_speed(current);
  const double half_scale = 0.5 * control::StallGuard::kMaximum /
                            control::StallGuard::kCountsPerVolt / equations.torque_constant();
  const double speed =
      values.value_or("speed", std::fmin(half_scale, 0.9 * corner) / base::kTwoPi) * base::kTwoPi;
  if (speed > corner) {
    throw ExperimentError(fmt::format(
        "stall-guard: above {:.3g} rev/s {:g} V do not regulate {:.3g} A and there is nothing to "
        "measure; choose a lower --speed",
        corner / base::kTwoPi, bench.axis.supply_voltage, current));
  }
  const double damper =
      2.0 * kDampingRatio * equations.inertia() * equations.natural_frequency(current);
  LoadedModule module(bench, damper, speed);
  module.start(run, threshold);

  const double offset = threshold * control::StallGuard::kCountsPerThreshold;
  const auto expected = [&](double torque) {
    return std::fmax(0.0, offset + equations.stall_guard(speed, torque, current,
                                                         control::StallGuard::kCountsPerVolt));
  };
  const double pull_out = equations.regulated_pull_out(current);
  const double unloaded = expected(0.0);
  Panel panel{"motor torque (load and friction)", "N m", "StallGuard2 value 2101h", "", {}, {}};
  panel.from_zero = true;
  Curve measured{"measured", Curve::Style::measured_points, {}};
  Curve line{"100/V Kt ω (1 - T / (Kt I)) + 8 SGT", Curve::Style::equation, {}};
  Result result;
  result.title = "StallGuard2 value over load";
  const auto points = static_cast<int>(values["points"]);
  const double friction = equations.running_torque(speed);
  for (int n = 0; n < points; ++n) {
    values.reached(n, points);
    const double torque = friction + (kHeaviest * pull_out - friction) * n / (points - 1);
    const double value = module.measure(torque - friction);
    if (!module.in_step()) {
      result.remarks.push_back(fmt::format("Out of step at {:.3g} N m.", torque));
      break;
    }
    panel.x.push_back(torque);
    measured.values.push_back(value);
    line.values.push_back(expected(torque));
    result.comparisons.push_back({.quantity = fmt::format("value at {:.3g} N m", torque),
                                  .unit = "",
                                  .measured = value,
                                  .equation = expected(torque),
                                  .scale = unloaded});
  }
  panel.x.push_back(pull_out);
  measured.values.push_back(std::numeric_limits<double>::quiet_NaN());
  line.values.push_back(expected(pull_out));
  panel.curves = {measured, line};
  result.remarks.push_back(
      fmt::format("{}, {:.3g} A amplitude, {:.2f} rev/s, threshold {}: pull-out at {:.3g} N m. "
                  "Deviations are parts of the value without load.",
                  module.name(), current, speed / base::kTwoPi, threshold, pull_out));
  result.panels = {panel};
  return result;
}

}  // namespace stator::experiment
