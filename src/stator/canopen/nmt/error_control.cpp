#include "stator/canopen/nmt/error_control.hpp"

#include <algorithm>

#include "stator/canopen/nmt_command.hpp"

namespace stator::canopen {

namespace {

using base::SimDuration;
using base::SimTime;

constexpr std::uint16_t kGuardTime = 0x100C;
constexpr std::uint16_t kLifeTimeFactor = 0x100D;
constexpr std::uint16_t kProducerHeartbeatTime = 0x1017;
constexpr SimDuration kMillisecond(1'000'000);
/// Distinguishes life guarding from the entries of 1016h, which are counted from 1.
constexpr std::uint8_t kLifeGuardingCause = 0;

constexpr base::EventRule kLifeGuardingExpired{
    "life-guarding-expired", base::Severity::fault,
    "life guarding error: no guarding request for node {0} came within {1} ms (100Ch * 100Dh)"};
constexpr base::EventRule kLifeGuardingResolved{
    "life-guarding-resolved", base::Severity::information,
    "life guarding: the NMT master guards node {0} again"};
constexpr base::EventRule kGuardingWithHeartbeat{
    "guarding-with-heartbeat", base::Severity::refusal,
    "guarding request for node {0} not answered: it produces a heartbeat (1017h = {1} ms), which "
    "has priority; write 0 to 1017h to use guarding"};

std::uint64_t value(const dictionary::Entry* entry) {
  return entry == nullptr ? 0 : entry->value();
}

}  // namespace

ErrorControl::ErrorControl(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
                           base::EventReporter reporter, CommunicationErrors& errors)
    : transmitter_(transmitter),
      reporter_(reporter),
      errors_(errors),
      producer_heartbeat_time_(dictionary.find(kProducerHeartbeatTime, 0)),
      guard_time_(dictionary.find(kGuardTime, 0)),
      life_time_factor_(dictionary.find(kLifeTimeFactor, 0)) {
  for (const dictionary::Entry* entry :
       {producer_heartbeat_time_, guard_time_, life_time_factor_}) {
    if (entry != nullptr) {
      dictionary.on_written(entry->index(), 0,
                            dictionary::Entry::WrittenHook::bind<&ErrorControl::on_written>(*this));
    }
  }
}

SimDuration ErrorControl::heartbeat_time() const {
  return kMillisecond * static_cast<std::int64_t>(value(producer_heartbeat_time_));
}

/// 0 if life guarding is off.
SimDuration ErrorControl::life_time() const {
  return kMillisecond * static_cast<std::int64_t>(value(guard_time_) * value(life_time_factor_));
}

void ErrorControl::start(SimTime now) {
  toggle_ = false;
  life_guarding_ = LifeGuarding::waiting;
  life_end_ = SimTime::never();
  configuration_changed_ = false;
  heartbeat_changed_ = false;
  const SimDuration period = heartbeat_time();
  heartbeat_due_ = period > SimDuration() ? now + period : SimTime::never();
}

void ErrorControl::on_state(NmtState state, SimTime /*now*/) {
  state_ = state;
}

void ErrorControl::on_written(const dictionary::Entry& entry) {
  configuration_changed_ = true;
  heartbeat_changed_ = heartbeat_changed_ || &entry == producer_heartbeat_time_;
  deadline_changed();
}

/// Heartbeat time, guard time or life time factor were written.
void ErrorControl::apply_configuration(SimTime now) {
  if (heartbeat_changed_) {
    heartbeat_due_ = heartbeat_time() > SimDuration() ? now : SimTime::never();
  }
  configuration_changed_ = false;
  heartbeat_changed_ = false;
  if (heartbeat_time() > SimDuration() || life_time() == SimDuration()) {
    stop_life_guarding(now);
  } else if (life_guarding_ == LifeGuarding::running) {
    life_end_ = now + life_time();
  }
}

void ErrorControl::stop_life_guarding(SimTime now) {
  if (life_guarding_ == LifeGuarding::expired) {
    errors_.clear(kLifeGuardingCause, now);
  }
  life_guarding_ = LifeGuarding::waiting;
  life_end_ = SimTime::never();
}

bool ErrorControl::receive(const can::Frame& frame, SimTime now) {
  if (!frame.remote || frame.identifier != kErrorControlBase + node_id_ || guard_time_ == nullptr) {
    return false;
  }
  if (heartbeat_time() > SimDuration()) {
    reporter_.report(now, kGuardingWithHeartbeat,
                     {int{node_id_}, static_cast<std::int64_t>(value(producer_heartbeat_time_))});
    return true;
  }
  send_state(toggle_ ? 0x80 : 0);
  toggle_ = !toggle_;
  if (life_guarding_ == LifeGuarding::expired) {
    reporter_.report(now, kLifeGuardingResolved, {int{node_id_}});
    errors_.clear(kLifeGuardingCause, now);
    life_guarding_ = LifeGuarding::waiting;
  }
  if (life_time() > SimDuration()) {
    life_guarding_ = LifeGuarding::running;
    life_end_ = now + life_time();
  }
  return true;
}

void ErrorControl::advance(SimTime now) {
  if (configuration_changed_) {
    apply_configuration(now);
  }
  if (now >= heartbeat_due_) {
    send_state(0);
    // One that comes a little late does not shift those behind it; those missed are not made up.
    const SimDuration period = heartbeat_time();
    const SimTime next = heartbeat_due_ + period;
    heartbeat_due_ = next > now ? next : now + period;
  }
  if (now >= life_end_) {
    life_end_ = SimTime::never();
    life_guarding_ = LifeGuarding::expired;
    reporter_.report(now, kLifeGuardingExpired, {int{node_id_}, life_time() / kMillisecond});
    errors_.raise(kLifeGuardingCause, now);
  }
}

SimTime ErrorControl::next_deadline() const {
  return configuration_changed_ ? SimTime() : std::min(heartbeat_due_, life_end_);
}

void ErrorControl::send_state(unsigned toggle) {
  transmitter_.send(
      can::data_frame(kErrorControlBase + node_id_, {toggle | static_cast<unsigned>(state_)}));
}

}  // namespace stator::canopen
