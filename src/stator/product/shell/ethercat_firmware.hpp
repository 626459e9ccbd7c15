#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/stack/slave_application.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/device_description.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/product/device/firmware_memory.hpp"
#include "stator/product/shell/object_signals.hpp"
#include "stator/product/shell/standard_objects.hpp"
#include "stator/tmcl/sessions/module_interface.hpp"

namespace stator::product {

/// The emergency that tells of a mapped object which did not take its value: a parameter has a
/// wrong value (CiA 402-2 annex A).
inline constexpr std::uint16_t kRefusedOutput = 0x6320;
/// Those of 1001h that it sets: generic and device profile specific error (CiA 301 §7.5.2.2).
inline constexpr std::uint8_t kRefusedOutputBits = 1U << 0 | 1U << 5;

/// What firmwares of EtherCAT products do differently.
struct EtherCatFirmwareRules {
  /// Of EtherCatFirmware::tick().
  base::SimDuration control_period{1'000'000};
  /// An interrupt routine takes its time: pulses of SYNC0 that follow sooner are seen as one.
  base::SimDuration sync0_interrupt{50'000};
  /// Of a step of the world that ends when a period begins: it is made before the firmware's tick.
  bool step_before_tick = true;
  /// A period begins with SYNC0, as long as the master synchronises by it, and with power; else
  /// periods lie on a grid from the start of the rack on. A SYNC0 that stays away is waited for
  /// half a period, then the firmware goes on without it.
  bool periods_follow_sync0 = false;
  /// After a serial command for the boot loader the firmware stops when its next period begins.
  /// True: SYNC0 is taken until then; false: no more.
  bool sync0_until_stopped = false;
  /// Additional bytes of kRefusedOutput.
  std::array<std::uint8_t, 5> refused_output_bytes{};
  /// Most bytes of a firmware image; 0: the product takes none.
  std::size_t firmware_capacity = 0;
  /// A new image is there and the firmware starts again; argument: {0} bytes. Null: in the words of
  /// all that have none of their own.
  const base::EventRule* new_firmware = nullptr;
};

/// What such a product is made of.
struct EtherCatFirmwareParts {
  ethercat::DeviceDescription description{};            ///< of which SII and ESI are made
  ethercat::SlaveControllerConfiguration controller{};  ///< which chip it has
  ethercat::SlaveStackOptions stack{};  ///< `files` is filled in where the product takes firmware
  CoeOptions coe{};                     ///< what a rack file says of it
  dictionary::Quirks quirks{};          ///< the same
  EtherCatFirmwareRules rules{};        ///< its choices
};

/// A product of which all else is as usual: a slave controller of 16 KB, mailboxes of 256 bytes,
/// CoE with its information service and complete access, all objects that can be mapped in the
/// process data, no distributed clocks.
struct EtherCatOutline {
  std::uint32_t vendor = 0;    ///< which the ETG assigns
  std::uint32_t code = 0;      ///< of the product
  std::uint32_t revision = 1;  ///< of the product
  std::string name{};          ///< what masters print
  /// They must outlive the device, as constants do. Those that are outputs have two bytes at least.
  std::span<const dictionary::EntryDeclaration> objects{};
  base::SimDuration period{1'000'000};  ///< of EtherCatFirmware::tick()
  CoeOptions coe{};                     ///< what a rack file says of it
  dictionary::Quirks quirks{};          ///< the same
};

/// An EtherCAT product with firmware of its own: slave controller, slave stack, objects, and the
/// order in which bus, SYNC0, control period and the world around it are served. What the product
/// itself does derives from this class.
///
/// At one instant SYNC0 comes first, then what ends there and what begins there (rules). Nothing
/// allocates after construction.
class EtherCatFirmware : public EtherCatDevice, protected ethercat::SlaveApplication {
 public:
  // What a rack asks and tells, see EtherCatDevice and Device.

  /// By which it is on the segment.
  [[nodiscard]] ethercat::SlaveController& controller() final { return controller_; }
  /// The same.
  [[nodiscard]] const ethercat::SlaveController& controller() const final { return controller_; }
  /// Its objects.
  [[nodiscard]] const dictionary::Dictionary& dictionary() const final { return dictionary_; }
  /// The same, to be written from outside.
  [[nodiscard]] dictionary::Dictionary& dictionary() final { return dictionary_; }
  /// State machine, mailbox and process data.
  [[nodiscard]] ethercat::SlaveStack* slave_stack() final { return &stack_; }
  /// The same.
  [[nodiscard]] const ethercat::SlaveStack& stack() const { return stack_; }
  /// What its SII and its ESI file are made of.
  [[nodiscard]] const ethercat::DeviceDescription& description() const final {
    return description_;
  }
  /// Ethernet over EtherCAT; null: it has none.
  [[nodiscard]] ethercat::EoeServer* eoe() final { return stack_.eoe(); }
  /// Where it keeps images that came to it; null: it takes none.
  [[nodiscard]] FirmwareMemory* firmware() final {
    return firmware_.capacity() != 0 ? &firmware_ : nullptr;
  }
  /// Brings firmware and world to `now`.
  void advance(base::SimTime now) final;
  /// Lets it take what a frame has brought.
  void handle_bus_events(base::SimTime now) final;
  /// Switches its supply.
  void set_power(bool on, base::SimTime now) override;
  /// The values of all objects that can be mapped, see object_signals().
  [[nodiscard]] std::vector<Signal> signals() const override { return object_signals(dictionary_); }

 protected:
  /// `declare` is called with a dictionary to which it adds the product's objects. If it does not
  /// finish it, StandardObjects adds what is missing there. Throws std::logic_error where objects
  /// cannot be so, or 1001h is missing.
  EtherCatFirmware(const EtherCatFirmwareParts& parts,
                   const std::function<void(dictionary::Dictionary&)>& declare,
                   base::EventReporter reporter);
  /// Throws as above.
  EtherCatFirmware(const EtherCatOutline& outline, base::EventReporter reporter);

  // What the product does. Times are those to which the rack has come.

  /// The firmware starts, or stops for its boot loader: objects have their defaults, and all else
  /// is to become what it is at power-on. Motors and loads go on.
  virtual void restart(base::SimTime /*now*/) {}
  /// A control period begins; the bus has been served. Inputs go out right after it, unless the
  /// master synchronises by SYNC0.
  virtual void tick(base::SimTime now) = 0;
  /// The world makes the steps that are due until `until`, which it includes.
  virtual void step_world(base::SimTime /*until*/) {}
  /// What a frame has brought is obeyed at once, as by an interrupt.
  virtual void apply(base::SimTime /*now*/) {}
  /// Outputs came by that frame and have been obeyed; inputs go out right after it.
  virtual void outputs_obeyed() {}
  /// SYNC0 while the master synchronises by it: outputs have been taken over, inputs go out right
  /// after it.
  virtual void at_sync0(base::SimTime /*now*/) {}
  /// Operational was entered or left.
  virtual void network_operational(bool /*operational*/, base::SimTime /*now*/) {}
  /// The bus is about to be served: a master may read what objects show.
  virtual void before_bus() {}
  /// A period while the boot loader is at work: what goes on without firmware.
  virtual void tick_without_firmware(base::SimTime /*now*/) {}

  /// An override has to call this function, too.
  void on_state(ethercat::AlState from, ethercat::AlState to, base::SimTime now) override;
  /// Inputs are about to go out: objects are to show what is.
  void before_inputs(base::SimTime /*now*/) override {}

  /// Everything is as after power-on, with the newest firmware image.
  void restart_firmware(base::SimTime now);
  /// See SlaveStack::send_emergency(); bits that 1001h has are added to `register_bits`.
  void send_emergency(std::uint16_t code, std::uint8_t register_bits,
                      const std::array<std::uint8_t, 5>& additional, base::SimTime now);

  /// The serial interface whose boot loader takes firmware; it is a part of the product.
  void set_boot_loader(tmcl::ModuleInterface& loader) { boot_loader_ = &loader; }
  /// Those that were declared, for variables and hooks.
  [[nodiscard]] dictionary::Dictionary& objects() { return dictionary_; }
  /// It has supply.
  [[nodiscard]] bool powered() const { return powered_; }
  /// For events of the product's own.
  [[nodiscard]] const base::EventReporter& reporter() const { return reporter_; }
  /// 1001h.
  [[nodiscard]] dictionary::Variable<std::uint8_t>& error_register() { return error_register_; }

 private:
  void on_outputs(base::SimTime /*now*/) final { outputs_came_ = true; }
  void on_sync0(base::SimTime now) final;
  void on_output_refused(const dictionary::Entry& entry, const dictionary::Refusal& refusal,
                         base::SimTime now) final;

  [[nodiscard]] dictionary::Dictionary& declared(
      const std::function<void(dictionary::Dictionary&)>& declare);
  [[nodiscard]] bool in_boot_loader() const {
    return boot_loader_ != nullptr && boot_loader_->in_boot_loader();
  }
  /// The firmware has power and is not in its boot loader.
  [[nodiscard]] bool runs() const { return powered_ && !in_boot_loader(); }
  [[nodiscard]] base::SimTime next_sync0();
  void begin_period(base::SimTime now);
  void run_boot_loader(base::SimTime now);
  /// Lets the firmware's interrupt run if SYNC0 has come.
  void take_sync0(base::SimTime now);
  void process_bus(base::SimTime now);
  void stop_firmware(base::SimTime now);

  EtherCatFirmwareRules rules_;
  base::EventReporter reporter_;
  ethercat::DeviceDescription description_;
  StandardObjects standard_objects_;
  dictionary::Dictionary dictionary_;
  ethercat::SlaveController controller_;
  FirmwareMemory firmware_;
  ethercat::SlaveStack stack_;
  dictionary::Variable<std::uint8_t> error_register_;  // 1001h

  base::SimTime next_tick_;
  base::SimTime sync0_earliest_;
  std::int64_t ticks_to_sync_ = 0;        ///< until the next SYNC0 has to come
  std::uint64_t sync0_pulses_ = 0;        ///< the firmware has seen
  std::uint32_t downloads_in_force_ = 0;  ///< of firmware_ at the last start of the firmware
  bool restart_due_ = false;              ///< Bootstrap was left with a new image
  tmcl::ModuleInterface* boot_loader_ = nullptr;  ///< null: there is none
  bool powered_ = true;
  bool outputs_came_ = false;
};

}  // namespace stator::product
