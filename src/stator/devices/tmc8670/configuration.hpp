#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/devices/tmc8670/axis_world.hpp"
#include "stator/devices/tmc8670/objects.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/catalogue/parts.hpp"

namespace stator::devices {

/// What surrounds a chip, and the choices its document leaves open.
struct Tmc8670Configuration {
  /// Motor, load, supply, power stage, converters, sensors and switches.
  plant::PwmAxisParameters axis = tmc8670::default_axis();
  /// Objects that are delivered with another default, e.g. gains that suit the motor.
  std::vector<tmc8670::ObjectValue> objects;
  /// Preset of the slave controller: "document" or "silicon".
  std::string controller = "document";
  std::int32_t clock_deviation_ppb = 0;  ///< of the oscillator
  /// Straps MIIx_TX_SHIFT, 0..3 steps of 10 ns per port; nothing: MIIx_TXCLK are connected and the
  /// chip finds the steps itself.
  std::optional<std::array<std::uint8_t, 2>> tx_shift{{0, 0}};
  /// ns by which the PHYs' transmit clocks are late against the chip's, 0..30.
  std::array<std::uint8_t, 2> tx_clock_phase{};
  bool link_polarity = false;  ///< strap LINK_POLARITY: the link pins of both ports are active high
  std::array<bool, 2> phy_link_active_high{};  ///< what the PHYs drive there
  /// At which the PHYs of ports 0 and 1 answer; nothing: where the chip looks for them.
  std::optional<std::array<std::uint8_t, 2>> phy_addresses;
  /// "System time PDI controlled": the host steers the distributed clock (0910h) and not the bus.
  bool host_controls_time = false;
  std::uint32_t serial_number = 0;  ///< 1018h:04

  /// The chip has no ID switch, so by default no identification; its firmware's document does not
  /// name Ethernet over EtherCAT, so by default none.
  product::CoeOptions coe;
  dictionary::Quirks quirks;  ///< what it does otherwise than it should
};

}  // namespace stator::devices
