#include "stator/environment/task.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stator::environment {

namespace {

constexpr std::array<std::string_view, 7> kTorqueNames{
    "target_torque", "direct_current", "quadrature_current", "speed",
    "sine",          "cosine",         "supply_voltage"};
constexpr std::array<std::string_view, 6> kVelocityNames{
    "target_speed", "speed", "quadrature_current", "sine", "cosine", "supply_voltage"};
constexpr std::array<std::string_view, 7> kPositionNames{"position_error",     "position", "speed",
                                                         "quadrature_current", "sine",     "cosine",
                                                         "supply_voltage"};

constexpr std::array<std::string_view, 1> kCurrentNames{"quadrature_current"};
constexpr std::array<std::string_view, 2> kVoltageNames{"direct_voltage", "quadrature_voltage"};
constexpr std::array<std::string_view, 3> kPhaseNames{"duty_u", "duty_v", "duty_w"};
constexpr std::array<std::string_view, 2> kCoilNames{"duty_a", "duty_b"};

float cut(double x) {
  return static_cast<float>(std::clamp(x, -1.0, 1.0));
}

}  // namespace

std::span<const std::string_view> observation_names(Task task) {
  switch (task) {
    case Task::torque:
      return kTorqueNames;
    case Task::velocity:
      return kVelocityNames;
    case Task::position:
      break;
  }
  return kPositionNames;
}

std::span<const std::string_view> action_names(PlantKind plant, ActionKind action) {
  switch (action) {
    case ActionKind::current:
      return kCurrentNames;
    case ActionKind::voltage:
      return kVoltageNames;
    case ActionKind::duty:
      break;
  }
  if (plant == PlantKind::servo) {
    return kPhaseNames;
  }
  return kCoilNames;
}

Judge::Judge(const EnvironmentSettings& settings, const Scales& scales)
    : task_(settings.task),
      scales_(scales),
      effort_weight_(settings.effort_weight),
      per_current_(1.0 / scales.trip_current),
      per_torque_(1.0 / (scales.torque_constant * scales.trip_current)),
      per_speed_(1.0 / scales.speed_limit),
      per_revolution_(1.0 / scales.travel_limit),
      per_supply_voltage_(1.0 / scales.supply_voltage),
      per_error_(0.5 / scales.largest_target),
      square_trip_current_(scales.trip_current * scales.trip_current) {}

void Judge::observe(const Reading& reading, double target, std::span<float> observation) const {
  const float speed = cut(reading.speed * per_speed_);
  const float current = cut(reading.quadrature_current * per_current_);
  float* next = observation.data();
  switch (task_) {
    case Task::torque:
      *next++ = cut(target * per_torque_);
      *next++ = cut(reading.direct_current * per_current_);
      *next++ = current;
      *next++ = speed;
      break;
    case Task::velocity:
      *next++ = cut(target * per_speed_);
      *next++ = speed;
      *next++ = current;
      break;
    case Task::position:
      *next++ = cut((target - reading.revolutions) * per_error_);
      *next++ = cut(reading.revolutions * per_revolution_);
      *next++ = speed;
      *next++ = current;
      break;
  }
  *next++ = cut(reading.sine);
  *next++ = cut(reading.cosine);
  *next = cut(reading.supply_voltage * per_supply_voltage_ - 1.0);
}

double Judge::error(const Reading& reading, double target) const {
  switch (task_) {
    case Task::torque:
      // Current along the magnets is as wrong as the same current too much across them.
      return std::fabs(target - scales_.torque_constant * reading.quadrature_current) +
             scales_.torque_constant * std::fabs(reading.direct_current);
    case Task::velocity:
      return std::fabs(target - reading.speed);
    case Task::position:
      break;
  }
  return std::fabs(target - reading.revolutions);
}

double Judge::reward(const Reading& reading, double target, std::span<const float> action) const {
  double square = 0.0;
  for (const float number : action) {
    square += static_cast<double>(number) * static_cast<double>(number);
  }
  const double effort = square / static_cast<double>(action.size());
  return std::max(1.0 - error(reading, target) * per_error_, 0.0) - effort_weight_ * effort;
}

bool Judge::ends(const Reading& reading) const {
  const double square = reading.direct_current * reading.direct_current +
                        reading.quadrature_current * reading.quadrature_current;
  return square > square_trip_current_ || std::fabs(reading.speed) > scales_.speed_limit ||
         (task_ == Task::position && std::fabs(reading.revolutions) > scales_.travel_limit);
}

}  // namespace stator::environment
