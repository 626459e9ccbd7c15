#include "stator/experiment/tuning/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "stator/base/trigonometry.hpp"
#include "stator/experiment/tuning/step_response.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::Field;
using control::foc::field;
using Response = std::complex<double>;

constexpr std::int32_t kVelocityMode = 2;
constexpr double kRpm = base::kTwoPi / 60.0;  // rad/s

/// Where a loop takes its target and shows its actual value, in steps of those registers.
struct Loop {
  Field target;
  Field actual;
  double offset = 0.0;
  double supply = 0.0;  ///< V above which what braking returns is burnt; 0: never
  std::function<double(double frequency)> amplitude;
};

/// A sine that fits whole numbers of times into a window of PWM periods.
struct Sine {
  int window;
  int cycles;
  [[nodiscard]] double frequency(double period) const { return cycles / (window * period); }
};

Sine sine_near(double frequency, double period) {
  constexpr double kLeastCycles = 8.0;
  constexpr double kLeastTime = 0.1;  // s
  const double time = std::max(kLeastTime, kLeastCycles / frequency);
  const double cycles = std::round(time * frequency);
  return {static_cast<int>(std::lround(cycles / (frequency * period))), static_cast<int>(cycles)};
}

Response measure(Chip& chip, const Loop& loop, const Sine& sine, int settle) {
  const double amplitude = loop.amplitude(sine.frequency(chip.period()));
  Response target;
  Response actual;
  for (int k = -settle; k < sine.window; ++k) {
    // Reduced first: an angle of thousands of turns would lose digits.
    const auto phase = (static_cast<std::int64_t>(k) * sine.cycles) % sine.window;
    const base::SineCosine z =
        base::sine_cosine(base::kTwoPi * static_cast<double>(phase) / sine.window);
    const auto wanted = std::lround(loop.offset + amplitude * z.sine);
    chip.set(loop.target, wanted);
    if (loop.supply > 0.0) {
      step_burning(chip, loop.supply);
    } else {
      chip.step();
    }
    if (k >= 0) {
      const Response turn(z.cosine, -z.sine);
      target += static_cast<double>(wanted) * turn;
      actual += static_cast<double>(chip.get(loop.actual)) * turn;
    }
  }
  return actual / target;
}

/// The highest frequency at which `of` crosses `level` downwards, straight over the logarithms: the
/// spring that a holding current makes of the rotor may dent the response far below.
template <typename Of>
double crossing(const std::vector<double>& frequency, const std::vector<Response>& responses,
                double level, const Of& of) {
  for (std::size_t n = responses.size() - 1; n > 0; --n) {
    const double before = of(responses[n - 1]);
    const double now = of(responses[n]);
    if (before >= level && now < level) {
      const double share = std::log(before / level) / std::log(before / now);
      return frequency[n - 1] * std::pow(frequency[n] / frequency[n - 1], share);
    }
  }
  return 0.0;
}

/// Degrees left to 180 where the open loop T / (1 - T) has the gain 1.
double phase_margin(const std::vector<double>& frequency, const std::vector<Response>& closed) {
  std::vector<Response> open;
  open.reserve(closed.size());
  for (const Response& response : closed) {
    open.push_back(response / (1.0 - response));
  }
  const double at = crossing(frequency, open, 1.0, [](const Response& r) { return std::abs(r); });
  if (at == 0.0) {
    return 0.0;
  }
  const auto above =
      static_cast<std::size_t>(std::ranges::lower_bound(frequency, at) - frequency.begin());
  const double share =
      std::log(at / frequency[above - 1]) / std::log(frequency[above] / frequency[above - 1]);
  const double first = std::arg(open[above - 1]);
  const double second = std::arg(open[above]);
  const double step = std::remainder(second - first, base::kTwoPi);
  return 180.0 + std::remainder(first + share * step, base::kTwoPi) * 180.0 / base::kPi;
}

BodePlot measure_response(Chip& chip, const Loop& loop, const LoopModel& model, double wanted,
                          Response (LoopModel::*expected)(double) const) {
  constexpr int kPoints = 34;
  constexpr double kSettle = 0.06;  // s
  const double first = wanted / 20.0;
  const double last = std::min(4.0 * wanted, 0.4 / chip.period());
  BodePlot plot;
  plot.wanted = wanted;
  const int settle = chip.periods(std::max(kSettle, 1.5 / wanted));
  for (int n = 0; n < kPoints; ++n) {
    const Sine sine = sine_near(first * std::pow(last / first, n / (kPoints - 1.0)), chip.period());
    const double frequency = sine.frequency(chip.period());
    plot.frequency.push_back(frequency);
    plot.measured.push_back(measure(chip, loop, sine, settle));
    plot.model.push_back((model.*expected)(frequency));
  }
  chip.set(loop.target, std::lround(loop.offset));
  plot.bandwidth = crossing(plot.frequency, plot.measured, std::sqrt(0.5),
                            [](const Response& r) { return std::abs(r); });
  plot.phase_margin = phase_margin(plot.frequency, plot.measured);
  return plot;
}

}  // namespace

BodePlot measure_current_response(Chip& chip, const LoopDesign& design) {
  constexpr double kShare = 0.15;  // of the current
  const double amplitude = kShare * chip.settings().current / chip.ampere();
  const Loop loop{.target = field("PID_TORQUE_TARGET"),
                  .actual = field("PID_TORQUE_ACTUAL"),
                  .amplitude = [amplitude](double) { return amplitude; }};
  hold_along_phase(chip, design);
  BodePlot plot =
      measure_response(chip, loop, design.model, design.wanted_current, &LoopModel::locked_current);
  release(chip, design);
  return plot;
}

BodePlot measure_velocity_response(Chip& chip, const LoopDesign& design,
                                   const Mechanics& mechanics) {
  constexpr double kShare = 0.4;                      // of the current
  const double bias = mechanics.highest_speed / 3.0;  // rad/s
  const double torque = kShare * chip.settings().current * mechanics.torque_constant;
  const Loop loop{.target = field("PID_VELOCITY_TARGET"),
                  .actual = field("PID_VELOCITY_ACTUAL"),
                  .offset = bias / kRpm,
                  .supply = design.supply,
                  .amplitude = [&](double frequency) {
                    // What the current can accelerate in the loop, and what the controller asks
                    // for.
                    const double angular = base::kTwoPi * frequency;
                    const double speed =
                        std::min({0.5 * bias, torque / (mechanics.inertia.value * angular),
                                  kShare * chip.settings().current / design.model.velocity_gain});
                    return std::max(speed / kRpm, 3.0);
                  }};
  settle_supply(chip, design.supply);
  chip.set(loop.target, 0);
  chip.close_loop(kVelocityMode);
  change_velocity(chip, mechanics, design.supply,
                  static_cast<std::int32_t>(std::lround(loop.offset)));
  BodePlot plot =
      measure_response(chip, loop, design.model, design.wanted_velocity, &LoopModel::velocity);
  change_velocity(chip, mechanics, design.supply, 0);
  return plot;
}

}  // namespace stator::experiment::tuning
