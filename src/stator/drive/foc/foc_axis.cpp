#include "stator/drive/foc/foc_axis.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "stator/control/foc/fixed_point.hpp"

namespace stator::drive {

namespace {

using control::foc::field;
using control::foc::saturate_s16;
using control::foc::saturate_s32;

constexpr std::int32_t kCentredPwm = 7;   // PWM_CHOP
constexpr std::int32_t kPhiEByHalls = 5;  // PHI_E_SELECTION
constexpr std::uint8_t kPositionPolarity = 0x80;
constexpr std::uint8_t kVelocityPolarity = 0x40;
constexpr std::uint32_t kDegrees = 360;  // of a revolution
constexpr std::int64_t kMilliseconds = 1'000'000;
constexpr double kSecondsPerMinute = MotionUnits::kSecondsPerMinute;

/// Seen in the block and remembered until the fault reset.
constexpr AxisErrors kShorts{AxisError::overcurrent_a, AxisError::overcurrent_c};
constexpr std::array kWatched{AxisError::undervoltage,   AxisError::overvoltage,
                              AxisError::hall_error,     AxisError::overcurrent_a,
                              AxisError::overcurrent_c,  AxisError::initialisation_error,
                              AxisError::shutdown_switch};
constexpr AxisErrors kWatchedErrors{AxisError::undervoltage,   AxisError::overvoltage,
                                    AxisError::hall_error,     AxisError::overcurrent_a,
                                    AxisError::overcurrent_c,  AxisError::initialisation_error,
                                    AxisError::shutdown_switch};

std::int64_t rounded(double value) {
  return static_cast<std::int64_t>(std::floor(value + 0.5));
}

}  // namespace

FocAxis::FocAxis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
                 base::EventReporter reporter, control::foc::FocBlock& block)
    : Axis(dictionary, configuration, reporter),
      block_(block),
      shown_(dictionary, configuration.profile_offset),
      commutation_(block) {
  settings_.behaviour = kFocBehaviour;
  SwitchInputs& inputs = settings_.reference.switches;
  inputs.left.inverted = inputs.right.inverted = inputs.home.inverted = true;
  configure();
  start();
}

void FocAxis::configure() {
  const std::uint32_t counts = std::max(foc_settings_.counts_per_revolution, 1U);
  const bool reversed = (foc_settings_.polarity & kPositionPolarity) != 0;
  if ((counts != counts_ || reversed != reversed_) && !bridge_on_) {
    counts_ = counts;
    reversed_ = reversed;
    feedback_.set_scale(kBlockCounts, counts_, reversed_);
  }
  settings_.velocity_reversed = reversed != ((foc_settings_.polarity & kVelocityPolarity) != 0);
  const double units_per_rpm = foc_settings_.velocity_units / kSecondsPerMinute;
  settings_.units =
      MotionUnits::rotational(counts_,
                              std::min(foc_settings_.maximum_speed * units_per_rpm,
                                       static_cast<double>(foc_settings_.maximum_profile_velocity)),
                              foc_settings_.maximum_acceleration, foc_settings_.velocity_units);
  const MotionUnits& units = settings_.units;
  settings_.position_end = {.distance = std::max<std::int64_t>(counts_ / kDegrees, 1),
                            .velocity = pps_of_rpm(foc_settings_.standstill)};
  settings_.velocity_window = foc_settings_.velocity_window != 0
                                  ? units.pps(foc_settings_.velocity_window)
                                  : std::numeric_limits<double>::infinity();
  settings_.velocity_window_time =
      base::SimDuration(foc_settings_.velocity_window_time * kMilliseconds);
  settings_.velocity_threshold = units.pps(foc_settings_.velocity_threshold);
  settings_.velocity_threshold_time =
      base::SimDuration(foc_settings_.velocity_threshold_time * kMilliseconds);
  settings_.torque_unit = TorqueUnit::per_mille_of(std::max(foc_settings_.rated_current, 1U));
  settings_.maximum_torque = std::min(foc_settings_.maximum_torque, foc_settings_.maximum_current) *
                             settings_.torque_unit.amperes;
}

void FocAxis::begin_period(base::SimTime now) {
  now_ = now;
  configure();
  configure_probes();
  read_block();
  read_switches();
  feedback_.update(count_, configuration().control_period);
  motion_.advance(configuration().control_period);
  const bool free = !power_.bridge_enabled() || !commutation_.known();
  motion_.follow_shaft({.position = feedback_.position(),
                        .velocity = actual_velocity(),
                        .standstill = pps_of_rpm(foc_settings_.standstill),
                        .lead = position_lead(),
                        .free = free});
}

/// s by which PID_POSITION_TARGET is ahead of the shaft where the position controller asks for the
/// velocity of the demand: P in Q4.12 makes rpm of 65536ths of a revolution.
double FocAxis::position_lead() const {
  constexpr double kOne = 4096.0;
  const std::int32_t p = block_.get(field("PID_POSITION_P"));
  return p > 0 ? kSecondsPerMinute * kOne / (static_cast<double>(kBlockCounts) * p) : 0.0;
}

void FocAxis::read_block() {
  count_ = count_at(block_.get(field("PID_POSITION_ACTUAL")));
  rpm_ = block_.get(field("PID_VELOCITY_ACTUAL"));
  const double current = block_.get(field("PID_TORQUE_ACTUAL")) * foc_settings_.current_per_step;
  current_ = reversed_ ? -current : current;
  supply_voltage_ = (block_.get(field("ADC_VM_RAW")) - foc_settings_.voltage_offset) *
                    foc_settings_.volts_per_step;
  constexpr double kTimeConstant = 2e-3;  // s
  const double share = configuration().control_period.seconds() / kTimeConstant;
  filtered_current_ = homing() ? filtered_current_ + share * (current_ - filtered_current_) : 0.0;
}

/// In 64 bits, near the position of the latest control period.
std::int64_t FocAxis::count_at(std::int32_t position) const {
  return count_ + static_cast<std::int32_t>(static_cast<std::uint32_t>(position) -
                                            static_cast<std::uint32_t>(count_));
}

SwitchLevels FocAxis::switch_levels_of_block() const {
  const SwitchLevels levels{.left = block_.get(field("REF_SW_L_RAW")) != 0,
                            .right = block_.get(field("REF_SW_R_RAW")) != 0,
                            .home = block_.get(field("REF_SW_H_RAW")) != 0};
  return reversed_ ? SwitchLevels{levels.right, levels.left, levels.home} : levels;
}

/// How levels are read: left is where positions fall to, whatever 607Eh makes of the motor's sense.
ReferenceSettings FocAxis::reference() const {
  ReferenceSettings result = settings_.reference;
  if (reversed_) {
    std::swap(result.switches.left, result.switches.right);
  }
  result.index_active_low = false;  // ABN_NPOL has taken care of it
  return result;
}

void FocAxis::read_switches() {
  conditions_.set_switches(reference().switches.pressed(switch_levels_of_block()));
}

void FocAxis::supervise_stage(base::SimTime now) {
  update_conditions();
  const AxisErrors present = stage_errors_.without(kShorts & errors());
  if (nothing_new(kWatchedErrors, present)) {
    return;
  }
  for (const AxisError error : kWatched) {
    watch(error, present.has(error), now);
  }
}

void FocAxis::update_conditions() {
  const double hysteresis = foc_settings_.voltage_hysteresis;
  supply_high_ = supply_voltage_ > foc_settings_.overvoltage - (supply_high_ ? hysteresis : 0.0);
  supply_low_ = supply_voltage_ < foc_settings_.undervoltage + (supply_low_ ? hysteresis : 0.0);
  const bool under_power = power_.bridge_enabled();
  stage_errors_.set(AxisError::overvoltage, supply_high_);
  stage_errors_.set(AxisError::undervoltage, supply_low_ && under_power);
  stage_errors_.set(AxisError::initialisation_error, commutation_.failed() && under_power);
  stage_errors_.set(
      AxisError::shutdown_switch,
      conditions_.shutdown_switch && (under_power || causes().has(AxisError::shutdown_switch)));
  stage_errors_.set(AxisError::hall_error,
                    bridge_on_ && block_.get(field("PHI_E_SELECTION")) == kPhiEByHalls &&
                        FocCommutation::halls_impossible(block_));
  if (bridge_on_ && block_.get(field("ADC_I_CLIPPED")) != 0) {
    block_.set(field("ADC_I_CLIPPED"), 0);
    const bool in_w =
        std::abs(block_.get(field("ADC_IWY"))) > std::abs(block_.get(field("ADC_IUX")));
    stage_errors_.set(in_w ? AxisError::overcurrent_c : AxisError::overcurrent_a, true);
  }
}

void FocAxis::fault_was_reset() {
  stage_errors_ = stage_errors_.without(kShorts);
  if (commutation_.failed()) {
    commutation_.forget();
  }
}

void FocAxis::end_period() {
  switch_bridge();
  if (bridge_on_) {
    commutation_.advance(now_);
    write_limits();
    if (commutation_.active() || !commutation_.known()) {
      written_.mode = MotionMode::stopped;
    } else {
      write_targets();
    }
  }
  show();
}

void FocAxis::switch_bridge() {
  const bool wanted = power_.bridge_enabled() && !stage_errors_.any_of(kShorts);
  if (wanted == bridge_on_) {
    return;
  }
  bridge_on_ = wanted;
  written_ = {};
  if (wanted) {
    block_.set(field("ADC_I_CLIPPED"), 0);
    block_.set(field("PWM_CHOP"), kCentredPwm);
    commutation_.start(foc_settings_.commutation, block_current(foc_settings_.commutation.current),
                       now_);
    return;
  }
  commutation_.stop();
  write_feed_forward({});
  block_.set(field("MODE_MOTION"), static_cast<std::int32_t>(MotionMode::stopped));
  block_.set(field("PWM_CHOP"), 0);
}

void FocAxis::write_limits() {
  const std::int32_t current =
      std::min(foc_settings_.torque_flux_limit, block_current(settings_.maximum_torque));
  if (current != written_.torque_flux_limit) {
    written_.torque_flux_limit = current;
    block_.set(field("PID_TORQUE_FLUX_LIMITS"), current);
  }
  const std::uint32_t velocity =
      std::min(foc_settings_.velocity_limit, foc_settings_.maximum_speed);
  if (velocity != written_.velocity_limit) {
    written_.velocity_limit = velocity;
    block_.set(field("PID_VELOCITY_LIMIT"), velocity);
  }
}

void FocAxis::write_targets() {
  switch (motion_.loop()) {
    case ControlLoop::position:
      block_.set(field("PID_POSITION_TARGET"), target_count());
      write_feed_forward(motion_.feed_forward());
      set_mode(MotionMode::position);
      break;
    case ControlLoop::velocity:
      block_.set(field("PID_VELOCITY_TARGET"), block_velocity(motion_.velocity()));
      write_feed_forward({.torque = motion_.feed_forward().torque});
      set_mode(MotionMode::velocity);
      break;
    case ControlLoop::torque:
      torque_demand_ = tapered(motion_.torque().value_or(0.0));
      block_.set(field("PID_TORQUE_TARGET"), signed_block_current(torque_demand_));
      write_feed_forward({});
      set_mode(MotionMode::torque);
      break;
  }
}

void FocAxis::set_mode(MotionMode mode) {
  if (mode != written_.mode) {
    written_.mode = mode;
    block_.set(field("MODE_MOTION"), static_cast<std::int32_t>(mode));
  }
}

void FocAxis::write_feed_forward(const FeedForward& ahead) {
  const std::int32_t velocity = block_velocity(ahead.velocity);
  if (velocity != written_.velocity_offset) {
    written_.velocity_offset = velocity;
    block_.set(field("PID_VELOCITY_OFFSET"), velocity);
  }
  const std::int32_t torque = signed_block_current(ahead.torque);
  if (torque != written_.torque_offset) {
    written_.torque_offset = torque;
    block_.set(field("PID_TORQUE_OFFSET"), torque);
  }
}

/// PID_POSITION_TARGET for the demand position, its fraction included.
std::int32_t FocAxis::target_count() const {
  const control::MicrostepPosition& demand = motion_.ramp().position();
  const std::int64_t units = demand.microsteps - feedback_.position_at(0);
  std::int64_t turns = units / counts_;
  std::int64_t rest = units % counts_;
  if (rest < 0) {
    rest += counts_;
    --turns;
  }
  const std::int64_t within = rounded((static_cast<double>(rest) + demand.fraction) *
                                      static_cast<double>(kBlockCounts) / counts_);
  const std::int64_t count = turns * kBlockCounts + within;
  return static_cast<std::int32_t>(reversed_ ? -count : count);
}

std::int32_t FocAxis::block_velocity(double pps) const {
  const std::int64_t rpm = rounded(pps * kSecondsPerMinute / counts_);
  return saturate_s32(reversed_ ? -rpm : rpm);
}

std::int32_t FocAxis::block_current(double amperes) const {
  return saturate_s16(rounded(amperes / foc_settings_.current_per_step));
}

std::int32_t FocAxis::signed_block_current(double amperes) const {
  return block_current(reversed_ ? -amperes : amperes);
}

/// A torque that drives the motor beyond 6080h fades out over the last twentieth of the speed.
double FocAxis::tapered(double torque) const {
  const double largest = foc_settings_.maximum_speed;
  const double speed = torque < 0.0 ? -rpm() : rpm();
  constexpr double kBand = 0.05;
  const double share = (largest - speed) / (kBand * largest);
  return torque * std::clamp(share, 0.0, 1.0);
}

// In this order of operations, which decides bits, it is what MotionUnits does where objects count
// rpm.
double FocAxis::pps_of_rpm(double rpm) const {
  return rpm / (kSecondsPerMinute / counts_);
}

double FocAxis::rpm() const {
  return reversed_ ? -rpm_ : rpm_;
}

Axis::StageStatus FocAxis::stage_status() const {
  return {.ready = commutation_.known(),
          .closed_loop = true,
          .position_loop = true,
          .current = filtered_current_};
}

double FocAxis::actual_velocity() const {
  return pps_of_rpm(rpm());
}

double FocAxis::torque_current() const {
  return current_;
}

bool FocAxis::voltage_enabled() const {
  return !supply_low_ && !supply_high_;
}

double FocAxis::shown_velocity() const {
  return std::abs(rpm_) < foc_settings_.standstill ? 0.0 : actual_velocity();
}

}  // namespace stator::drive
