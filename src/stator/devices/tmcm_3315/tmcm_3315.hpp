#pragma once

#include <array>
#include <cstddef>
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
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"

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
class Tmcm3315 final : public product::EtherCatFirmware {
 public:
  static constexpr base::SimDuration kPlantStep{50'000};
  static constexpr std::array<std::string_view, 1> kSerialInterfaces{"usb"};
  /// Longest firmware image, bytes; the document names no limit.
  static constexpr std::size_t kFirmwareCapacity = std::size_t{2} << 20;

  explicit Tmcm3315(const Tmcm3315Configuration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kSerialInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override;
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

  [[nodiscard]] tmcm_3315::AxisUnit& axis(std::size_t number) { return *axes_[number]; }

  /// Level of general-purpose input IN0..IN3 from the next control period on.
  void set_digital_input(std::size_t input, bool high) { io_.set_level(input, high); }
  /// Reading of analog input 0..3, ADC counts.
  void set_analog_input(std::size_t input, std::uint16_t counts) { io_.set_counts(input, counts); }
  /// The shutdown switch: while active no axis has power.
  void set_shutdown_switch(bool active) { shutdown_switch_ = active; }
  /// OUT0..OUT3 in bits 16..19, as 2703h has them.
  [[nodiscard]] std::uint32_t digital_outputs() const { return io_.output_bits(); }

 private:
  void restart(base::SimTime now) override;
  void tick(base::SimTime now) override;
  void step_world(base::SimTime until) override;
  void apply(base::SimTime now) override;
  void outputs_obeyed() override { switch_outputs(); }
  void at_sync0(base::SimTime now) override;
  void network_operational(bool operational, base::SimTime now) override;

  [[nodiscard]] base::StaticText drive_state(std::uint8_t axis);
  void set_identity();
  void switch_outputs();
  void feed_brakes();
  void report_errors(base::SimTime now);
  [[nodiscard]] bool told_by_another(std::uint8_t motor, drive::AxisError error) const;
  void input_shutdown_switch(double level) { set_shutdown_switch(level >= 0.5); }
  void show_errors();
  void send(const drive::AxisEmergency& row, std::uint8_t motor, base::SimTime now);

  std::uint32_t product_code_;
  std::array<std::unique_ptr<tmcm_3315::AxisUnit>, tmcm_3315::kAxisCount> axes_;
  tmcm_3315::ModuleIo io_;
  tmcm_3315::UsbMonitor usb_;

  base::SimTime now_;  ///< up to which the axes have come
  bool shutdown_switch_ = false;
  /// As last told to the master by emergencies.
  std::array<drive::AxisErrors, tmcm_3315::kAxisCount> reported_errors_{};
  std::array<std::uint32_t, tmcm_3315::kAxisCount> reported_resets_{};
};

}  // namespace stator::devices
