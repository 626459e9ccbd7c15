#include "stator/control/servo/servo_controller.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stator/control/rounding.hpp"

namespace stator::control {

namespace {

constexpr double kPeriodsPerMinute = 1'200'000.0;
constexpr double kMillivolt = 1e-3;
constexpr double kMilliamperes = 1e3;             // per ampere
constexpr double kPiUnit = 65536.0;               // outputs of PI controllers carry 16 bits
constexpr double kVelocityUnit = 256.0;           // the velocity error carries 8 bits
constexpr double kPositionGainUnit = 4.0;         // rpm per revolution: u = 1, P = 300: 20 1/s
constexpr double kDelay = 1.5;                    // periods from sampling to the middle of holding
constexpr double kSmoothing = 0.25;               // of a millisecond in 4 ms
constexpr double kInterpolationThreshold = 60.0;  // rpm
constexpr double kVelocityBand = 0.2;             // of the limit, in which torque is taken back
constexpr double kLeastVelocityBand = 50.0;       // rpm
constexpr double kLeastSupply = 1.0;              // V, below it there is nothing to control
constexpr double kLargestCurrent = 1e6;           // A, of a set-point; keeps conversions in range
constexpr double kTurning = 60.0;                 // rpm from which a motor has to be caught
constexpr int kCatchingPeriods = 2;               // outer ones: 2 ms
constexpr unsigned kCatchingIntegral = 32;        // of P: an integral time of 8 periods

std::int32_t of_milliampere(std::uint32_t value) {
  return static_cast<std::int32_t>(std::min<std::uint32_t>(value, 1'000'000));
}

ElectricalAngle times_one_and_a_half(ElectricalAngle angle) {
  return {angle.value + static_cast<std::uint32_t>(static_cast<std::int32_t>(angle.value) / 2)};
}

}  // namespace

void ServoController::configure(const ServoControllerSettings& settings) {
  const bool other_mode = settings.commutation != settings_.commutation;
  const std::int64_t present = position();
  const bool other_direction = settings.encoder_reversed != settings_.encoder_reversed;
  settings_ = settings;
  const double pole_pairs = settings.pole_pairs;
  halls_.configure(
      settings.hall_inverted, settings.hall_interpolated,
      static_cast<std::uint32_t>(
          kPeriodsPerMinute / (kInterpolationThreshold * HallDecoder::kStepsPerTurn * pole_pairs)));
  encoder_.configure(settings);
  halls_used_ = settings.commutation == ServoCommutation::hall ||
                (settings.commutation == ServoCommutation::encoder &&
                 settings.init_mode == EncoderInitMode::hall);
  if (catching_ > 0) {
    catching_ = 0;
    current_pi_.change_integral(settings_.torque_i);
  }
  current_pi_.configure(settings.torque_p, settings.torque_i);
  velocity_pi_.configure(settings.velocity_p, settings.velocity_i);
  const double increments = increments_per_revolution();
  rpm_of_rate_ = kPeriodsPerMinute / increments;
  rate_of_rpm_ = pole_pairs / kPeriodsPerMinute;
  advance_of_rpm_ = kDelay * rate_of_rpm_;
  const int unit = outer_gain_unit(settings.commutation);
  rpm_of_increment_ = kPositionGainUnit * unit * settings.position_p / increments;
  increments_of_rpm_ = kOuterLoopDivider * increments / kPeriodsPerMinute;
  velocity_limit_ = settings.maximum_velocity;
  inverse_velocity_band_ = 1.0 / std::max(kVelocityBand * velocity_limit_, kLeastVelocityBand);
  torque_limit_ = of_milliampere(settings.maximum_torque);
  velocity_output_unit_ = unit;
  velocity_output_limit_ = std::int64_t{torque_limit_} * 65536 / velocity_output_unit_;
  field_current_ = std::min(of_milliampere(settings.open_loop_current), torque_limit_);
  i2t_.configure(settings.i2t_time_constant, settings.i2t_limit);
  constexpr double kDecivolt = 0.1;
  chopper_.configure(settings.brake_chopper_enabled, settings.brake_chopper_limit * kDecivolt,
                     settings.brake_chopper_hysteresis * kDecivolt);
  if (other_direction) {
    set_position(present);
    placed_ = false;
  }
  if (other_mode) {
    set_position(0);
    placed_ = false;
    running_ = false;
    halls_.clear_error();
  }
}

std::int32_t ServoController::increments_per_revolution() const {
  return settings_.commutation == ServoCommutation::hall
             ? HallDecoder::kStepsPerTurn * settings_.pole_pairs
             : std::max<std::int32_t>(settings_.encoder_steps, 1);
}

std::int64_t ServoController::raw_position() const {
  switch (settings_.commutation) {
    case ServoCommutation::hall:
      return halls_.position();
    case ServoCommutation::encoder:
      return encoder_.count();
    case ServoCommutation::controlled:
      break;
  }
  return field_position_.microsteps;
}

ElectricalAngle ServoController::commutation_angle() const {
  if (field_driven_) {
    return open_loop_angle_;
  }
  return settings_.commutation == ServoCommutation::hall ? halls_.angle(period_) : encoder_.angle();
}

std::int32_t ServoController::torque_error_sum() const {
  return current_pi_.torque().sum;
}

std::int32_t ServoController::flux_error_sum() const {
  return current_pi_.flux().sum;
}

std::int32_t ServoController::velocity_error() const {
  return saturated(nearest_integer(velocity_pi_.error() * (1.0 / kVelocityUnit)));
}

std::int32_t ServoController::velocity_error_sum() const {
  return saturated(velocity_pi_.sum() >> 8);
}

std::int32_t ServoController::position_error() const {
  constexpr double kLargest = 2147483647.0;
  return static_cast<std::int32_t>(std::clamp(position_error_, -kLargest, kLargest));
}

bool ServoController::motor_halted() const {
  return std::fabs(smoothed_velocity_) <= settings_.motor_halted_velocity;
}

base::ServoActuation ServoController::step(const ServoSetPoint& set_point,
                                           const base::ServoSensing& sensing) {
  ++period_;
  sense(sensing);
  const bool closed = set_point.loop != ServoLoop::off;
  if (closed != running_) {
    closed ? begin(set_point, sensing) : end();
  }
  if (--until_outer_loops_ == 0) {
    until_outer_loops_ = kOuterLoopDivider;
    run_outer_loops(set_point, sensing);
  }
  base::ServoActuation actuation;
  actuation.brake_chopper_on = chopper_.step(sensing.supply_voltage);
  if (closed && !encoder_.failed()) {
    actuation.bridge_enabled = true;
    // One by one: a wide load would wait for the narrow stores of the last period.
    actuation.duty[0] = duty_[0];
    actuation.duty[1] = duty_[1];
    actuation.duty[2] = duty_[2];
    control_currents(set_point, sensing);
  }
  return actuation;
}

void ServoController::rest(int periods, const base::ServoSensing& sensing) {
  while (periods >= until_outer_loops_) {
    periods -= until_outer_loops_;
    period_ += static_cast<std::uint32_t>(until_outer_loops_);
    until_outer_loops_ = kOuterLoopDivider;
    run_outer_loops({}, sensing);
  }
  until_outer_loops_ -= periods;
  period_ += static_cast<std::uint32_t>(periods);
}

void ServoController::sense(const base::ServoSensing& sensing) {
  encoder_.note(sensing.encoder_count);
  if (halls_.step(sensing.halls, period_) && encoder_.awaits_hall_edge()) {
    encoder_.correct_at_hall_edge(halls_.edge());
  }
  const std::int64_t raw = raw_position();
  if (!placed_) {
    placed_ = true;
    velocity_meter_.place(raw, period_);
  }
  velocity_meter_.note(raw, period_);
}

EncoderCommutation::Observation ServoController::observation(
    const base::ServoSensing& sensing) const {
  return {.hall_valid = halls_.valid(),
          .hall_angle = halls_.angle(period_),
          .index_passages = sensing.encoder_index_passages,
          .index_count = sensing.encoder_index_count,
          .current_flows = field_current_ > 0 && 2 * actual_current_ >= field_current_};
}

void ServoController::begin(const ServoSetPoint& set_point, const base::ServoSensing& sensing) {
  running_ = true;
  until_outer_loops_ = 1;  // the first duties come with the first targets
  loop_ = set_point.loop;
  current_pi_.reset();
  velocity_pi_.preset(0);
  duty_ = {0.5, 0.5, 0.5};
  square_current_ = 0.0;
  field_driven_ = settings_.commutation == ServoCommutation::controlled;
  if (settings_.commutation == ServoCommutation::encoder && !encoder_.initialised()) {
    set_field(encoder_.start(observation(sensing)));
    field_driven_ = encoder_.initialising();
  }
  catch_turning_motor();
}

void ServoController::catch_turning_motor() {
  const bool turns = !field_driven_ && std::fabs(velocity_) > kTurning;
  const unsigned integral = std::min(kCatchingIntegral * settings_.torque_p,
                                     unsigned{std::numeric_limits<std::uint16_t>::max()});
  const bool catches = turns && settings_.torque_i > 0 && integral > settings_.torque_i;
  catching_ = catches ? kCatchingPeriods + 1 : 0;  // the first outer period is the present one
  current_pi_.change_integral(catches ? static_cast<std::uint16_t>(integral) : settings_.torque_i);
}

void ServoController::end() {
  running_ = false;
  loop_ = ServoLoop::off;
  current_pi_.reset();
  velocity_pi_.preset(0);
  target_current_ = 0;
  ramp_target_current_ = 0;
  actual_current_ = 0;
  square_current_ = 0.0;
  velocity_demand_ = 0.0;
  position_error_ = 0.0;
  open_loop_step_ = {};
  voltage_limited_ = false;
}

void ServoController::set_field(const EncoderCommutation::Field& field) {
  open_loop_angle_ = field.angle;
  open_loop_step_ = field.step;
}

void ServoController::run_outer_loops(const ServoSetPoint& set_point,
                                      const base::ServoSensing& sensing) {
  constexpr double kShare = 1.0 / kOuterLoopDivider;
  i2t_.pass_millisecond(square_current_ * kShare);
  square_current_ = 0.0;
  measure_velocity();
  if (!running_) {
    return;
  }
  if (encoder_.initialising()) {
    initialise_encoder(sensing);
  }
  if (catching_ > 0 && --catching_ == 0) {
    current_pi_.change_integral(settings_.torque_i);
  }
  if (set_point.loop != loop_) {
    enter_loop(set_point.loop);
  }
  run_loop(set_point);
  limit_torque_by_velocity();
  targets_each_period_ = field_driven_ || loop_ == ServoLoop::torque || encoder_.failed();
  if (!targets_each_period_) {
    set_current_targets(set_point);
  }
  // The voltage acts 1.5 periods after the angle it was computed for.
  advance_ = sine_cosine(field_driven_ ? times_one_and_a_half(open_loop_step_)
                                       : angle_of_turns(velocity_ * advance_of_rpm_));
}

void ServoController::measure_velocity() {
  const bool controlled = settings_.commutation == ServoCommutation::controlled;
  velocity_ = controlled ? (running_ ? velocity_demand_ : 0.0)
                         : velocity_meter_.measure(period_) * rpm_of_rate_;
  const double change = velocity_ - smoothed_velocity_;
  constexpr double kNothing = 1e-3;  // rpm; an exponential never arrives
  smoothed_velocity_ =
      std::fabs(change) < kNothing ? velocity_ : smoothed_velocity_ + kSmoothing * change;
  if (controlled) {
    field_position_ = displaced(field_position_, velocity_ * increments_of_rpm_);
  }
}

void ServoController::initialise_encoder(const base::ServoSensing& sensing) {
  if (encoder_.pass_millisecond(observation(sensing))) {
    set_field(encoder_.field());
  }
  if (!encoder_.initialising()) {
    field_driven_ = false;
    open_loop_step_ = {};
    current_pi_.reset();
    target_current_ = 0;  // what stays on view when it failed
    ramp_target_current_ = 0;
    actual_current_ = 0;
  }
}

void ServoController::enter_loop(ServoLoop loop) {
  if (loop_ == ServoLoop::torque) {
    velocity_pi_.preset((std::int64_t{ramp_target_current_} * 65536) / velocity_output_unit_);
  }
  loop_ = loop;
}

void ServoController::run_loop(const ServoSetPoint& set_point) {
  position_error_ = 0.0;
  velocity_demand_ = 0.0;
  if (loop_ == ServoLoop::torque || encoder_.initialising()) {
    outer_torque_ = 0;
    return;
  }
  velocity_demand_ = set_point.velocity;
  if (loop_ == ServoLoop::position) {
    position_error_ = distance({raw_position() + origin_, 0.0}, set_point.position);
    velocity_demand_ += rpm_of_increment_ * position_error_;
  }
  velocity_demand_ = std::clamp(velocity_demand_, -velocity_limit_, velocity_limit_);
  if (field_driven_) {
    open_loop_step_ = angle_of_turns(velocity_demand_ * rate_of_rpm_);
    return;
  }
  const auto error =
      static_cast<std::int32_t>(nearest_integer((velocity_demand_ - velocity_) * kVelocityUnit));
  const std::int64_t torque = velocity_pi_.step(error, velocity_output_limit_);
  outer_torque_ = static_cast<std::int32_t>((torque * velocity_output_unit_ + 0x8000) >> 16);
}

void ServoController::limit_torque_by_velocity() {
  torque_upper_ = torque_limit_;
  torque_lower_ = -torque_limit_;
  if (i2t_.exceeded()) {
    torque_upper_ = 0;
    torque_lower_ = 0;
  } else if (loop_ == ServoLoop::torque) {
    const double ahead = (velocity_limit_ - velocity_) * inverse_velocity_band_;
    const double behind = (velocity_limit_ + velocity_) * inverse_velocity_band_;
    const double limit = torque_limit_;
    torque_upper_ = static_cast<std::int32_t>(limit * std::clamp(ahead, -1.0, 1.0));
    torque_lower_ = static_cast<std::int32_t>(-limit * std::clamp(behind, -1.0, 1.0));
  }
}

void ServoController::set_current_targets(const ServoSetPoint& set_point) {
  if (field_driven_) {
    target_current_ = field_current_;
    ramp_target_current_ = i2t_.exceeded() ? 0 : field_current_;
    current_target_ = {static_cast<double>(ramp_target_current_), 0.0};
    return;
  }
  target_current_ =
      loop_ == ServoLoop::torque
          ? static_cast<std::int32_t>(nearest_integer(
                std::clamp(set_point.torque, -kLargestCurrent, kLargestCurrent) * kMilliamperes))
          : outer_torque_;
  ramp_target_current_ = std::clamp(target_current_, torque_lower_, torque_upper_);
  current_target_ = {0.0, static_cast<double>(ramp_target_current_)};
}

void ServoController::control_currents(const ServoSetPoint& set_point,
                                       const base::ServoSensing& sensing) {
  if (targets_each_period_) {
    set_current_targets(set_point);
  }
  const base::SineCosine angle = sine_cosine(commutation_angle());
  const RotorVector current = park(clarke(sensing.phase_current), angle);
  square_current_ += current.d * current.d + current.q * current.q;
  const Pair rounded = nearest_integers(Pair{current.d, current.q} * kMilliamperes);
  actual_current_ =
      static_cast<std::int32_t>(static_cast<std::int64_t>(rounded[field_driven_ ? 0 : 1]));

  // Voltages in the unit of the controllers' outputs from here to the duties.
  constexpr double kUnitsPerVolt = kPiUnit / kMillivolt;
  const double supply = std::max(sensing.supply_voltage, kLeastSupply) * kUnitsPerVolt;
  const double inverse_supply = 1.0 / supply;
  const double limit = supply * kInverseSqrt3;
  const Pair output = current_pi_.step(Pair{current_target_.d, current_target_.q} - rounded, limit);
  voltage_limited_ = current_pi_.cut();
  const RotorVector voltage{output[0], output[1]};
  duty_ = space_vector_duties(inverse_park(voltage, turned(angle, advance_)), inverse_supply);
  open_loop_angle_ = open_loop_angle_ + open_loop_step_;
}

}  // namespace stator::control
