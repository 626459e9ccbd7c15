#pragma once

#include <array>
#include <cstdint>

#include "stator/drive/motion/reference_switches.hpp"

namespace stator::drive {

/// Where a homing method finds home.
enum class HomeSignal : std::uint8_t {
  present_position,   ///< no motion
  index,              ///< the next index pulse in the direction of travel
  release,            ///< where the switch is released
  release_and_index,  ///< at the next index pulse beyond that point
  hard_stop,          ///< where the motor's current rises because the shaft is held up
};

/// One method of 6098h (CiA 402-2 §11.4) as a row. A method with a switch runs in
/// `search_direction` until the switch is pressed, at once if it is pressed already, and then
/// leaves the switch in the other direction. The edge is always met in that direction: the
/// "positive" edge of a home switch (3, 19) is the one where it becomes active in positive
/// direction, and is looked for on the way back.
struct HomingMethod {
  std::int8_t code = 0;
  HomeSignal signal = HomeSignal::release;
  int search_direction = 0;  ///< 1 or -1; without a switch the only direction
  ReferenceSwitch reference = ReferenceSwitch::home;
  /// A limit switch met on the way to the home switch turns the motion round; otherwise it stops
  /// the motor.
  bool reverses_at_limit_switch = false;
  bool both_ends = false;  ///< hard stop: the other one is looked for as well
  bool scales = false;     ///< and position objects are scaled to the way between them
};

/// Every method there is; the negative ones are Trinamic's (TMCC160 CANopen manual L2668-L2795). A
/// device refuses the codes its document does not list when 6098h is written.
inline constexpr std::array kHomingMethods{
    HomingMethod{-6, HomeSignal::hard_stop, -1, ReferenceSwitch::home, false, true, true},
    HomingMethod{-5, HomeSignal::hard_stop, +1, ReferenceSwitch::home, false, true, true},
    HomingMethod{-4, HomeSignal::hard_stop, -1, ReferenceSwitch::home, false, true},
    HomingMethod{-3, HomeSignal::hard_stop, +1, ReferenceSwitch::home, false, true},
    HomingMethod{-2, HomeSignal::hard_stop, -1},
    HomingMethod{-1, HomeSignal::hard_stop, +1},
    HomingMethod{1, HomeSignal::release_and_index, -1, ReferenceSwitch::negative_limit},
    HomingMethod{2, HomeSignal::release_and_index, +1, ReferenceSwitch::positive_limit},
    HomingMethod{3, HomeSignal::release_and_index, +1, ReferenceSwitch::home},
    HomingMethod{5, HomeSignal::release_and_index, -1, ReferenceSwitch::home},
    HomingMethod{17, HomeSignal::release, -1, ReferenceSwitch::negative_limit},
    HomingMethod{18, HomeSignal::release, +1, ReferenceSwitch::positive_limit},
    HomingMethod{19, HomeSignal::release, +1, ReferenceSwitch::home, true},
    HomingMethod{21, HomeSignal::release, -1, ReferenceSwitch::home, true},
    HomingMethod{33, HomeSignal::index, -1},
    HomingMethod{34, HomeSignal::index, +1},
    HomingMethod{35, HomeSignal::present_position},
    HomingMethod{37, HomeSignal::present_position},  // the number that took the place of 35
};

/// The row of `code`; null for 0 (no homing) and codes without one.
[[nodiscard]] constexpr const HomingMethod* find_homing_method(int code) {
  for (const HomingMethod& method : kHomingMethods) {
    if (method.code == code) {
      return &method;
    }
  }
  return nullptr;
}

}  // namespace stator::drive
