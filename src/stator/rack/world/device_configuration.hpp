#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/junction/junction.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/product/device/can_device.hpp"

namespace stator::rack {

/// A CAN device that is none of the products: a class of one's own, in a program that uses Stator
/// as a library.
struct OwnCanDevice {
  std::function<std::unique_ptr<product::CanDevice>(const base::EventReporter&)> make;
};

/// Configuration of one product; a further product is a further alternative.
using ProductConfiguration =
    std::variant<devices::Tmcm3315Configuration, devices::Tmcc160Configuration,
                 devices::Tmcm142Configuration, devices::Tmc8670Configuration,
                 devices::Tmc8461Configuration, devices::JunctionConfiguration, OwnCanDevice>;

/// The cable in front of a device, on the master's side of it. See wiring.hpp for the defaults.
struct WiringConfiguration {
  std::optional<std::size_t>
      after{};                     ///< device of the segment it hangs at; default: the one before
  std::optional<unsigned> port{};  ///< port of that device; default: the one away from the master
  unsigned entry_port = 0;         ///< port of this device
  base::SimDuration cable_delay = ethercat::Segment::kDefaultCableDelay;
};

/// A serial interface of a device and the line it is connected to.
struct SerialConnection {
  std::string interface;  ///< one of product::Device::serial_interfaces()
  std::string line;       ///< e.g. "pty:/tmp/module"; see link::kSerialLinkForms

  friend bool operator==(const SerialConnection&, const SerialConnection&) = default;
};

struct DeviceConfiguration {
  std::string name;  ///< unique within the rack; prefix of its signals
  ProductConfiguration product;
  WiringConfiguration wiring{};
  /// Of its slave controller, from port to port; default: the product's own.
  std::optional<base::SimDuration> forwarding_delay{};
  std::string eoe_interface{};  ///< TAP interface its EoE is bridged to; empty = no EoE
  std::string host_link{};      ///< socket for the firmware beside a chip; see link::kChipLinkForms
  std::vector<SerialConnection> serial{};  ///< its serial interfaces that have a cable
};

}  // namespace stator::rack
