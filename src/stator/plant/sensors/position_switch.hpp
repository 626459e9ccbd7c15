#pragma once

#include <cstdint>
#include <limits>

namespace stator::plant {

/// What is wrong with a switch, whatever presses it.
enum class SwitchFault : std::uint8_t {
  none,
  released,  ///< never pressed
  pressed,   ///< always
};

/// A limit or home switch pressed by a cam while the shaft is within a range of positions, or by
/// hand.
struct PositionSwitch {
  bool fitted = false;
  double pressed_from = -std::numeric_limits<double>::infinity();  ///< revolutions, inclusive
  double pressed_to = std::numeric_limits<double>::infinity();     ///< revolutions, inclusive
  bool normally_closed = false;                                    ///< signal is low while pressed
  bool level_if_not_fitted = false;                                ///< what the open input reads

  /// A left (negative) limit switch: pressed at and below `revolutions`.
  static constexpr PositionSwitch left_at(double revolutions) {
    return {.fitted = true, .pressed_to = revolutions};
  }
  /// A right (positive) limit switch: pressed at and above `revolutions`.
  static constexpr PositionSwitch right_at(double revolutions) {
    return {.fitted = true, .pressed_from = revolutions};
  }
  /// A home switch: pressed between the two positions.
  static constexpr PositionSwitch home_between(double from, double to) {
    return {.fitted = true, .pressed_from = from, .pressed_to = to};
  }

  /// Input level with the shaft at `revolutions`, true = high. Where no switch is fitted, a hand
  /// holds a wire that takes the open input to its other level.
  [[nodiscard]] constexpr bool level(double revolutions, bool by_hand = false) const {
    if (!fitted) {
      return by_hand != level_if_not_fitted;
    }
    const bool by_cam = revolutions >= pressed_from && revolutions <= pressed_to;
    return (by_cam || by_hand) != normally_closed;
  }
  /// What a stuck one makes of that level.
  [[nodiscard]] constexpr bool through(SwitchFault fault, bool level) const {
    return fault == SwitchFault::none ? level
                                      : (fault == SwitchFault::pressed) !=
                                            (fitted ? normally_closed : level_if_not_fitted);
  }
};

}  // namespace stator::plant
