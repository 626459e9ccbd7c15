#pragma once

#include <memory>
#include <string>

#include "stator/product/device/ethercat_device.hpp"

namespace stator::rack {

/// An EtherCAT device of the rack with the name people gave it.
struct NamedDevice {
  std::string name;
  std::unique_ptr<product::EtherCatDevice> device;
};

}  // namespace stator::rack
