#include "stator/ethercat/stack/dc_supervision.hpp"

#include <algorithm>
#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

using base::EventArgument;
using base::EventRule;
using base::Severity;
using base::SimDuration;
using base::SimTime;

constexpr EventRule kSyncRequired{
    "dc-sync-required", Severity::refusal,
    "{3} refused, AL status {0:x4}: this device runs with SYNC0 only; activate it "
    "(AssignActivate 0300h) before requesting Safe-Operational"};
constexpr EventRule kSyncUnsupported{
    "dc-sync-unsupported", Severity::refusal,
    "{3} refused, AL status {0:x4}: SYNC activation 0981h is {1:x2}, but this device does not use "
    "{2}; choose an operation mode that its description offers"};
constexpr EventRule kSyncConfiguration{
    "dc-sync-configuration", Severity::refusal,
    "{3} refused, AL status {0:x4}: SYNC activation 0981h is {1:x2}, which switches the unit on "
    "without SYNC0; write 03h (SYNC0) or 07h (SYNC0 and SYNC1)"};
constexpr EventRule kSyncSide{
    "dc-sync-side", Severity::refusal,
    "{3} refused, AL status {0:x4}: register 0980h is {1:x2} and leaves the SYNC unit to the "
    "device, which does not set it; clear bit 0"};
constexpr EventRule kLatchConfiguration{
    "dc-latch-configuration", Severity::refusal,
    "{3} refused, AL status {0:x4}: register 0980h is {1:x2} and leaves a latch unit to the "
    "device, which does not use it; clear bits 4 and 5"};
constexpr EventRule kCycleTimeRange{
    "dc-cycle-time-range", Severity::refusal,
    "{3} refused, AL status {0:x4}: SYNC0 cycle time 09A0h is {1} ns, the device takes {2} to {4} "
    "ns; choose another bus cycle"};
constexpr EventRule kCycleTimeStep{"dc-cycle-time-step", Severity::refusal,
                                   "{3} refused, AL status {0:x4}: SYNC0 cycle time 09A0h is {1} "
                                   "ns, the device takes multiples of "
                                   "{2} ns only"};
constexpr EventRule kSync1Cycle{
    "dc-sync1-cycle-time", Severity::refusal,
    "{3} refused, AL status {0:x4}: SYNC1 cycle time 09A4h is {1} ns, not below the SYNC0 cycle "
    "time of {2} ns; the device needs one SYNC1 in each SYNC0 cycle"};
constexpr EventRule kNoSync{
    "dc-no-sync", Severity::refusal,
    "Operational refused, AL status {0:x4}: no SYNC0 came within {1} ms; the start time 0990h must "
    "lie ahead of the system time 0910h, and not far, when 0981h is written"};
constexpr EventRule kNotSettled{
    "dc-not-settled", Severity::refusal,
    "Operational refused, AL status {0:x4}: the clock differs from the reference by {1} ns, {2} "
    "are allowed; distribute the system time (FRMW or ARMW 0910h) until 092Ch has settled"};
constexpr EventRule kSyncLost{
    "dc-sync-lost", Severity::fault,
    "SYNC0 has not come for {1} cycles, AL status {0:x4}: register 0981h is now {2:x2}; keep the "
    "SYNC unit active in Operational"};
constexpr EventRule kCycleChanged{
    "dc-cycle-changed", Severity::fault,
    "SYNC0 does not come every {1} ns any more, AL status {0:x4}: its cycle time 09A0h was changed "
    "to {2} ns in Operational; change it in Safe-Operational and request Operational again"};
constexpr EventRule kOutputsMissing{
    "dc-outputs-missing", Severity::fault,
    "outputs came too late for SYNC0 too often, AL status {0:x4}: the error counter passed {1}; "
    "send process data in every cycle of {2} ns"};
constexpr EventRule kOutputsOutOfStep{
    "dc-outputs-out-of-step", Severity::fault,
    "outputs do not keep step with SYNC0, AL status {0:x4}: none in some cycles of {2} ns and "
    "several in others, the error counter passed {1}; let the master follow the reference clock "
    "and send well before SYNC0"};
constexpr EventRule kClockLost{
    "dc-clock-lost", Severity::fault,
    "the clock has differed from the reference by up to {1} ns for {2} cycles, AL status {0:x4}; "
    "distribute the system time in every cycle"};
constexpr EventRule kLateSync{
    "dc-late-sync", Severity::warning,
    "SYNC0 began after {0} had been entered without it; the device stays synchronous with the "
    "process data until it passes Pre-Operational; activate SYNC before Safe-Operational"};

constexpr unsigned kActive = 0x01;
constexpr unsigned kSync0 = 0x02;
constexpr unsigned kSync1 = 0x04;
constexpr unsigned kHostControlsSync = 0x01;
constexpr unsigned kHostControlsLatches = 0x30;

constexpr unsigned kMissedOutputs = 3;  // steps of the error counter

}  // namespace

AlStatusCode DcSupervision::refuse(SimTime now, const EventRule& rule, AlStatusCode code,
                                   std::int64_t value, std::int64_t limit) const {
  reporter_.report(
      now, rule,
      {EventArgument(static_cast<int>(code)), EventArgument(value), EventArgument(limit),
       EventArgument(to_text(wanted_)), EventArgument(capabilities_.longest_cycle.nanoseconds())});
  return code;
}

AlStatusCode DcSupervision::permit_safe_operational(SimTime now) {
  wanted_ = AlState::safe_operational;
  stop();
  const AlStatusCode code = choose_mode(now);
  entered_synchronous_ = synchronous_;
  return code;
}

AlStatusCode DcSupervision::choose_mode(SimTime now) {
  std::array<std::byte, 2> control{};
  interface_.read(kCyclicUnitControl, control);
  const auto sides = std::to_integer<unsigned>(control[0]);
  const auto activation = std::to_integer<unsigned>(control[1]);
  if ((sides & kHostControlsLatches) != 0 && !capabilities_.latch) {
    return refuse(now, kLatchConfiguration, AlStatusCode::invalid_dc_latch_configuration, sides);
  }
  if ((activation & kActive) == 0) {
    return capabilities_.required ? refuse(now, kSyncRequired, AlStatusCode::free_run_not_supported)
                                  : AlStatusCode::no_error;
  }
  constexpr AlStatusCode kInvalid = AlStatusCode::invalid_dc_sync_configuration;
  if ((sides & kHostControlsSync) != 0) {
    return refuse(now, kSyncSide, kInvalid, sides);
  }
  if ((activation & kSync0) == 0) {
    return refuse(now, kSyncConfiguration, kInvalid, activation);
  }
  const bool sync1 = (activation & kSync1) != 0;
  if (!capabilities_.sync0 || (sync1 && !capabilities_.sync1)) {
    reporter_.report(now, kSyncUnsupported,
                     {EventArgument(static_cast<int>(kInvalid)), EventArgument(activation),
                      capabilities_.sync0 ? base::StaticText("SYNC1") : base::StaticText("SYNC0"),
                      EventArgument(to_text(wanted_))});
    return kInvalid;
  }
  if (const AlStatusCode code = check_cycle_times(now); code != AlStatusCode::no_error) {
    return code;
  }
  synchronous_ = true;
  return AlStatusCode::no_error;
}

AlStatusCode DcSupervision::check_cycle_times(SimTime now) {
  std::array<std::byte, 8> cycles{};
  interface_.read(kSync0CycleTime, cycles);
  const SimDuration cycle(base::load_le<std::uint32_t>(cycles));
  const SimDuration sync1(base::load_le<std::uint32_t>(cycles, 4));
  if (cycle < capabilities_.shortest_cycle || cycle > capabilities_.longest_cycle) {
    return refuse(now, kCycleTimeRange, AlStatusCode::dc_invalid_sync_cycle_time,
                  cycle.nanoseconds(), capabilities_.shortest_cycle.nanoseconds());
  }
  if (cycle % capabilities_.cycle_step != SimDuration(0)) {
    return refuse(now, kCycleTimeStep, AlStatusCode::dc_sync0_cycle_time, cycle.nanoseconds(),
                  capabilities_.cycle_step.nanoseconds());
  }
  std::array<std::byte, 1> activation{};
  interface_.read(kSyncActivation, activation);
  const bool sync1_on = (std::to_integer<unsigned>(activation[0]) & kSync1) != 0;
  if (sync1_on && sync1 >= cycle) {
    return refuse(now, kSync1Cycle, AlStatusCode::dc_sync1_cycle_time, sync1.nanoseconds(),
                  cycle.nanoseconds());
  }
  if (!synchronous_ || cycle != cycle_) {
    last_sync_.reset();  // a pulse with other settings does not tell that these run
  }
  cycle_ = cycle;
  return AlStatusCode::no_error;
}

std::optional<AlStatusCode> DcSupervision::permit_operational(SimTime now) {
  wanted_ = AlState::operational;
  // Some masters activate SYNC in Safe-Operational only, or change its cycle there. If it was
  // switched off there, it is waited for.
  if (!synchronous_ || sync_active()) {
    if (const AlStatusCode code = choose_mode(now); code != AlStatusCode::no_error) {
      abandon_start();
      return code;
    }
  }
  if (!synchronous_ || (sync_runs(now) && settled())) {
    give_up_at_ = SimTime::never();
    return AlStatusCode::no_error;
  }
  if (give_up_at_ == SimTime::never()) {
    give_up_at_ = now + capabilities_.start_timeout;
  }
  if (now < give_up_at_) {
    return std::nullopt;
  }
  const bool runs = sync_runs(now);
  abandon_start();
  if (!runs) {
    return refuse(now, kNoSync, AlStatusCode::no_sync_error,
                  capabilities_.start_timeout.nanoseconds() / 1'000'000);
  }
  return refuse(now, kNotSettled, AlStatusCode::pll_error, time_difference().nanoseconds(),
                capabilities_.largest_time_difference.nanoseconds());
}

void DcSupervision::abandon_start() {
  give_up_at_ = SimTime::never();
  synchronous_ = entered_synchronous_;
}

void DcSupervision::set_operational(bool operational, SimTime now) {
  operational_ = operational;
  entered_synchronous_ = synchronous_;
  outputs_seen_ = false;
  outputs_ = 0;
  sync_errors_ = 0;
  missed_outputs_ = operational ? 0 : missed_outputs_;
  surplus_outputs_ = 0;
  differences_ = 0;
  give_up_at_ = SimTime::never();
  lost_at_ = SimTime::never();
  watch(now);
}

void DcSupervision::stop() {
  synchronous_ = false;
  last_sync_.reset();
  late_sync_told_ = false;
  set_operational(false, SimTime());
}

void DcSupervision::watch(SimTime now) {
  if (operational_ && synchronous_ && capabilities_.lost_sync_cycles != 0) {
    // A pulse at the limit is still in time.
    lost_at_ = now + cycle_ * capabilities_.lost_sync_cycles + SimDuration(1);
  }
}

AlStatusCode DcSupervision::on_sync0(SimTime now) {
  last_sync_ = now;
  if (!synchronous_) {
    if (operational_ && !late_sync_told_) {
      late_sync_told_ = true;
      reporter_.report(now, kLateSync, {EventArgument(to_text(AlState::operational))});
    }
    return AlStatusCode::no_error;
  }
  watch(now);
  if (!operational_) {
    outputs_ = 0;
    return AlStatusCode::no_error;
  }
  const AlStatusCode code = count_outputs(now);
  return code != AlStatusCode::no_error ? code : check_difference(now);
}

AlStatusCode DcSupervision::count_outputs(SimTime now) {
  const unsigned outputs = outputs_;
  outputs_ = 0;
  outputs_seen_ = outputs_seen_ || outputs != 0;
  missed_outputs_ += outputs_seen_ && outputs == 0 ? 1 : 0;
  if (capabilities_.sync_error_limit == 0 || !outputs_seen_) {
    return AlStatusCode::no_error;
  }
  if (outputs != 0) {
    surplus_outputs_ += outputs - 1;
    sync_errors_ -= sync_errors_ != 0 ? 1 : 0;
    surplus_outputs_ = sync_errors_ != 0 ? surplus_outputs_ : 0;
    return AlStatusCode::no_error;
  }
  sync_errors_ += kMissedOutputs;
  if (sync_errors_ <= capabilities_.sync_error_limit) {
    return AlStatusCode::no_error;
  }
  const bool out_of_step = surplus_outputs_ != 0;
  const AlStatusCode code =
      out_of_step ? AlStatusCode::synchronization_error : AlStatusCode::dc_sync_timeout;
  return refuse(now, out_of_step ? kOutputsOutOfStep : kOutputsMissing, code,
                capabilities_.sync_error_limit, cycle_.nanoseconds());
}

AlStatusCode DcSupervision::check_difference(SimTime now) {
  if (settled()) {
    differences_ = 0;
    return AlStatusCode::no_error;
  }
  if (++differences_ < capabilities_.tolerated_differences) {
    return AlStatusCode::no_error;
  }
  return refuse(now, kClockLost, AlStatusCode::pll_error, time_difference().nanoseconds(),
                differences_);
}

AlStatusCode DcSupervision::check(SimTime now) {
  if (now < lost_at_) {
    return AlStatusCode::no_error;
  }
  lost_at_ = SimTime::never();
  std::array<std::byte, 4> cycle{};
  interface_.read(kSync0CycleTime, cycle);
  const SimDuration changed(base::load_le<std::uint32_t>(cycle));
  if (sync_active() && changed != cycle_) {
    return refuse(now, kCycleChanged, AlStatusCode::fatal_sync_error, cycle_.nanoseconds(),
                  changed.nanoseconds());
  }
  std::array<std::byte, 1> activation{};
  interface_.read(kSyncActivation, activation);
  return refuse(now, kSyncLost, AlStatusCode::fatal_sync_error, capabilities_.lost_sync_cycles,
                std::to_integer<int>(activation[0]));
}

bool DcSupervision::sync_active() const {
  std::array<std::byte, 1> activation{};
  interface_.read(kSyncActivation, activation);
  return (std::to_integer<unsigned>(activation[0]) & kActive) != 0;
}

base::SimDuration DcSupervision::time_difference() const {
  std::array<std::byte, 4> bytes{};
  interface_.read(kSystemTimeDifference, bytes);
  return SimDuration(base::load_le<std::uint32_t>(bytes) & 0x7FFFFFFF);  // bit 31: the sign
}

bool DcSupervision::sync_runs(SimTime now) const {
  const unsigned cycles = std::max(capabilities_.lost_sync_cycles, 1U);
  return last_sync_ && now - *last_sync_ <= cycle_ * cycles;
}

bool DcSupervision::settled() const {
  return capabilities_.largest_time_difference == SimDuration(0) ||
         time_difference() <= capabilities_.largest_time_difference;
}

}  // namespace stator::ethercat
