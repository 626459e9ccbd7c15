#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "stator/base/delegate.hpp"

namespace stator::base {

/// What of the world an input belongs to, by which people find it among many.
enum class InputGroup : std::uint8_t {
  other,
  load,  ///< what turns or holds the shaft from outside
  supply,
  switches,
  sensors,
  driver,  ///< the power stage and its cables to the motor
  heat,
  lines,  ///< general purpose inputs and pins
  network,
};

/// As programs read it.
[[nodiscard]] constexpr std::string_view name_of(InputGroup group) {
  constexpr std::array<std::string_view, 9> kNames{
      "other", "load", "supply", "switches", "sensors", "driver", "heat", "lines", "network"};
  return kNames[static_cast<std::size_t>(group)];
}

/// Something of the world around a device that a person, a timetable or a test may set while it
/// runs, e.g. "axis0.load_torque" in "Nm" or "axis1.home_switch" (0 or 1). The counterpart of
/// Signal. Values are finite and lie in minimum..maximum; who sets one checks that.
struct InputRange {
  std::string name;  ///< unique within the device
  std::string unit{};
  double minimum = 0.0;
  double maximum = 1.0;
  InputGroup group = InputGroup::other;
  double normal = 0.0;  ///< what holds while nobody has set it
};

/// The same with the way to set it, for whoever stands for the world around the device.
struct Input : InputRange {
  Input() = default;
  Input(std::string name_of_it, std::string unit_of_it, double lowest, double highest,
        Delegate<void(double)> setting, InputGroup group_of_it = InputGroup::other,
        double usual = 0.0)
      : set(setting) {
    name = std::move(name_of_it);
    unit = std::move(unit_of_it);
    minimum = lowest;
    maximum = highest;
    group = group_of_it;
    normal = usual;
  }

  Delegate<void(double)> set;
};

}  // namespace stator::base
