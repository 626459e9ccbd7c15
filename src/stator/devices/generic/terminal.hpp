// An EtherCAT device as a file describes it, without a mailbox: a terminal or a coupler.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/generic/object_inputs.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/controller/memory_partner.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::devices::generic {

/// What a rack file says of such a device.
struct TerminalConfiguration {
  std::uint32_t serial_number = 0;
  std::uint16_t station_alias = 0;
  std::int32_t clock_deviation_ppb = 0;  ///< of the oscillator
};

/// A device whose controller does all by itself: its AL state follows the master (device
/// emulation), its process data are lines. What stands in transmit PDOs can be set as inputs; what
/// stands in receive PDOs are signals, which are 0 outside of Operational.
class Terminal final : public product::EtherCatDevice, private ethercat::MemoryPartner {
 public:
  /// `file` is complete (see complete()) and outlives the device. Throws std::logic_error for a
  /// file that no dictionary or EEPROM can be made of.
  Terminal(const ethercat::ImportedSlave& file, const TerminalConfiguration& configuration,
           base::EventReporter reporter);

  [[nodiscard]] ethercat::SlaveController& controller() override { return controller_; }
  [[nodiscard]] const ethercat::SlaveController& controller() const override { return controller_; }
  [[nodiscard]] const ethercat::DeviceDescription& description() const override {
    return description_;
  }
  [[nodiscard]] const dictionary::Dictionary& dictionary() const override { return dictionary_; }
  [[nodiscard]] dictionary::Dictionary& dictionary() override { return dictionary_; }
  [[nodiscard]] std::vector<std::byte> sii_image() const override;
  void advance(base::SimTime now) override { controller_.advance(now); }
  void handle_bus_events(base::SimTime now) override;
  void set_power(bool on, base::SimTime now) override;
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

 private:
  /// An object in the area of a sync manager.
  struct Item {
    dictionary::Entry* entry = nullptr;
    std::size_t bit = 0;
    std::size_t bits = 0;
  };
  /// What one sync manager carries.
  struct Area {
    unsigned channel = 0;
    bool outputs = false;  ///< the master writes it
    std::size_t bytes = 0;
    std::vector<Item> items{};
    std::vector<std::byte> image{};
  };

  void lay_out();
  [[nodiscard]] std::uint16_t start_of(const Area& area) const;
  [[nodiscard]] double al_state() const;

  void start_of_frame(base::SimTime /*time*/) override {}
  void end_of_frame(base::SimTime /*time*/) override {}
  void before_bus_read(base::SimTime time, std::uint16_t address, std::size_t length) override;
  void after_bus_write(base::SimTime time, std::uint16_t address, std::size_t length) override;
  void parameters_changed(base::SimTime /*time*/) override {}
  void al_status_changed(base::SimTime time, std::uint16_t al_status) override;
  void controller_reset(base::SimTime time) override;

  const ethercat::ImportedSlave& file_;
  ethercat::DeviceDescription description_;
  dictionary::Dictionary dictionary_;
  ethercat::SlaveController controller_;
  std::vector<Area> areas_;
  ObjectInputs inputs_;
};

/// What the EEPROM of a device without a mailbox says; sync managers as long as what they carry by
/// default.
[[nodiscard]] ethercat::SiiContents sii_contents(const ethercat::ImportedSlave& file);

}  // namespace stator::devices::generic
