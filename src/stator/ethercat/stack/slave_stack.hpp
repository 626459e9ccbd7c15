#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/ethercat/eoe/eoe.hpp"
#include "stator/ethercat/stack/application_layer.hpp"
#include "stator/ethercat/stack/coe.hpp"
#include "stator/ethercat/stack/dc_supervision.hpp"
#include "stator/ethercat/stack/foe.hpp"
#include "stator/ethercat/stack/mailbox.hpp"
#include "stator/ethercat/stack/pdo_configuration.hpp"
#include "stator/ethercat/stack/process_image.hpp"
#include "stator/ethercat/stack/slave_application.hpp"
#include "stator/ethercat/stack/slave_stack_statistics.hpp"
#include "stator/ethercat/stack/sync_manager_settings.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/device_description.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"

namespace stator::ethercat {

/// Choices in which real products differ.
struct SlaveStackOptions {
  /// Send CoE emergencies. Off for masters that cannot take an unsolicited message.
  bool emergencies = true;
  /// Refuse Operational with AL status 0019h until outputs have come since Safe-Operational.
  bool require_outputs = false;
  /// Explicit device identification (ETG.1020): the value of the device's ID switch, delivered
  /// in 0x0134 when the master asks with AL control bit 5. Empty: not supported.
  std::optional<std::uint16_t> device_identification = std::nullopt;
  /// The files offered by FoE; needed if the device's description has `foe`. Must outlive the
  /// stack.
  FileStore* files = nullptr;
  FoeOptions foe = {};
  /// First address behind the controller's process memory, for the length limit of process data.
  std::uint16_t process_memory_end = 0x3000;
  /// What the device does with SYNC0; by default nothing.
  DcCapabilities distributed_clocks{};
  /// What it does otherwise than a slave should.
  dictionary::Quirks quirks{};
};

/// The software of an EtherCAT slave: state machine, mailbox protocols and process data
/// (ETG.1000.5, ETG.1000.6), on any controller that offers a ProcessDataInterface.
///
/// Passive: it acts only inside process(), publish_inputs() and reset(), and takes the time from
/// their argument. Nothing allocates after construction except longer strings in the dictionary.
/// It installs the check hooks of 1C00h, 1C12h, 1C13h, 1600h..17FFh and 1A00h..1BFFh.
class SlaveStack final : private AlActions {
 public:
  /// All references must outlive the stack; `dictionary` must be finished.
  SlaveStack(ProcessDataInterface& interface, dictionary::Dictionary& dictionary,
             const DeviceDescription& description, SlaveApplication& application,
             base::EventReporter reporter, const SlaveStackOptions& options = {});

  /// Back to Init as after power-on: transfers, queues and counters forgotten, AL status written.
  /// Dictionary values are the device's business.
  void reset(base::SimTime now);

  /// Takes what the bus brought: AL control, sync manager changes, mailboxes, outputs, watchdog.
  /// Call after each frame and at each control tick; cheap when nothing came.
  void process(base::SimTime now);

  /// SYNC0 has come, for boards that wire it to an interrupt; where the controller raises an AL
  /// event instead (acknowledge mode), process() notices by itself. While synchronous(), outputs
  /// that have come since the last one are taken over now.
  void sync0(base::SimTime now);
  /// True while process data are taken over at SYNC0: the master had activated it before
  /// Safe-Operational or Operational was entered.
  [[nodiscard]] bool synchronous() const { return clocks_.synchronous(); }

  /// See DcSupervision.
  void set_sync_error_limit(unsigned limit) { clocks_.set_sync_error_limit(limit); }
  [[nodiscard]] const DcSupervision& clocks() const { return clocks_; }

  /// Brings the inputs up to date for the master; nothing in Init, Pre-Operational and Bootstrap.
  /// Call at each control tick.
  void publish_inputs(base::SimTime now);

  /// Queues an emergency (ETG.1000.6 §5.6.4; CiA 301 §7.2.7) with its five additional bytes;
  /// `error_register` is object 1001h. False if the queue is full, the mailbox is not running or
  /// emergencies are switched off.
  bool send_emergency(std::uint16_t error_code, std::uint8_t error_register,
                      const std::array<std::uint8_t, 5>& additional, base::SimTime now);

  /// The device itself leaves for a lower state with the error indication set, e.g.
  /// Safe-Operational with fatal_sync_error. Nothing happens if `target` is not below the present
  /// state.
  void step_down(AlState target, AlStatusCode code, base::SimTime now);
  /// Sets the error indication with `code` in the present state.
  void raise_error(AlStatusCode code, base::SimTime now);

  /// Decides when an SDO's write is complete, so that it is answered; must outlive the stack or be
  /// taken away. Null: every write is complete at once.
  void set_write_completion(dictionary::WriteCompletion* completion) {
    coe_.set_write_completion(completion);
  }

  // Faults from outside.

  /// Every step up is refused with this code from now on; no_error ends that.
  void refuse_steps_up(AlStatusCode code) { refusal_ = code; }
  /// See MailboxIntervention; null ends it.
  void set_mailbox_intervention(MailboxIntervention* intervention) {
    mailbox_.set_intervention(intervention);
    coe_.set_intervention(intervention);
  }

  [[nodiscard]] AlState state() const { return application_layer_.state(); }
  /// The error in AL status code 0x0134; no_error once the master has acknowledged it.
  [[nodiscard]] AlStatusCode status_code() const { return application_layer_.status_code(); }

  /// Length of the process data in bytes by the mapping in force since Pre-Operational to
  /// Safe-Operational; 0 below.
  [[nodiscard]] std::size_t output_bytes() const { return outputs_.bytes(); }
  [[nodiscard]] std::size_t input_bytes() const { return inputs_.bytes(); }

  [[nodiscard]] const SlaveStackStatistics& statistics() const { return statistics_; }
  /// Ethernet over EtherCAT; null unless the description announces it.
  [[nodiscard]] EoeServer* eoe() { return eoe_ ? &*eoe_ : nullptr; }
  /// Switches emergencies on or off; off also forgets those that wait.
  void set_emergencies(bool enabled);

 private:
  std::optional<AlStatusCode> perform(AlStep step, base::SimTime now) override;
  void entered(AlStep step, base::SimTime now) override;
  void request_abandoned() override { clocks_.abandon_start(); }

  // slave_stack.cpp: states, events
  /// The controller has become dead to its firmware, or is back.
  void follow_interface(base::SimTime now);
  [[nodiscard]] AlStatusCode start_mailbox(AlStep step, base::SimTime now);
  [[nodiscard]] bool has_mailbox() const { return description_.receive_mailbox.length != 0; }
  [[nodiscard]] bool process_data_runs() const {
    return state() == AlState::safe_operational || state() == AlState::operational;
  }
  /// Notes which events process() has to look at from now on.
  void update_attention();

  // slave_stack_sync_managers.cpp
  /// Reports and returns `code` if the mailbox channels are not as `state` needs them.
  [[nodiscard]] AlStatusCode check_mailbox(const SyncManagerBank& bank, AlState state,
                                           base::SimTime now);
  [[nodiscard]] AlStatusCode check_process_data(const SyncManagerBank& bank, base::SimTime now);
  [[nodiscard]] AlStatusCode check_channel(const SyncManagerBank& bank,
                                           const SyncManagerRequirement& requirement, AlState state,
                                           AlStatusCode code, base::SimTime now);
  [[nodiscard]] AlStatusCode check_unchanged(const SyncManagerBank& bank, unsigned channel,
                                             AlStatusCode code, base::SimTime now);
  void handle_sync_manager_change(base::SimTime now);

  // slave_stack_process_data.cpp
  [[nodiscard]] AlStatusCode start_process_data(base::SimTime now);
  void stop_process_data();
  [[nodiscard]] AlStatusCode permit_outputs(base::SimTime now);
  void enter_operational(base::SimTime now);
  [[nodiscard]] bool outputs_wait(std::uint32_t events) const;
  void take_outputs(base::SimTime now);
  /// Outputs that came before Safe-Operational was entered are not those of the next Operational.
  void forget_outputs();
  /// Outputs of the bus are there: taken over now or at the next SYNC0.
  void offer_outputs(base::SimTime now);
  void apply_outputs(base::SimTime now);
  void read_outputs();
  void write_inputs();
  void send_storm(base::SimTime now);
  void on_refused(const dictionary::Entry& entry, const dictionary::Refusal& refusal);
  void check_clocks(base::SimTime now);
  void check_watchdog(std::uint32_t events, base::SimTime now);
  /// True if the master has sent no outputs for the time of the watchdog and the controller's
  /// watchdog does not show it.
  [[nodiscard]] bool outputs_overdue(base::SimTime now);
  /// Bit 0 of the watchdog's status register; reading it acknowledges an expiry.
  [[nodiscard]] bool watchdog_runs();
  /// Zero if the watchdog is off: by its time, its divider's product or the channel's trigger bit.
  [[nodiscard]] base::SimDuration watchdog_time();

  ProcessDataInterface& interface_;
  dictionary::Dictionary& dictionary_;
  const DeviceDescription& description_;
  SlaveApplication& application_;
  base::EventReporter reporter_;
  SlaveStackOptions options_;
  SlaveStackStatistics statistics_;

  ApplicationLayer application_layer_;
  Mailbox mailbox_;
  CoeServer coe_;
  std::optional<EoeServer> eoe_;
  std::optional<FoeServer> foe_;
  PdoConfiguration configuration_;
  ProcessImage outputs_;
  ProcessImage inputs_;
  DcSupervision clocks_;
  SyncManagerBank bank_;         ///< settings in force: mailbox since I->P, process data since P->S
  std::uint32_t attention_ = 0;  ///< AL events that need process()
  bool polls_channels_ = false;  ///< a channel in use raises no event
  bool connected_ = true;        ///< the controller answers
  AlStatusCode refusal_ = AlStatusCode::no_error;  ///< of every step up
  bool outputs_received_ = false;                  ///< since Safe-Operational was entered
  bool outputs_await_sync_ = false;                ///< taken from the bus, not yet over at SYNC0
  // The controller's watchdog runs from its first trigger on. Until then, and after it was switched
  // off and on again, the firmware counts itself.
  base::SimTime silent_since_;
  base::SimDuration watchdog_time_;                      ///< as last looked up; 0: off
  base::SimTime watchdog_due_ = base::SimTime::never();  ///< next look; never outside Operational
  base::SimTime storm_due_ = base::SimTime::never();     ///< next emergency of a storm
  base::SimTime now_;                                    ///< of the call being handled
};

namespace rules {
/// Argument: {0} state.
inline constexpr base::EventRule kControllerLost{
    "al-controller-lost", base::Severity::fault,
    "the slave controller does not answer its firmware any more, since its EEPROM is not loaded or "
    "names another interface; the firmware left {0} for Init, which AL status cannot show"};
inline constexpr base::EventRule kControllerBack{
    "al-controller-back", base::Severity::information,
    "the slave controller answers its firmware again, which starts in Init"};
inline constexpr base::EventRule kStateFault{
    "al-fault", base::Severity::fault,
    "{0} refused, AL status {1:x4}, by a fault that was asked for"};
inline constexpr base::EventRule kBootstrapUnsupported{
    "al-bootstrap-unsupported", base::Severity::refusal,
    "Bootstrap refused, AL status 0013h: this device has no bootstrap mailbox (words 14h to 17h of "
    "its SII are 0) and takes no firmware this way; use Pre-Operational"};
inline constexpr base::EventRule kNoOutputs{
    "al-no-outputs", base::Severity::refusal,
    "Operational refused, AL status 0019h: no outputs have come since Safe-Operational; exchange "
    "process data before requesting Operational"};
inline constexpr base::EventRule kMappingInvalid{
    "al-mapping-invalid", base::Severity::refusal,
    "Safe-Operational refused, AL status {0:x4}: the PDO mapping assigned by {1:x4} is not valid; "
    "configure it again in Pre-Operational"};
inline constexpr base::EventRule kApplicationRefused{
    "al-application-refused", base::Severity::refusal,
    "{0} refused by the device, AL status {1:x4}; what this device needs is in its documentation"};
inline constexpr base::EventRule kWatchdogExpired{
    "al-watchdog", base::Severity::fault,
    "process data watchdog expired: no outputs within {0} us; send process data faster than that "
    "or change 0400h and 0420h"};
}  // namespace rules

}  // namespace stator::ethercat
