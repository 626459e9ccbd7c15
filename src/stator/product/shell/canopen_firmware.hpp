#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/controller.hpp"
#include "stator/canopen/emergency/controller_supervision.hpp"
#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/canopen/emergency/error_behaviour.hpp"
#include "stator/canopen/nmt/node.hpp"
#include "stator/canopen/pdo/pdo_service.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/firmware_memory.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::product {

/// What firmwares of CANopen products do differently.
struct CanOpenFirmwareRules {
  /// Of CanOpenFirmware::tick().
  base::SimDuration control_period{1'000'000};
  canopen::EmergencyRules emergencies{};
  canopen::SyncRules sync{};
  canopen::PdoRules pdos{};
  std::span<const canopen::ErrorBehaviourValue> error_behaviour = canopen::kErrorBehaviourOfCia301;
  /// Objects from here on belong to the application: reset node gives them their defaults. Those
  /// below are communication objects.
  std::uint16_t first_application_object = 0x2000;
  /// Most bytes of a firmware image; 0: the product takes none.
  std::size_t firmware_capacity = 0;
  /// A new image is there and the firmware starts again; argument: {0} bytes. Null: in the words of
  /// all that have none of their own.
  const base::EventRule* new_firmware = nullptr;
};

/// A CANopen product with firmware of its own: CAN controller, node with emergencies, SYNC, PDOs
/// and error behaviour, objects, and the order in which bus, control period and the world around
/// it are served. What the product itself does derives from this class, whose constructor ends
/// with start_firmware().
///
/// At one instant steps of the world that end there come first, then the firmware's period, then
/// what the node does on the clock. Nothing allocates after construction.
class CanOpenFirmware : public CanDevice {
 public:
  [[nodiscard]] can::Controller& controller() final { return controller_; }
  [[nodiscard]] const can::Controller& controller() const final { return controller_; }
  [[nodiscard]] dictionary::NetworkState network_state() const final;
  [[nodiscard]] const dictionary::Dictionary& dictionary() const { return dictionary_; }
  [[nodiscard]] const dictionary::Dictionary* object_dictionary() const final {
    return &dictionary_;
  }
  [[nodiscard]] const canopen::Node& node() const { return node_; }
  [[nodiscard]] const canopen::EmergencyProducer& emergencies() const { return emergencies_; }
  [[nodiscard]] FirmwareMemory* firmware() final {
    return firmware_.capacity() != 0 ? &firmware_ : nullptr;
  }
  /// RUN and ERR as CiA 303-3 has them.
  [[nodiscard]] Indicators indicators() const override;
  [[nodiscard]] NetworkStatus network_status() const override;
  [[nodiscard]] base::SimTime next_deadline() const final;
  void objects_written(base::SimTime now) final { apply(now); }
  void advance(base::SimTime now) final;
  void handle_bus_events(base::SimTime now) final;
  void set_power(bool on, base::SimTime now) final;

 protected:
  /// `declare` is called with a dictionary to which it adds the product's objects, and finishes it.
  CanOpenFirmware(const canopen::NodeConfiguration& node, const CanOpenFirmwareRules& rules,
                  const std::function<void(dictionary::Dictionary&)>& declare,
                  base::EventReporter reporter);

  // What the product does. Times are those to which the rack has come.

  /// Power-on and reset node: objects of the application have their defaults; what was stored takes
  /// their place.
  virtual void load_application(base::SimTime /*now*/) {}
  /// Everything but objects is as at power-on: after load_application(), and where the firmware
  /// stops. Motors and loads go on.
  virtual void restart(base::SimTime now) = 0;
  /// Reset communication. Returns the stored node-ID, see canopen::NodeHooks.
  virtual std::uint8_t reset_communication(base::SimTime now) = 0;
  /// The node works with this node-ID from now on: communication objects have their defaults; what
  /// was stored takes their place.
  virtual void load_communication(std::uint8_t /*node_id*/, base::SimTime /*now*/) {}
  /// A control period begins; the bus has been served.
  virtual void tick(base::SimTime now) = 0;
  /// The world makes the steps that end at `until` at the latest.
  virtual void step_world(base::SimTime until) = 0;
  /// Objects may have been written: what they command is obeyed at once, as by an interrupt.
  virtual void apply(base::SimTime /*now*/) {}
  /// The state of NMT has changed. It is called before the first restart() as well.
  virtual void state_changed(canopen::NmtState /*state*/, base::SimTime /*now*/) {}
  /// The controller has gone bus-off.
  virtual void bus_off(base::SimTime /*now*/) {}

  /// The supply has come, or the boot loader has ended.
  void start_firmware(base::SimTime now);

  /// The serial interface whose boot loader takes firmware; it is a part of the product.
  void set_boot_loader(tmcl::ModuleInterface& loader) { boot_loader_ = &loader; }
  [[nodiscard]] dictionary::Dictionary& objects() { return dictionary_; }
  [[nodiscard]] canopen::Node& network_node() { return node_; }
  [[nodiscard]] canopen::EmergencyProducer& emergency_producer() { return emergencies_; }
  [[nodiscard]] canopen::PdoService& pdos() { return pdos_; }
  [[nodiscard]] const base::EventReporter& reporter() const { return reporter_; }

 private:
  // What the node asks of its device.
  void on_reset_application(base::SimTime now);
  std::uint8_t on_reset_communication(base::SimTime now);
  void on_assign_node_id(std::uint8_t node_id, base::SimTime now);
  void on_state(canopen::NmtState state, base::SimTime now) { state_changed(state, now); }
  void on_process_data(base::SimTime now) { apply(now); }
  void on_bus_off(base::SimTime now) { bus_off(now); }
  [[nodiscard]] canopen::NmtState nmt_state() const { return node_.state(); }
  void enter_state(canopen::NmtState state, base::SimTime now) { node_.enter(state, now); }

  void wire_node();
  [[nodiscard]] bool in_boot_loader() const {
    return boot_loader_ != nullptr && boot_loader_->in_boot_loader();
  }
  void begin_period(base::SimTime now);
  void run_boot_loader(base::SimTime now);
  void process_bus(base::SimTime now);

  CanOpenFirmwareRules rules_;
  base::EventReporter reporter_;
  dictionary::Dictionary dictionary_;
  can::Controller controller_;
  FirmwareMemory firmware_;
  canopen::Node node_;
  canopen::EmergencyProducer emergencies_;
  canopen::SyncConsumer sync_;
  canopen::PdoService pdos_;
  canopen::ErrorBehaviour error_behaviour_;
  canopen::ControllerSupervision supervision_;
  base::SimTime next_tick_;
  tmcl::ModuleInterface* boot_loader_ = nullptr;  ///< null: there is none
  bool powered_ = true;
};

}  // namespace stator::product
