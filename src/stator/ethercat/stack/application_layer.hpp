#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/stack/slave_stack_statistics.hpp"
#include "stator/ethercat/standard/al_transition.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"

namespace stator::ethercat {

/// What the state machine calls to carry out its decisions; the slave stack implements it.
class AlActions {
 public:
  AlActions() = default;
  AlActions(const AlActions&) = delete;
  AlActions& operator=(const AlActions&) = delete;
  virtual ~AlActions() = default;

  /// Does the work of a step: starts or stops mailbox and process data. A step up may be refused;
  /// the refusing side raises the event that says why. Empty: the step has to wait for something,
  /// ask again.
  [[nodiscard]] virtual std::optional<AlStatusCode> perform(AlStep step, base::SimTime now) = 0;
  /// The step is done; AL status does not show it yet.
  virtual void entered(AlStep step, base::SimTime now) = 0;
  /// The request whose step had to wait is not asked for any more.
  virtual void request_abandoned() = 0;
};

/// The EtherCAT state machine behind AL control, AL status and AL status code
/// (ETG.1000.6 §6.4; ETG.1020 for codes, error acknowledge and device identification).
class ApplicationLayer {
 public:
  /// `identification`: see SlaveStackOptions::device_identification.
  ApplicationLayer(ProcessDataInterface& interface, AlActions& actions,
                   std::optional<std::uint16_t> identification, base::EventReporter reporter,
                   SlaveStackStatistics& statistics);

  /// Init without error, told to the master; no action runs.
  void reset();
  /// Takes the request in AL control; call when its event is set.
  void handle_al_control(base::SimTime now);
  /// True while a request waits for something; the master reads the old state meanwhile and may
  /// request another one.
  [[nodiscard]] bool pending() const { return pending_.has_value(); }
  /// Asks again whether a waiting request can go on.
  void continue_change(base::SimTime now);
  /// Leaves for `target` with the error indication and `code`; nothing if `target` is not below.
  void step_down(AlState target, AlStatusCode code, base::SimTime now);
  /// Leaves for Init without error indication, since there is no controller that could show one.
  void leave_for_init(base::SimTime now);
  /// Sets the error indication with `code` in the present state.
  void raise_error(AlStatusCode code, base::SimTime now);

  [[nodiscard]] AlState state() const { return state_; }
  [[nodiscard]] AlStatusCode status_code() const { return code_; }

 private:
  [[nodiscard]] AlStatusCode change_state(AlState requested, base::SimTime now);
  void abandon_request();
  void answer(AlStatusCode result);
  [[nodiscard]] AlStatusCode refuse_invalid(AlState requested, base::SimTime now) const;
  void indicate_error(AlStatusCode code);
  void write_status();

  ProcessDataInterface& interface_;
  AlActions& actions_;
  std::optional<std::uint16_t> identification_;
  base::EventReporter reporter_;
  SlaveStackStatistics& statistics_;
  AlState state_ = AlState::init;
  AlStatusCode code_ = AlStatusCode::no_error;  ///< other than no_error: error indication set
  std::optional<AlState> pending_;              ///< requested, waits for something
  bool identification_requested_ = false;
};

namespace rules {
/// Arguments: {0} state, {1} AL status code.
inline constexpr base::EventRule kAlErrorRaised{
    "al-error-raised", base::Severity::fault,
    "error in {0} with AL status {1:x4}; acknowledge with bit 4 of AL control"};
inline constexpr base::EventRule kAlUnknownState{
    "al-unknown-state", base::Severity::refusal,
    "state change refused, AL status 0012h: AL control requests state {0}, which is none of 1, 2, "
    "3, "
    "4, 8"};
inline constexpr base::EventRule kAlInvalidChange{
    "al-invalid-change", base::Severity::refusal,
    "{1} refused, AL status 0011h: it cannot be reached from {0} directly; request the states "
    "Init, Pre-Operational, Safe-Operational, Operational one after the other (Bootstrap from Init "
    "only)"};
inline constexpr base::EventRule kAlNoIdentification{
    "al-no-identification", base::Severity::warning,
    "request for the device identification (AL control bit 5) not answered: this device has no ID "
    "switch; give it a value with \"identification\" in the rack file, or identify it by its "
    "alias"};
inline constexpr base::EventRule kAlErrorNotAcknowledged{
    "al-error-not-acknowledged", base::Severity::refusal,
    "request for {0} ignored: the error with AL status {1:x4} is not acknowledged; set bit 4 of AL "
    "control with the request"};
inline constexpr base::EventRule kAlSteppedDown{
    "al-stepped-down", base::Severity::fault,
    "left {0} for {1} with AL status {2:x4}; acknowledge with bit 4 of AL control, then request "
    "the "
    "state again"};
}  // namespace rules

}  // namespace stator::ethercat
