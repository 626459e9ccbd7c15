// A drive of CiA 402 behind the objects that a file says a device has.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmc8670/axis_unit.hpp"
#include "stator/devices/tmc8670/emergencies.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/import_report.hpp"
#include "stator/drive/axis/error_report.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"

namespace stator::devices::generic {

/// Of the firmware of a device that has no drive.
inline constexpr base::SimDuration kPeriodWithoutDrives{1'000'000};

/// What the numbers of the profile's objects mean. 0: what the device's own objects say (608Fh,
/// 6091h, 6092h), else what stands at each member.
struct DriveUnits {
  std::uint32_t position = 0;  ///< units in a revolution of the motor; else 65536
  /// Units of velocity objects in a revolution per second, of acceleration objects in one per
  /// second squared; else as many as of position (CiA 402-2 §6: position units per second).
  double velocity = 0.0;
};

/// Index that the objects of axis `number` are above those of the first (CiA 402-1).
[[nodiscard]] constexpr std::uint16_t index_offset(unsigned number) {
  return static_cast<std::uint16_t>(0x800 * number);
}

/// The dictionary has what makes axis `number` a drive: a controlword and a statusword of 16 bits.
/// A 6040h alone makes none: terminals map bits there.
[[nodiscard]] bool is_drive(const dictionary::Dictionary& objects, unsigned number);

/// One drive: the field-oriented servo of a TMC8670 with its motor, load and sensors, behind the
/// objects of CiA 402 that a device has. The servo has a complete dictionary of its own; each
/// object that both have is linked, whatever integer type the device gives it. What the device
/// lacks keeps the servo's default; what the device has and the servo has not is only stored.
class Drive {
 public:
  /// Links `objects`, which is finished, and gives writable ones without a default that of the
  /// servo; `report`, if not null, is told so. Throws std::logic_error if !is_drive().
  Drive(dictionary::Dictionary& objects, unsigned number, const DriveUnits& units,
        const plant::PwmAxisParameters& parameters, base::EventReporter reporter,
        dictionary::ImportReport* report = nullptr);
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;
  ~Drive() = default;

  /// The firmware starts anew with the values of the device's objects; the world goes on.
  void restart(base::SimTime now);
  /// Obeys what was written since the last call; false if nothing was.
  bool apply(base::SimTime now);
  /// One period of the firmware, tmc8670::AxisUnit::kControlPeriod.
  void tick(base::SimTime now);
  /// Lets motor and load go on until then.
  void step_world(base::SimTime until);
  /// The network lets the drive work, or no longer.
  void set_network_operational(bool operational, base::SimTime now) {
    unit_.set_network_operational(operational, now);
  }
  /// Brings the device's objects up to date.
  void show();

  /// Calls `tell` with each emergency that is due, see drive::ErrorReport.
  template <typename Tell>
  void report_errors(const Tell& tell) {
    errors_.update(unit_.axis(), tell);
  }

  /// 1001h as far as the drive makes it.
  [[nodiscard]] std::uint8_t error_register() const { return errors_.error_register(); }
  /// Position units in a revolution of the motor.
  [[nodiscard]] std::uint32_t position_units() const { return position_units_; }
  /// Velocity units in a revolution per second.
  [[nodiscard]] double velocity_units() const { return velocity_units_; }
  /// Appends "axis<number>.<name>".
  void append_signals(std::vector<product::Signal>& signals) const;
  /// The same.
  void append_inputs(std::vector<product::Input>& inputs);

 private:
  /// An object that both dictionaries have.
  struct Link {
    dictionary::Entry* device = nullptr;
    dictionary::Entry* servo = nullptr;
  };

  void link(dictionary::ImportReport* report);
  void link_entry(dictionary::Entry& entry, dictionary::ImportReport* report);
  void choose_only_mode(dictionary::Entry& entry, dictionary::ImportReport* report);
  void choose_defaults(const Link& link, dictionary::ImportReport* report);
  void follow_units();
  void scale_defaults();
  [[nodiscard]] std::uint64_t object_value(std::uint16_t index, std::uint8_t subindex) const;
  dictionary::Verdict command(const dictionary::Entry& entry, std::uint64_t bits);
  void units_written(const dictionary::Entry& /*entry*/) { follow_units(); }
  [[nodiscard]] std::string renamed(const std::string& name) const;

  dictionary::Dictionary& objects_;
  unsigned number_;
  DriveUnits units_;
  std::uint32_t position_units_ = 0;
  double velocity_units_ = 0.0;
  dictionary::Dictionary servo_;  ///< of the servo behind
  tmc8670::AxisUnit unit_;
  drive::ErrorReport errors_;
  std::vector<Link> commands_;  ///< what masters write, ascending
  std::vector<Link> shown_;     ///< what they read
  base::SimTime next_period_;
};

}  // namespace stator::devices::generic
