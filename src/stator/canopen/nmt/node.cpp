#include "stator/canopen/nmt/node.hpp"

#include <algorithm>

#include "stator/canopen/nmt_command.hpp"

namespace stator::canopen {

namespace {

using base::SimTime;

constexpr std::uint16_t kFirstSdoServer = 0x1200;
constexpr std::uint16_t kLastSdoServer = 0x127F;

constexpr base::EventRule kStateChanged{"nmt-state", base::Severity::information,
                                        "NMT state of node {0}: {1}"};
constexpr base::EventRule kNoNodeId{
    "nmt-no-node-id", base::Severity::warning,
    "the node has no node-ID and stays silent; give it one from 1 to 127 by LSS"};
constexpr base::EventRule kMalformedCommand{
    "nmt-length", base::Severity::refusal,
    "NMT message ignored: it has {0} bytes, must have 2, command and node-ID"};
constexpr base::EventRule kUnknownCommand{
    "nmt-command", base::Severity::refusal,
    "NMT message ignored: {0} is no command; there are 1 start, 2 stop, 128 enter pre-operational, "
    "129 reset node and 130 reset communication"};

/// Puts the identity that quirks ask for into 1018h.
void set_wrong_identity(dictionary::Dictionary& dictionary, const dictionary::Quirks& quirks) {
  constexpr std::uint16_t kIdentity = 0x1018;
  const std::array values{quirks.wrong_vendor, quirks.wrong_product, quirks.wrong_revision};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto subindex = static_cast<std::uint8_t>(i + 1);
    dictionary::Entry* entry = dictionary.find(kIdentity, subindex);
    if (values[i] && entry != nullptr) {
      dictionary.set_default(kIdentity, subindex, *values[i]);
      entry->set_value(*values[i]);
    }
  }
}

}  // namespace

Node::Node(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
           base::EventReporter reporter, const NodeConfiguration& configuration)
    : transmitter_(transmitter),
      reporter_(reporter),
      configuration_(configuration),
      node_id_(configuration.node_id),
      communication_errors_(configuration.life_guard_information),
      error_control_(dictionary, transmitter, reporter, communication_errors_),
      heartbeat_consumer_(dictionary, reporter, communication_errors_),
      time_stamp_(dictionary, transmitter, reporter) {
  configuration_.sdo.quirks = configuration.quirks;
  set_wrong_identity(dictionary, configuration.quirks);
  for (unsigned index = kFirstSdoServer; index <= kLastSdoServer; ++index) {
    if (index == kFirstSdoServer || dictionary.find(static_cast<std::uint16_t>(index)) != nullptr) {
      sdo_servers_.push_back(
          std::make_unique<SdoServer>(dictionary, static_cast<std::uint16_t>(index), transmitter,
                                      reporter, configuration_.sdo));
      enlist(*sdo_servers_.back(), false, true);
    }
  }
  enlist(error_control_, true, false);
  enlist(heartbeat_consumer_, true, false);
  enlist(time_stamp_, false, false);
  if (configuration.lss) {
    lss_.emplace(dictionary, transmitter, reporter, *configuration.lss);
    enlist(*lss_, true, false);
  }
  if (configuration.quirks.emergency_storm != 0) {
    storm_.emplace(transmitter, configuration.quirks.emergency_storm);
    enlist(*storm_, false, false);
  }
}

void Node::enlist(Service& service, bool in_stopped, bool writes_objects) {
  service.deadline_stale_ = &deadline_stale_;
  members_.push_back(
      {.service = &service, .in_stopped = in_stopped, .writes_objects = writes_objects});
}

void Node::add(Service& service) {
  enlist(service, false, false);
}

void Node::stored_node_id_changed() {
  if (lss_) {
    lss_->forget_pending_node_id();
  }
}

void Node::set_lss_hooks(const LssHooks& hooks) {
  if (lss_) {
    lss_->set_hooks(hooks);
  }
}

void Node::set_write_completion(dictionary::WriteCompletion* completion) {
  for (const auto& server : sdo_servers_) {
    server->set_write_completion(completion);
  }
}

void Node::power_on(SimTime now) {
  powered_ = true;
  statistics_ = {};
  initialise(true, configuration_.boot_time, now);
}

void Node::power_off(SimTime now) {
  powered_ = false;
  boot_up_due_ = SimTime::never();
  change_state(NmtState::initialisation, now);
}

void Node::reset_node(SimTime now) {
  if (powered_) {
    initialise(true, configuration_.reset_time, now);
  }
}

void Node::reset_communication(SimTime now) {
  if (powered_) {
    initialise(false, configuration_.reset_time, now);
  }
}

/// Initialisation begins; its last sub-state ends a time `until_boot_up` later.
void Node::initialise(bool with_application, base::SimDuration until_boot_up, SimTime now) {
  change_state(NmtState::initialisation, now);
  if (with_application && lss_) {
    lss_->forget_configuration();
  }
  if (with_application && hooks_.reset_application) {
    hooks_.reset_application(now);
  }
  node_id_ = hooks_.reset_communication ? hooks_.reset_communication(now) : configuration_.node_id;
  awaits_node_id_ = false;
  boot_up_due_ = now + until_boot_up;
}

void Node::finish_initialisation(SimTime now) {
  boot_up_due_ = SimTime::never();
  forget_ignored();
  if (lss_) {
    node_id_ = lss_->pending_node_id().value_or(node_id_);
    lss_->set_active_node_id(node_id_);
    lss_->start(now);
  }
  if (is_node_id(node_id_)) {
    boot_up(now);
  } else {
    node_id_ = kUnconfiguredNodeId;
    awaits_node_id_ = true;
    reporter_.report(now, kNoNodeId);
  }
}

/// The node reports that it is there (CiA 301 §7.2.8.3.3), and can be talked to from now on.
void Node::boot_up(SimTime now) {
  awaits_node_id_ = false;
  if (hooks_.assign_node_id) {
    hooks_.assign_node_id(node_id_, now);
  }
  error_control_.set_node_id(node_id_);
  for (const auto& server : sdo_servers_) {
    server->set_node_id(node_id_);
  }
  if (storm_) {
    storm_->set_node_id(node_id_);
  }
  for (const Member& member : members_) {
    member.service->start(now);
  }
  if (!configuration_.quirks.no_boot_up_message) {
    transmitter_.send(can::data_frame(kErrorControlBase + node_id_, {0}));
  }
  change_state(NmtState::pre_operational, now);
}

void Node::enter(NmtState state, SimTime now) {
  if (state_ != NmtState::initialisation && state != NmtState::initialisation) {
    change_state(state, now);
  }
}

void Node::change_state(NmtState state, SimTime now) {
  deadline_stale_ = true;
  forget_ignored();
  if (state == state_) {
    return;
  }
  state_ = state;
  reporter_.report(now, kStateChanged, {int{node_id_}, to_text(state)});
  for (const Member& member : members_) {
    member.service->on_state(state, now);
  }
  if (hooks_.state_changed) {
    hooks_.state_changed(state, now);
  }
}

void Node::receive(const can::Frame& frame, SimTime now) {
  if (!powered_) {
    return;
  }
  advance(now);  // what was due before the frame came
  ++statistics_.received;
  const bool known = !frame.extended && frame.identifier < kIdentifiers;
  if (!known || (!frame.remote && ignored_identifiers_[frame.identifier])) {
    ++statistics_.ignored;
    return;
  }
  if (frame.identifier == kNmtIdentifier && !frame.remote) {
    receive_nmt(frame, now);
  } else if (!dispatch(frame, now)) {
    ++statistics_.ignored;
    if (!frame.remote) {
      ignore(frame.identifier);
    }
    return;
  }
  // A node without a node-ID takes the one it was given when LSS leaves its configuration state.
  if (awaits_node_id_ && lss_ && !lss_->configuring() &&
      is_node_id(lss_->pending_node_id().value_or(kUnconfiguredNodeId))) {
    finish_initialisation(now);
  }
  deadline_stale_ = true;
  advance(now);
}

/// In Initialisation only LSS, and only once all is ready but the node-ID.
bool Node::works(const Member& member) const {
  return state_ != NmtState::initialisation ||
         (awaits_node_id_ && lss_ && member.service == &*lss_);
}

bool Node::dispatch(const can::Frame& frame, SimTime now) {
  for (const Member& member : members_) {
    const bool listens = works(member) && (state_ != NmtState::stopped || member.in_stopped);
    if (listens && member.service->receive(frame, now)) {
      if (member.writes_objects) {
        communication_objects_changed();
      }
      return true;
    }
  }
  return false;
}

void Node::receive_nmt(const can::Frame& frame, SimTime now) {
  if (state_ == NmtState::initialisation) {
    ++statistics_.ignored;
    return;
  }
  if (frame.length != 2) {
    ++statistics_.malformed_nmt;
    reporter_.report(now, kMalformedCommand, {int{frame.length}});
    return;
  }
  const auto addressed = std::to_integer<std::uint8_t>(frame.data[1]);
  if (addressed != 0 && addressed != node_id_) {
    ++statistics_.ignored;
    return;
  }
  const auto command = std::to_integer<std::uint8_t>(frame.data[0]);
  const auto transition = find_transition(command);
  if (!transition) {
    ++statistics_.unknown_nmt_command;
    reporter_.report(now, kUnknownCommand, {int{command}});
    return;
  }
  switch (transition->command) {
    case NmtCommand::reset_node:
      reset_node(now);
      break;
    case NmtCommand::reset_communication:
      reset_communication(now);
      break;
    default:
      change_state(transition->target, now);
      break;
  }
}

void Node::advance(SimTime now) {
  if (!powered_ || now < next_deadline()) {
    return;
  }
  deadline_stale_ = true;
  if (now >= boot_up_due_) {
    finish_initialisation(now);
  }
  for (const Member& member : members_) {
    if (works(member) && member.service->next_deadline() <= now) {
      member.service->advance(now);
    }
  }
}

SimTime Node::next_deadline() const {
  if (deadline_stale_) {
    refresh_deadline();
  }
  return deadline_;
}

void Node::refresh_deadline() const {
  deadline_ = boot_up_due_;
  for (const Member& member : members_) {
    if (works(member)) {
      deadline_ = std::min(deadline_, member.service->next_deadline());
    }
  }
  deadline_stale_ = false;
}

}  // namespace stator::canopen
