#include "ethercat/slave_stack.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/byte_order.hpp"
#include "ethercat/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

using base::EventArgument;

/// Header, CoE header and one SDO: the shortest mailbox that can work.
constexpr std::size_t kMinimumMailbox = 16;
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
               reporter, statistics_),
      coe_(dictionary,
           {.complete_access = description.complete_access,
            .sdo_information = description.sdo_information},
           reporter, statistics_),
      eoe_(description.eoe ? std::make_unique<EoeServer>(reporter) : nullptr),
      configuration_(dictionary, limits_of(description, options)),
      outputs_(PdoDirection::receive, limits_of(description, options).receive_bytes),
      inputs_(PdoDirection::transmit, limits_of(description, options).transmit_bytes),
      clocks_(interface, options.distributed_clocks, reporter) {
  if (description.coe) {
    mailbox_.add(coe_);
  }
  if (eoe_ != nullptr) {
    mailbox_.add(*eoe_);
  }
  if (description.foe) {
    if (options.files == nullptr) {
      throw std::logic_error(description.name + " announces FoE, but has no file store");
    }
    mailbox_.add(foe_.emplace(*options.files, options.foe, reporter));
  }
  application_layer_.reset();
  update_attention();
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
  if (eoe_ != nullptr) {
    eoe_->poll(mailbox_.running() && state() != AlState::bootstrap);
  }
  std::uint32_t events = interface_.al_event_request();
  if ((events & attention_) == 0 && !polls_channels_ && now < first_outputs_deadline_ &&
      now < clocks_.deadline() && !application_layer_.pending() && mailbox_.idle()) {
    return;
  }
  now_ = now;
  if ((events & al_event::kDcSync0) != 0) {
    std::array<std::byte, 1> status{};
    interface_.read(kSync0Status, status);  // acknowledges
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
  if (state() == AlState::operational) {
    check_clocks(now);
    check_watchdog(events, now);
  }
  if (mailbox_.needs_attention(events)) {
    mailbox_.process(events, now);
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

void SlaveStack::sync0(base::SimTime now) {
  now_ = now;
  const AlStatusCode code = clocks_.on_sync0(now);
  if (code != AlStatusCode::no_error) {
    step_down(AlState::safe_operational, code, now);
    return;
  }
  if (!clocks_.synchronous()) {
    return;
  }
  if (state() == AlState::operational && std::exchange(outputs_await_sync_, false)) {
    apply_outputs(now);
  }
  application_.on_sync0(now);
}

void SlaveStack::check_clocks(base::SimTime now) {
  const AlStatusCode code = clocks_.check(now);
  if (code != AlStatusCode::no_error) {
    application_layer_.step_down(AlState::safe_operational, code, now);
  }
}

void SlaveStack::publish_inputs(base::SimTime now) {
  if (!process_data_runs() || inputs_.bytes() == 0) {
    return;
  }
  now_ = now;
  application_.before_inputs(now);
  inputs_.pack(dictionary_);
  interface_.write(bank_[kInputChannel].start, inputs_.data());
  ++statistics_.inputs_published;
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

std::optional<AlStatusCode> SlaveStack::perform(AlStep step, base::SimTime now) {
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
    reporter_.report(now, rules::kApplicationRefused,
                     {EventArgument(to_text(step.to)), EventArgument(static_cast<int>(code))});
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

AlStatusCode SlaveStack::start_process_data(base::SimTime now) {
  const std::array images{std::pair{&outputs_, AlStatusCode::invalid_output_mapping},
                          std::pair{&inputs_, AlStatusCode::invalid_input_mapping}};
  for (const auto& [image, code] : images) {
    if (const auto verdict = image->compile(dictionary_, configuration_); !verdict) {
      reporter_.report(now, *verdict.error().rule, verdict.error().arguments);
      reporter_.report(now, rules::kMappingInvalid,
                       {EventArgument(static_cast<int>(code)),
                        int{image == &outputs_ ? kOutputAssignment : kInputAssignment}});
      stop_process_data();
      return code;
    }
  }
  const SyncManagerBank bank = read_sync_managers(interface_);
  AlStatusCode code = check_process_data(bank, now);
  if (code == AlStatusCode::no_error) {
    code = clocks_.permit_safe_operational(now);
  }
  if (code != AlStatusCode::no_error) {
    stop_process_data();
    return code;
  }
  bank_[kOutputChannel] = bank[kOutputChannel];
  bank_[kInputChannel] = bank[kInputChannel];
  return AlStatusCode::no_error;
}

void SlaveStack::stop_process_data() {
  outputs_.clear();
  inputs_.clear();
  outputs_received_ = false;
  first_outputs_deadline_ = base::SimTime::never();
  outputs_await_sync_ = false;
  clocks_.stop();
}

AlStatusCode SlaveStack::permit_outputs(base::SimTime now) {
  if (outputs_.bytes() != 0 && outputs_wait(interface_.al_event_request())) {
    take_outputs(now);
  }
  if (options_.require_outputs && outputs_.bytes() != 0 && !outputs_received_) {
    reporter_.report(now, rules::kNoOutputs);
    return AlStatusCode::no_valid_outputs;
  }
  return AlStatusCode::no_error;
}

void SlaveStack::enter_operational(base::SimTime now) {
  if (outputs_.bytes() == 0) {
    return;
  }
  // Reading the status also acknowledges an expiry that happened in Safe-Operational.
  std::array<std::byte, 2> status{};
  interface_.read(kProcessDataWatchdogStatus, status);
  const bool expired = (status[0] & std::byte{1}) == std::byte{0};
  first_outputs_deadline_ = base::SimTime::never();
  if (expired || !outputs_received_) {
    const base::SimDuration time = watchdog_time();
    if (time != base::SimDuration(0)) {
      first_outputs_deadline_ = now + time;
    }
  }
  if (outputs_received_) {
    offer_outputs(now);
  }
}

AlStatusCode SlaveStack::check_channel(const SyncManagerBank& bank,
                                       const SyncManagerRequirement& requirement, AlState state,
                                       AlStatusCode code, base::SimTime now) {
  const auto fault = check_sync_manager(bank, requirement, state, code);
  if (!fault) {
    return AlStatusCode::no_error;
  }
  reporter_.report(now, *fault->rule, fault->arguments);
  return code;
}

AlStatusCode SlaveStack::check_mailbox(const SyncManagerBank& bank, AlState state,
                                       base::SimTime now) {
  const bool bootstrap = state == AlState::bootstrap;
  const AlStatusCode code = bootstrap ? AlStatusCode::invalid_mailbox_configuration_bootstrap
                                      : AlStatusCode::invalid_mailbox_configuration_pre_operational;
  const MailboxArea& receive =
      bootstrap ? description_.bootstrap_receive_mailbox : description_.receive_mailbox;
  const MailboxArea& transmit =
      bootstrap ? description_.bootstrap_transmit_mailbox : description_.transmit_mailbox;
  const std::array requirements{
      SyncManagerRequirement{kReceiveMailboxChannel, SyncManagerSettings::kMailboxMode,
                             SyncManagerSettings::kMasterWrites, kMinimumMailbox, receive.length,
                             options_.process_memory_end},
      SyncManagerRequirement{kTransmitMailboxChannel, SyncManagerSettings::kMailboxMode,
                             SyncManagerSettings::kMasterReads, kMinimumMailbox, transmit.length,
                             options_.process_memory_end}};
  for (const SyncManagerRequirement& requirement : requirements) {
    if (check_channel(bank, requirement, state, code, now) != AlStatusCode::no_error) {
      return code;
    }
  }
  return AlStatusCode::no_error;
}

AlStatusCode SlaveStack::check_process_data(const SyncManagerBank& bank, base::SimTime now) {
  const auto requirement = [this](unsigned channel, std::uint8_t direction, std::size_t bytes) {
    return SyncManagerRequirement{channel,   SyncManagerSettings::kThreeBufferMode,
                                  direction, bytes,
                                  bytes,     options_.process_memory_end};
  };
  const AlState state = AlState::safe_operational;
  const AlStatusCode code = check_channel(
      bank, requirement(kOutputChannel, SyncManagerSettings::kMasterWrites, outputs_.bytes()),
      state, AlStatusCode::invalid_output_configuration, now);
  if (code != AlStatusCode::no_error) {
    return code;
  }
  return check_channel(
      bank, requirement(kInputChannel, SyncManagerSettings::kMasterReads, inputs_.bytes()), state,
      AlStatusCode::invalid_input_configuration, now);
}

AlStatusCode SlaveStack::check_unchanged(const SyncManagerBank& bank, unsigned channel,
                                         AlStatusCode code, base::SimTime now) {
  const SyncManagerSettings& settings = bank[channel];
  if (settings.start == bank_[channel].start && settings.length == bank_[channel].length) {
    return AlStatusCode::no_error;
  }
  reporter_.report(now, rules::kSyncManagerChanged,
                   {EventArgument(to_text(state())), EventArgument(static_cast<int>(code)),
                    EventArgument(channel), int{settings.start}, int{settings.length}});
  return code;
}

void SlaveStack::handle_sync_manager_change(base::SimTime now) {
  const SyncManagerBank bank = read_sync_managers(interface_);
  const auto first_error = [](std::initializer_list<AlStatusCode> codes) {
    const auto* found =
        std::ranges::find_if(codes, [](AlStatusCode c) { return c != AlStatusCode::no_error; });
    return found == codes.end() ? AlStatusCode::no_error : *found;
  };
  if (mailbox_.running()) {
    AlStatusCode code = check_mailbox(bank, state(), now);
    if (code == AlStatusCode::no_error) {
      const auto changed = state() == AlState::bootstrap
                               ? AlStatusCode::invalid_mailbox_configuration_bootstrap
                               : AlStatusCode::invalid_mailbox_configuration_pre_operational;
      code = first_error({check_unchanged(bank, kReceiveMailboxChannel, changed, now),
                          check_unchanged(bank, kTransmitMailboxChannel, changed, now)});
    }
    if (code != AlStatusCode::no_error) {
      application_layer_.step_down(AlState::init, code, now);
      return;
    }
    mailbox_.handle_repeat_request(bank[kTransmitMailboxChannel]);
  }
  if (!process_data_runs()) {
    return;
  }
  AlStatusCode code = check_process_data(bank, now);
  if (code == AlStatusCode::no_error && outputs_.bytes() != 0) {
    code = check_unchanged(bank, kOutputChannel, AlStatusCode::invalid_output_configuration, now);
  }
  if (code == AlStatusCode::no_error && inputs_.bytes() != 0) {
    code = check_unchanged(bank, kInputChannel, AlStatusCode::invalid_input_configuration, now);
  }
  if (code != AlStatusCode::no_error) {
    application_layer_.step_down(AlState::pre_operational, code, now);
  }
}

bool SlaveStack::outputs_wait(std::uint32_t events) const {
  const SyncManagerSettings& settings = bank_[kOutputChannel];
  if (outputs_.bytes() == 0) {
    return false;
  }
  if (settings.interrupts_host()) {
    return (events & al_event::sync_manager(kOutputChannel)) != 0;
  }
  std::array<std::byte, 1> status{};
  interface_.read(sync_manager_register(kOutputChannel, kSyncManagerStatus), status);
  return (std::to_integer<unsigned>(status[0]) & SyncManagerSettings::kStatusWritten) != 0;
}

void SlaveStack::take_outputs(base::SimTime now) {
  interface_.read(bank_[kOutputChannel].start, outputs_.data());
  outputs_received_ = true;
  first_outputs_deadline_ = base::SimTime::never();
  ++statistics_.outputs_received;
  clocks_.on_outputs();
  if (state() == AlState::operational) {
    offer_outputs(now);
  }
}

void SlaveStack::offer_outputs(base::SimTime now) {
  if (clocks_.synchronous()) {
    outputs_await_sync_ = true;
  } else {
    apply_outputs(now);
  }
}

void SlaveStack::apply_outputs(base::SimTime now) {
  using Hook = ProcessImage::RefusedHook;
  statistics_.outputs_refused +=
      outputs_.unpack(dictionary_, Hook::bind<&SlaveStack::on_refused>(*this));
  application_.on_outputs(now);
}

void SlaveStack::on_refused(const dictionary::Entry& entry, const dictionary::Refusal& refusal) {
  if (refusal.rule != nullptr) {
    reporter_.report(now_, *refusal.rule, refusal.arguments);
  }
  application_.on_output_refused(entry, refusal, now_);
}

void SlaveStack::check_watchdog(std::uint32_t events, base::SimTime now) {
  bool expired = now >= first_outputs_deadline_;
  if ((events & al_event::kProcessDataWatchdog) != 0) {
    std::array<std::byte, 2> status{};
    interface_.read(kProcessDataWatchdogStatus, status);
    expired = expired || (status[0] & std::byte{1}) == std::byte{0};
  }
  if (!expired) {
    return;
  }
  ++statistics_.watchdog_expirations;
  reporter_.report(now, rules::kWatchdogExpired,
                   {EventArgument(watchdog_time().nanoseconds() / 1000)});
  application_layer_.step_down(AlState::safe_operational, AlStatusCode::sync_manager_watchdog, now);
}

/// Zero if the watchdog is off: by its time, its divider's product or the channel's trigger bit.
base::SimDuration SlaveStack::watchdog_time() {
  if ((bank_[kOutputChannel].control & SyncManagerSettings::kWatchdogTrigger) == 0) {
    return base::SimDuration(0);
  }
  std::array<std::byte, 2> bytes{};
  interface_.read(kWatchdogDivider, bytes);
  const std::int64_t divider = base::load_le<std::uint16_t>(bytes);
  interface_.read(kProcessDataWatchdogTime, bytes);
  const std::int64_t count = base::load_le<std::uint16_t>(bytes);
  return base::SimDuration((divider + 2) * 40 * count);  // units of 40 ns, ETG.1000.4 §6.3
}

}  // namespace stator::ethercat
