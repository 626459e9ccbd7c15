#include "control/foc/control_cascade.hpp"

#include <algorithm>
#include <array>

namespace stator::control::foc {
namespace {

using enum Loop;
using enum TargetSource;

constexpr std::array<MotionMode, 16> kMotionModes{{
    {stopped, registers},
    {torque, registers},
    {velocity, registers},
    {position, registers},
    {torque, noise_flux},
    {torque, noise},
    {velocity, noise},
    {position, noise},
    {voltage, registers},
    {mini_move, registers},
    {torque, analog_pin},
    {velocity, analog_pin},
    {position, analog_pin},
    {torque, pwm_pin},
    {velocity, pwm_pin},
    {position, pwm_pin},
}};

constexpr std::uint8_t kVelocityAhead = 1;
constexpr std::uint8_t kTorqueAhead = 2;

BiquadCoefficients coefficients(const RegisterFile& registers, const std::array<Field, 6>& f) {
  return {registers.get(f[0]), registers.get(f[1]), registers.get(f[2]),
          registers.get(f[3]), registers.get(f[4]), registers.get_unsigned(f[5]) != 0};
}

/// A cut that fits into a word of 32 bits.
std::int32_t cut_word(std::int64_t value, std::int64_t low, std::int64_t high) {
  return static_cast<std::int32_t>(cut(value, low, high));
}

std::uint32_t clipped_if(bool condition, std::uint32_t bit) {
  return condition ? bit : 0;
}

}  // namespace

MotionMode motion_mode(std::int32_t number) {
  return number >= 0 && number < 16 ? kMotionModes[static_cast<unsigned>(number)] : MotionMode{};
}

void ControlCascade::configure(const RegisterFile& registers) {
  const auto structure =
      registers.get(field("MODE_PID_TYPE")) != 0 ? PiStructure::advanced : PiStructure::classic;
  const std::int64_t voltage_limit = registers.get(field("PIDOUT_UQ_UD_LIMITS"));
  current_limit_ = std::min(registers.get(field("PID_TORQUE_FLUX_LIMITS")), kS16Max);
  velocity_limit_ =
      std::min<std::int64_t>(registers.get_unsigned(field("PID_VELOCITY_LIMIT")), kS32Max);
  torque_.configure(structure, {registers.get(field("PID_TORQUE_P")),
                                registers.get(field("PID_TORQUE_I")), voltage_limit});
  flux_.configure(structure, {registers.get(field("PID_FLUX_P")),
                              registers.get(field("PID_FLUX_I")), voltage_limit});
  velocity_.configure(structure, {registers.get(field("PID_VELOCITY_P")),
                                  registers.get(field("PID_VELOCITY_I")), current_limit_});
  position_.configure(structure, {registers.get(field("PID_POSITION_P")),
                                  registers.get(field("PID_POSITION_I")), velocity_limit_});
  constexpr std::array kX{field("BIQUAD_X_A_1"), field("BIQUAD_X_A_2"), field("BIQUAD_X_B_0"),
                          field("BIQUAD_X_B_1"), field("BIQUAD_X_B_2"), field("BIQUAD_X_ENABLE")};
  constexpr std::array kT{field("BIQUAD_T_A_1"), field("BIQUAD_T_A_2"), field("BIQUAD_T_B_0"),
                          field("BIQUAD_T_B_1"), field("BIQUAD_T_B_2"), field("BIQUAD_T_ENABLE")};
  constexpr std::array kF{field("BIQUAD_F_A_1"), field("BIQUAD_F_A_2"), field("BIQUAD_F_B_0"),
                          field("BIQUAD_F_B_1"), field("BIQUAD_F_B_2"), field("BIQUAD_F_ENABLE")};
  position_filter_.configure(coefficients(registers, kX));
  torque_axis_.filter.configure(coefficients(registers, kT));
  flux_axis_.filter.configure(coefficients(registers, kF));
  torque_axis_.offset = registers.get(field("PID_TORQUE_OFFSET"));
  flux_axis_.offset = registers.get(field("PID_FLUX_OFFSET"));
  rate_limit_ = registers.get_unsigned(field("PID_TORQUE_FLUX_TARGET_DDT_LIMITS"));
  velocity_offset_ = registers.get(field("PID_VELOCITY_OFFSET"));
  position_low_ = registers.get(field("PID_POSITION_LIMIT_LOW"));
  position_high_ = registers.get(field("PID_POSITION_LIMIT_HIGH"));
  feed_forward_ = static_cast<std::uint8_t>(registers.get(field("MODE_FF")));
  decimation_ = static_cast<std::uint8_t>(registers.get(field("MODE_PID_SMPL")) + 1);
  velocity_ahead_.configure(registers.get(field("FEED_FORWARD_VELOCITY_GAIN")),
                            registers.get_unsigned(field("FEED_FORWARD_VELOCITY_FILTER_CONSTANT")));
  torque_ahead_.configure(registers.get(field("FEED_FORWARD_TORQUE_GAIN")),
                          registers.get_unsigned(field("FEED_FORWARD_TORQUE_FILTER_CONSTANT")));
}

void ControlCascade::reset(const Targets& targets) {
  torque_.reset();
  flux_.reset();
  torque_axis_.filter.preset(0);
  flux_axis_.filter.preset(0);
  torque_axis_.slewed = flux_axis_.slewed = 0;
  torque_axis_.clipped = flux_axis_.clipped = 0;
  input_ = {};
  limited_ = {};
  reset_outer(targets);
}

void ControlCascade::reset_outer(const Targets& targets) {
  velocity_.reset();
  position_.reset();
  velocity_clipped_ = position_clipped_ = 0;
  position_filter_.preset(targets.position);
  velocity_ahead_.reset();
  torque_ahead_.reset();
  last_position_target_ = targets.position;
  last_velocity_target_ = targets.velocity;
  ahead_velocity_ = ahead_torque_ = torque_target_ = 0;
  waited_ = 0;
  waited_ticks_ = 0;
}

void ControlCascade::step_outer(Loop loop, const Targets& targets, std::int32_t velocity,
                                std::int32_t position, std::int32_t ticks) {
  const std::int32_t wanted =
      loop == Loop::position ? position_filter_.step(targets.position) : targets.position;
  waited_ticks_ += ticks;
  if (waited_ != 0) {
    --waited_;
    return;
  }
  waited_ = static_cast<std::uint8_t>(decimation_ - 1);
  const std::int64_t passed = waited_ticks_;
  waited_ticks_ = 0;
  std::int32_t velocity_target = targets.velocity;
  if (loop == Loop::position) {
    input_.position = targets.position;
    const std::int32_t target = cut_word(wanted, position_low_, position_high_);
    position_clipped_ = clipped_if(target != wanted, kTargetClipped);
    limited_.position = target;
    const std::int32_t error = saturate_s32(std::int64_t{target} - position);
    velocity_target = position_.step(error, passed);
    if ((feed_forward_ & kVelocityAhead) != 0) {
      ahead_velocity_ =
          velocity_ahead_.step(wrap_s32(std::int64_t{target} - last_position_target_));
      velocity_target = saturate_s32(std::int64_t{velocity_target} + ahead_velocity_);
    }
    last_position_target_ = target;
  }
  step_velocity(velocity_target, velocity, passed);
}

void ControlCascade::step_velocity(std::int32_t target, std::int32_t velocity, std::int64_t ticks) {
  input_.velocity = target;
  const std::int32_t limited = cut_word(target, -velocity_limit_, velocity_limit_);
  velocity_clipped_ = clipped_if(limited != target, kTargetClipped);
  const std::int32_t wanted = saturate_s32(std::int64_t{limited} + velocity_offset_);
  limited_.velocity = wanted;
  torque_target_ = velocity_.step(saturate_s32(std::int64_t{wanted} - velocity), ticks);
  if ((feed_forward_ & kTorqueAhead) != 0) {
    ahead_torque_ = saturate_s16(
        torque_ahead_.step(saturate_s32(std::int64_t{wanted} - last_velocity_target_)));
    torque_target_ = saturate_s16(std::int64_t{torque_target_} + ahead_torque_);
  }
  last_velocity_target_ = wanted;
}

std::int32_t ControlCascade::prepared(CurrentTarget& axis, std::int32_t target) const {
  const std::int32_t filtered = axis.filter.step(target);
  const std::int32_t slewed =
      cut_word(filtered, axis.slewed - rate_limit_, axis.slewed + rate_limit_);
  axis.slewed = slewed;
  const std::int32_t limited = cut_word(slewed, -current_limit_, current_limit_);
  axis.clipped =
      clipped_if(slewed != filtered, kRateClipped) | clipped_if(limited != slewed, kTargetClipped);
  return limited + axis.offset;
}

RotorVector ControlCascade::step_inner(bool outer, const Targets& targets,
                                       const RotorVector& current, std::int32_t ticks) {
  input_.flux = targets.flux;
  limited_.flux = prepared(flux_axis_, targets.flux);
  const std::int32_t ud = flux_.step(saturate_s16(limited_.flux - current.d), ticks);
  return {ud, step_torque(outer, targets, current.q, ticks)};
}

std::int32_t ControlCascade::step_torque(bool outer, const Targets& targets, std::int32_t current,
                                         std::int32_t ticks) {
  input_.torque = outer_torque(outer, targets);
  limited_.torque = prepared(torque_axis_, input_.torque);
  const std::int32_t uq = torque_.step(saturate_s16(limited_.torque - current), ticks);
  return uq;
}

}  // namespace stator::control::foc
