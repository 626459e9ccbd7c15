#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/motion/axis_settings.hpp"
#include "stator/drive/stepper/driver_chip.hpp"

namespace stator::devices::tmcm_3315 {

/// The objects of the driver chip of one axis: chopper, CoolStep, StallGuard2, StealthChop, and
/// what the chip reports.
class DriverObjects {
 public:
  DriverObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset);

  /// Writes the objects into `settings.driver`; settings.units must be up to date.
  void configure(const drive::MotionUnits& units, drive::DriverSettings& driver) const;
  /// Brings 2101h and 2102h up to date.
  void publish(const drive::DriverChip& driver);
  [[nodiscard]] std::uint8_t flags() const { return error_flags_.get(); }  ///< 2102h

 private:
  dictionary::Variable<std::uint8_t> blank_time_;                  // 2092h
  dictionary::Variable<std::uint8_t> chopper_mode_;                // 2093h
  dictionary::Variable<std::uint8_t> hysteresis_decrement_;        // 2094h
  dictionary::Variable<std::int8_t> hysteresis_end_;               // 2095h
  dictionary::Variable<std::uint8_t> hysteresis_start_;            // 2096h
  dictionary::Variable<std::uint8_t> off_time_;                    // 2097h
  dictionary::Variable<std::uint8_t> cool_step_minimum_;           // 2098h
  dictionary::Variable<std::uint8_t> cool_step_down_;              // 2099h
  dictionary::Variable<std::uint8_t> cool_step_hysteresis_;        // 209Ah
  dictionary::Variable<std::uint8_t> cool_step_up_;                // 209Bh
  dictionary::Variable<std::uint8_t> cool_step_hysteresis_start_;  // 209Ch
  dictionary::Variable<std::uint8_t> stall_guard_filter_;          // 209Dh
  dictionary::Variable<std::int8_t> stall_guard_threshold_;        // 209Eh
  dictionary::Variable<std::uint8_t> short_protection_disable_;    // 20A1h
  dictionary::Variable<std::uint32_t> stop_on_stall_;              // 20A4h
  dictionary::Variable<std::uint32_t> cool_step_threshold_;        // 20A5h
  dictionary::Variable<std::uint32_t> pwm_threshold_;              // 20B0h
  dictionary::Variable<std::uint8_t> pwm_gradient_;                // 20B1h
  dictionary::Variable<std::uint8_t> pwm_amplitude_;               // 20B2h
  dictionary::Variable<std::uint16_t> load_value_;                 // 2101h
  dictionary::Variable<std::uint8_t> error_flags_;                 // 2102h
};

}  // namespace stator::devices::tmcm_3315
