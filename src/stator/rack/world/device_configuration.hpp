#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/product/catalogue/setup.hpp"

namespace stator::rack {

/// The cable in front of a device, on the master's side of it. See wiring.hpp for the defaults.
struct WiringConfiguration {
  std::optional<std::size_t>
      after{};                     ///< device of the segment it hangs at; default: the one before
  std::optional<unsigned> port{};  ///< port of that device; default: the one away from the master
  unsigned entry_port = 0;         ///< port of this device
  base::SimDuration cable_delay = ethercat::kDefaultCableDelay;
};

/// A serial interface of a device and the line it is connected to.
struct SerialConnection {
  std::string interface;  ///< one of product::Device::serial_interfaces()
  std::string line;       ///< e.g. "pty:/tmp/module"; see link::kSerialLinkForms

  friend bool operator==(const SerialConnection&, const SerialConnection&) = default;
};

struct DeviceConfiguration {
  std::string name;  ///< unique within the rack; prefix of its signals
  product::Setup setup;
  WiringConfiguration wiring{};
  /// Of its slave controller, from port to port; default: the product's own.
  std::optional<base::SimDuration> forwarding_delay{};
  std::string eoe_interface{};  ///< TAP interface its EoE is bridged to; empty = no EoE
  std::string host_link{};      ///< socket for the firmware beside a chip; see link::kChipLinkForms
  std::vector<SerialConnection> serial{};  ///< its serial interfaces that have a cable
};

}  // namespace stator::rack
