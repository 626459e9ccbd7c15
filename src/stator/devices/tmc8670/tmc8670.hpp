#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/canopen/storage/parameter_storage.hpp"
#include "stator/devices/tmc8670/axis_unit.hpp"
#include "stator/devices/tmc8670/configuration.hpp"
#include "stator/devices/tmc8670/hardware_uart.hpp"
#include "stator/devices/tmc8670/logic_supply.hpp"
#include "stator/devices/tmc8670/mcu_uart.hpp"
#include "stator/devices/tmc8670/synchronisation.hpp"
#include "stator/drive/axis/error_report.hpp"
#include "stator/ethercat/stack/slave_application.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/product/device/parameter_images.hpp"

namespace stator::devices {

/// The TMC8670 of Trinamic: EtherCAT slave controller, firmware with CoE and CiA 402, and
/// field-oriented control of one motor in a chip ("TMC8670 datasheet" V1.00), with a power stage,
/// a motor and sensors around it.
///
/// Three things happen in order of time: PWM periods of the FOC block, the firmware's period of 125
/// us, and SYNC0. While the master synchronises by SYNC0 the firmware's period begins with it, so
/// that set-points are taken over and positions are sampled at SYNC0 and nowhere else.
class Tmc8670 final : public product::EtherCatDevice, private ethercat::SlaveApplication {
 public:
  static constexpr base::SimDuration kControlPeriod = tmc8670::AxisUnit::kControlPeriod;
  static constexpr std::array<std::string_view, 2> kSerialInterfaces{"mcu-uart", "hardware-uart"};
  /// Longest firmware image, bytes; the document names no limit.
  static constexpr std::size_t kFirmwareCapacity = std::size_t{1} << 20;

  /// Throws std::logic_error for a controller preset or an object that does not exist.
  explicit Tmc8670(const Tmc8670Configuration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] ethercat::SlaveController& controller() override { return controller_; }
  [[nodiscard]] const dictionary::Dictionary& dictionary() const override { return dictionary_; }
  [[nodiscard]] ethercat::SlaveStack* slave_stack() override { return &stack_; }
  [[nodiscard]] ethercat::EoeServer* eoe() override { return stack_.eoe(); }
  [[nodiscard]] const ethercat::DeviceDescription& description() const override {
    return description_;
  }
  void advance(base::SimTime now) override;
  void handle_bus_events(base::SimTime now) override;
  [[nodiscard]] product::FirmwareMemory* firmware() override { return &firmware_; }
  void connect_memory(canopen::NonVolatileMemory& memory) override;
  [[nodiscard]] bool stores_parameters() const override { return true; }
  [[nodiscard]] dictionary::WriteCompletion* write_completion() override { return &storage_; }
  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kSerialInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override;
  void handle_serial(base::SimTime now) override;
  [[nodiscard]] std::optional<std::uint32_t> baud_rate(std::string_view interface) const override;
  void set_power(bool on, base::SimTime now) override;
  [[nodiscard]] std::vector<product::Signal> signals() override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

  [[nodiscard]] tmc8670::AxisUnit& axis() { return axis_; }
  [[nodiscard]] const ethercat::SlaveStack& stack() const { return stack_; }

 private:
  [[nodiscard]] ethercat::AlStatusCode permit_state(ethercat::AlState from, ethercat::AlState to,
                                                    base::SimTime now) override;
  [[nodiscard]] bool explains_refusals() const override { return true; }
  void on_state(ethercat::AlState from, ethercat::AlState to, base::SimTime now) override;
  void on_outputs(base::SimTime now) override;
  void on_sync0(base::SimTime now) override;
  void before_inputs(base::SimTime now) override;
  void on_output_refused(const dictionary::Entry& entry, const dictionary::Refusal& refusal,
                         base::SimTime now) override;

  void show_version(dictionary::Entry& entry);
  void process_bus(base::SimTime now);
  void restart_firmware(base::SimTime now);
  /// The chip has got or lost its supply.
  void restart_chip(bool powered, base::SimTime now);
  template <std::size_t Rail>
  void set_logic_supply(double volts) {
    supply_.set_voltage(Rail, volts, controller_.now());
    take_logic_supply(controller_.now());
  }
  void take_logic_supply(base::SimTime now);
  /// Everything is as before the firmware starts.
  void stop_firmware(base::SimTime now);
  void tick(base::SimTime now);
  /// The part of the firmware's period that concerns the axis.
  void run_axis(base::SimTime now);
  void take_sync0(base::SimTime now);
  void apply_commands(base::SimTime now);
  /// What the chip does while its boot loader is at work, which the MCU UART has started.
  void run_boot_loader(base::SimTime now);
  void report_errors(base::SimTime now);
  void watch_junction(base::SimTime now);
  void send_emergency(std::uint16_t code, std::uint8_t register_bits, std::uint8_t detail,
                      base::SimTime now);

  // The LEDs of the chip, coded as registers 0138h and 0139h.
  [[nodiscard]] double led_run() const { return static_cast<double>(controller_.run_led()); }
  [[nodiscard]] double led_error() const { return static_cast<double>(controller_.error_led()); }
  template <unsigned Port>
  [[nodiscard]] double led_link() const {
    return static_cast<double>(controller_.link_led(Port));
  }
  // What happens at the ports.
  void append_port_inputs(std::vector<product::Input>& inputs);
  template <unsigned Port>
  void set_link_partner(double kind) {
    controller_.set_link_partner(Port, static_cast<ethercat::LinkPartner>(static_cast<int>(kind)));
  }
  /// Below 0 the PHY drives the pin.
  template <unsigned Port>
  void hold_link_pin(double level) {
    controller_.hold_link_pin(Port, level < 0.0 ? std::nullopt : std::optional(level >= 0.5));
  }
  template <unsigned Port>
  [[nodiscard]] double link_pin() const {
    return controller_.link_pin(Port) ? 1.0 : 0.0;
  }

  Tmc8670Configuration configuration_;
  base::EventReporter reporter_;
  ethercat::DeviceDescription description_;
  dictionary::Dictionary dictionary_;
  ethercat::SlaveController controller_;
  product::FirmwareMemory firmware_{kFirmwareCapacity};
  product::ParameterImages memory_;
  tmc8670::AxisUnit axis_;
  tmc8670::LogicSupply supply_;
  ethercat::SlaveStack stack_;
  canopen::ParameterStorage storage_;
  tmc8670::Synchronisation synchronisation_;
  tmc8670::HardwareUart hardware_uart_;
  tmc8670::McuUart mcu_uart_;

  drive::ErrorReport error_report_;

  base::SimTime next_period_;  ///< when the next PWM period begins
  base::SimTime next_tick_{kControlPeriod};
  /// Periods of the firmware until the next SYNC0 has to come.
  std::int64_t ticks_to_sync_ = 0;
  bool outputs_came_ = false;
  std::uint32_t downloads_in_force_ = 0;  ///< of firmware_ at the last start of the firmware
  bool restart_due_ = false;              ///< Bootstrap was left with a new image
  bool powered_ = true;
  std::uint64_t sync0_pulses_ = 0;  ///< the firmware has seen
  /// An interrupt routine takes its time: pulses that a master sets too close are seen as one.
  base::SimTime sync0_earliest_;
  bool junction_hot_ = false;  ///< told
};

}  // namespace stator::devices
