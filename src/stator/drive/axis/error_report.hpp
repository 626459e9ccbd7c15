#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/axis/axis.hpp"
#include "stator/drive/axis/axis_error.hpp"

namespace stator::drive {

/// Bits of the error register 1001h (CiA 301 §7.5.2.2).
namespace error_register {
inline constexpr std::uint8_t kGeneric = 1U << 0;
inline constexpr std::uint8_t kCurrent = 1U << 1;
inline constexpr std::uint8_t kVoltage = 1U << 2;
inline constexpr std::uint8_t kTemperature = 1U << 3;
inline constexpr std::uint8_t kCommunication = 1U << 4;
inline constexpr std::uint8_t kDeviceProfile = 1U << 5;
inline constexpr std::uint8_t kManufacturer = 1U << 7;
// Every error sets the generic bit beside that of its class.
inline constexpr std::uint8_t kOfCurrent = kGeneric | kCurrent;
inline constexpr std::uint8_t kOfVoltage = kGeneric | kVoltage;
inline constexpr std::uint8_t kOfTemperature = kGeneric | kTemperature;
inline constexpr std::uint8_t kOfCommunication = kGeneric | kCommunication;
inline constexpr std::uint8_t kOfDeviceProfile = kGeneric | kDeviceProfile;
inline constexpr std::uint8_t kOfManufacturer = kGeneric | kManufacturer;
}  // namespace error_register

/// An error of the axis as a master sees it: code of emergency and 603Fh (CiA 402-2 annex A, where
/// it has one for the case), first additional byte, bits of 1001h, and what the drive does.
struct AxisEmergency {
  AxisError error{};
  std::uint16_t code = 0;
  std::uint8_t detail = 0;
  std::uint8_t register_bits = 0;
  ErrorReaction reaction{};
  /// It concerns the whole device and not one of its motors.
  bool of_device = false;
  /// The device's document has a code for it; the others show in 1001h, and products may keep from
  /// telling of them.
  bool documented = true;
};

/// The reactions of a product's table, by AxisError. An error without a row is only an event.
template <std::size_t Rows>
constexpr ErrorReactions reactions_of(const std::array<AxisEmergency, Rows>& table) {
  ErrorReactions reactions{};
  for (const AxisEmergency& row : table) {
    reactions[static_cast<std::size_t>(row.error)] = row.reaction;
  }
  return reactions;
}

/// Calls `act` with each row of `table` whose error is in `these` and not in `those`: errors that
/// have appeared if these are the present and those the earlier ones; errors that have gone the
/// other way round.
template <typename Act>
void for_each_row_only_in(std::span<const AxisEmergency> table, const AxisErrors& these,
                          const AxisErrors& those, const Act& act) {
  for (const AxisEmergency& row : table) {
    if (these.has(row.error) && !those.has(row.error)) {
      act(row);
    }
  }
}

/// What 1001h shows of errors.
constexpr std::uint8_t register_bits_of(std::span<const AxisEmergency> table,
                                        const AxisErrors& errors) {
  unsigned bits = 0;
  for (const AxisEmergency& row : table) {
    bits |= errors.has(row.error) ? row.register_bits : 0U;
  }
  return static_cast<std::uint8_t>(bits);
}

/// Keeps 1001h and 603Fh of a device with one axis, and says what its master has to be told.
class ErrorReport {
 public:
  /// `table` must outlive the report, as constants do. Throws std::logic_error if an object is
  /// missing.
  ErrorReport(dictionary::Dictionary& dictionary, std::span<const AxisEmergency> table)
      : table_(table),
        register_(dictionary.variable<std::uint8_t>(0x1001)),
        code_(dictionary.variable<std::uint16_t>(0x603F)) {}

  /// The firmware starts anew, with objects that have been reset.
  void restart() {
    errors_ = {};
    resets_ = 0;
  }
  /// Calls `tell` with each row whose error has appeared since the last call, and with one of code
  /// 0 if a fault was reset. Cheap when nothing has changed.
  template <typename Tell>
  void update(const Axis& axis, const Tell& tell) {
    if (axis.fault_resets() == resets_ && axis.errors() == errors_) [[likely]] {
      return;
    }
    const AxisErrors before = std::exchange(errors_, axis.errors());
    register_.set(register_bits_of(table_, errors_));
    if (std::exchange(resets_, axis.fault_resets()) != axis.fault_resets()) {
      code_.set(0);
      tell(AxisEmergency{});
    }
    for_each_row_only_in(table_, errors_, before, [&](const AxisEmergency& row) {
      code_.set(row.code);
      tell(row);
    });
  }
  [[nodiscard]] std::uint8_t error_register() const { return register_.get(); }

 private:
  std::span<const AxisEmergency> table_;
  dictionary::Variable<std::uint8_t> register_;  // 1001h
  dictionary::Variable<std::uint16_t> code_;     // 603Fh
  AxisErrors errors_;                            ///< as last told
  std::uint32_t resets_ = 0;
};

}  // namespace stator::drive
