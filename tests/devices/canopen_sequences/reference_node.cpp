// NMT, error control, emergencies and LSS of the reference.

#include "devices/canopen_sequences/reference_node.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::tests {

namespace {

using base::SimDuration;

constexpr SimDuration kMillisecond{1'000'000};
/// For what the firmware notices in its next period.
constexpr SimDuration kPeriods{3'000'000};
constexpr std::uint8_t kCommunicationBits = 0x11;
constexpr std::uint8_t kUndervoltageBits = 0x05;
constexpr const char* kUndervoltage = "undervoltage";

std::uint8_t byte(const can::Frame& frame, std::size_t position) {
  return std::to_integer<std::uint8_t>(frame.data[position]);
}

}  // namespace

const char* to_text(Rule rule) {
  constexpr std::array kNames{
      "boot-up",      "node-ID",        "silence",      "SDO answer",  "abort code",
      "value",        "error register", "emergency",    "heartbeat",   "guarding",
      "inhibit time", "event timer",    "transmit PDO", "synchronous", "LSS"};
  return kNames[static_cast<std::size_t>(rule)];
}

ReferenceNode::ReferenceNode(const Options& options, std::uint8_t node_id,
                             const std::map<Key, std::uint32_t>& defaults)
    : options_(options), node_id_(node_id), defaults_(defaults) {
  for (const ObjectUnderTest& object : objects_under_test()) {
    defaults_[{object.index, object.subindex}] -= object.node_id_relative ? node_id : 0U;
  }
  reset_values(true);
}

void ReferenceNode::fail(Rule rule, std::string text, Time now) {
  static_cast<void>(now);
  if (!violation_ && !excepted_.contains(rule)) {
    violation_ = Violation{.rule = rule, .text = std::move(text)};
  }
}

void ReferenceNode::power_on(Time now) {
  pending_node_id_.reset();
  initialise(true, options_.boot_time, now);
}

void ReferenceNode::set_supply(bool good, Time now) {
  if (good == supply_) {
    return;
  }
  supply_ = good;
  stimulus_ = now;
  if (good) {
    // The fault stays until it is reset, which is not followed here.
    make_uncertain(kUndervoltage);
    supply_certain_at_ = Time::never();
    return;
  }
  const bool was_there = errors_.contains(kUndervoltage);
  raise(0xFF00, kUndervoltage, kUndervoltageBits, now, !was_there);
  errors_[kUndervoltage].certain = false;
  supply_certain_at_ = now + kPeriods;
}

/// What is due until now by the clock alone.
void ReferenceNode::catch_up(Time now) {
  if (now >= supply_certain_at_) {
    supply_certain_at_ = Time::never();
    errors_[kUndervoltage].certain = true;
  }
  if (now >= life_end_) {
    life_end_ = Time::never();
    life_guarded_ = false;  // until the next request
    communication_error("life guarding", now);
  }
  if (now >= watched_until_) {
    watched_until_ = Time::never();
    communication_error("heartbeat", now);
  }
  if (now >= transfer_ends_) {
    end_transfer();
    timed_out_ = true;
  }
}

void ReferenceNode::communication_error(const std::string& key, Time now) {
  raise(0x8130, key, kCommunicationBits, now);
  if (state_ == State::operational && value(0x1029, 1) == 0) {
    enter(State::stopped, true, now);
  }
}

void ReferenceNode::raise(std::uint16_t code, const std::string& key, std::uint8_t bits, Time now,
                          bool must) {
  constexpr std::size_t kSureToFit = 3;
  const auto found = errors_.find(key);
  if (found != errors_.end() && found->second.certain) {
    return;
  }
  const bool maybe = found != errors_.end();
  errors_[key] = {.bits = bits};
  const bool sent = (value(0x1014, 0) & kInvalid) == 0;
  due_.push_back({.code = code,
                  .since = now,
                  .must = must && sent && !maybe && due_.size() < kSureToFit,
                  .bits = bits});
}

void ReferenceNode::make_uncertain(const std::string& key) {
  if (const auto found = errors_.find(key); found != errors_.end()) {
    found->second.certain = false;
  }
}

base::SimDuration ReferenceNode::life_time() const {
  return kMillisecond * static_cast<std::int64_t>(value(0x100C, 0) * value(0x100D, 0));
}

/// The state is this one, or was until this instant, in which the node changed it by itself.
bool ReferenceNode::state_is(State state, Time now) const {
  return state_ == state || (now == changed_by_itself_at_ && before_ == state);
}

bool ReferenceNode::has_sdo(Time now) const {
  return state_is(State::pre_operational, now) || state_is(State::operational, now);
}

void ReferenceNode::hear(const can::Frame& frame, Time now) {
  catch_up(now);
  answer_.reset();
  lss_answer_.reset();
  if (state_ == State::initialisation || frame.extended) {
    return;
  }
  const std::uint32_t identifier = frame.identifier;
  const bool works = state_ != State::stopped;
  if (identifier == 0 && !frame.remote) {
    hear_nmt(frame, now);
  } else if (identifier == 0x600U + node_id_ && !frame.remote) {
    if (works) {
      hear_sdo(frame, now);
    }
  } else if (identifier == 0x700U + node_id_ && frame.remote) {
    hear_guarding(now);
  } else if (identifier > 0x700 && identifier < 0x780 && !frame.remote) {
    hear_heartbeat(frame, now);
  } else if (identifier == 0x7E5 && options_.lss && !frame.remote) {
    hear_lss(frame);
  } else if (works && identifier == (value(0x1005, 0) & 0x7FF) && !frame.remote) {
    if (state_ == State::operational) {
      hear_sync(now);
    }
  } else if (state_ == State::operational && !frame.remote) {
    hear_process_data(frame, now);
  }
}

void ReferenceNode::hear_nmt(const can::Frame& frame, Time now) {
  const bool addressed = byte(frame, 1) == 0 || byte(frame, 1) == node_id_;
  if (frame.length != 2 || !addressed) {
    return;
  }
  switch (byte(frame, 0)) {
    case 1:
      enter(State::operational, false, now);
      break;
    case 2:
      enter(State::stopped, false, now);
      break;
    case 128:
      enter(State::pre_operational, false, now);
      break;
    case 129:
      initialise(true, options_.reset_time, now);
      break;
    case 130:
      initialise(false, options_.reset_time, now);
      break;
    default:
      break;
  }
}

void ReferenceNode::enter(State state, bool by_itself, Time now) {
  if (state == state_) {
    return;
  }
  before_ = state_;
  changed_by_itself_at_ = by_itself ? now : Time::never();
  const bool flowed = state_ == State::pre_operational || state_ == State::operational;
  const bool flows = state == State::pre_operational || state == State::operational;
  state_ = state;
  if (flows && !flowed) {
    emergencies_flow_since_ = now;
  }
  if (!flows) {
    end_transfer();
    answer_.reset();
  }
  if (before_ == State::operational || state == State::operational) {
    process_data_state(state == State::operational, now);
  }
  stimulus_ = now;
}

void ReferenceNode::initialise(bool application, SimDuration duration, Time now) {
  enter(State::initialisation, false, now);
  boot_up_by_ = now + duration + kMillisecond;
  heartbeat_from_ = heartbeat_by_ = Time::never();
  life_end_ = watched_until_ = Time::never();
  timed_out_ = false;
  life_guarded_ = false;
  due_.clear();
  emergency_sent_.reset();
  transmit_ = {};
  std::erase_if(errors_,
                [&](const auto& each) { return application || each.first != kUndervoltage; });
  // CiA 305: the persistent node-ID is taken at reset node, the one LSS has configured at reset
  // communication.
  if (application) {
    pending_node_id_.reset();
  }
  const auto stored = images_.find(Stored::network);
  const auto persistent = static_cast<std::uint8_t>(
      stored == images_.end() ? defaults_[{0x2705, 0}] : stored->second[{0x2705, 0}]);
  possible_node_ids_ = {pending_node_id_.value_or(persistent)};
  if (stored_since_pending_) {
    possible_node_ids_.insert(persistent);
  }
  reset_values(application);
  load_values(application);
  if (!application && errors_.contains(kUndervoltage)) {
    // That an error lasts may be told once more.
    due_.push_back({.code = 0xFF00, .since = now, .must = false, .bits = kUndervoltageBits});
  }
  if (application && !supply_) {
    raise(0xFF00, kUndervoltage, kUndervoltageBits, now);
    due_.back().must = false;
    errors_[kUndervoltage].certain = false;
    supply_certain_at_ = now + kPeriods;
  }
}

void ReferenceNode::boot_up(std::uint8_t node_id, Time now) {
  if (!possible_node_ids_.contains(node_id)) {
    fail(Rule::node_id,
         "boots up with node-ID " + std::to_string(node_id) + ", expected was " +
             std::to_string(*possible_node_ids_.begin()),
         now);
  }
  node_id_ = node_id;
  boot_up_by_ = Time::never();
  guard_toggle_ = false;
  lss_configuring_ = false;
  enter(State::pre_operational, false, now);
  reset_values(false);
  load_values(false);
  if (const std::uint32_t period = value(0x1017, 0); period != 0) {
    heartbeat_from_ = heartbeat_by_ = now + kMillisecond * std::int64_t{period};
  }
}

void ReferenceNode::hear_guarding(Time now) {
  if (value(0x1017, 0) != 0) {
    return;
  }
  guard_answer_due_ = true;
  errors_.erase("life guarding");
  if (life_time() > SimDuration()) {
    life_guarded_ = true;
    life_end_ = now + life_time();
  }
}

void ReferenceNode::hear_heartbeat(const can::Frame& frame, Time now) {
  const std::uint32_t watched = value(0x1016, 1);
  const std::uint32_t node = watched >> 16;
  const std::uint32_t time = watched & 0xFFFF;
  if (node == 0 || node > 127 || time == 0 || frame.identifier != 0x700 + node ||
      frame.length != 1) {
    return;
  }
  errors_.erase("heartbeat");
  watched_until_ = now + kMillisecond * std::int64_t{time};
}

void ReferenceNode::hear_lss(const can::Frame& frame) {
  if (frame.length != 8) {
    return;
  }
  const int command = byte(frame, 0);
  const int first = byte(frame, 1);
  if (command == 0x04) {
    lss_configuring_ = first == 1 || (lss_configuring_ && first != 0);
    return;
  }
  if (!lss_configuring_) {
    return;
  }
  switch (command) {
    case 0x11: {
      const bool possible = first >= 1 && first <= 127;
      lss_answer_ = {command, possible ? 0 : 1, -1};
      if (possible) {
        pending_node_id_ = static_cast<std::uint8_t>(first);
        stored_since_pending_ = false;
      }
      break;
    }
    case 0x17:
      lss_answer_ = {command, 0, -1};
      values_[{0x2705, 0}] = pending_node_id_.value_or(node_id_);
      store({Stored::network}, false);
      break;
    case 0x5A:
      lss_answer_ = {command, 0x86, 0x02};
      break;
    case 0x5B:
      lss_answer_ = {command, 0xA0, 0};
      break;
    case 0x5E:
      lss_answer_ = {command, node_id_, 0};
      break;
    default:
      break;
  }
}

void ReferenceNode::see(const can::Frame& frame, Time now) {
  catch_up(now);
  const std::uint32_t identifier = frame.identifier;
  if (frame.extended || frame.remote) {
    fail(Rule::silence, "a remote or extended frame", now);
    return;
  }
  if (identifier > 0x700 && identifier < 0x780) {
    see_error_control(frame, now);
    return;
  }
  if (state_ == State::initialisation) {
    fail(Rule::boot_up, "identifier " + std::to_string(identifier) + " before the boot-up message",
         now);
    return;
  }
  if (identifier == 0x7E4) {
    const bool fits = lss_answer_ && frame.length == 8 && byte(frame, 0) == (*lss_answer_)[0] &&
                      byte(frame, 1) == (*lss_answer_)[1] &&
                      ((*lss_answer_)[2] < 0 || byte(frame, 2) == (*lss_answer_)[2]);
    if (!fits) {
      fail(Rule::lss, "an LSS answer that does not fit what was asked", now);
    }
    lss_answer_.reset();
    return;
  }
  if (!has_sdo(now)) {
    fail(Rule::silence, "identifier " + std::to_string(identifier) + " in Stopped", now);
    return;
  }
  if (identifier == 0x580U + node_id_) {
    see_sdo(frame, now);
    return;
  }
  const std::uint32_t emergency = value(0x1014, 0);
  if ((emergency & kInvalid) == 0 && identifier == (emergency & 0x7FF)) {
    see_emergency(frame, now);
    return;
  }
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    const std::uint32_t cob_id = transmit_value(pdo, 1);
    if ((cob_id & kInvalid) == 0 && (cob_id & 0x7FF) == identifier) {
      see_process_data(pdo, frame, now);
      return;
    }
  }
  fail(Rule::silence, "identifier " + std::to_string(identifier) + " that nothing configures", now);
}

void ReferenceNode::see_error_control(const can::Frame& frame, Time now) {
  const auto node = static_cast<std::uint8_t>(frame.identifier - 0x700);
  const std::uint8_t content = byte(frame, 0);
  if (state_ == State::initialisation) {
    if (frame.length != 1 || content != 0) {
      fail(Rule::boot_up, "error control before the boot-up message", now);
      return;
    }
    boot_up(node, now);
    return;
  }
  if (node != node_id_ || frame.length != 1) {
    fail(Rule::node_id, "error control of node " + std::to_string(node), now);
    return;
  }
  const bool heartbeat = value(0x1017, 0) != 0;
  const auto state = static_cast<State>(content & 0x7F);
  const Rule rule = heartbeat ? Rule::heartbeat : Rule::guarding;
  if (!state_is(state, now)) {
    fail(rule,
         "shows state " + std::to_string(content) + " in state " +
             std::to_string(static_cast<int>(state_)),
         now);
  }
  if (heartbeat) {
    if ((content & 0x80) != 0 || now < heartbeat_from_ || now > heartbeat_by_) {
      fail(rule, "a heartbeat too early, too late or with bit 7", now);
    }
    heartbeat_from_ = heartbeat_by_ = now + kMillisecond * std::int64_t{value(0x1017, 0)};
    return;
  }
  if (!guard_answer_due_ || ((content & 0x80) != 0) != guard_toggle_) {
    fail(rule, "guarding answer without a request or with the wrong toggle bit", now);
  }
  guard_answer_due_ = false;
  guard_toggle_ = !guard_toggle_;
}

void ReferenceNode::see_emergency(const can::Frame& frame, Time now) {
  const auto code = base::load_le<std::uint16_t>(frame.data, 0);
  if (frame.length != 8) {
    fail(Rule::emergency, "an emergency with " + std::to_string(frame.length) + " bytes", now);
  }
  if (emergency_sent_ && now - *emergency_sent_ < emergency_inhibit_) {
    fail(Rule::emergency, "an emergency within the inhibit time 1015h", now);
  }
  emergency_sent_ = now;
  emergency_inhibit_ = SimDuration(100'000) * std::int64_t{value(0x1015, 0)};
  if (code == 0) {
    return;
  }
  const auto found = std::ranges::find(due_, code, &DueEmergency::code);
  if (found == due_.end()) {
    fail(Rule::emergency, "emergency " + std::to_string(code) + " that nothing has caused", now);
    return;
  }
  if ((byte(frame, 2) & 1) == 0 ||
      (found->since == now && (byte(frame, 2) & found->bits) != found->bits)) {
    fail(Rule::emergency, "an emergency whose error register lacks its error", now);
  }
  due_.erase(found);
}

void ReferenceNode::settle(Time now) {
  if (answer_ && has_sdo(now)) {
    fail(Rule::sdo_answer, "a request was not answered", now);
  }
  if (lss_answer_) {
    fail(Rule::lss, "an LSS request was not answered", now);
  }
  if (guard_answer_due_) {
    fail(Rule::guarding, "a guarding request was not answered", now);
  }
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    if (transmit_[pdo].awaits_sync && !transmit_[pdo].came_at_sync) {
      fail(Rule::synchronous_pdo, "TPDO " + std::to_string(pdo + 1) + " did not come at SYNC", now);
    }
    transmit_[pdo].awaits_sync = false;
  }
  answer_.reset();
  lss_answer_.reset();
  guard_answer_due_ = false;
  pass(now);
}

void ReferenceNode::pass(Time now) {
  catch_up(now);
  if (now > boot_up_by_) {
    fail(Rule::boot_up, "no boot-up message", now);
    boot_up_by_ = Time::never();
  }
  if (now > heartbeat_by_) {
    fail(Rule::heartbeat, "a heartbeat is missing", now);
    heartbeat_by_ = Time::never();
  }
  if (timed_out_ && has_sdo(now)) {
    fail(Rule::sdo_answer, "an abandoned transfer was not aborted", now);
  }
  timed_out_ = false;
  if (has_sdo(now) && (value(0x1014, 0) & kInvalid) == 0) {
    const SimDuration inhibit = SimDuration(100'000) * std::int64_t{value(0x1015, 0)};
    for (DueEmergency& due : due_) {
      const Time from = std::max({due.since, emergencies_flow_since_,
                                  emergency_sent_.value_or(Time()) + emergency_inhibit_});
      if (due.must && now > from + inhibit * 10 + kPeriods) {
        fail(Rule::emergency, "emergency " + std::to_string(due.code) + " does not come", now);
        due.must = false;
      }
    }
  }
  check_process_data(now);
}

}  // namespace stator::tests
