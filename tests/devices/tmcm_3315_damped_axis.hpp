#pragma once

#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {

/// A module whose axis 0 settles within milliseconds: a load with so much viscous friction that
/// the rotor does not ring when it is pushed, stopped or switched on.
inline Tmcm3315Configuration damped_axis() {
  Tmcm3315Configuration configuration;
  configuration.axes[0].load.viscous_friction = 0.02;  // N m s/rad
  return configuration;
}

}  // namespace stator::devices
