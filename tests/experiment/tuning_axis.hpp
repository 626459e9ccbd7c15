#pragma once

#include <string>

#include "stator/devices/tmc8670/servo_stage.hpp"
#include "stator/experiment/tuning/tuner.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"

namespace stator::experiment::tuning {

/// An axis with that motor as its sheet says: friction and cogging, 4096 counts per revolution.
inline plant::PwmAxisParameters axis_with(const std::string& motor) {
  plant::PwmAxisParameters axis;
  axis.motor = *plant::find_three_phase_motor(motor);
  axis.inverter.pwm_frequency = 25e3;
  return axis;
}

inline plant::ThreePhaseMotorParameters& motor_of(plant::PwmAxisParameters& axis) {
  return std::get<plant::ThreePhaseMotorParameters>(axis.motor);
}

/// What a commissioner reads on the type plate.
inline Settings settings_for(const plant::PwmAxisParameters& axis) {
  Settings settings;
  if (const auto* motor = std::get_if<plant::ThreePhaseMotorParameters>(&axis.motor)) {
    settings.current = motor->rated_current;
  }
  return settings;
}

}  // namespace stator::experiment::tuning
