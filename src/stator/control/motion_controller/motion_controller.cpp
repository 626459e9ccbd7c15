#include "stator/control/motion_controller/motion_controller.hpp"

#include <algorithm>

#include "stator/control/motion_controller/motion_controller_units.hpp"
#include "stator/control/rounding.hpp"

namespace stator::control::motion_controller {

namespace {

constexpr std::uint8_t kFullCurrent = 15;
constexpr std::uint16_t kLongestDelay = 4095;

std::int32_t wrapped_difference(std::int32_t from, std::int32_t to) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(to) -
                                   static_cast<std::uint32_t>(from));
}

}  // namespace

MotionController::MotionController() {
  const Settings settings;
  configure(settings);
  set_encoder_mode(settings.encoder.mode);
  set_microstep_resolution(1);
  current_scale_ = settings.current.run;
}

void MotionController::configure(const Settings& settings) {
  const bool new_encoder_mode = settings.encoder.mode != settings_.encoder.mode;
  const bool new_ramp = settings.ramp != settings_.ramp || settings.limits != settings_.limits ||
                        settings.switches.mode != settings_.switches.mode;
  settings_ = settings;
  if (new_ramp) {
    ramp_.configure(settings.ramp, settings.limits,
                    (settings.switches.mode & switch_mode::kSoftStop) != 0);
  }
  switches_.configure(settings.switches);
  encoder_.set_constant(settings.encoder.constant);
  if (new_encoder_mode) {
    encoder_.set_mode(settings.encoder.mode);
  }
  regulator_.configure(settings.regulator);
  step_direction_.pulse_length = settings.step_pulse_length * kStepPulseUnitPicoseconds;
}

void MotionController::set_encoder_mode(std::uint32_t mode) {
  settings_.encoder.mode = mode;
  encoder_.set_mode(mode);
}

void MotionController::set_microstep_resolution(std::uint8_t index) {
  table_.load(index, settings_.sine_offset);
}

void MotionController::begin_motion() {
  stopped_by_deviation_ = false;
  regulator_.pause(false);
}

void MotionController::move_to(std::int32_t target) {
  begin_motion();
  ramp_.move_to(target);
}

void MotionController::rotate(std::int32_t velocity) {
  begin_motion();
  ramp_.rotate(velocity);
}

void MotionController::set_target_velocity(std::int32_t velocity) {
  begin_motion();
  ramp_.set_target_velocity(velocity);
}

void MotionController::set_mode(Mode mode) {
  begin_motion();
  ramp_.set_mode(mode);
}

void MotionController::stop_undriven() {
  if (mode() != Mode::velocity || target_velocity() != 0 || !at_rest()) {
    ramp_.stop_at_once();
  }
  regulator_.pause(true);
}

void MotionController::set_position(std::int32_t position) {
  ramp_.set_position(position);
}

void MotionController::set_reference(std::int32_t position) {
  ramp_.stop_at_once();
  ramp_.set_position(position);
  ramp_.set_idle_target(position);
  encoder_.set_position(position);
}

void MotionController::ignore_stops(bool ignore) {
  stops_ignored_ = ignore;
  ramp_.ignore_limits(ignore);
}

void MotionController::advance(const base::AxisSensing& sensing, base::SimDuration period) {
  observe(sensing);
  supervise();
  regulator_.advance(wrapped_difference(position(), encoder_position()), period);
  ramp_.advance(stops_ignored_ ? StopConditions{} : switches_.stops(), period);
  move_sequencer(period);
  const CurrentSettings& current = settings_.current;
  moving_ = ramp_.generator().velocity() != 0.0 || regulator_.result() != 0;
  current_scale_ = current_selector_.advance(
      {.run = std::min(current.run, kFullCurrent),
       .standby = std::min(current.standby, kFullCurrent),
       .standby_delay = kStandbyUnit * std::min(current.standby_delay, kLongestDelay)},
      moving_ ? RampPhase::constant_velocity : RampPhase::standstill, period);
}

/// Takes in the sensors, all of one moment.
void MotionController::observe(const base::AxisSensing& sensing) {
  observed_travel_ = travel();
  encoder_.sample(sensing);
  settings_.encoder.mode = encoder_.mode();
  if (switches_.sample(sensing.left_switch, sensing.right_switch)) {
    latched_position_ = position();
    if (switches_.latches_encoder()) {
      encoder_.latch();
    }
  }
}

/// Motor to encoder, without a sign.
std::int64_t MotionController::deviation() const {
  const std::int64_t difference = wrapped_difference(position(), encoder_position());
  return difference < 0 ? -difference : difference;
}

void MotionController::supervise() {
  const EncoderSettings& encoder = settings_.encoder;
  const std::int64_t distance = deviation();
  encoder_warning_ = encoder.warn_distance > 0 && distance > encoder.warn_distance;
  // A motor that stands cannot be stopped: turning it by hand is no error.
  const bool moves = moving_ || !ramp_.at_rest();
  if (encoder.maximum_deviation == 0 || distance <= encoder.maximum_deviation || !moves ||
      stopped_by_deviation_) {
    return;
  }
  ramp_.stop_at_once();
  regulator_.pause(true);
  stopped_by_deviation_ = true;
  deviation_flag_ = true;
}

std::uint32_t MotionController::read_error_flags() {
  const std::uint32_t value = error_flags();
  deviation_flag_ = false;
  return value;
}

std::uint32_t MotionController::status_flags() const {
  return (position_reached() ? 1U : 0U) | (velocity_reached() ? 2U : 0U) |
         (velocity() == 0 ? 4U : 0U) | (encoder_warning_ ? 8U : 0U);
}

std::int32_t MotionController::pid_velocity() const {
  return saturated(std::int64_t{velocity()} + regulator_.result());
}

/// Ramp and correction together, in whole microsteps since power-on.
std::int64_t MotionController::sequencer_target() const {
  constexpr int kBits = PositionRegulator::kCorrectionBits;
  constexpr std::int64_t kMask = (std::int64_t{1} << kBits) - 1;
  const RampGenerator& ramp = ramp_.generator();
  const std::int64_t correction = regulator_.correction();
  const auto fraction =
      static_cast<std::int64_t>(ramp.position().fraction * static_cast<double>(kMask + 1));
  return ramp.motor_microsteps() + (correction >> kBits) +
         ((fraction + (correction & kMask)) >> kBits);
}

void MotionController::move_sequencer(base::SimDuration period) {
  const std::int64_t target = sequencer_target();
  const std::int64_t steps = target - microsteps_;
  step_direction_.merged = false;
  if (steps == 0) {
    return;
  }
  microsteps_ = target;
  const std::int64_t turned = settings_.shaft ? -steps : steps;
  const std::int64_t before = table_.travel();
  table_.advance(turned);
  full_step_pulses_ += full_steps_met(before, table_.travel());
  const std::int64_t count = steps < 0 ? -steps : steps;
  step_direction_.pulses += count;
  step_direction_.forward = turned > 0;
  step_direction_.merged = count * step_direction_.pulse_length >= period.nanoseconds() * 1000;
}

}  // namespace stator::control::motion_controller
