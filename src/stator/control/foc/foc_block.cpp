#include "stator/control/foc/foc_block.hpp"

namespace stator::control::foc {
namespace {

constexpr std::uint32_t bit_if(bool condition, const Field& f) {
  return static_cast<std::uint32_t>(condition) << f.low;
}

}  // namespace

FocBlock::FocBlock() {
  configure();
}

inline void FocBlock::take_steps(const Inputs& inputs) {
  const auto steps = static_cast<std::int32_t>(inputs.steps - steps_seen_);
  if (steps == 0) {
    return;
  }
  steps_seen_ = inputs.steps;
  const std::int64_t way = std::int64_t{steps} * step_width_;
  targets_.position = wrap_s32(targets_.position + (inputs.direction ? -way : way));
  registers_.set(field("PID_POSITION_TARGET"), targets_.position);
}

Targets FocBlock::other_targets(const Inputs& inputs) {
  Targets result = targets_;
  if (mode_.source == TargetSource::noise_flux) {
    result.flux = saturate_s16(noise_.step());
  } else if (mode_.source == TargetSource::noise) {
    const std::int32_t noise = noise_.step();
    result.torque = saturate_s16(noise);
    result.velocity = result.position = noise;
  } else {
    if (mode_.source == TargetSource::analog_pin) {
      single_pin_.take(adc_.raw().general_a);
    } else {
      single_pin_.take(inputs.pwm_in);
    }
    result.torque = single_pin_.torque();
    result.velocity = single_pin_.velocity();
    result.position = single_pin_.position();
  }
  return result;
}

inline void FocBlock::measure(const SineCosine& direction) {
  const PhaseVector& phase = adc_.phase();
  if (pwm_.motor() == MotorType::direct_current) {
    stator_current_ = {phase.u, 0};
    current_ = {0, phase.u};
    return;
  }
  stator_current_ = pwm_.motor() == MotorType::two_phase ? StatorVector{phase.u, phase.w}
                                                         : clarke(phase.u, phase.v);
  current_ = park(stator_current_, direction);
}

[[gnu::always_inline]] inline RotorVector FocBlock::wanted_voltage(const Inputs& inputs) {
  const Loop loop = mode_.loop;
  if (loop < Loop::torque) {
    switch (loop) {
      case Loop::voltage:
        return external_voltage_;
      case Loop::mini_move:
        return {minimal_movement_.voltage(), 0};
      default:
        return {};
    }
  }
  Targets other;
  if (mode_.source != TargetSource::registers) [[unlikely]] {
    other = other_targets(inputs);
  }
  const Targets& wanted = mode_.source == TargetSource::registers ? targets_ : other;
  const std::int32_t ticks = pwm_.period();
  const bool outer = loop != Loop::torque;
  if (outer) {
    cascade_.step_outer(loop, wanted, sensors_.velocity(), sensors_.position(), ticks);
  }
  if (pwm_.motor() == MotorType::direct_current) {
    return {0, cascade_.step_torque(outer, wanted, current_.q, ticks)};
  }
  return cascade_.step_inner(outer, wanted, current_, ticks);
}

inline void FocBlock::apply(const RotorVector& wanted, const SineCosine& direction) {
  const LimitedVoltage limited = limit_circle(wanted, voltage_limit_);
  // Word by word: a pair that is copied while its halves are still being stored has to wait.
  wanted_voltage_.d = wanted.d;
  wanted_voltage_.q = wanted.q;
  voltage_.d = limited.voltage.d;
  voltage_.q = limited.voltage.q;
  if (limited.d_limited || limited.q_limited) [[unlikely]] {
    flags_ |= bit_if(limited.d_limited, field("IPARK_CIRLIM_LIMIT_U_D")) |
              bit_if(limited.q_limited, field("IPARK_CIRLIM_LIMIT_U_Q")) |
              bit_if(true, field("IPARK_CIRLIM_LIMIT_U_R"));
  }
  if (pwm_.motor() == MotorType::direct_current) {
    stator_voltage_ = {voltage_.q, 0};
    phase_voltage_ = {voltage_.q, 0, 0};
    pwm_.set(voltage_.q);
    return;
  }
  stator_voltage_ = inverse_park(voltage_, direction);
  if (pwm_.motor() == MotorType::two_phase) {
    phase_voltage_ = {stator_voltage_.a, 0, stator_voltage_.b};
    pwm_.set(stator_voltage_);
  } else {
    phase_voltage_ = inverse_clarke(stator_voltage_);
    pwm_.set(phase_voltage_);
  }
}

void FocBlock::initialise_by_halls() {
  const std::int32_t border = sensors_.hall().border();
  const auto shifted = [&](const Field& offset, std::int32_t shown) {
    const std::int32_t result = wrap_s16(registers_.get(offset) + std::int64_t{border} - shown);
    registers_.set(offset, result);
    return result;
  };
  const std::int32_t abn = shifted(field("ABN_DECODER_PHI_E_OFFSET"), sensors_.abn().phi_e());
  const std::int32_t analog =
      shifted(field("AENC_DECODER_PHI_E_OFFSET"), sensors_.analog().phi_e());
  hall_initialisation_.finish(abn, analog,
                              wrap_s16(std::int64_t{border} - sensors_.analog().phi_a_raw()));
  sensors_.configure(registers_, hall_filter_);
}

void FocBlock::move_minimally() {
  const std::int32_t angle = sensors_.abn().phi_e();
  const std::int32_t moved = wrap_s16(std::int64_t{angle} - abn_angle_);
  abn_angle_ = angle;
  if (!minimal_movement_.step(moved, external_voltage_.d)) {
    return;
  }
  const Field offset = field("ABN_DECODER_PHI_E_OFFSET");
  registers_.set(offset, registers_.get(offset) + std::int64_t{minimal_movement_.field()} - angle);
  sensors_.configure(registers_, hall_filter_);
}

void FocBlock::note_events() {
  flags_ |= bit_if(pwm_.at_minimum(), field("PWM_MIN")) |
            bit_if(pwm_.at_maximum(), field("PWM_MAX")) |
            bit_if(adc_.clipped(), field("ADC_I_CLIPPED")) |
            bit_if(sensors_.analog().clipped(), field("AENC_CLIPPED")) |
            bit_if(sensors_.abn().n_event(), field("ENC_N")) |
            bit_if(sensors_.abn_2().n_event(), field("ENC_2_N"));
}

inline void FocBlock::supervise(const Inputs& inputs) {
  outputs_.brake_chopper = brake_chopper_.step(adc_.raw().motor_supply);
  switches_.step(inputs, sensors_.position());
  const unsigned active = switches_.status();
  flags_ |= cascade_.flags() | bit_if((active & 1U) != 0, field("REF_SW_H")) |
            bit_if((active & 2U) != 0, field("REF_SW_L")) |
            bit_if((active & 4U) != 0, field("REF_SW_R"));
  if (pwm_.at_minimum() || pwm_.at_maximum() || adc_.clipped() || sensors_.analog().clipped() ||
      sensors_.abn().n_event() || sensors_.abn_2().n_event()) [[unlikely]] {
    note_events();
  }
  outputs_.status = (flags_ & status_mask_) != 0;
  outputs_.enable = inputs.enable;
}

const Outputs& FocBlock::step(const Inputs& inputs) {
  const std::int32_t passed = outputs_.pwm.period;
  adc_.step(inputs);
  sensors_.step(inputs, adc_.encoder_group(inputs), outputs_.pwm, passed);
  if (hall_initialisation_.due(sensors_.hall().edges())) [[unlikely]] {
    initialise_by_halls();
  }
  if (mode_.loop == Loop::mini_move) [[unlikely]] {
    move_minimally();
  }
  take_steps(inputs);
  const std::int32_t angle =
      mode_.loop == Loop::mini_move ? minimal_movement_.field() : sensors_.phi_e();
  const SineCosine direction = sine_cosine(static_cast<std::uint16_t>(angle));
  measure(direction);
  const RotorVector wanted = wanted_voltage(inputs);
  pwm_.begin(outputs_.pwm);
  apply(wanted, direction);
  supervise(inputs);
  // Copied last, when the caller's stores are complete and need not be waited for.
  pins_ = static_cast<const PinLevels&>(inputs);
  return outputs_;
}

}  // namespace stator::control::foc
