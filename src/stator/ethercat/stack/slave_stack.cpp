#include "stator/ethercat/stack/slave_stack.hpp"

#include <algorithm>
#include <stdexcept>

#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using base::EventArgument;

/// Most bytes of process data in one direction: what one frame can carry.
constexpr std::size_t kMaximumProcessData = 1486;

/// A three-buffer sync manager takes its length three times between `begin` and `end`.
std::size_t three_buffer_room(std::uint16_t begin, std::uint16_t end) {
  const std::size_t room = end > begin ? static_cast<std::size_t>(end - begin) / 3 : 0;
  return std::min(room, kMaximumProcessData);
}

PdoLimits limits_of(const DeviceDescription& description, const SlaveStackOptions& options) {
  const std::uint16_t outputs = description.output_offset;
  const std::uint16_t inputs = description.input_offset;
  const std::uint16_t end = options.process_memory_end;
  return {.receive_bytes = three_buffer_room(outputs, inputs > outputs ? inputs : end),
          .transmit_bytes = three_buffer_room(inputs, outputs > inputs ? outputs : end)};
}

std::size_t longest(const MailboxArea& a, const MailboxArea& b) {
  return std::max(a.length, b.length);
}

}  // namespace

SlaveStack::SlaveStack(ProcessDataInterface& interface, dictionary::Dictionary& dictionary,
                       const DeviceDescription& description, SlaveApplication& application,
                       base::EventReporter reporter, const SlaveStackOptions& options)
    : interface_(interface),
      dictionary_(dictionary),
      description_(description),
      application_(application),
      reporter_(reporter),
      options_(options),
      application_layer_(interface, *this, options.device_identification, reporter, statistics_),
      mailbox_(interface,
               longest(description.receive_mailbox, description.bootstrap_receive_mailbox),
               longest(description.transmit_mailbox, description.bootstrap_transmit_mailbox),
               reporter, statistics_, options.quirks),
      coe_(dictionary,
           {.complete_access = description.complete_access,
            .sdo_information = description.sdo_information,
            .quirks = options.quirks},
           reporter, statistics_),
      configuration_(dictionary, limits_of(description, options), options.quirks),
      outputs_(PdoDirection::receive, limits_of(description, options).receive_bytes),
      inputs_(PdoDirection::transmit, limits_of(description, options).transmit_bytes),
      clocks_(interface, options.distributed_clocks, reporter) {
  if (description.coe) {
    mailbox_.add(coe_);
  }
  if (description.eoe) {
    mailbox_.add(eoe_.emplace(reporter));
  }
  if (description.foe) {
    if (options.files == nullptr) {
      throw std::logic_error(description.name + " announces FoE, but has no file store");
    }
    mailbox_.add(foe_.emplace(*options.files, options.foe, reporter));
  }
  application_layer_.reset();
  update_attention();
  if (options_.quirks.emergency_storm != 0) {
    storm_due_ = base::SimTime();
  }
}

void SlaveStack::reset(base::SimTime now) {
  now_ = now;
  mailbox_.stop();
  stop_process_data();
  configuration_.allow_changes(false);
  statistics_ = {};
  application_layer_.reset();
  update_attention();
}

void SlaveStack::process(base::SimTime now) {
  if (eoe_) {
    eoe_->poll(mailbox_.running() && state() != AlState::bootstrap);
  }
  if (interface_.answers() != connected_) [[unlikely]] {
    follow_interface(now);
  }
  std::uint32_t events = interface_.al_event_request();
  if ((events & attention_) == 0 && !polls_channels_ && now < watchdog_due_ &&
      now < clocks_.deadline() && now < storm_due_ && !application_layer_.pending() &&
      mailbox_.idle()) {
    return;
  }
  now_ = now;
  if ((events & al_event::kDcSync0) != 0) {
    std::array<std::byte, 1> status{};
    interface_.read(register_address::kSync0Status, status);  // acknowledges
    sync0(now);
  }
  if ((events & al_event::kAlControl) != 0) {
    application_layer_.handle_al_control(now);
    events = interface_.al_event_request();
  }
  if ((events & al_event::kSyncManagerActivation) != 0) {
    handle_sync_manager_change(now);
    events = interface_.al_event_request();
  }
  if (process_data_runs() && outputs_wait(events)) {
    take_outputs(now);
  }
  application_layer_.continue_change(now);
  if (now >= storm_due_) {
    send_storm(now);
  }
  if (state() == AlState::operational) {
    check_clocks(now);
    check_watchdog(events, now);
  }
  if (mailbox_.needs_attention(events)) {
    mailbox_.process(events, now);
  }
  update_attention();
}

// Called when the controller has become dead to its firmware, or is back. While it is dead no event
// comes, so the firmware leaves for Init and stops what it does. When it is back the stack is
// reset, since registers no longer hold what the firmware wrote.
void SlaveStack::follow_interface(base::SimTime now) {
  connected_ = interface_.answers();
  now_ = now;
  if (connected_) {
    reset(now);
    reporter_.report(now, rules::kControllerBack);
  } else if (state() != AlState::init) {
    reporter_.report(now, rules::kControllerLost, {EventArgument(to_text(state()))});
    application_layer_.leave_for_init(now);
  }
  update_attention();
}

void SlaveStack::update_attention() {
  attention_ = al_event::kAlControl | al_event::kSyncManagerActivation | al_event::kDcSync0;
  polls_channels_ = false;
  const auto watch = [this](unsigned channel) {
    attention_ |= al_event::sync_manager(channel);
    polls_channels_ = polls_channels_ || !bank_[channel].interrupts_host();
  };
  if (mailbox_.running()) {
    watch(kReceiveMailboxChannel);
  }
  if (process_data_runs() && outputs_.bytes() != 0) {
    watch(kOutputChannel);
  }
  if (state() == AlState::operational) {
    attention_ |= al_event::kProcessDataWatchdog;
  }
}

bool SlaveStack::send_emergency(std::uint16_t error_code, std::uint8_t error_register,
                                const std::array<std::uint8_t, 5>& additional,
                                base::SimTime /*now*/) {
  if (!options_.emergencies || !description_.coe || !mailbox_.running() ||
      state() == AlState::bootstrap) {
    return false;
  }
  return coe_.queue_emergency({error_code, error_register, additional});
}

/// Sends the emergencies of the quirk that are due since the last call, but no more than the queue
/// holds.
void SlaveStack::send_storm(base::SimTime now) {
  const base::SimDuration period(1'000'000'000 / std::int64_t{options_.quirks.emergency_storm});
  constexpr std::uint8_t kManufacturerError = 0x80;
  for (std::size_t i = 0; i < EmergencyQueue::kCapacity && storm_due_ <= now; ++i) {
    send_emergency(dictionary::kStormEmergency, kManufacturerError, {}, now);
    storm_due_ += period;
  }
  storm_due_ = std::max(storm_due_, now + base::SimDuration(1));
}

void SlaveStack::set_emergencies(bool enabled) {
  options_.emergencies = enabled;
  if (!enabled) {
    coe_.drop_emergencies();
  }
}

void SlaveStack::step_down(AlState target, AlStatusCode code, base::SimTime now) {
  now_ = now;
  application_layer_.step_down(target, code, now);
  update_attention();
}

void SlaveStack::raise_error(AlStatusCode code, base::SimTime now) {
  now_ = now;
  application_layer_.raise_error(code, now);
  update_attention();
}

std::optional<AlStatusCode> SlaveStack::perform(AlStep step, base::SimTime now) {
  if (refusal_ != AlStatusCode::no_error && goes_up(step)) {
    reporter_.report(now, rules::kStateFault,
                     {EventArgument(to_text(step.to)), EventArgument(static_cast<int>(refusal_))});
    return refusal_;
  }
  AlStatusCode code = AlStatusCode::no_error;
  if (step == al_step::kIP || step == al_step::kIB) {
    code = start_mailbox(step, now);
  } else if (step == al_step::kPS) {
    code = start_process_data(now);
  } else if (step == al_step::kSO) {
    code = permit_outputs(now);
    if (code == AlStatusCode::no_error) {
      const std::optional<AlStatusCode> verdict = clocks_.permit_operational(now);
      if (!verdict) {
        return std::nullopt;
      }
      code = *verdict;
    }
  } else if (step == al_step::kSP) {
    stop_process_data();
  } else if (step == al_step::kPI || step == al_step::kBI) {
    mailbox_.stop();
  }
  if (!goes_up(step) || code != AlStatusCode::no_error) {
    return code;
  }
  code = application_.permit_state(step.from, step.to, now);
  if (code != AlStatusCode::no_error) {
    if (!application_.explains_refusals()) {
      reporter_.report(now, rules::kApplicationRefused,
                       {EventArgument(to_text(step.to)), EventArgument(static_cast<int>(code))});
    }
    if (step == al_step::kPS) {
      stop_process_data();
    } else if (step.from == AlState::init) {
      mailbox_.stop();
    }
  }
  return code;
}

void SlaveStack::entered(AlStep step, base::SimTime now) {
  using dictionary::NetworkState;
  configuration_.allow_changes(step.to == AlState::pre_operational);
  if (step.to == AlState::operational) {
    coe_.set_network_state(NetworkState::operational);
  } else if (step.to == AlState::safe_operational) {
    coe_.set_network_state(NetworkState::safe_operational);
  } else {
    coe_.set_network_state(NetworkState::pre_operational);
  }
  if (step == al_step::kSO || step == al_step::kOS) {
    clocks_.set_operational(step == al_step::kSO, now);
    outputs_await_sync_ = false;
  }
  if (step == al_step::kOS) {
    forget_outputs();
  }
  application_.on_state(step.from, step.to, now);
  if (step == al_step::kPS) {
    publish_inputs(now);
  } else if (step == al_step::kSO) {
    enter_operational(now);
  }
}

AlStatusCode SlaveStack::start_mailbox(AlStep step, base::SimTime now) {
  const bool bootstrap = step.to == AlState::bootstrap;
  if (bootstrap && description_.bootstrap_receive_mailbox.length == 0) {
    reporter_.report(now, rules::kBootstrapUnsupported);
    return AlStatusCode::bootstrap_not_supported;
  }
  if (!bootstrap && !has_mailbox()) {
    return AlStatusCode::no_error;
  }
  const SyncManagerBank bank = read_sync_managers(interface_);
  const AlStatusCode code = check_mailbox(bank, step.to, now);
  if (code == AlStatusCode::no_error) {
    bank_ = bank;
    mailbox_.start(bank, step.to);
  }
  return code;
}

}  // namespace stator::ethercat
