#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/foc/foc_axis.hpp"

namespace stator::devices::tmc8670 {

/// The objects that tell the drive how to work beyond those it binds itself, brought into its
/// settings before each of its periods: what was written by SDO or process data is in force then.
class DriveObjects {
 public:
  explicit DriveObjects(const dictionary::Dictionary& dictionary);

  void configure(drive::FocAxis& axis) const;
  /// Units of velocity objects in a revolution per second, see drive::FocSettings; rpm if nobody
  /// says otherwise.
  void set_velocity_units(double units) { velocity_units_ = units; }

 private:
  void configure_profile(drive::FocSettings& settings) const;
  void configure_stage(drive::FocSettings& settings) const;
  void configure_axis(drive::AxisSettings& settings) const;

  template <typename T>
  using Variable = dictionary::Variable<const T>;

  Variable<std::uint16_t> velocity_window_;           // 606Dh, rpm
  Variable<std::uint16_t> velocity_window_time_;      // 606Eh, ms
  Variable<std::uint16_t> velocity_threshold_;        // 606Fh, rpm
  Variable<std::uint16_t> velocity_threshold_time_;   // 6070h, ms
  Variable<std::uint16_t> maximum_torque_;            // 6072h, per mille
  Variable<std::uint16_t> maximum_current_;           // 6073h, per mille
  Variable<std::uint32_t> rated_current_;             // 6075h, mA
  Variable<std::uint8_t> polarity_;                   // 607Eh
  Variable<std::uint32_t> maximum_profile_velocity_;  // 607Fh, rpm
  Variable<std::uint32_t> maximum_speed_;             // 6080h, rpm
  Variable<std::uint32_t> increments_;                // 608Fh:01
  Variable<std::uint32_t> revolutions_;               // 608Fh:02
  Variable<std::uint8_t> commutation_source_;         // 2020h:01
  Variable<std::uint16_t> torque_limit_;              // 2031h:01
  Variable<std::uint32_t> velocity_limit_;            // 2031h:03, rpm
  Variable<std::uint8_t> commutation_method_;         // 2050h:01
  Variable<std::uint32_t> commutation_current_;       // 2050h:02, mA
  Variable<std::uint16_t> commutation_time_;          // 2050h:03, ms
  Variable<std::uint16_t> commutation_voltage_;       // 2050h:04
  Variable<std::int16_t> commutation_movement_;       // 2050h:05
  Variable<std::uint32_t> voltage_step_;              // 2051h:01, uV
  Variable<std::uint16_t> voltage_offset_;            // 2051h:02
  Variable<std::uint32_t> undervoltage_;              // 2051h:03, mV
  Variable<std::uint32_t> overvoltage_;               // 2051h:04, mV
  Variable<std::uint32_t> voltage_hysteresis_;        // 2051h:05, mV
  Variable<std::uint32_t> current_step_;              // 2052h:01, uA
  Variable<std::uint32_t> maximum_acceleration_;      // 2052h:02, rpm/s
  Variable<std::uint16_t> standstill_;                // 2052h:03, rpm
  Variable<std::uint8_t> switches_active_high_;       // 2053h:01
  Variable<std::uint8_t> switches_not_used_;          // 2053h:02
  Variable<std::uint8_t> home_offset_is_position_;    // 2053h:03
  Variable<std::uint16_t> brake_hold_;                // 2054h:01, ms
  Variable<std::uint16_t> brake_release_;             // 2054h:02, ms
  Variable<std::uint16_t> brake_apply_;               // 2054h:03, ms
  Variable<std::uint32_t> hard_stop_current_;         // 2055h:01, mA
  Variable<std::int32_t> positive_clearance_;         // 2055h:02
  Variable<std::int32_t> negative_clearance_;         // 2055h:03
  double velocity_units_ = drive::MotionUnits::kSecondsPerMinute;
};

}  // namespace stator::devices::tmc8670
