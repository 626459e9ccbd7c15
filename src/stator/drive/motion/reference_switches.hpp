#pragma once

#include <cstdint>

namespace stator::drive {

/// The switches an axis finds its reference with.
enum class ReferenceSwitch : std::uint8_t { negative_limit, positive_limit, home };

/// Which switches are pressed, after polarity; one that is not used is never pressed.
struct SwitchStates {
  bool negative_limit = false;
  bool positive_limit = false;
  bool home = false;

  [[nodiscard]] constexpr bool of(ReferenceSwitch which) const {
    switch (which) {
      case ReferenceSwitch::negative_limit:
        return negative_limit;
      case ReferenceSwitch::positive_limit:
        return positive_limit;
      case ReferenceSwitch::home:
        return home;
    }
    return false;
  }
};

/// How one switch input is read.
struct SwitchInput {
  bool used = true;
  bool inverted = false;  ///< the signal is low while the switch is pressed

  /// The switch is pressed, whether it is used or not.
  [[nodiscard]] constexpr bool active(bool level) const { return level != inverted; }
  /// The switch is pressed and used.
  [[nodiscard]] constexpr bool pressed(bool level) const { return used && active(level); }
};

/// Levels of the switch inputs, true = high.
struct SwitchLevels {
  bool left = false;
  bool right = false;
  bool home = false;
};

/// The switch inputs in what the sensors of any stage tell.
template <typename Sensing>
[[nodiscard]] constexpr SwitchLevels switch_levels(const Sensing& sensing) {
  return {sensing.left_switch, sensing.right_switch, sensing.home_switch};
}

/// How all switch inputs of an axis are read. Left is negative, right is positive.
struct SwitchInputs {
  SwitchInput left;
  SwitchInput right;
  SwitchInput home;

  [[nodiscard]] constexpr SwitchStates pressed(const SwitchLevels& levels) const {
    return {.negative_limit = left.pressed(levels.left),
            .positive_limit = right.pressed(levels.right),
            .home = home.pressed(levels.home)};
  }
};

/// How an axis finds its reference, as far as CiA 402 leaves it to the manufacturer.
struct ReferenceSettings {
  SwitchInputs switches;
  bool index_active_low = false;  ///< the encoder's N channel is low at its pulse
  /// Position at home: the home offset itself instead of its negative.
  bool home_offset_is_position = false;
};

}  // namespace stator::drive
