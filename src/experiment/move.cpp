#include <array>
#include <cmath>

#include <fmt/format.h>

#include "experiment/equations.hpp"
#include "experiment/measurements.hpp"
#include "experiment/module_bench.hpp"

namespace stator::experiment {

namespace {

constexpr Option number(std::string_view name, std::string_view unit, std::string_view help,
                        double minimum, double maximum, double preset) {
  return {name, unit, help, minimum, maximum, preset};
}

constexpr std::array kOptions{
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

constinit const std::span<const Option> kMoveOptions = kOptions;

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

  Panel position{"time", "s", "position", "rev", {}, {{"shaft", {}, {}}, {}}};
  position.curves[1] = {"set-point", Curve::Style::equation, {}};
  Panel velocity{"time", "s", "speed", "rev/s", {}, {{"shaft", {}, {}}, {}}};
  velocity.curves[1] = {"set-point", Curve::Style::equation, {}};
  Panel amperes{"time", "s", "current", "A", {}, {{"amplitude", {}, {}}}};
  amperes.from_zero = true;
  Panel angle{"time", "s", "load angle", "° electrical", {}, {{"measured", {}, {}}, {}}};
  angle.curves[1] = {"asin(T / (Kt I))", Curve::Style::equation, {}};

  MeanOverStretch accelerating(0.0, ramp);
  MeanOverStretch cruising(ramp, ramp + cruise);
  double arrival = std::nan("");
  double peak_speed = 0.0;
  const auto steps = static_cast<int>((duration + kAfter) / ModuleBench::period());
  const int every = std::max(1, steps / kSamples);
  for (int n = 0; n <= steps; ++n) {
    const double time = bench.time() - begin;
    const plant::StepperAxisObservation seen = bench.plant().observe();
    accelerating.take(time, seen.load_angle * kDegrees);
    cruising.take(time, seen.load_angle * kDegrees);
    peak_speed = std::max(peak_speed, bench.ramp().velocity() / 51'200.0);
    if (std::isnan(arrival) && time > 0.5 * duration && bench.ramp().at_rest()) {
      arrival = time;
    }
    if (n % every == 0) {
      const double setpoint = bench.ramp().velocity() / 51'200.0;
      const double sign = bench.ramp().acceleration() > 0.0   ? 1.0
                          : bench.ramp().acceleration() < 0.0 ? -1.0
                                                              : 0.0;
      for (Panel* panel : {&position, &velocity, &amperes, &angle}) {
        panel->x.push_back(time);
      }
      position.curves[0].values.push_back(seen.shaft_revolutions - origin);
      position.curves[1].values.push_back(bench.demand_revolutions() - demand_origin);
      velocity.curves[0].values.push_back(seen.speed / base::kTwoPi);
      velocity.curves[1].values.push_back(setpoint);
      amperes.curves[0].values.push_back(bench.current_amplitude());
      angle.curves[0].values.push_back(seen.load_angle * kDegrees);
      angle.curves[1].values.push_back(
          setpoint == 0.0
              ? std::nan("")
              : load_angle(sign * inertial + equations.running_torque(setpoint * base::kTwoPi)));
    }
    bench.step();
  }

  Result result;
  result.title = "Profile position move";
  result.comparisons.push_back({"distance travelled by the shaft", "rev",
                                bench.plant().observe().shaft_revolutions - origin, distance});
  result.comparisons.push_back({"duration", "s", arrival, duration});
  result.comparisons.push_back({"highest speed of the set-point", "rev/s", peak_speed, speed});
  result.comparisons.push_back({.quantity = "mean load angle, accelerating",
                                .unit = "°",
                                .measured = accelerating.value(),
                                .equation = load_angle(inertial + half_speed_torque),
                                .scale = 90.0});
  if (cruise > 0.0) {
    result.comparisons.push_back({.quantity = "mean load angle, at constant speed",
                                  .unit = "°",
                                  .measured = cruising.value(),
                                  .equation = load_angle(full_speed_torque),
                                  .scale = 90.0});
  }
  result.remarks.push_back(
      fmt::format("TMCM-3315, {:.3g} A amplitude (setting {} of {:g} A); J = {:.3g} kg m². "
                  "Deviations of load angles are parts of 90°, where the motor pulls out.",
                  current, run, setup.full_scale_current, equations.inertia()));
  result.panels = {position, velocity, amperes, angle};
  return result;
}

}  // namespace stator::experiment
