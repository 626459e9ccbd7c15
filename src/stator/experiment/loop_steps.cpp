// Step responses of current, velocity and position loop of a servo drive, compared with a linear
// model of the cascade.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "stator/control/servo/servo_controller.hpp"
#include "stator/experiment/measurements.hpp"
#include "stator/experiment/servo_bench.hpp"
#include "stator/experiment/servo_equations.hpp"

namespace stator::experiment {

namespace {

constexpr double kRpm = base::kPi / 30.0;
constexpr double kPeriod = 50e-6;  // s
constexpr int kSamples = 400;
constexpr std::array kParts{0.05, 0.1, 0.2, 0.35, 0.6, 1.0};  ///< of the time shown

constexpr Option gain(std::string_view name, std::string_view help, double preset) {
  return {.name = name,
          .unit = "",
          .help = help,
          .minimum = 0.0,
          .maximum = 65'535.0,
          .preset = preset};
}
constexpr Option kTorqueP = gain("current-p", "P of the current controller, V/A / 256", 500.0);
constexpr Option kTorqueI = gain("current-i", "I of it, V/A and period / 65536", 500.0);
constexpr Option kVelocityP = gain("velocity-p", "P of the velocity controller", 500.0);
constexpr Option kVelocityI = gain("velocity-i", "I of it", 500.0);
constexpr Option kPositionP = gain("position-p", "P of the position controller", 300.0);
constexpr Option kEncoder{.name = "encoder",
                          .unit = "",
                          .help = "Counts per revolution; the linear model has no steps",
                          .minimum = 100.0,
                          .maximum = 65'535.0,
                          .preset = 40'000.0};
constexpr Option kDuration{.name = "duration",
                           .unit = "ms",
                           .help = "How long to look",
                           .minimum = 0.5,
                           .maximum = 10'000.0,
                           .preset = {}};
constexpr Option kCurrentStep{.name = "step",
                              .unit = "A",
                              .help = "Height of the step; else 60 % of the rated current",
                              .minimum = 0.01,
                              .maximum = 100.0,
                              .preset = {}};
constexpr Option kVelocityStep{.name = "step",
                               .unit = "rpm",
                               .help = "Height of the step",
                               .minimum = 1.0,
                               .maximum = 10'000.0,
                               .preset = 400.0};
constexpr Option kPositionStep{.name = "step",
                               .unit = "rev",
                               .help = "Height of the step",
                               .minimum = 0.01,
                               .maximum = 100.0,
                               .preset = 0.125};
constexpr std::array kCurrentOptions{kCurrentStep, kTorqueP, kTorqueI, kDuration};
constexpr std::array kVelocityOptions{kVelocityStep, kTorqueP, kTorqueI, kVelocityP,
                                      kVelocityI,    kEncoder, kDuration};
constexpr std::array kPositionOptions{kPositionStep, kTorqueP,   kTorqueI, kVelocityP,
                                      kVelocityI,    kPositionP, kEncoder, kDuration};

/// One loop of the cascade and what of it is looked at.
struct Loop {
  control::ServoLoop loop;
  const char* quantity;
  const char* unit;
  double unit_in_si;  ///< A, rad/s or rad
  double step;        ///< in that unit
  double duration;    ///< s
};

std::uint16_t chosen(const Values& values, std::string_view name, std::uint16_t otherwise) {
  return values.contains(name) ? static_cast<std::uint16_t>(std::lround(values[name])) : otherwise;
}

control::ServoControllerSettings gains_of(const Values& values,
                                          const plant::ServoAxisParameters& axis) {
  control::ServoControllerSettings gains;
  gains.pole_pairs = static_cast<std::uint8_t>(axis.motor.pole_pairs);
  gains.commutation = control::ServoCommutation::encoder;
  gains.encoder_steps = static_cast<std::uint16_t>(axis.encoder.counts_per_revolution);
  gains.torque_p = chosen(values, "current-p", gains.torque_p);
  gains.torque_i = chosen(values, "current-i", gains.torque_i);
  gains.velocity_p = chosen(values, "velocity-p", gains.velocity_p);
  gains.velocity_i = chosen(values, "velocity-i", gains.velocity_i);
  gains.position_p = chosen(values, "position-p", gains.position_p);
  // The linear model has no limits.
  gains.maximum_torque = 1'000'000;
  gains.maximum_velocity = 1'000'000;
  gains.i2t_time_constant = 0;
  return gains;
}

/// The axis as the linear model has it: no dry friction, no cogging; locked for the current loop.
plant::ServoAxisParameters linear_axis(const BenchSetup& setup, const Values& values, bool locked) {
  plant::ServoAxisParameters axis = uncoupled(setup.servo);
  axis.motor.cogging = {};
  axis.motor.coulomb_friction = 0.0;
  axis.motor.static_friction = 0.0;
  axis.load.coulomb_friction = locked ? 1e3 : 0.0;
  axis.load.constant_torque = 0.0;
  axis.halls = {};
  axis.encoder = {.counts_per_revolution =
                      values.contains("encoder") ? std::lround(values["encoder"]) : 40'000};
  return axis;
}

control::ServoSetPoint set_point_of(const Loop& loop, std::int64_t encoder_steps) {
  control::ServoSetPoint set_point;
  set_point.loop = loop.loop;
  switch (loop.loop) {
    case control::ServoLoop::torque:
      set_point.torque = loop.step;
      break;
    case control::ServoLoop::velocity:
      set_point.velocity = loop.step;
      break;
    default:
      set_point.position.microsteps = std::llround(loop.step * static_cast<double>(encoder_steps));
  }
  return set_point;
}

double measured(const Loop& loop, const plant::ServoAxis& axis) {
  const plant::ServoAxisObservation seen = axis.observe();
  switch (loop.loop) {
    case control::ServoLoop::torque:
      return seen.quadrature_current;
    case control::ServoLoop::velocity:
      return seen.speed / loop.unit_in_si;
    default:
      return seen.shaft_revolutions;
  }
}

double expected(const Loop& loop, const LinearServo& linear) {
  switch (loop.loop) {
    case control::ServoLoop::torque:
      return linear.current();
    case control::ServoLoop::velocity:
      return linear.speed() / loop.unit_in_si;
    default:
      return linear.angle() / loop.unit_in_si;
  }
}

Result measure_loop(const BenchSetup& setup, const Values& values, const Loop& loop) {
  const bool locked = loop.loop == control::ServoLoop::torque;
  const plant::ServoAxisParameters axis = linear_axis(setup, values, locked);
  const control::ServoControllerSettings gains = gains_of(values, axis);
  LinearServo linear(ServoEquations(axis), axis.motor, gains, locked);
  plant::ServoAxis plant(axis);
  control::ServoController controller;
  controller.configure(gains);
  const control::ServoSetPoint set_point = set_point_of(loop, axis.encoder.counts_per_revolution);

  Result result;
  result.title =
      fmt::format("A step of {:.4g} {} in the {} loop", loop.step, loop.unit, loop.quantity);
  Panel panel{"time", "ms", loop.quantity, loop.unit, {}, {{}, {}}};
  panel.curves = {{"measured", Curve::Style::measured_line, {}},
                  {"linear model", Curve::Style::equation, {}}};
  panel.from_zero = true;
  const auto periods = static_cast<int>(std::lround(loop.duration / kPeriod));
  const int every = std::max(1, periods / kSamples);
  std::array<double, 2> highest{};
  Comparison furthest{.quantity = "where they differ most",
                      .unit = loop.unit,
                      .measured = 0.0,
                      .equation = 0.0,
                      .scale = loop.step};
  std::size_t part = 0;
  bool limited = false;
  for (int n = 0; n <= periods; ++n) {
    const double seen = measured(loop, plant);
    const double should = expected(loop, linear);
    highest = {std::max(highest[0], seen), std::max(highest[1], should)};
    if (std::fabs(seen - should) > std::fabs(furthest.measured - furthest.equation)) {
      furthest.measured = seen;
      furthest.equation = should;
    }
    if (part < kParts.size() && n >= kParts[part] * periods) {
      result.comparisons.push_back(
          {.quantity = fmt::format("{} after {:.4g} ms", loop.quantity, n * kPeriod * 1e3),
           .unit = loop.unit,
           .measured = seen,
           .equation = should,
           .scale = loop.step});
      ++part;
    }
    if (n % every == 0) {
      values.reached(n, periods);
      panel.x.push_back(n * kPeriod * 1e3);
      panel.curves[0].values.push_back(seen);
      panel.curves[1].values.push_back(should);
    }
    plant.step(controller.step(set_point, plant.sensing()), control::ServoController::kPeriod);
    linear.step({.loop = loop.loop, .value = loop.step * loop.unit_in_si});
    limited = limited || controller.voltage_limited();
  }
  if (limited) {
    throw ExperimentError(fmt::format(
        "{}-step: the supply does not give the voltage this step asks for, so nothing is linear; "
        "choose a lower --step, lower gains or a higher --supply",
        loop.quantity));
  }
  result.comparisons.push_back({.quantity = fmt::format("highest {}", loop.quantity),
                                .unit = loop.unit,
                                .measured = highest[0],
                                .equation = highest[1],
                                .scale = loop.step});
  result.comparisons.push_back(furthest);
  result.remarks.push_back(fmt::format(
      "Gains: current {} and {}, velocity {} and {}, position {}. R = {:.3g} Ω, L = {:.3g} H, J = "
      "{:.3g} kg m²; dry friction and cogging are left out, as in the linear model.",
      gains.torque_p, gains.torque_i, gains.velocity_p, gains.velocity_i, gains.position_p,
      ServoEquations(axis).resistance(), axis.motor.quadrature_inductance,
      ServoEquations(axis).inertia()));
  result.panels = {panel};
  return result;
}

}  // namespace

std::span<const Option> current_step_options() {
  return kCurrentOptions;
}

Result measure_current_step(const BenchSetup& setup, const Values& values) {
  return measure_loop(setup, values,
                      {.loop = control::ServoLoop::torque,
                       .quantity = "current",
                       .unit = "A",
                       .unit_in_si = 1.0,
                       .step = values.value_or("step", 0.6 * setup.servo.motor.rated_current),
                       .duration = 1e-3 * values.value_or("duration", 20.0)});
}

std::span<const Option> velocity_step_options() {
  return kVelocityOptions;
}

Result measure_velocity_step(const BenchSetup& setup, const Values& values) {
  return measure_loop(setup, values,
                      {.loop = control::ServoLoop::velocity,
                       .quantity = "velocity",
                       .unit = "rpm",
                       .unit_in_si = kRpm,
                       .step = values["step"],
                       .duration = 1e-3 * values.value_or("duration", 200.0)});
}

std::span<const Option> position_step_options() {
  return kPositionOptions;
}

Result measure_position_step(const BenchSetup& setup, const Values& values) {
  return measure_loop(setup, values,
                      {.loop = control::ServoLoop::position,
                       .quantity = "position",
                       .unit = "rev",
                       .unit_in_si = base::kTwoPi,
                       .step = values["step"],
                       .duration = 1e-3 * values.value_or("duration", 200.0)});
}

}  // namespace stator::experiment
