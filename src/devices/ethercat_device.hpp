#pragma once

#include <vector>

#include "base/sim_time.hpp"
#include "devices/firmware_memory.hpp"
#include "devices/input.hpp"
#include "devices/signal.hpp"
#include "dictionary/dictionary.hpp"
#include "ethercat/device_description.hpp"
#include "ethercat/eoe.hpp"
#include "ethercat/slave_controller.hpp"
#include "tmcl/serial_port.hpp"

namespace stator::devices {

/// A complete EtherCAT product: slave controller, firmware, drives and plants. Passive: frames go
/// through its controller (ethercat::Segment does that), time comes in by advance().
class EtherCatDevice {
 public:
  EtherCatDevice() = default;
  EtherCatDevice(const EtherCatDevice&) = delete;
  EtherCatDevice& operator=(const EtherCatDevice&) = delete;
  virtual ~EtherCatDevice() = default;

  [[nodiscard]] virtual ethercat::SlaveController& controller() = 0;
  [[nodiscard]] virtual const dictionary::Dictionary& dictionary() const = 0;
  [[nodiscard]] virtual const ethercat::DeviceDescription& description() const = 0;

  /// Brings firmware and plant to `now` in the device's own control periods. Time never goes back;
  /// a `now` before the last one is ignored.
  virtual void advance(base::SimTime now) = 0;

  /// Lets the firmware take what the last frame brought: AL control, mailboxes, process data.
  /// Called after each frame; cheap when nothing came.
  virtual void handle_bus_events(base::SimTime now) = 0;

  /// Where the device keeps a firmware image that came over the bus; null if it takes none.
  [[nodiscard]] virtual FirmwareMemory* firmware() { return nullptr; }

  /// Ethernet over EtherCAT, or null if the device has none or it is switched off.
  [[nodiscard]] virtual ethercat::EoeServer* eoe() { return nullptr; }

  /// Connects the device's USB interface, a serial line of binary TMCL, or disconnects it (null).
  /// False: it has none. The device looks for bytes in its firmware's loop.
  virtual bool connect_usb(tmcl::SerialPort* /*port*/) { return false; }

  /// Switches the device's supply at `now`. Off: its firmware stops with all it knew and its power
  /// stages open; the mechanics go on. On: it starts as after a reset. What becomes of the slave
  /// controller is said to its segment (ethercat::Segment::set_power), before this when switched
  /// on.
  virtual void set_power(bool on, base::SimTime now) = 0;

  /// Everything that can be recorded, with names unique within the device.
  [[nodiscard]] virtual std::vector<Signal> signals() = 0;

  /// Everything around the device that can be set while it runs.
  [[nodiscard]] virtual std::vector<Input> inputs() { return {}; }
};

}  // namespace stator::devices
