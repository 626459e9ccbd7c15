#pragma once

#include <cstdint>
#include <span>

#include "stator/devices/tmcm_142/motion_axis.hpp"
#include "stator/devices/tmcm_142/options.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/tmcl/module/parameter_table.hpp"
#include "stator/tmcl/module/parameter_values.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::devices::tmcm_142 {

/// The axis parameters of the module: their values in RAM and EEPROM, the user's units, and what
/// they mean for the axis.
///
/// Values are kept in units of the chip (A54). With parameter 255 at 1 velocities and accelerations
/// are microsteps per second and per square second for the user; a value that the chip's units
/// cannot hold becomes the nearest one. Accelerations are 1 unit at least.
class AxisParameters {
 public:
  /// `declarations` and `axis` must outlive it. Allocates; nothing else here does.
  AxisParameters(std::span<const tmcl::ParameterDeclaration> declarations, MotionAxis& axis);

  /// Takes what the EEPROM holds; the axis has been restarted.
  void power_on();

  [[nodiscard]] tmcl::ParameterRange range(const tmcl::ParameterDeclaration& parameter) const;
  [[nodiscard]] std::int32_t read(AxisParameter parameter);
  /// `value` is within range(). Status::invalid_value: it has no meaning, or none at present.
  [[nodiscard]] tmcl::Status write(AxisParameter parameter, std::int32_t value);
  void store(AxisParameter parameter);
  void restore(AxisParameter parameter);

  /// The EEPROM behind the parameters.
  [[nodiscard]] tmcl::ParameterValues& values() { return values_; }
  [[nodiscard]] const tmcl::ParameterValues& values() const { return values_; }

  /// Commands and motion in the user's unit. False: more than the unit allows (A19).
  [[nodiscard]] bool rotate(std::int32_t velocity);
  void start_reference_search();
  [[nodiscard]] std::int32_t reference_search_mode() const {
    return value(AxisParameter::reference_search_mode);
  }
  /// Parameter 255: microsteps per second instead of units of the chip.
  [[nodiscard]] bool in_pulses_per_second() const {
    return value(AxisParameter::unit_conversion_mode) != 0;
  }

 private:
  [[nodiscard]] std::size_t place_of(AxisParameter parameter) const;
  [[nodiscard]] std::int32_t value(AxisParameter parameter) const;
  [[nodiscard]] std::uint32_t magnitude(AxisParameter parameter) const;
  [[nodiscard]] std::int32_t read_raw(AxisParameter parameter);
  [[nodiscard]] tmcl::Status write_raw(AxisParameter parameter, std::int32_t raw);
  [[nodiscard]] tmcl::Status command(AxisParameter parameter, std::int32_t raw);
  void configure();
  [[nodiscard]] control::motion_controller::Settings settings() const;

  tmcl::ParameterTable table_;
  tmcl::ParameterValues values_;
  MotionAxis& axis_;
};

}  // namespace stator::devices::tmcm_142
