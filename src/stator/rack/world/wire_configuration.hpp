#pragma once

#include <optional>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::rack {

/// A signal of one device that sets an input of another, see wires.hpp.
struct WireConfiguration {
  DeviceAddress from;
  std::string signal;  ///< one of product::Device::signals()
  DeviceAddress to;
  std::string input;  ///< one of product::Device::inputs()
  /// A digital wire carries `high` while the signal is at or above the threshold, else `low`;
  /// without a threshold the wire is analog.
  std::optional<double> threshold{0.5};
  double low = 0.0;
  double high = 1.0;
  double scale = 1.0;          ///< of an analog wire, units of the input per unit of the signal
  double offset = 0.0;         ///< of an analog wire, units of the input
  base::SimDuration delay{0};  ///< a multiple of kWirePeriod
};

/// Distance of the instants at which wires act, beginning at power-on.
inline constexpr base::SimDuration kWirePeriod{50'000};

}  // namespace stator::rack
