#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/controller.hpp"
#include "stator/canopen/emergency/controller_supervision.hpp"
#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/canopen/emergency/error_behaviour.hpp"
#include "stator/canopen/nmt/node.hpp"
#include "stator/canopen/pdo/pdo_service.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/firmware_memory.hpp"
#include "stator/product/shell/object_signals.hpp"
#include "stator/product/shell/standard_objects.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::product {

/// What firmwares of CANopen products do differently.
struct CanOpenFirmwareRules {
  /// Of CanOpenFirmware::tick().
  base::SimDuration control_period{1'000'000};
  std::uint32_t bit_rate = 1'000'000;     ///< bit/s, of its controller
  canopen::EmergencyRules emergencies{};  ///< which there are, and how they are sent
  canopen::SyncRules sync{};              ///< what becomes of SYNC
  canopen::PdoRules pdos{};               ///< what the PDOs can be set to
  /// What values of 1029h mean.
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

/// A product of which all else is as usual: CiA 301 as it stands there, all objects that can be
/// mapped in as many PDOs as they take.
struct CanOpenOutline {
  std::uint8_t node_id = 1;    ///< 1 to 127
  std::uint32_t vendor = 0;    ///< which CiA assigns
  std::uint32_t code = 0;      ///< of the product
  std::uint32_t revision = 1;  ///< 1018h:03
  std::string name{};          ///< 1008h
  /// They must outlive the device, as constants do.
  std::span<const dictionary::EntryDeclaration> objects{};
  base::SimDuration period{1'000'000};  ///< of CanOpenFirmware::tick()
  std::uint32_t bit_rate = 1'000'000;   ///< bit/s
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
  // What a rack asks and tells, see CanDevice and Device.

  /// By which it is on the bus.
  [[nodiscard]] can::Controller& controller() final { return controller_; }
  /// The same.
  [[nodiscard]] const can::Controller& controller() const final { return controller_; }
  /// What its NMT state means for writes of its objects.
  [[nodiscard]] dictionary::NetworkState network_state() const final;
  /// Its objects.
  [[nodiscard]] const dictionary::Dictionary& dictionary() const { return dictionary_; }
  /// The same, to be written from outside.
  [[nodiscard]] dictionary::Dictionary& dictionary() { return dictionary_; }
  /// The same.
  [[nodiscard]] const dictionary::Dictionary* object_dictionary() const final {
    return &dictionary_;
  }
  /// The same.
  [[nodiscard]] dictionary::Dictionary* object_dictionary() final { return &dictionary_; }
  /// NMT, SDO server and error control.
  [[nodiscard]] const canopen::Node& node() const { return node_; }
  /// What it has reported.
  [[nodiscard]] const canopen::EmergencyProducer& emergencies() const { return emergencies_; }
  /// Where it keeps images that came to it; null: it takes none.
  [[nodiscard]] FirmwareMemory* firmware() final {
    return firmware_.capacity() != 0 ? &firmware_ : nullptr;
  }
  /// RUN and ERR as CiA 303-3 has them.
  [[nodiscard]] Indicators indicators() const override;
  /// Its state of NMT.
  [[nodiscard]] NetworkStatus network_status() const override;
  /// That of the rules, where the product does not say otherwise.
  [[nodiscard]] std::uint32_t bit_rate() const override { return rules_.bit_rate; }
  /// When it sends something on its own at the earliest.
  [[nodiscard]] base::SimTime next_deadline() const final;
  /// Objects were written otherwise than over the bus.
  void objects_written(base::SimTime now) final { apply(now); }
  /// Brings firmware and world to `now`.
  void advance(base::SimTime now) final;
  /// Lets it take what came over the bus.
  void handle_bus_events(base::SimTime now) final;
  /// Switches its supply.
  void set_power(bool on, base::SimTime now) final;
  /// The values of all objects that can be mapped, see object_signals().
  [[nodiscard]] std::vector<Signal> signals() const override { return object_signals(dictionary_); }

 protected:
  /// `declare` is called with a dictionary to which it adds the product's objects. If it does not
  /// finish it, CanOpenStandardObjects adds the missing ones, with the product's identity.
  CanOpenFirmware(const canopen::NodeConfiguration& node, const CanOpenFirmwareRules& rules,
                  const std::function<void(dictionary::Dictionary&)>& declare,
                  base::EventReporter reporter, const CanOpenIdentity& identity = {});
  /// Starts the firmware. A product's own constructor calls start_firmware() only if it overrides
  /// restart() and the like, which a base class's constructor cannot reach.
  CanOpenFirmware(const CanOpenOutline& outline, base::EventReporter reporter);

  // What the product does. Times are those to which the rack has come.

  /// Power-on and reset node: objects of the application have their defaults; what was stored takes
  /// their place.
  virtual void load_application(base::SimTime /*now*/) {}
  /// Everything but objects is as at power-on: after load_application(), and where the firmware
  /// stops. Motors and loads go on.
  virtual void restart(base::SimTime /*now*/) {}
  /// Reset communication. Returns the stored node-ID, see canopen::NodeHooks; by default the one
  /// that the node was built with.
  virtual std::uint8_t reset_communication(base::SimTime /*now*/) { return first_node_id_; }
  /// The node works with this node-ID from now on: communication objects have their defaults; what
  /// was stored takes their place.
  virtual void load_communication(std::uint8_t /*node_id*/, base::SimTime /*now*/) {}
  /// A control period begins; the bus has been served.
  virtual void tick(base::SimTime now) = 0;
  /// The world makes the steps that end at `until` at the latest.
  virtual void step_world(base::SimTime /*until*/) {}
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
  /// Those that were declared, for variables and hooks.
  [[nodiscard]] dictionary::Dictionary& objects() { return dictionary_; }
  /// For what the product itself does with NMT.
  [[nodiscard]] canopen::Node& network_node() { return node_; }
  /// Reports errors, as emergencies and in 1001h and 1003h.
  [[nodiscard]] canopen::EmergencyProducer& emergency_producer() { return emergencies_; }
  /// For transmissions that the product asks for.
  [[nodiscard]] canopen::PdoService& pdos() { return pdos_; }
  /// For events of the product's own.
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

  [[nodiscard]] dictionary::Dictionary& declared(
      const std::function<void(dictionary::Dictionary&)>& declare, const CanOpenIdentity& identity);
  void wire_node();
  [[nodiscard]] bool in_boot_loader() const {
    return boot_loader_ != nullptr && boot_loader_->in_boot_loader();
  }
  void begin_period(base::SimTime now);
  void run_boot_loader(base::SimTime now);
  void process_bus(base::SimTime now);

  CanOpenFirmwareRules rules_;
  base::EventReporter reporter_;
  std::uint8_t first_node_id_;
  CanOpenStandardObjects standard_objects_;
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
