#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"

namespace stator::ethercat {

/// What a device can do with the SYNC signals of its controller, and what it does not tolerate.
/// The defaults describe a device that knows nothing of them.
struct DcCapabilities {
  bool sync0 = false;     ///< can take over its process data at SYNC0
  bool sync1 = false;     ///< the master may switch SYNC1 on as well
  bool required = false;  ///< refuses Safe-Operational without SYNC0
  bool latch = false;     ///< its firmware uses latch units that the master hands to it
  base::SimDuration shortest_cycle{1};
  base::SimDuration longest_cycle{0xFFFFFFFF};
  base::SimDuration cycle_step{1};  ///< cycle times are multiples of it
  /// How long a request for Operational may wait for the first SYNC0 and for the clock to settle;
  /// masters allow 5 s and more (ETG.1020).
  base::SimDuration start_timeout{1'000'000'000};
  /// Cycles without SYNC0 after which Operational ends with 002Ch; 0: never.
  unsigned lost_sync_cycles = 3;
  /// Limit of the synchronisation error counter: each SYNC0 without new outputs since the one
  /// before counts 3 up, each other one 1 down (ETG.1020, 1C32h:20h). 0: not supervised.
  unsigned sync_error_limit = 0;
  /// Largest system time difference (0x092C) with which the device runs; 0: not supervised.
  base::SimDuration largest_time_difference{0};
  /// Cycles in a row with a larger one after which Operational ends with 0032h.
  unsigned tolerated_differences = 10;
};

/// Supervises the synchronisation by distributed clocks on behalf of a slave stack (ETG.1020
/// "Synchronization", AL status codes 001Ah, 002Ch..0037h). It reads the controller's registers as
/// firmware does and is told of SYNC0 pulses and outputs.
///
/// The mode is chosen on the way to Safe-Operational, and once more on the way to Operational,
/// since some masters activate SYNC in between or change its cycle. SYNC0 that begins later does
/// not change it.
class DcSupervision {
 public:
  DcSupervision(ProcessDataInterface& interface, const DcCapabilities& capabilities,
                base::EventReporter reporter)
      : interface_(interface), capabilities_(capabilities), reporter_(reporter) {}

  /// Process data taken over at SYNC0; otherwise when they come (SM-synchronous) as without clocks.
  [[nodiscard]] bool synchronous() const { return synchronous_; }

  /// Changes DcCapabilities::sync_error_limit, for devices whose master sets it (10F1h:02).
  void set_sync_error_limit(unsigned limit) { capabilities_.sync_error_limit = limit; }
  /// The error counter (ETG.1020, 1C32h:20h tells whether it has passed the limit).
  [[nodiscard]] unsigned sync_errors() const { return sync_errors_; }
  /// SYNC0 pulses in Operational without new outputs before them, since it was entered.
  [[nodiscard]] std::uint32_t missed_outputs() const { return missed_outputs_; }
  /// SYNC0 cycle time while synchronous().
  [[nodiscard]] base::SimDuration cycle() const { return cycle_; }

  /// Pre-Operational to Safe-Operational: chooses the mode by what the master has configured, or
  /// says what is wrong with it.
  [[nodiscard]] AlStatusCode permit_safe_operational(base::SimTime now);

  /// Safe-Operational to Operational, asked until there is an answer: no_error, a refusal, or
  /// nothing yet because the first SYNC0 is still to come or the clock to settle.
  [[nodiscard]] std::optional<AlStatusCode> permit_operational(base::SimTime now);
  /// The request that waited was given up or refused: back to the mode of Safe-Operational.
  void abandon_start();
  /// Operational has been entered or left, by `now`.
  void set_operational(bool operational, base::SimTime now);
  /// Process data stop: back to no synchronisation.
  void stop();

  /// New outputs have come.
  void on_outputs() { ++outputs_; }
  /// SYNC0 has come at `now`. Any code but no_error ends Operational.
  [[nodiscard]] AlStatusCode on_sync0(base::SimTime now);
  /// To be asked at `now`: fatal_sync_error once SYNC0 has stayed away too long.
  [[nodiscard]] AlStatusCode check(base::SimTime now);
  /// When check() is due at the latest.
  [[nodiscard]] base::SimTime deadline() const { return lost_at_; }

 private:
  /// Chooses the mode by the registers as they are.
  [[nodiscard]] AlStatusCode choose_mode(base::SimTime now);
  [[nodiscard]] bool sync_active() const;
  [[nodiscard]] AlStatusCode check_cycle_times(base::SimTime now);
  [[nodiscard]] AlStatusCode refuse(base::SimTime now, const base::EventRule& rule,
                                    AlStatusCode code, std::int64_t value = 0,
                                    std::int64_t limit = 0) const;
  [[nodiscard]] base::SimDuration time_difference() const;
  [[nodiscard]] bool settled() const;
  /// SYNC0 has come and has not stayed away since.
  [[nodiscard]] bool sync_runs(base::SimTime now) const;
  [[nodiscard]] AlStatusCode count_outputs(base::SimTime now);
  [[nodiscard]] AlStatusCode check_difference(base::SimTime now);
  void watch(base::SimTime now);

  ProcessDataInterface& interface_;
  DcCapabilities capabilities_;
  base::EventReporter reporter_;
  base::SimDuration cycle_;
  AlState wanted_ = AlState::safe_operational;  ///< by the request being answered
  bool synchronous_ = false;
  bool entered_synchronous_ = false;  ///< mode in which the present state was entered
  bool operational_ = false;
  std::optional<base::SimTime> last_sync_;             ///< since the mode was chosen
  bool late_sync_told_ = false;                        ///< SYNC0 in SM-synchronous mode
  base::SimTime give_up_at_ = base::SimTime::never();  ///< waiting for the first SYNC0
  base::SimTime lost_at_ = base::SimTime::never();
  bool outputs_seen_ = false;  ///< since Operational: before, the watchdog alone supervises them
  unsigned outputs_ = 0;       ///< since the last SYNC0
  unsigned sync_errors_ = 0;
  std::uint32_t missed_outputs_ = 0;
  unsigned surplus_outputs_ = 0;  ///< since the error counter was 0
  unsigned differences_ = 0;      ///< in a row
};

}  // namespace stator::ethercat
