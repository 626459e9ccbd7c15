#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/canopen/emergency/controller_supervision.hpp"
#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/canopen/emergency/error_behaviour.hpp"
#include "stator/canopen/nmt/node.hpp"
#include "stator/canopen/pdo/pdo_service.hpp"
#include "stator/canopen/storage/parameter_storage.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/devices/tmcc160/axis_world.hpp"
#include "stator/devices/tmcc160/emergencies.hpp"
#include "stator/devices/tmcc160/module_inputs.hpp"
#include "stator/devices/tmcc160/options.hpp"
#include "stator/devices/tmcc160/parameter_memory.hpp"
#include "stator/devices/tmcc160/serial_interface.hpp"
#include "stator/devices/tmcc160/servo_objects.hpp"
#include "stator/drive/servo/servo_axis.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/firmware_memory.hpp"

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
class Tmcc160 final : public product::CanDevice {
 public:
  static constexpr base::SimDuration kCurrentPeriod = control::ServoController::kPeriod;
  /// RS232 or RS485, as the module is made.
  static constexpr std::array<std::string_view, 1> kSerialInterfaces{"serial"};
  static constexpr base::SimDuration kControlPeriod{1'000'000};
  /// Longest firmware image, bytes; the document names no limit.
  static constexpr std::size_t kFirmwareCapacity = std::size_t{1} << 20;

  explicit Tmcc160(const Tmcc160Configuration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] can::Controller& controller() override { return controller_; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return bit_rate_; }
  [[nodiscard]] dictionary::NetworkState network_state() const override {
    return node_.state() == canopen::NmtState::operational
               ? dictionary::NetworkState::operational
               : dictionary::NetworkState::pre_operational;
  }
  void objects_written(base::SimTime now) override { apply_commands(now); }
  [[nodiscard]] base::SimTime next_deadline() const override;
  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kSerialInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override;
  void connect_memory(canopen::NonVolatileMemory& memory) override;
  [[nodiscard]] base::SimDuration bus_off_recovery() const override {
    return base::SimDuration(1'000'000'000);
  }

  [[nodiscard]] const dictionary::Dictionary& dictionary() const { return dictionary_; }
  [[nodiscard]] const dictionary::Dictionary* object_dictionary() const override {
    return &dictionary_;
  }
  [[nodiscard]] dictionary::WriteCompletion* write_completion() override { return &storage_; }
  /// The document describes no LEDs: RUN and ERR as CiA 303-3 has them.
  [[nodiscard]] product::Indicators indicators() override;
  [[nodiscard]] product::NetworkStatus network_status() override;
  void advance(base::SimTime now) override;
  void handle_bus_events(base::SimTime now) override;
  [[nodiscard]] product::FirmwareMemory* firmware() override { return &firmware_; }
  void set_power(bool on, base::SimTime now) override;
  [[nodiscard]] std::vector<product::Signal> signals() override;
  [[nodiscard]] std::vector<product::Input> inputs() override;

  [[nodiscard]] const canopen::Node& node() const { return node_; }
  [[nodiscard]] const canopen::EmergencyProducer& emergencies() const { return emergencies_; }
  [[nodiscard]] drive::ServoAxis& axis() { return *axis_; }
  [[nodiscard]] const drive::ServoAxis& axis() const { return *axis_; }
  [[nodiscard]] tmcc160::AxisWorld& world() { return world_; }
  [[nodiscard]] tmcc160::ModuleInputs& module_inputs() { return inputs_; }
  /// The electronic data sheet of this very device.
  [[nodiscard]] std::string_view eds() const override { return eds_; }

 private:
  // What the node asks of its device.
  void reset_application(base::SimTime now);
  std::uint8_t reset_communication(base::SimTime now);
  void assign_node_id(std::uint8_t node_id, base::SimTime now);
  void follow_state(canopen::NmtState state, base::SimTime now);
  void take_process_data(base::SimTime now) { apply_commands(now); }
  void stop_at_bus_off(base::SimTime now) { axis_->network_left_operational(now); }
  [[nodiscard]] canopen::NmtState nmt_state() const { return node_.state(); }
  void enter_state(canopen::NmtState state, base::SimTime now) { node_.enter(state, now); }
  [[nodiscard]] bool supports_bit_rate(std::uint32_t bit_rate);
  void activate_bit_rate(std::uint32_t bit_rate, base::SimTime now);
  bool store_network(std::optional<std::uint8_t> node_id, std::optional<std::uint32_t> bit_rate);
  void follow_order(const canopen::StorageCommand& command);
  [[nodiscard]] dictionary::Verdict check_node_id(const dictionary::Entry& entry,
                                                  std::uint64_t value);
  [[nodiscard]] double position_scale() const;

  void set_defaults();
  void wire_node();
  void start_firmware(base::SimTime now);
  void restart_axis();
  void configure_axis();
  void step_until(base::SimTime end);
  void tick(base::SimTime now);
  void process_bus(base::SimTime now);
  void apply_commands(base::SimTime now);
  void run_boot_loader(base::SimTime now);
  void report_errors(base::SimTime now);
  void report_error(const tmcc160::AxisEmergency& row, bool present, base::SimTime now);

  void input_enable(double level) { inputs_.set_enable(level >= 0.5); }
  template <std::size_t Input>
  void input_analog(double counts) {
    inputs_.set_analog(Input, static_cast<std::uint16_t>(counts));
  }

  Tmcc160Configuration configuration_;
  base::EventReporter reporter_;
  dictionary::Dictionary dictionary_;
  std::string eds_;
  can::Controller controller_;
  product::FirmwareMemory firmware_{kFirmwareCapacity};
  tmcc160::ParameterMemory memory_;

  canopen::Node node_;
  canopen::EmergencyProducer emergencies_;
  canopen::SyncConsumer sync_;
  canopen::PdoService pdos_;
  canopen::ErrorBehaviour error_behaviour_;
  canopen::ControllerSupervision supervision_;
  canopen::ParameterStorage storage_;

  tmcc160::AxisWorld world_;
  tmcc160::ModuleInputs inputs_;
  tmcc160::ServoObjects objects_;
  std::optional<drive::ServoAxis> axis_;
  tmcc160::SerialInterface serial_;

  base::SimTime now_;
  base::SimTime next_tick_{kControlPeriod};
  bool powered_ = true;
  std::uint32_t bit_rate_ = 1'000'000;
  std::optional<std::uint32_t> lss_bit_rate_;  ///< activated by LSS, until reset node
  drive::AxisErrors reported_errors_;          ///< as last told
  std::uint32_t reported_resets_ = 0;
};

}  // namespace stator::devices
