#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/canopen/storage/parameter_storage.hpp"
#include "stator/devices/tmcc160/axis_world.hpp"
#include "stator/devices/tmcc160/emergencies.hpp"
#include "stator/devices/tmcc160/module_inputs.hpp"
#include "stator/devices/tmcc160/options.hpp"
#include "stator/devices/tmcc160/parameter_memory.hpp"
#include "stator/devices/tmcc160/serial_interface.hpp"
#include "stator/devices/tmcc160/servo_objects.hpp"
#include "stator/drive/servo/servo_axis.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/product/shell/canopen_firmware.hpp"

namespace stator::devices {

/// What surrounds a drive, and the choices its document leaves open.
struct Tmcc160Configuration {
  /// Motor, load, supply, sensors and switches. The defaults fit those of the objects: four pole
  /// pairs, an encoder with 4000 steps.
  plant::ServoAxisParameters axis = tmcc160::default_axis();
  /// 2705h as delivered, 1 to 127; with Options::lss also canopen::kUnconfiguredNodeId.
  std::uint8_t node_id = 1;
  std::uint16_t bit_rate = 1000;  ///< 2704h as delivered, kbit/s; one of tmcc160::kBitRates
  tmcc160::Options options;
  drive::ServoLimits limits;                     ///< where the drive warns and switches off
  base::SimDuration boot_time{500'000'000};      ///< from power-on to the boot-up message
  base::SimDuration sdo_timeout{1'000'000'000};  ///< between two segments
  std::uint32_t serial_number = 0;               ///< 1018h:04 and LSS address, with Options::lss
  dictionary::Quirks quirks;                     ///< what it does otherwise than it should
};

/// The TMCC160 of Trinamic: a servo drive for one three-phase motor on CANopen with CiA 402, as
/// "TMCC160 CANopen Firmware Manual" (firmware V3.00) describes it.
class Tmcc160 final : public product::CanOpenFirmware {
 public:
  static constexpr base::SimDuration kCurrentPeriod = control::ServoController::kPeriod;
  /// RS232 or RS485, as the module is made.
  static constexpr std::array<std::string_view, 1> kSerialInterfaces{"serial"};
  static constexpr base::SimDuration kControlPeriod{1'000'000};
  /// Longest firmware image, bytes; the document names no limit.
  static constexpr std::size_t kFirmwareCapacity = std::size_t{1} << 20;

  explicit Tmcc160(const Tmcc160Configuration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] std::uint32_t bit_rate() const override { return bit_rate_; }
  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kSerialInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override;
  void connect_memory(canopen::NonVolatileMemory& memory) override;
  [[nodiscard]] base::SimDuration bus_off_recovery() const override {
    return base::SimDuration(1'000'000'000);
  }
  [[nodiscard]] dictionary::WriteCompletion* write_completion() override { return &storage_; }
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

  [[nodiscard]] drive::ServoAxis& axis() { return *axis_; }
  [[nodiscard]] const drive::ServoAxis& axis() const { return *axis_; }
  [[nodiscard]] tmcc160::AxisWorld& world() { return world_; }
  [[nodiscard]] tmcc160::ModuleInputs& module_inputs() { return inputs_; }
  /// The electronic data sheet of this very device.
  [[nodiscard]] std::string_view eds() const override { return eds_; }

 private:
  void load_application(base::SimTime now) override;
  void restart(base::SimTime now) override;
  std::uint8_t reset_communication(base::SimTime now) override;
  void load_communication(std::uint8_t node_id, base::SimTime now) override;
  void tick(base::SimTime now) override;
  void step_world(base::SimTime until) override;
  void apply(base::SimTime now) override;
  void state_changed(canopen::NmtState state, base::SimTime now) override;
  void bus_off(base::SimTime now) override { axis_->network_left_operational(now); }

  // What LSS and storage ask of the device.
  [[nodiscard]] bool supports_bit_rate(std::uint32_t bit_rate);
  void activate_bit_rate(std::uint32_t bit_rate, base::SimTime now);
  bool store_network(std::optional<std::uint8_t> node_id, std::optional<std::uint32_t> bit_rate);
  void follow_order(const canopen::StorageCommand& command);
  [[nodiscard]] dictionary::Verdict check_node_id(const dictionary::Entry& entry,
                                                  std::uint64_t value);
  [[nodiscard]] double position_scale() const;

  void wire_storage();
  void configure_axis();
  void report_errors(base::SimTime now);
  void report_error(const drive::AxisEmergency& row, bool present, base::SimTime now);

  void input_enable(double level) { inputs_.set_enable(level >= 0.5); }
  template <std::size_t Input>
  void input_analog(double counts) {
    inputs_.set_analog(Input, static_cast<std::uint16_t>(counts));
  }

  Tmcc160Configuration configuration_;
  std::string eds_;
  tmcc160::ParameterMemory memory_;
  canopen::ParameterStorage storage_;

  tmcc160::AxisWorld world_;
  tmcc160::ModuleInputs inputs_;
  tmcc160::ServoObjects objects_;
  std::optional<drive::ServoAxis> axis_;
  tmcc160::SerialInterface serial_;

  base::SimTime now_;  ///< up to which the axis has come
  std::uint32_t bit_rate_ = 1'000'000;
  std::optional<std::uint32_t> lss_bit_rate_;  ///< activated by LSS, until reset node
  drive::AxisErrors reported_errors_;          ///< as last told
  std::uint32_t reported_resets_ = 0;
};

}  // namespace stator::devices
