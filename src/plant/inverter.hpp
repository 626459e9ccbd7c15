#pragma once

#include <array>

#include "plant/two_body_thermal.hpp"

namespace stator::plant {

/// Three half bridges, averaged over a PWM period. The defaults are those of a 10 A stage with
/// N-channel transistors on a small board.
struct InverterParameters {
  double on_resistance = 0.01;    ///< ohm of a transistor
  double pwm_frequency = 100e3;   ///< Hz
  double dead_time = 0.0;         ///< s both transistors of a half bridge are off, less what
                                  ///< the stage compensates
  double diode_drop = 0.7;        ///< V
  double switching_share = 2e-3;  ///< time spent switching: W per V and A
  /// Transistors inside, board outside.
  ThermalParameters thermal{.inner_capacity = 0.5,
                            .outer_capacity = 10.0,
                            .inner_to_outer = 3.0,
                            .outer_to_ambient = 12.0};
};

}  // namespace stator::plant
