#pragma once

#include "devices/device.hpp"
#include "ethercat/device_description.hpp"
#include "ethercat/eoe.hpp"
#include "ethercat/slave_controller.hpp"

namespace stator::devices {

/// A complete EtherCAT product. Frames go through its slave controller (ethercat::Segment does
/// that). What becomes of the controller when the supply is switched is said to its segment
/// (ethercat::Segment::set_power), before set_power() when switched on.
class EtherCatDevice : public Device {
 public:
  [[nodiscard]] virtual ethercat::SlaveController& controller() = 0;
  [[nodiscard]] virtual const ethercat::DeviceDescription& description() const = 0;
  [[nodiscard]] virtual const dictionary::Dictionary& dictionary() const = 0;
  [[nodiscard]] const dictionary::Dictionary* object_dictionary() const final {
    return &dictionary();
  }

  /// Ethernet over EtherCAT, or null if the device has none or it is switched off.
  [[nodiscard]] virtual ethercat::EoeServer* eoe() { return nullptr; }
};

}  // namespace stator::devices
