#include "stator/experiment/experiment.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "stator/experiment/measurements.hpp"

namespace stator::experiment {

namespace {

template <typename Range>
std::string names_of(const Range& range) {
  std::vector<std::string_view> names;
  names.reserve(range.size());
  for (const auto& item : range) {
    names.push_back(item.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

base::SimDuration microseconds(double value) {
  return base::SimDuration(std::llround(value * 1000.0));
}

std::optional<double> Choices::find(std::span<const Option> options, std::string_view name) const {
  if (const auto chosen = values_.find(name); chosen != values_.end()) {
    return chosen->second;
  }
  const auto option = std::ranges::find(options, name, &Option::name);
  return option == options.end() ? std::nullopt : option->preset;
}

Result Experiment::run(const BenchSetup& setup, const Choices& choices,
                       const Report& report) const {
  for (const auto& [chosen, value] : choices.values()) {
    const auto option = std::ranges::find(options, chosen, &Option::name);
    if (option == options.end()) {
      throw ExperimentError(
          fmt::format("{} has no option {}; it has: {}", name, chosen, names_of(options)));
    }
    if (!(value >= option->minimum && value <= option->maximum)) {
      throw ExperimentError(fmt::format("{} is {} {}; it must lie in {} .. {}", chosen, value,
                                        option->unit, option->minimum, option->maximum));
    }
  }
  return measure(setup, Values(options, choices, report));
}

std::span<const Experiment> experiments() {
  static const auto table = std::to_array<Experiment>({
      {"free-acceleration", "torque-limited start of a free shaft: speed over time",
       free_acceleration_options(), measure_free_acceleration},
      {"coast-down", "the motor let go at speed: friction alone slows it", coast_down_options(),
       measure_coast_down},
      {"pull-out", "largest load that loses no steps, over speed", pull_out_options(),
       measure_pull_out},
      {"resonance", "a step around a full step: natural frequency and damping of the rotor",
       resonance_options(), measure_resonance},
      {"stall-guard", "load measurement 2101h over load, at a constant speed",
       stall_guard_options(), measure_stall_guard},
      {"standby", "run, boost and standby current during a move, and all current settings",
       standby_options(), measure_standby},
      {"move", "a profile position move: position, velocity, current, load angle", move_options(),
       measure_move},
      {"back-emf", "a three-phase motor let go at speed: its EMF, and friction alone",
       back_emf_options(), measure_back_emf, MotorKind::three_phase},
      {"torque-speed", "torque, torque constant, efficiency and no-load speed at a voltage",
       torque_speed_options(), measure_torque_speed, MotorKind::three_phase},
      {"current-step", "a step in the current loop of a servo drive, shaft locked",
       current_step_options(), measure_current_step, MotorKind::three_phase},
      {"velocity-step", "a step in its velocity loop", velocity_step_options(),
       measure_velocity_step, MotorKind::three_phase},
      {"position-step", "a step in its position loop", position_step_options(),
       measure_position_step, MotorKind::three_phase},
      {"regeneration", "the supply while a motor brakes, with and without brake chopper",
       regeneration_options(), measure_regeneration, MotorKind::three_phase},
  });
  return table;
}

const Experiment& require_experiment(std::string_view name) {
  const auto found = std::ranges::find(experiments(), name, &Experiment::name);
  if (found == experiments().end()) {
    throw ExperimentError(
        fmt::format("there is no experiment {}; there are: {}", name, names_of(experiments())));
  }
  return *found;
}

}  // namespace stator::experiment
