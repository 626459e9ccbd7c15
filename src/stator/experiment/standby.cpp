// The experiment standby: run, boost and standby current of a TMCM-3315 axis during a move.
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "stator/experiment/measurements.hpp"
#include "stator/experiment/module_bench.hpp"

namespace stator::experiment {

namespace {

constexpr Option setting(std::string_view name, std::string_view help, double preset) {
  return {.name = name, .unit = "", .help = help, .minimum = 0, .maximum = 255, .preset = preset};
}

constexpr std::array kStandbyOptions{
    setting("run", "Run current, 2003h", 128.0),
    setting("boost", "Boost current, 204Eh; 0 = none", 200.0),
    setting("standby", "Standby current, 2004h", 40.0),
    Option{.name = "delay",
           .unit = "ms",
           .help = "Standstill before standby current, 2089h",
           .minimum = 0.0,
           .maximum = 10000.0,
           .preset = 200.0},
};

constexpr std::int8_t kProfilePosition = 1;
constexpr double kDistance = 4.0;       // rev
constexpr double kSpeed = 4.0;          // rev/s
constexpr double kAcceleration = 16.0;  // rev/s²: 0.25 s up, 0.75 s at speed, 0.25 s down
constexpr double kBefore = 0.1;         // s under current before the move
constexpr double kAfter = 0.6;          // s after delay and move
constexpr std::array<std::uint16_t, 2> kStandingCurrents{0x2003, 0x2004};  // run, standby
constexpr int kSampleEvery = 100;                                          // steps: 5 ms

/// A stretch of the move in which the current ought to be constant.
struct Stretch {
  const char* name = "";
  double from = 0.0;  ///< s
  double to = 0.0;
  double expected = 0.0;  ///< A
  double sum = 0.0;
  int samples = 0;
};

/// Standing current at every eighth setting: the 32 scales of the driver.
Panel all_settings(const BenchSetup& setup, const Values& values, Result& result) {
  Panel panel{"setting", "0…255", "standing current", "A", {}, {{"measured", {}, {}}, {}}};
  panel.from_zero = true;
  panel.curves[0].style = Curve::Style::measured_points;
  panel.curves[1] = {"(⌊s/8⌋ + 1) / 32 of full scale", Curve::Style::equation, {}};
  ModuleBench bench(setup);
  bench.enable(kProfilePosition);
  constexpr double kSettling = 0.05;  // s
  for (int value = 0; value <= 255; ++value) {
    values.reached(value, 256);
    panel.x.push_back(value);
    panel.curves[1].values.push_back(current_of_setting(value, setup.full_scale_current));
    for (const std::uint16_t index : kStandingCurrents) {
      bench.write<std::uint8_t>(index, static_cast<std::uint8_t>(value));
    }
    bench.run(kSettling);
    panel.curves[0].values.push_back(bench.current_amplitude());
    if (value % 64 == 63 || value == 0) {
      result.comparisons.push_back({fmt::format("standing current at setting {}", value), "A",
                                    panel.curves[0].values.back(), panel.curves[1].values.back()});
    }
  }
  return panel;
}

}  // namespace

std::span<const Option> standby_options() {
  return kStandbyOptions;
}

Result measure_standby(const BenchSetup& setup, const Values& values) {
  ModuleBench bench(setup);
  const int run = static_cast<int>(values["run"]);
  const int boost = static_cast<int>(values["boost"]);
  const int standby = static_cast<int>(values["standby"]);
  const double delay = 0.01 * static_cast<int>(values["delay"] / 10.0);
  bench.write<std::uint8_t>(0x2003, static_cast<std::uint8_t>(run));
  bench.write<std::uint8_t>(0x204E, static_cast<std::uint8_t>(boost));
  bench.write<std::uint8_t>(0x2004, static_cast<std::uint8_t>(standby));
  bench.write<std::uint16_t>(0x2089, static_cast<std::uint16_t>(std::lround(delay * 100.0)));
  bench.enable(kProfilePosition);
  bench.run(kBefore);

  const auto amplitude = [&](int value) {
    return current_of_setting(value, setup.full_scale_current);
  };
  const double begin = bench.time();
  const double ramp = kSpeed / kAcceleration;
  const double cruise = begin + ramp;
  const double braking = begin + kDistance / kSpeed;
  const double end = braking + ramp;
  const double low = end + delay;
  const int changing = boost > 0 ? boost : run;
  std::array stretches{
      Stretch{"accelerating", begin, cruise, amplitude(changing)},
      Stretch{"at constant speed", cruise, braking, amplitude(run)},
      Stretch{"braking", braking, end, amplitude(changing)},
      Stretch{"standing, before the delay ends", end, low, amplitude(run)},
      Stretch{"standing, after it", low, low + kAfter, amplitude(standby)},
  };

  Panel current{"time", "s", "current", "A", {}, {{"measured", {}, {}}, {}}};
  current.from_zero = true;
  current.curves[1] = {"settings", Curve::Style::equation, {}};
  Panel speed{"time", "s", "shaft speed", "rev/s", {}, {{"measured", {}, {}}}};
  bench.start_move(kDistance, kSpeed, kAcceleration);
  constexpr double kMargin = 0.02;  // s left out at the ends of a stretch
  for (int n = 0; bench.time() < low + kAfter; ++n) {
    const double now = bench.time();
    const double seen = bench.current_amplitude();
    double expected = 0.0;
    for (Stretch& stretch : stretches) {
      expected = now >= stretch.from ? stretch.expected : expected;
      if (now >= stretch.from + kMargin && now < stretch.to - kMargin) {
        stretch.sum += seen;
        ++stretch.samples;
      }
    }
    if (n % kSampleEvery == 0) {
      current.x.push_back(now - begin);
      current.curves[0].values.push_back(seen);
      current.curves[1].values.push_back(expected);
      speed.x.push_back(now - begin);
      speed.curves[0].values.push_back(bench.plant().observe().speed / base::kTwoPi);
    }
    bench.step();
  }

  Result result;
  result.title = "Run, boost and standby current during a move";
  for (const Stretch& stretch : stretches) {
    if (stretch.samples > 0) {
      result.comparisons.push_back({fmt::format("current {}", stretch.name), "A",
                                    stretch.sum / stretch.samples, stretch.expected});
    }
  }
  result.panels = {speed, current};
  result.panels.push_back(all_settings(setup, values, result));
  result.remarks.push_back(
      fmt::format("{} with {:g} A full scale: run {}, boost {}, standby {} after {:g} s.",
                  bench.name(), setup.full_scale_current, run, boost, standby, delay));
  return result;
}

}  // namespace stator::experiment
