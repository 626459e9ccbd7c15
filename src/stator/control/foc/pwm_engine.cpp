#include "stator/control/foc/pwm_engine.hpp"

namespace stator::control::foc {

void PwmEngine::configure(const RegisterFile& registers) {
  settings_.period = registers.get(field("PWM_MAXCNT")) + 1;
  settings_.pause_high = registers.get(field("PWM_BBM_H"));
  settings_.pause_low = registers.get(field("PWM_BBM_L"));
  const std::int32_t chopper = registers.get(field("PWM_CHOP"));
  settings_.chopper = chopper > 7 ? Chopper::off : static_cast<Chopper>(chopper);
  const std::int32_t motor = registers.get(field("MOTOR_TYPE"));
  motor_ = motor > 3 ? MotorType::none : static_cast<MotorType>(motor);
  constexpr std::array<std::uint8_t, 4> kHalfBridges{0, 2, 4, 3};
  settings_.half_bridges = kHalfBridges[static_cast<unsigned>(motor_)];
  space_vector_ = registers.get(field("PWM_SV")) != 0;
  low_polarity_ = static_cast<std::uint8_t>(registers.get(field("PWM_POLARITIES_0")));
  high_polarity_ = static_cast<std::uint8_t>(registers.get(field("PWM_POLARITIES_1")));
}

GateTimes PwmEngine::gate_times(const PwmPeriod& pwm, unsigned half_bridge) {
  if (half_bridge >= pwm.half_bridges) {
    return {.low_on = pwm.period};
  }
  const std::int32_t on = (pwm.period - pwm.on_time[half_bridge]) / 2;
  const std::int32_t off = on + pwm.on_time[half_bridge];
  const GateTimes none{.low_on = pwm.period};
  GateTimes result{on + pwm.pause_high, off, on, off + pwm.pause_low};
  switch (pwm.chopper) {
    case Chopper::centred:
      break;
    case Chopper::low_side:
      result.high_on = result.high_off = 0;
      break;
    case Chopper::high_side:
      result.low_off = 0;
      result.low_on = pwm.period;
      break;
    case Chopper::low_sides_on:
      return {};
    case Chopper::high_sides_on:
      return {0, pwm.period, 0, pwm.period};
    default:
      return none;
  }
  if (pwm.on_time[half_bridge] == 0) {  // no edge, hence no pause
    result.high_on = result.high_off = 0;
    if (pwm.chopper != Chopper::high_side) {
      result.low_off = result.low_on = 0;
    }
  } else if (pwm.on_time[half_bridge] == pwm.period) {
    result.high_on = 0;
    result.high_off = pwm.chopper == Chopper::low_side ? 0 : pwm.period;
    result.low_off = 0;
    result.low_on = pwm.period;
  }
  return result;
}

std::uint8_t PwmEngine::gate_levels(const PwmPeriod& pwm, bool enabled, std::int32_t tick) const {
  unsigned levels = 0;
  for (unsigned k = 0; k < 4; ++k) {
    const GateTimes times = gate_times(pwm, k);
    const bool high = enabled && tick >= times.high_on && tick < times.high_off;
    // A pause may reach into the next period.
    const bool low_pause =
        (tick >= times.low_off && tick < times.low_on) || tick < times.low_on - pwm.period;
    const bool low = enabled && !low_pause;
    levels |= (low ? 1U : 0U) << (2 * k) | (high ? 1U : 0U) << (2 * k + 1);
  }
  const unsigned inverted = (low_polarity_ != 0 ? 0x55U : 0U) | (high_polarity_ != 0 ? 0xAAU : 0U);
  return static_cast<std::uint8_t>(levels ^ inverted);
}

}  // namespace stator::control::foc
