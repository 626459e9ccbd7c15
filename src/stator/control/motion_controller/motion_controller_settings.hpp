#pragma once

#include <cstdint>

namespace stator::control::motion_controller {

// The registers of the chip that only configure it, under the numbers of the axis parameters (AP)
// that show them. Defaults are those of A55. Velocities and accelerations are in the chip's units
// (motion_controller_units.hpp), positions in microsteps.

/// Values outside the ranges named are the caller's mistake: they count as the nearest in range.
struct RampSettings {
  std::uint32_t maximum_velocity = 500'000;  ///< AP 4, 0..2^31-1: of positioning
  std::uint32_t acceleration = 50'000;       ///< AP 16, 1..16777215
  std::uint32_t deceleration = 50'000;       ///< AP 17, 1..16777215
  std::uint32_t stop_deceleration = 50'000;  ///< AP 15, 1..16777215: at stop switches and limits
  std::uint8_t bow = 0;                      ///< AP 18, 0..18

  friend constexpr bool operator==(const RampSettings&, const RampSettings&) = default;
};

/// Virtual stop switches.
struct PositionLimits {
  std::int32_t right = 0;      ///< AP 50
  std::int32_t left = 0;       ///< AP 51
  bool right_enabled = false;  ///< AP 52
  bool left_enabled = false;   ///< AP 53

  friend constexpr bool operator==(const PositionLimits&, const PositionLimits&) = default;
};

/// Bits of AP 14.
namespace switch_mode {
inline constexpr std::uint32_t kLeftActiveHigh = 1U << 2;   ///< 0: active when the pin is low (A44)
inline constexpr std::uint32_t kRightActiveHigh = 1U << 3;  ///< the same
inline constexpr std::uint32_t kSwap = 1U << 4;
inline constexpr std::uint32_t kSoftStop = 1U << 5;
inline constexpr std::uint32_t kLatchLeftActive = 1U << 8;
inline constexpr std::uint32_t kLatchLeftInactive = 1U << 9;
inline constexpr std::uint32_t kLatchRightActive = 1U << 10;
inline constexpr std::uint32_t kLatchRightInactive = 1U << 11;
inline constexpr std::uint32_t kLatchEncoder = 1U << 12;
}  // namespace switch_mode

struct SwitchSettings {
  std::uint32_t mode = 0;       ///< AP 14
  bool right_disabled = false;  ///< AP 12: the switch does not stop the motor
  bool left_disabled = false;   ///< AP 13

  friend constexpr bool operator==(const SwitchSettings&, const SwitchSettings&) = default;
};

/// Bits of AP 43. 1 in the first three: the level is high (as in Trinamic's other interfaces).
namespace encoder_mode {
inline constexpr std::uint32_t kChannelA = 1U << 0;
inline constexpr std::uint32_t kChannelB = 1U << 1;
inline constexpr std::uint32_t kNullActiveHigh = 1U << 2;
inline constexpr std::uint32_t kIgnoreAb = 1U << 3;
inline constexpr std::uint32_t kClearContinuously = 1U << 4;
inline constexpr std::uint32_t kClearOnce = 1U << 5;
inline constexpr std::uint32_t kPositiveEdge = 1U << 6;
inline constexpr std::uint32_t kNegativeEdge = 1U << 7;
inline constexpr std::uint32_t kClearOnNull = 1U << 8;
inline constexpr std::uint32_t kDecimal = 1U << 13;
}  // namespace encoder_mode

struct EncoderSettings {
  std::uint32_t constant = 65'536;      ///< AP 42; decimal mode: whole << 16 | ten-thousandths
  std::uint32_t mode = 0;               ///< AP 43
  std::uint32_t warn_distance = 0;      ///< AP 47, microsteps; 0 = no warning (A39)
  std::uint32_t maximum_deviation = 0;  ///< AP 212, microsteps; 0 = no stop

  friend constexpr bool operator==(const EncoderSettings&, const EncoderSettings&) = default;
};

struct RegulatorSettings {
  std::uint32_t tolerance = 0;      ///< AP 28, 0..1048575 microsteps
  std::uint32_t p = 0;              ///< AP 30, 0..16777215 (A27)
  std::uint32_t i = 0;              ///< AP 31, the same
  std::uint32_t d = 0;              ///< AP 32, the same
  std::uint16_t integral_clip = 0;  ///< AP 33, 0..32640, in units of 65536
  std::uint8_t d_divider = 0;       ///< AP 35, 0 = 256
  std::uint32_t velocity_clip = 0;  ///< AP 37, 0..2^31-1
  bool enabled = false;             ///< AP 40

  friend constexpr bool operator==(const RegulatorSettings&, const RegulatorSettings&) = default;
};

struct CurrentSettings {
  std::uint8_t run = 8;              ///< AP 6, 0..15
  std::uint8_t standby = 2;          ///< AP 7, 0..15
  std::uint16_t standby_delay = 50;  ///< AP 20, 0..4095 units of 4.096 ms

  friend constexpr bool operator==(const CurrentSettings&, const CurrentSettings&) = default;
};

struct Settings {
  RampSettings ramp;
  PositionLimits limits;
  SwitchSettings switches;
  EncoderSettings encoder;
  RegulatorSettings regulator;
  CurrentSettings current;
  bool shaft = false;                  ///< AP 19: the motor turns the other way
  std::uint8_t sine_offset = 0;        ///< AP 29; acts when AP 27 is written
  std::uint8_t step_pulse_length = 0;  ///< AP 64, clocks

  friend constexpr bool operator==(const Settings&, const Settings&) = default;
};

}  // namespace stator::control::motion_controller
