// The members of the bus: adds and removes them and tells their error states.

#include <algorithm>

#include "stator/can/bus.hpp"

namespace stator::can {

namespace {

using base::SimDuration;
using base::SimTime;

/// What a bus-off controller waits for at least (ISO 11898-1 §12.1.4.2).
constexpr unsigned kRecoveryBits = 128 * 11;

}  // namespace

std::size_t Bus::add(Controller& controller, const NodeSettings& settings) {
  const std::size_t number = members_.size();
  Member& member = members_.emplace_back();
  member.controller = &controller;
  member.settings = settings;
  keys_.push_back(kNothing);
  held_until_.emplace_back();
  senders_.reserve(members_.size());
  contenders_.add_member();
  noted_.add_member();
  reached_.add_member();
  taker_words_ = (members_.size() + 63) / 64;
  takers_.resize(AcceptanceFilter::kIdentifiers * taker_words_);
  controller.attach(&noted_, number);
  controller.filter().count_changes(&filter_changes_);
  membership_changed(number);
  if (mismatched(member)) {
    settings.reporter.report(now_, rules::kBitRateDiffers,
                             {settings.bit_rate, *settings_.bit_rate});
  }
  return number;
}

std::size_t Bus::add(Port& port) {
  const std::size_t number = members_.size();
  members_.emplace_back().port = &port;
  keys_.push_back(kNothing);
  held_until_.emplace_back();
  senders_.reserve(members_.size());
  contenders_.add_member();
  noted_.add_member();
  reached_.add_member();
  taker_words_ = (members_.size() + 63) / 64;
  takers_.resize(AcceptanceFilter::kIdentifiers * taker_words_);
  ++ports_;
  port.attach(&noted_, number);
  membership_changed(number);
  return number;
}

void Bus::remove(const Port& port) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    if (members_[i].port == &port) {
      members_[i].port->attach(nullptr, 0);
      members_[i].port = nullptr;
      members_[i].connected = false;
      --ports_;
      membership_changed(i);
    }
  }
}

bool Bus::mismatched(const Member& member) const {
  return member.controller != nullptr && settings_.bit_rate &&
         member.settings.bit_rate != *settings_.bit_rate;
}

void Bus::membership_changed(std::size_t number) {
  listeners_.clear();
  listening_ports_.clear();
  ++filter_changes_;
  mismatched_ = 0;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    const Member& member = members_[i];
    if (mismatched(member)) {
      ++mismatched_;
    } else if (member.active()) {
      listeners_.push_back({member.controller, member.port, i});
      if (member.port != nullptr) {
        listening_ports_.push_back(member.port);
      }
    }
  }
  if (members_[number].active()) {
    noted_.note(number);
  } else {
    refresh(number);
  }
}

void Bus::set_connected(std::size_t number, bool connected) {
  members_[number].connected = connected;
  membership_changed(number);
}

void Bus::set_power(std::size_t number, bool on) {
  Member& member = members_[number];
  member.powered = on;
  member.errors.reset();
  member.state = ErrorState::error_active;
  member.recovers_at = SimTime::never();
  if (member.controller != nullptr) {
    member.controller->clear();
    member.controller->set_error_state(ErrorState::error_active);
  }
  membership_changed(number);
}

void Bus::set_bit_rate(std::size_t number, std::uint32_t bit_rate) {
  Member& member = members_[number];
  if (member.settings.bit_rate == bit_rate) {
    return;
  }
  member.settings.bit_rate = bit_rate;
  membership_changed(number);
  if (mismatched(member)) {
    member.settings.reporter.report(now_, rules::kBitRateDiffers, {bit_rate, *settings_.bit_rate});
  }
}

void Bus::force_bus_off(std::size_t number, SimTime now) {
  if (members_[number].controller != nullptr && members_[number].active()) {
    members_[number].errors.enter_bus_off();
    update_state(number, now);
    plan();
  }
}

void Bus::force_error_passive(std::size_t number, SimTime now) {
  if (members_[number].controller != nullptr && members_[number].active()) {
    members_[number].errors.enter_error_passive();
    errors_counted_ = true;
    update_state(number, now);
  }
}

/// Tells node and log of an error state that follows from the counters.
void Bus::update_state(std::size_t number, SimTime now) {
  Member& member = members_[number];
  const ErrorState state = member.errors.state();
  if (member.controller == nullptr || state == member.state) {
    return;
  }
  member.state = state;
  member.controller->set_error_state(state);
  reached_.note(number);
  if (state == ErrorState::bus_off) {
    enter_bus_off(member, now);
    membership_changed(number);
  } else if (state == ErrorState::error_passive) {
    member.settings.reporter.report(now, rules::kErrorPassive,
                                    {member.errors.transmit(), member.errors.receive()});
  } else {
    member.settings.reporter.report(now, rules::kErrorActive);
  }
}

void Bus::enter_bus_off(Member& member, SimTime now) {
  const SimDuration wait = std::max(member.settings.recovery, error_bits(kRecoveryBits));
  ++member.statistics.bus_offs;
  member.recovers_at = now + wait;
  next_recovery_ = std::min(next_recovery_, member.recovers_at);
  member.settings.reporter.report(now, rules::kBusOff, {wait.nanoseconds() / 1'000'000});
}

void Bus::recover(SimTime now) {
  next_recovery_ = SimTime::never();
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    if (member.recovers_at <= now) {
      member.recovers_at = SimTime::never();
      member.errors.reset();
      member.state = ErrorState::error_active;
      member.controller->set_error_state(ErrorState::error_active);
      reached_.note(i);
      member.settings.reporter.report(now, rules::kRecovered);
      membership_changed(i);
    }
    next_recovery_ = std::min(next_recovery_, member.recovers_at);
  }
}

}  // namespace stator::can
