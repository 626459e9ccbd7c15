#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::devices {

/// What a junction is ordered with.
struct JunctionConfiguration {
  std::uint8_t ports = 4;  ///< 3 or 4
  std::uint32_t serial_number = 0;
  std::uint16_t station_alias = 0;
  std::int32_t clock_deviation_ppb = 0;  ///< of the oscillator
};

/// A coupler that branches a segment: a slave controller with three or four ports and nothing else.
/// It has no firmware, no mailbox and no process data; its AL state follows the master (device
/// emulation). Frames come in at port 0 and go on to port 3, then 1, then 2 and back
/// (ETG.1000.4 §4.2). Nobody's product: vendor ID and product code are made up.
class Junction final : public product::EtherCatDevice {
 public:
  /// "STAT" and "JUN" in ASCII: outside of the numbers that the ETG assigns.
  static constexpr std::uint32_t kVendorId = 0x53544154;
  static constexpr std::uint32_t kProductCode = 0x4A554E00;  ///< plus the number of ports

  /// Throws std::logic_error for another number of ports.
  explicit Junction(const JunctionConfiguration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] ethercat::SlaveController& controller() override { return controller_; }
  [[nodiscard]] const ethercat::SlaveController& controller() const override { return controller_; }
  [[nodiscard]] const ethercat::DeviceDescription& description() const override {
    return description_;
  }
  /// Empty.
  [[nodiscard]] const dictionary::Dictionary& dictionary() const override { return dictionary_; }
  [[nodiscard]] dictionary::Dictionary& dictionary() override { return dictionary_; }
  void advance(base::SimTime now) override { controller_.advance(now); }
  void handle_bus_events(base::SimTime now) override;
  void set_power(bool on, base::SimTime now) override;
  /// AL status, and for each port whether it has a link and whether frames leave through it.
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override { return {clock_deviation_input()}; }

 private:
  struct Probe {
    const ethercat::SlaveController* controller = nullptr;
    unsigned port = 0;
    [[nodiscard]] double link() const { return controller->link(port) ? 1.0 : 0.0; }
    [[nodiscard]] double open() const { return controller->port_open(port) ? 1.0 : 0.0; }
  };
  [[nodiscard]] double al_state() const;

  ethercat::DeviceDescription description_;
  dictionary::Dictionary dictionary_;
  ethercat::SlaveController controller_;
  std::array<Probe, ethercat::kPortsPerSlave> probes_{};
};

}  // namespace stator::devices
