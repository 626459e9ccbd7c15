// The experiment move: a profile position move of a TMCM-3315 axis with position, speed, current
// and load angle.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "stator/experiment/equations.hpp"
#include "stator/experiment/measurements.hpp"
#include "stator/experiment/module_bench.hpp"

namespace stator::experiment {

namespace {

constexpr Option number(std::string_view name, std::string_view unit, std::string_view help,
                        double minimum, double maximum, double preset) {
  return {name, unit, help, minimum, maximum, preset};
}

constexpr std::array kMoveOptions{
    number("distance", "rev", "How far", 0.01, 10'000.0, 5.0),
    number("speed", "rev/s", "Profile velocity, 6081h", 0.01, 100.0, 5.0),
    number("acceleration", "rev/s2", "Profile acceleration and deceleration, 6083h and 6084h", 0.1,
           10'000.0, 20.0),
    number("run", "", "Run current, 2003h", 0.0, 255.0, 255.0),
};

constexpr std::int8_t kProfilePosition = 1;
constexpr double kBefore = 0.1;  // s under current before the move
constexpr double kAfter = 0.15;  // s shown after it
constexpr int kSamples = 380;
constexpr double kDegrees = 180.0 / base::kPi;

/// One instant of the move.
struct Sample {
  double time = 0.0;                 ///< s since the move began
  double position = 0.0;             ///< rev since then
  double demand_position = 0.0;      ///< rev
  double speed = 0.0;                ///< rev/s
  double demand_speed = 0.0;         ///< rev/s
  double current = 0.0;              ///< A
  double load_angle = 0.0;           ///< electrical degrees
  double expected_load_angle = 0.0;  ///< electrical degrees; not a number: none
};

/// Position, speed, current and load angle over time.
std::vector<Panel> empty_panels() {
  Panel position{"time", "s", "position", "rev", {}, {{"shaft", {}, {}}, {}}};
  position.curves[1] = {"set-point", Curve::Style::equation, {}};
  Panel speed{"time", "s", "speed", "rev/s", {}, {{"shaft", {}, {}}, {}}};
  speed.curves[1] = {"set-point", Curve::Style::equation, {}};
  Panel current{"time", "s", "current", "A", {}, {{"amplitude", {}, {}}}};
  current.from_zero = true;
  Panel angle{"time", "s", "load angle", "° electrical", {}, {{"measured", {}, {}}, {}}};
  angle.curves[1] = {"asin(T / (Kt I))", Curve::Style::equation, {}};
  return {position, speed, current, angle};
}

void append(std::vector<Panel>& panels, const Sample& sample) {
  for (Panel& panel : panels) {
    panel.x.push_back(sample.time);
  }
  panels[0].curves[0].values.push_back(sample.position);
  panels[0].curves[1].values.push_back(sample.demand_position);
  panels[1].curves[0].values.push_back(sample.speed);
  panels[1].curves[1].values.push_back(sample.demand_speed);
  panels[2].curves[0].values.push_back(sample.current);
  panels[3].curves[0].values.push_back(sample.load_angle);
  panels[3].curves[1].values.push_back(sample.expected_load_angle);
}

Comparison mean_load_angle(std::string_view when, double measured, double equation) {
  return {.quantity = fmt::format("mean load angle, {}", when),
          .unit = "°",
          .measured = measured,
          .equation = equation,
          .scale = 90.0};
}

/// Sign of a number, 0 for 0.
double sign_of(double value) {
  return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
}

/// Mean load angle over the inner part of a stretch of the move, where swings have settled.
class MeanOverStretch {
 public:
  MeanOverStretch(double from, double to)
      : from_(from + 0.3 * (to - from)), to_(to - 0.05 * (to - from)) {}
  void take(double time, double value) {
    if (time >= from_ && time < to_) {
      sum_ += value;
      ++samples_;
    }
  }
  [[nodiscard]] double value() const { return samples_ > 0 ? sum_ / samples_ : 0.0; }

 private:
  double from_;
  double to_;
  double sum_ = 0.0;
  int samples_ = 0;
};

}  // namespace

std::span<const Option> move_options() {
  return kMoveOptions;
}

Result measure_move(const BenchSetup& setup, const Values& values) {
  const Equations equations(setup.axis);
  const double distance = values["distance"];
  const double acceleration = values["acceleration"];
  const double speed = std::min(values["speed"], std::sqrt(distance * acceleration));
  const int run = static_cast<int>(values["run"]);
  const double current = current_of_setting(run, setup.full_scale_current);
  const double ramp = speed / acceleration;
  const double cruise = distance / speed - ramp;
  const double duration = 2.0 * ramp + cruise;

  ModuleBench bench(setup);
  bench.write<std::uint8_t>(0x2003, static_cast<std::uint8_t>(run));
  bench.enable(kProfilePosition);
  bench.run(kBefore);
  const double begin = bench.time();
  const double origin = bench.plant().observe().shaft_revolutions;
  const double demand_origin = bench.demand_revolutions();
  bench.start_move(distance, speed, acceleration);

  const double inertial = equations.inertia() * acceleration * base::kTwoPi;
  const double half_speed_torque = equations.running_torque(0.65 * speed * base::kTwoPi);
  const double full_speed_torque = equations.running_torque(speed * base::kTwoPi);
  const auto load_angle = [&](double torque) {
    return std::asin(equations.load_angle_sine(torque, current)) * kDegrees;
  };

  Result result;
  result.title = "Profile position move";
  result.panels = empty_panels();
  MeanOverStretch accelerating(0.0, ramp);
  MeanOverStretch cruising(ramp, ramp + cruise);
  double arrival = std::nan("");
  double peak_speed = 0.0;
  const auto steps = static_cast<int>((duration + kAfter) / bench.period());
  const int every = std::max(1, steps / kSamples);
  for (int n = 0; n <= steps; ++n) {
    const double time = bench.time() - begin;
    const plant::StepperAxisObservation seen = bench.plant().observe();
    accelerating.take(time, seen.load_angle * kDegrees);
    cruising.take(time, seen.load_angle * kDegrees);
    peak_speed = std::max(peak_speed, bench.demand_speed());
    if (std::isnan(arrival) && time > 0.5 * duration && bench.ramp().at_rest()) {
      arrival = time;
    }
    if (n % every == 0) {
      values.reached(n, steps);
      const double demand = bench.demand_speed();
      const double torque = sign_of(bench.ramp().acceleration()) * inertial +
                            equations.running_torque(demand * base::kTwoPi);
      append(result.panels,
             {.time = time,
              .position = seen.shaft_revolutions - origin,
              .demand_position = bench.demand_revolutions() - demand_origin,
              .speed = seen.speed / base::kTwoPi,
              .demand_speed = demand,
              .current = bench.current_amplitude(),
              .load_angle = seen.load_angle * kDegrees,
              .expected_load_angle = demand == 0.0 ? std::nan("") : load_angle(torque)});
    }
    bench.step();
  }

  result.comparisons.push_back({"distance travelled by the shaft", "rev",
                                bench.plant().observe().shaft_revolutions - origin, distance});
  result.comparisons.push_back({"duration", "s", arrival, duration});
  result.comparisons.push_back({"highest speed of the set-point", "rev/s", peak_speed, speed});
  result.comparisons.push_back(mean_load_angle("accelerating", accelerating.value(),
                                               load_angle(inertial + half_speed_torque)));
  if (cruise > 0.0) {
    result.comparisons.push_back(
        mean_load_angle("at constant speed", cruising.value(), load_angle(full_speed_torque)));
  }
  result.remarks.push_back(
      fmt::format("{}, {:.3g} A amplitude (setting {} of {:g} A); J = {:.3g} kg m². "
                  "Deviations of load angles are parts of 90°, where the motor pulls out.",
                  bench.name(), current, run, setup.full_scale_current, equations.inertia()));
  return result;
}

}  // namespace stator::experiment
