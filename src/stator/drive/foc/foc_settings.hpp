#pragma once

#include <cstdint>
#include <limits>

#include "stator/base/sim_time.hpp"
#include "stator/drive/motion/axis_settings.hpp"
#include "stator/drive/motion/motion_units.hpp"

namespace stator::drive {

/// How the drive finds the electrical zero of its encoder before it moves (reading A-60).
enum class CommutationMethod : std::uint8_t {
  none = 0,              ///< the offset of the encoder is right as configured
  halls = 1,             ///< commutates by halls until their first border, then by the encoder
  bang_bang = 2,         ///< a current in D pulls the rotor to phi_e = 0
  minimal_movement = 3,  ///< motion mode 9 of the FOC block
};

/// How the commutation is searched: with which current, how long, and when it has failed.
struct CommutationSettings {
  CommutationMethod method = CommutationMethod::halls;
  /// PHI_E_SELECTION in operation, which the axis writes. An encoder (3, 6 and 7) has to be
  /// initialised, other sources and a DC motor are right as they are.
  std::uint8_t source = 3;
  double current = 1.0;                           ///< A in D, bang-bang
  base::SimDuration hold_time{500'000'000};       ///< of each of its two angles
  std::uint16_t minimal_movement_voltage = 3000;  ///< UD_EXT at the end
  std::int16_t largest_movement = 16384;          ///< of it, electrical, 65536 = a turn
};

/// What an axis on the FOC block has beside AxisSettings, filled by the device from its objects
/// before FocAxis::apply() and tick().
struct FocSettings {
  std::uint32_t counts_per_revolution = 65536;  ///< position units, 608Fh:01 / 608Fh:02; > 0
  std::uint8_t polarity = 0;                    ///< 607Eh: bit 7 position, bit 6 velocity
  /// Units of velocity objects in a revolution per second, of acceleration objects in one per
  /// second squared; > 0. "rpm" below means such a unit.
  double velocity_units = MotionUnits::kSecondsPerMinute;

  double current_per_step = 1e-3;          ///< A of one LSB of PID_TORQUE_ACTUAL
  std::uint32_t rated_current = 1000;      ///< 6075h, mA RMS; > 0
  std::uint16_t maximum_torque = 1000;     ///< 6072h, per mille of the rated torque
  std::uint16_t maximum_current = 1000;    ///< 6073h, per mille of the rated current
  std::int32_t torque_flux_limit = 32767;  ///< bound of PID_TORQUE_FLUX_LIMITS (2031h:01)

  std::uint32_t maximum_speed = 4000;             ///< 6080h, rpm in any case
  std::uint32_t maximum_profile_velocity = 4000;  ///< 607Fh, rpm
  std::uint32_t maximum_acceleration = std::numeric_limits<std::uint32_t>::max();  ///< rpm/s
  std::uint32_t velocity_limit =
      2147483647;  ///< bound of PID_VELOCITY_LIMIT (2031h:03), rpm in any case

  double volts_per_step = 1e-3;     ///< V of one step of ADC_VM_RAW above `voltage_offset`
  std::int32_t voltage_offset = 0;  ///< ADC_VM_RAW at 0 V
  double undervoltage = 7.0;        ///< V below which the stage cannot drive a motor
  double overvoltage = 60.0;        ///< V above which it switches off
  double voltage_hysteresis = 0.5;  ///< V back from a limit at which the error goes away

  std::uint16_t velocity_window = 0;          ///< 606Dh, rpm; 0 watches nothing
  std::uint16_t velocity_window_time = 0;     ///< 606Eh, ms
  std::uint16_t velocity_threshold = 0;       ///< 606Fh, rpm
  std::uint16_t velocity_threshold_time = 0;  ///< 6070h, ms
  std::uint16_t standstill = 5;  ///< rpm in any case; below it the shaft counts as standing

  CommutationSettings commutation;
};

/// The choices of a TMC8670 (decisions F-50 to F-69).
inline constexpr ProfileBehaviour kFocBehaviour{.end_velocity_goes_on = true,
                                                .slows_down_at_switches = true,
                                                .homing_needs_speeds = true,
                                                .homing_starts_on_edge = true,
                                                .homing_by_profile = true,
                                                .offsets_feed_forward = true};

}  // namespace stator::drive
