// What a slave stack demands of its sync managers, and what it does when the master changes them.

#include <algorithm>
#include <array>
#include <initializer_list>

#include "stator/ethercat/stack/slave_stack.hpp"

namespace stator::ethercat {

namespace {

using base::EventArgument;

/// Header, CoE header and one SDO: the shortest mailbox that can work.
constexpr std::size_t kMinimumMailbox = 16;

}  // namespace

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
    const bool any = options_.quirks.any_process_data_length && bytes != 0;
    return SyncManagerRequirement{channel,
                                  SyncManagerSettings::kThreeBufferMode,
                                  direction,
                                  any ? std::size_t{1} : bytes,
                                  any ? std::size_t{options_.process_memory_end} : bytes,
                                  options_.process_memory_end};
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

}  // namespace stator::ethercat
