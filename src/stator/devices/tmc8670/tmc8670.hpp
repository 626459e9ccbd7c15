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
#include "stator/product/device/parameter_images.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"

namespace stator::devices {

/// The TMC8670 of Trinamic: EtherCAT slave controller, firmware with CoE and CiA 402, and
/// field-oriented control of one motor in a chip ("TMC8670 datasheet" V1.00), with a power stage,
/// a motor and sensors around it.
///
/// Three things happen in order of time: PWM periods of the FOC block, the firmware's period of 125
/// us, and SYNC0. While the master synchronises by SYNC0 the firmware's period begins with it, so
/// that set-points are taken over and positions are sampled at SYNC0 and nowhere else.
class Tmc8670 final : public product::EtherCatFirmware {
 public:
  static constexpr std::array<std::string_view, 2> kSerialInterfaces{"mcu-uart", "hardware-uart"};
  /// Longest firmware image, bytes; the document names no limit.
  static constexpr std::size_t kFirmwareCapacity = std::size_t{1} << 20;

  /// Throws std::logic_error for a controller preset or an object that does not exist.
  explicit Tmc8670(const Tmc8670Configuration& configuration, base::EventReporter reporter = {});

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
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

  [[nodiscard]] tmc8670::AxisUnit& axis() { return axis_; }

 private:
  [[nodiscard]] ethercat::AlStatusCode permit_state(ethercat::AlState from, ethercat::AlState to,
                                                    base::SimTime now) override;
  [[nodiscard]] bool explains_refusals() const override { return true; }
  void on_state(ethercat::AlState from, ethercat::AlState to, base::SimTime now) override;
  void before_inputs(base::SimTime now) override;
  void restart(base::SimTime now) override;
  void tick(base::SimTime now) override;
  void step_world(base::SimTime until) override;
  void apply(base::SimTime now) override;
  void at_sync0(base::SimTime now) override;
  void network_operational(bool operational, base::SimTime now) override;
  void before_bus() override { synchronisation_.refresh(*slave_stack()); }
  void tick_without_firmware(base::SimTime now) override { hardware_uart_.serve(now); }

  void show_version(dictionary::Entry& entry);
  /// The chip has got or lost its supply.
  void restart_chip(bool powered, base::SimTime now);
  template <std::size_t Rail>
  void set_logic_supply(double volts) {
    supply_.set_voltage(Rail, volts, controller().now());
    take_logic_supply(controller().now());
  }
  void take_logic_supply(base::SimTime now);
  /// The part of the firmware's period that concerns the axis.
  void run_axis(base::SimTime now);
  void report_errors(base::SimTime now);
  void watch_junction(base::SimTime now);

  // The LEDs of the chip, coded as registers 0138h and 0139h.
  [[nodiscard]] double led_run() const { return static_cast<double>(controller().run_led()); }
  [[nodiscard]] double led_error() const { return static_cast<double>(controller().error_led()); }
  template <unsigned Port>
  [[nodiscard]] double led_link() const {
    return static_cast<double>(controller().link_led(Port));
  }
  // What happens at the ports.
  void append_port_inputs(std::vector<product::Input>& inputs);
  template <unsigned Port>
  void set_link_partner(double kind) {
    controller().set_link_partner(Port, static_cast<ethercat::LinkPartner>(static_cast<int>(kind)));
  }
  /// Below 0 the PHY drives the pin.
  template <unsigned Port>
  void hold_link_pin(double level) {
    controller().hold_link_pin(Port, level < 0.0 ? std::nullopt : std::optional(level >= 0.5));
  }
  template <unsigned Port>
  [[nodiscard]] double link_pin() const {
    return controller().link_pin(Port) ? 1.0 : 0.0;
  }

  product::ParameterImages memory_;
  tmc8670::AxisUnit axis_;
  tmc8670::LogicSupply supply_;
  canopen::ParameterStorage storage_;
  tmc8670::Synchronisation synchronisation_;
  tmc8670::HardwareUart hardware_uart_;
  tmc8670::McuUart mcu_uart_;

  drive::ErrorReport error_report_;

  base::SimTime next_period_;  ///< when the next PWM period begins
  bool junction_hot_ = false;  ///< told
};

}  // namespace stator::devices
