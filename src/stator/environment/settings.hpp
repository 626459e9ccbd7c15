#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/environment/conditions.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::environment {

/// Which axis is controlled.
enum class PlantKind : std::uint8_t {
  servo,   ///< a three-phase motor at an inverter
  stepper  ///< a two-phase stepper motor, whose angle is known, at two bridges
};

/// What is to follow the target.
enum class Task : std::uint8_t { torque, velocity, position };

/// What the numbers of an action are, each in -1..1.
enum class ActionKind : std::uint8_t {
  current,  ///< one: the current across the magnets (q), which the drive's current loop makes
  voltage,  ///< two: the voltages along and across the magnets (d, q)
  duty      ///< one for each phase
};

/// What a servo axis is computed with; a stepper axis always with doubles.
enum class Precision : std::uint8_t { double_precision, single_precision };

/// Environments of one kind, as they are asked for. What is empty follows from motor and supply.
struct EnvironmentSettings {
  PlantKind plant = PlantKind::servo;
  Task task = Task::velocity;
  ActionKind action = ActionKind::current;
  Precision precision = Precision::double_precision;
  plant::ServoAxisParameters servo;
  plant::StepperAxisParameters stepper;
  base::SimDuration step{20'000};  ///< of plant and current loop
  int steps_per_action = 1;
  base::SimDuration episode{1'000'000'000};
  /// A target is held for a time between these two, drawn evenly.
  base::SimDuration shortest_hold{50'000'000};
  base::SimDuration longest_hold{150'000'000};

  std::optional<double> current_limit;   ///< A that an action of 1 asks for
  std::optional<double> trip_current;    ///< A beyond which the episode ends
  std::optional<double> speed_limit;     ///< rad/s beyond which it ends
  double travel_limit = 3.0;             ///< revolutions beyond which it ends; positions only
  std::optional<double> largest_target;  ///< N m, rad/s or revolutions
  std::optional<double> bandwidth;       ///< rad/s of the current loop of a servo drive
  double effort_weight = 0.01;           ///< what the mean square of an action costs
  Randomisation randomisation;
};

/// What `plant` with `task` is unless something else is asked for: a usual motor with a load of its
/// own inertia, steps, times and targets that suit the task.
[[nodiscard]] EnvironmentSettings usual_settings(PlantKind plant, Task task);

/// What follows from settings: their limits, and by what observations and actions are divided.
struct Scales {
  double current = 1.0;          ///< A of an action of 1
  double trip_current = 1.0;     ///< A
  double speed_limit = 1.0;      ///< rad/s
  double travel_limit = 1.0;     ///< revolutions
  double largest_target = 1.0;   ///< N m, rad/s or revolutions
  double voltage = 1.0;          ///< V of an action of 1
  double supply_voltage = 1.0;   ///< V, nominal
  double torque_constant = 1.0;  ///< N m/A, nominal
  double rated_torque = 1.0;     ///< N m
  double rated_speed = 1.0;      ///< rad/s
};

[[nodiscard]] Scales scales_of(const EnvironmentSettings& settings);

/// What holds if nothing is drawn; the target is 0.
[[nodiscard]] Conditions nominal_conditions(const EnvironmentSettings& settings);

}  // namespace stator::environment
