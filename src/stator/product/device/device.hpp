#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/canopen/storage/non_volatile_memory.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/write_completion.hpp"
#include "stator/product/device/firmware_memory.hpp"
#include "stator/product/device/indicator.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"

namespace stator::tmcl {
class Firmware;
}

namespace stator::product {

/// A complete product, whatever network it is on: firmware, drives and plants. Passive: time comes
/// in by advance(), what its network brings through the controller its kind of device adds.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  /// To be looked at; null if it has none.
  [[nodiscard]] virtual const dictionary::Dictionary* object_dictionary() const { return nullptr; }
  /// The same, to be written: who does so calls objects_written().
  [[nodiscard]] virtual dictionary::Dictionary* object_dictionary() { return nullptr; }

  /// Its firmware acts on objects that were written otherwise than over its network, as it does on
  /// those an SDO wrote.
  virtual void objects_written(base::SimTime now) { handle_bus_events(now); }

  /// Decides when a write of its objects is complete, as SDO servers ask; null: every write is at
  /// once.
  [[nodiscard]] virtual dictionary::WriteCompletion* write_completion() { return nullptr; }

  /// Brings firmware and plant to `now` in the device's own control periods. Time never goes back;
  /// a `now` before the last one is ignored.
  virtual void advance(base::SimTime now) = 0;

  /// Lets the firmware take what the network has brought. Called after each frame; cheap when
  /// nothing came.
  virtual void handle_bus_events(base::SimTime now) = 0;

  /// The names of its serial interfaces, e.g. "usb": lines of TMCL.
  [[nodiscard]] virtual std::span<const std::string_view> serial_interfaces() const { return {}; }
  /// Connects a serial interface to a line, or disconnects it (null). False: the device has none of
  /// that name.
  virtual bool connect_serial(std::string_view /*interface*/, tmcl::SerialPort* /*port*/) {
    return false;
  }
  /// Something may have come over a serial line: a device whose firmware looks there in every pass
  /// of a fast loop answers it; others look in their next period.
  virtual void handle_serial(base::SimTime /*now*/) {}
  /// When a reply is sent that a serial interface holds back, e.g. for its telegram pause.
  [[nodiscard]] virtual base::SimTime next_serial_reply() const { return base::SimTime::never(); }
  /// What a serial interface is set to, bit/s; nothing: it has none, as USB, or it does not matter.
  [[nodiscard]] virtual std::optional<std::uint32_t> baud_rate(
      std::string_view /*interface*/) const {
    return std::nullopt;
  }

  /// Gives the device memory for its parameters that outlives the supply. Called once at most,
  /// before the first advance(): what is in the memory counts from power-on at 0 on. Without it
  /// what is stored is lost with the device.
  virtual void connect_memory(canopen::NonVolatileMemory& /*memory*/) {}
  /// It stores parameters on command, in such a memory.
  [[nodiscard]] virtual bool stores_parameters() const { return false; }

  /// Where the device keeps a firmware image that came to it; null if it takes none.
  [[nodiscard]] virtual FirmwareMemory* firmware() { return nullptr; }

  /// Switches the device's supply at `now`. Off: its firmware stops with all it knew and its power
  /// stages open; the mechanics go on. On: it starts as after a reset.
  virtual void set_power(bool on, base::SimTime now) = 0;

  /// What its status LEDs show while it has supply.
  [[nodiscard]] virtual Indicators indicators() const { return {}; }
  /// Where its network's state machine stands while it has supply.
  [[nodiscard]] virtual NetworkStatus network_status() const { return {}; }
  /// What runs TMCL programs in it; null: nothing does.
  [[nodiscard]] virtual const tmcl::Firmware* tmcl_firmware() const { return nullptr; }
  [[nodiscard]] virtual tmcl::Firmware* tmcl_firmware() { return nullptr; }

  /// Everything that can be recorded, with names unique within the device.
  [[nodiscard]] virtual std::vector<Signal> signals() const = 0;

  /// Everything around the device that can be set while it runs.
  [[nodiscard]] virtual std::vector<Input> inputs() { return {}; }
};

}  // namespace stator::product
