#pragma once

#include <cstdint>

#include "stator/control/foc/foc_block.hpp"

namespace stator::control::foc {

/// A block with raw - 32768 as current, a three-phase motor and one pole pair, in `mode`.
inline FocBlock block_in(int mode) {
  FocBlock block;
  block.set(field("CFG_DSMODULATOR_A"), 1);
  block.set(field("ADC_I0_OFFSET"), 32768);
  block.set(field("ADC_I1_OFFSET"), 32768);
  block.set(field("MOTOR_TYPE"), 3);
  block.set(field("PWM_CHOP"), 7);
  block.set(field("PHI_E_SELECTION"), 1);
  block.set(field("POSITION_SELECTION"), 9);
  block.set(field("VELOCITY_SELECTION"), 9);
  block.set(field("PID_TORQUE_P"), 256);
  block.set(field("PID_FLUX_P"), 256);
  block.set(field("PID_VELOCITY_P"), 256);
  block.set(field("PID_POSITION_P"), 4096);
  block.set(field("MODE_PID_TYPE"), 1);
  block.set(field("MODE_MOTION"), mode);
  return block;
}

inline Inputs with_currents(int u, int w) {
  Inputs inputs;
  inputs.delta_sigma_a.current = {static_cast<std::uint16_t>(32768 + u),
                                  static_cast<std::uint16_t>(32768 + w)};
  return inputs;
}

}  // namespace stator::control::foc
