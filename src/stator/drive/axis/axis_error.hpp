#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace stator::drive {

/// What can be wrong with an axis. A device maps each to its emergency and chooses the reaction.
enum class AxisError : std::uint8_t {
  following_error,
  positive_software_limit,
  negative_software_limit,
  positive_limit_switch,
  negative_limit_switch,
  stall,
  open_load_a,
  open_load_b,
  overcurrent_a,
  overcurrent_b,
  overcurrent_high_side,
  over_temperature_warning,
  over_temperature,
  undervoltage,
  shutdown_switch,
  // Of servo axes alone.
  overcurrent_c,
  overvoltage,
  hall_error,            ///< the hall sensors show a state that does not exist
  initialisation_error,  ///< the commutation could not be initialised
  driver_error,          ///< the gate driver reports a fault of its own
  overload,              ///< the I2t sum is above its limit
};
inline constexpr std::size_t kAxisErrorCount = 21;
inline constexpr std::size_t kStepperErrorCount = 15;  ///< the first ones

/// What an error does to the axis.
enum class ErrorReaction : std::uint8_t {
  message,    ///< told to the master, nothing else
  warning,    ///< statusword bit 7
  stop,       ///< the motion stops, statusword bit 11, no fault
  fault,      ///< transition 13, brakes as 605Eh says
  power_off,  ///< transition 13, bridge off at once
};

using ErrorReactions = std::array<ErrorReaction, kAxisErrorCount>;

/// A set of axis errors.
class AxisErrors {
 public:
  constexpr AxisErrors() = default;
  constexpr AxisErrors(std::initializer_list<AxisError> errors) {
    for (const AxisError error : errors) {
      set(error, true);
    }
  }
  [[nodiscard]] constexpr bool has(AxisError error) const { return (bits_ & bit(error)) != 0; }
  [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
  constexpr void set(AxisError error, bool present) {
    bits_ = present ? bits_ | bit(error) : bits_ & ~bit(error);
  }
  /// Some error is in both sets.
  [[nodiscard]] constexpr bool any_of(AxisErrors others) const {
    return (bits_ & others.bits_) != 0;
  }
  /// This set without `others`.
  [[nodiscard]] constexpr AxisErrors without(AxisErrors others) const {
    return AxisErrors(bits_ & ~others.bits_);
  }
  [[nodiscard]] friend constexpr AxisErrors operator&(AxisErrors a, AxisErrors b) {
    return AxisErrors(a.bits_ & b.bits_);
  }
  [[nodiscard]] friend constexpr AxisErrors operator|(AxisErrors a, AxisErrors b) {
    return AxisErrors(a.bits_ | b.bits_);
  }
  friend constexpr bool operator==(AxisErrors, AxisErrors) = default;

 private:
  explicit constexpr AxisErrors(std::uint32_t bits) : bits_(bits) {}
  static constexpr std::uint32_t bit(AxisError error) { return 1U << static_cast<unsigned>(error); }
  std::uint32_t bits_ = 0;
};

}  // namespace stator::drive
