#pragma once

#include <cstddef>

namespace stator::base {

/// What passes between the current loops of several servo drives and their motors, once per period:
/// the seam of ServoActuation and ServoSensing for drives that are computed side by side. Axis n
/// stands in lane n % kLanes of block n / kLanes.
template <typename Number>
struct alignas(64) ServoLanes {
  static constexpr std::size_t kLanes = 64 / sizeof(Number);

  Number phase_current[3][kLanes];  ///< A, measured, positive into the motor
  Number angle[kLanes];             ///< electrical rad, 0..2 pi, measured
  Number supply_voltage[kLanes];    ///< V at the power stage
  Number duty[3][kLanes];           ///< 0..1 for the next period
};

}  // namespace stator::base
