#include "stator/control/foc/control_cascade.hpp"

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

BiquadCoefficients coefficients(const RegisterFile& registers, const std::array<Field, 6>& f) {
  return {registers.get(f[0]), registers.get(f[1]), registers.get(f[2]),
          registers.get(f[3]), registers.get(f[4]), registers.get_unsigned(f[5]) != 0};
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

}  // namespace stator::control::foc
