#pragma once

#include <cstdint>

namespace stator::drive {

/// What a servo axis tells of itself beside statusword and emergencies; the value is the bit in the
/// status flags of the TMCC160 (200Dh, CANopen manual L982-L1016) and of Trinamic's other BLDC
/// modules.
enum class ServoFlag : std::uint8_t {
  overcurrent = 0,
  undervoltage = 1,
  overvoltage = 2,
  overtemperature = 3,
  motor_halted = 4,  ///< not faster than MotorHaltedVelocity
  hall_error = 5,
  driver_error = 6,
  init_error = 7,
  stop_mode = 8,      ///< mode 0, or the drive is not enabled
  velocity_mode = 9,  ///< the velocity controller is the outer loop
  position_mode = 10,
  torque_mode = 11,
  emergency_stop = 12,      ///< the enable input is missing
  free_running = 13,        ///< the power stage is off
  position_end = 14,        ///< at the target, see ServoSettings::target_reached_distance
  module_initialised = 15,  ///< the commutation angle is known
  it_exceeded = 17,         ///< I2t
};

/// A set of them, in the form of the object.
class ServoFlags {
 public:
  constexpr void set(ServoFlag flag, bool present) {
    const std::uint32_t bit = 1U << static_cast<unsigned>(flag);
    bits_ = present ? bits_ | bit : bits_ & ~bit;
  }
  [[nodiscard]] constexpr bool has(ServoFlag flag) const {
    return (bits_ >> static_cast<unsigned>(flag) & 1U) != 0;
  }
  [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }

 private:
  std::uint32_t bits_ = 0;
};

}  // namespace stator::drive
