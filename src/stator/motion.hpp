#pragma once

/// @file
/// Plants and control alone, without networks and dictionaries: motors with their loads, supplies
/// and sensors (stator::plant), ramps and field-oriented control (stator::control). One gives the
/// other base::AxisActuation and gets base::AxisSensing, or those of a servo.

#include "stator/base/axis_signals.hpp"
#include "stator/base/servo_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/control/servo/servo_controller.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/plant/motors/stepper_motor.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"
