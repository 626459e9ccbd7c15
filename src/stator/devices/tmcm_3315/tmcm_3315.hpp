#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/devices/tmcm_3315/axis_unit.hpp"
#include "stator/devices/tmcm_3315/emergencies.hpp"
#include "stator/devices/tmcm_3315/module_io.hpp"
#include "stator/devices/tmcm_3315/objects.hpp"
#include "stator/devices/tmcm_3315/usb_monitor.hpp"
#include "stator/ethercat/stack/slave_application.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::devices {

/// What surrounds a module, and the choices its document leaves open.
struct Tmcm3315Configuration {
  /// Motor, load, supply, encoder and switches of each axis. A switch that is not fitted reads low,
  /// which is inactive; set level_if_not_fitted for inputs with a pull-up.
  std::array<plant::StepperAxisParameters, tmcm_3315::kAxisCount> axes{};
  /// A, peak of a coil for a current setting of 255. The document never states it; its worked
  /// example gives 1 A for 85.
  double full_scale_current = 3.0;
  drive::DriverLimits driver_limits;  ///< where the driver chips warn and switch off
  tmcm_3315::FirmwareVersion firmware = tmcm_3315::FirmwareVersion::v1_09;
  std::uint32_t product_code = 3315;      ///< 1018h:02; printed without h, hence decimal
  std::optional<std::uint32_t> revision;  ///< 1018h:03; none: that of the firmware
  std::uint32_t serial_number = 0;        ///< in the SII only, 1018h has no entry for it

  /// The module has no ID switch, so by default no identification; its document names CoE and FoE
  /// only, so by default no Ethernet over EtherCAT.
  product::CoeOptions coe;
  /// At home the position becomes the home offset 607Ch, as on many drives, instead of its
  /// negative.
  bool home_offset_is_position = false;
  dictionary::Quirks quirks;  ///< what it does otherwise than it should
};

/// The TMCM-3315 of Trinamic: three stepper axes on EtherCAT with CoE and CiA 402, as "TMCM-3315
/// CoE Firmware Manual" (firmware V1.09) describes it.
class Tmcm3315 final : public product::EtherCatDevice, private ethercat::SlaveApplication {
 public:
  static constexpr base::SimDuration kPlantStep{50'000};
  static constexpr std::array<std::string_view, 1> kSerialInterfaces{"usb"};
  static constexpr base::SimDuration kControlPeriod{1'000'000};
  /// Longest firmware image, bytes; the document names no limit.
  static constexpr std::size_t kFirmwareCapacity = std::size_t{2} << 20;

  explicit Tmcm3315(const Tmcm3315Configuration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] ethercat::SlaveController& controller() override { return controller_; }
  [[nodiscard]] const dictionary::Dictionary& dictionary() const override { return dictionary_; }
  [[nodiscard]] ethercat::SlaveStack* slave_stack() override { return &stack_; }
  [[nodiscard]] const ethercat::DeviceDescription& description() const override {
    return description_;
  }
  void advance(base::SimTime now) override;
  void handle_bus_events(base::SimTime now) override;
  [[nodiscard]] product::FirmwareMemory* firmware() override { return &firmware_; }
  [[nodiscard]] ethercat::EoeServer* eoe() override { return stack_.eoe(); }
  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kSerialInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override;
  void set_power(bool on, base::SimTime now) override;
  [[nodiscard]] std::vector<product::Signal> signals() override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

  [[nodiscard]] tmcm_3315::AxisUnit& axis(std::size_t number) { return *axes_[number]; }
  [[nodiscard]] const ethercat::SlaveStack& stack() const { return stack_; }

  /// Level of general-purpose input IN0..IN3 from the next control period on.
  void set_digital_input(std::size_t input, bool high) { io_.set_level(input, high); }
  /// Reading of analog input 0..3, ADC counts.
  void set_analog_input(std::size_t input, std::uint16_t counts) { io_.set_counts(input, counts); }
  /// The shutdown switch: while active no axis has power.
  void set_shutdown_switch(bool active) { shutdown_switch_ = active; }
  /// OUT0..OUT3 in bits 16..19, as 2703h has them.
  [[nodiscard]] std::uint32_t digital_outputs() const { return io_.output_bits(); }

 private:
  void on_state(ethercat::AlState from, ethercat::AlState to, base::SimTime now) override;
  void on_outputs(base::SimTime now) override;
  void on_sync0(base::SimTime now) override;
  void before_inputs(base::SimTime now) override;
  void on_output_refused(const dictionary::Entry& entry, const dictionary::Refusal& refusal,
                         base::SimTime now) override;

  [[nodiscard]] base::StaticText drive_state(std::uint8_t axis);
  void set_identity(const Tmcm3315Configuration& configuration);
  void process_bus(base::SimTime now);
  void restart_firmware(base::SimTime now);
  /// Everything is as before the firmware starts.
  void stop_firmware(base::SimTime now);
  void tick(base::SimTime now);
  /// Lets the firmware's interrupt run if SYNC0 has come.
  void take_sync0(base::SimTime now);
  void apply_commands(base::SimTime now);
  /// What the module does while its boot loader is at work, which USB has started.
  void run_boot_loader(base::SimTime now);
  void switch_outputs();
  void feed_brakes();
  void report_errors(base::SimTime now);
  [[nodiscard]] bool told_by_another(std::uint8_t motor, drive::AxisError error) const;
  void input_shutdown_switch(double level) { set_shutdown_switch(level >= 0.5); }
  void send_emergency(const tmcm_3315::Emergency& emergency, std::uint8_t motor, base::SimTime now);
  [[nodiscard]] std::uint8_t error_register() const;

  Tmcm3315Configuration configuration_;
  base::EventReporter reporter_;
  ethercat::DeviceDescription description_;
  dictionary::Dictionary dictionary_;
  ethercat::SlaveController controller_;
  product::FirmwareMemory firmware_{kFirmwareCapacity};
  std::array<std::unique_ptr<tmcm_3315::AxisUnit>, tmcm_3315::kAxisCount> axes_;
  ethercat::SlaveStack stack_;

  dictionary::Variable<std::uint8_t> error_register_;  // 1001h
  tmcm_3315::ModuleIo io_;
  tmcm_3315::UsbMonitor usb_;

  base::SimTime now_;
  base::SimTime next_tick_{kControlPeriod};
  bool shutdown_switch_ = false;
  bool outputs_came_ = false;
  std::uint32_t downloads_in_force_ = 0;  ///< of firmware_ at the last start of the firmware
  bool restart_due_ = false;              ///< Bootstrap was left with a new image
  bool powered_ = true;
  std::uint64_t sync0_pulses_ = 0;  ///< the firmware has seen
  /// An interrupt routine takes its time: pulses that a master sets too close are seen as one.
  base::SimTime sync0_earliest_;
  /// As last told to the master by emergencies.
  std::array<drive::AxisErrors, tmcm_3315::kAxisCount> reported_errors_{};
  std::array<std::uint32_t, tmcm_3315::kAxisCount> reported_resets_{};
};

}  // namespace stator::devices
