#pragma once

#include <string_view>

#include "stator/can/controller.hpp"
#include "stator/product/device/device.hpp"

namespace stator::product {

/// A complete product on a CAN bus. The bus delivers frames to its controller and fetches what it
/// sends; handle_bus_events() lets the firmware take them, and is called also when the controller
/// gets into another error state.
class CanDevice : public Device {
 public:
  [[nodiscard]] virtual can::Controller& controller() = 0;
  [[nodiscard]] virtual const can::Controller& controller() const = 0;

  /// What its NMT state means for writes of its objects.
  [[nodiscard]] virtual dictionary::NetworkState network_state() const {
    return dictionary::NetworkState::pre_operational;
  }

  /// The bit rate its controller is set to, bit/s. It changes with a reset at most.
  [[nodiscard]] virtual std::uint32_t bit_rate() const = 0;

  /// The next moment at which the device does something on its own that others on the bus can see;
  /// advance() must not step over it, and after advance() to it the next one is later.
  [[nodiscard]] virtual base::SimTime next_deadline() const = 0;

  /// How long the controller stays bus-off before it takes part again; the standard's 128 x 11
  /// recessive bits at least.
  [[nodiscard]] virtual base::SimDuration bus_off_recovery() const { return {}; }

  /// Its electronic data sheet, the text of an EDS file; empty if it has none.
  [[nodiscard]] virtual std::string_view eds() const { return {}; }
};

}  // namespace stator::product
