#pragma once

#include <cstdint>

#include "stator/control/microstep_position.hpp"

namespace stator::control {

/// How a servo controller learns the rotor's angle (TMCC160 2055h).
enum class ServoCommutation : std::uint8_t { hall = 6, encoder = 7, controlled = 8 };

/// How the encoder's commutation angle is found (TMCC160 2080h:05).
enum class EncoderInitMode : std::uint8_t {
  align = 0,  ///< the open-loop current at angle 0 draws the rotor there
  hall = 1,   ///< hall sensors tell it
  index = 2,  ///< the motor turns open loop until the N pulse comes
};

/// u of the gains below: mA that the velocity controller's output counts in, and factor of the
/// position controller.
///
/// A shaft rests where it is told to only if the two loops are stiffer than the cogging, whose
/// torque changes by order * amplitude per rad: a softer loop lets the shaft fall from tooth to
/// tooth as the integral part grows, for ever. With an encoder the default motor cogs with 4.8 mA
/// per count, against which the gains as delivered hold 9.4 mA per count (2.3 with a factor of 1,
/// 4.7 with 2). Halls, whose edges are 25 ms apart at 100 rpm, make a loop so stiff hunt.
[[nodiscard]] constexpr int outer_gain_unit(ServoCommutation commutation) {
  return commutation == ServoCommutation::encoder ? 4 : 1;
}

/// Which loops are closed. Each includes those before it.
enum class ServoLoop : std::uint8_t { off, torque, velocity, position };

/// Parameters of a servo controller, in the units of the device's objects (TMCC160: 2010h..2095h).
/// The defaults are those of a TMCC160 that moves.
///
/// Gains, with P and I as integers (the sums are taken once per period of their loop):
///   current   20 kHz  voltage [mV]  = P * e[mA] / 256 + I * sum(e) / 65536
///   velocity   1 kHz  current [mA]  = u * (P * e[rpm] / 256 + I * sum(e) / 65536)
///   position   1 kHz  velocity      = u * P / 15 s * error, that is
///                     velocity[rpm] = 4 * u * P * error[increments] / increments per revolution
/// u = outer_gain_unit(): 4 with an encoder, otherwise 1.
/// In SI units:
///   current   Kp = P / 256 V/A,  Ki = I * 20000 / 65536 V/(A s)
///   velocity  Kp = u * P / 256e3 * 30/pi A/(rad/s),  Ki = u * I / 65536 * 30/pi A/rad
///   position  Kv = u * P / 15 1/s
struct ServoControllerSettings {
  std::uint8_t pole_pairs = 4;  ///< 1..127
  ServoCommutation commutation = ServoCommutation::hall;

  std::uint16_t torque_p = 500;  ///< of torque and flux controller
  std::uint16_t torque_i = 500;
  std::uint16_t velocity_p = 500;
  std::uint16_t velocity_i = 500;
  std::uint16_t position_p = 300;

  std::uint32_t maximum_torque = 4000;      ///< mA (peak), bounds the current of all modes
  std::uint32_t maximum_velocity = 4000;    ///< rpm, bounds the demand of all loops
  std::uint32_t open_loop_current = 1500;   ///< mA (peak)
  std::uint32_t motor_halted_velocity = 5;  ///< rpm; not above it the motor counts as halted

  bool hall_inverted = false;
  bool hall_interpolated = false;  ///< above 60 rpm

  std::uint16_t encoder_steps = 4000;  ///< per revolution, after quadrature; not 0
  std::uint16_t encoder_offset = 0;    ///< commutation offset, encoder steps
  bool encoder_reversed = false;       ///< it counts down when the motor turns forward
  EncoderInitMode init_mode = EncoderInitMode::hall;
  std::uint16_t init_delay = 1000;   ///< ms
  std::int32_t init_velocity = 100;  ///< rpm

  std::uint32_t i2t_time_constant = 30'000;  ///< ms; 0: no I2t monitor
  std::uint32_t i2t_limit = 5'880'000;       ///< A^2 ms

  bool brake_chopper_enabled = false;
  std::uint16_t brake_chopper_limit = 260;     ///< 0.1 V
  std::uint16_t brake_chopper_hysteresis = 5;  ///< 0.1 V

  friend bool operator==(const ServoControllerSettings&, const ServoControllerSettings&) = default;
};

/// What a servo controller is told. Only members of the loop chosen count.
struct ServoSetPoint {
  ServoLoop loop = ServoLoop::off;
  double torque = 0.0;           ///< A (peak, q axis); loop torque
  double velocity = 0.0;         ///< rpm; loop velocity, and feed-forward of loop position
  MicrostepPosition position{};  ///< increments in `microsteps`; loop position
};

}  // namespace stator::control
