// Process data of a slave stack: outputs and inputs, at SYNC0 or as they come, and what supervises
// them.

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;
using base::EventArgument;

/// How often the firmware looks at a watchdog that is off or that nothing has triggered yet: the
/// master may set it at any time, and no event tells.
constexpr base::SimDuration kWatchdogPoll{1'000'000};

}  // namespace

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
  forget_outputs();
  return AlStatusCode::no_error;
}

void SlaveStack::stop_process_data() {
  outputs_.clear();
  inputs_.clear();
  outputs_received_ = false;
  watchdog_due_ = base::SimTime::never();
  outputs_await_sync_ = false;
  clocks_.stop();
}

void SlaveStack::forget_outputs() {
  outputs_received_ = false;
  watchdog_due_ = base::SimTime::never();
  if (outputs_wait(interface_.al_event_request())) {
    read_outputs();  // takes what lies in the channel away
  }
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
  static_cast<void>(watchdog_runs());  // acknowledges an expiry in Safe-Operational
  silent_since_ = now;
  watchdog_time_ = watchdog_time();
  watchdog_due_ = now;
  if (outputs_received_) {
    offer_outputs(now);
  }
}

void SlaveStack::publish_inputs(base::SimTime now) {
  if (!process_data_runs() || inputs_.bytes() == 0) {
    return;
  }
  now_ = now;
  application_.before_inputs(now);
  inputs_.pack(dictionary_);
  write_inputs();
  ++statistics_.inputs_published;
}

// With the quirk any-process-data-length a buffer may be shorter or longer than the image; its last
// byte is what ends an access.

void SlaveStack::read_outputs() {
  const SyncManagerSettings& channel = bank_[kOutputChannel];
  const std::span<std::byte> image = outputs_.data();
  const std::size_t length = std::min<std::size_t>(image.size(), channel.length);
  interface_.read(channel.start, image.first(length));
  std::ranges::fill(image.subspan(length), std::byte{0});
  if (length < channel.length) {
    std::array<std::byte, 1> last{};
    interface_.read(static_cast<std::uint16_t>(channel.start + channel.length - 1), last);
  }
}

void SlaveStack::write_inputs() {
  const SyncManagerSettings& channel = bank_[kInputChannel];
  const std::size_t length = std::min<std::size_t>(inputs_.bytes(), channel.length);
  interface_.write(channel.start, inputs_.data().first(length));
  if (length < channel.length) {
    const std::array<std::byte, 1> last{};
    interface_.write(static_cast<std::uint16_t>(channel.start + channel.length - 1), last);
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
  read_outputs();
  outputs_received_ = true;
  ++statistics_.outputs_received;
  clocks_.on_outputs();
  if (state() == AlState::operational) {
    silent_since_ = now;
    watchdog_due_ = now + kWatchdogPoll;
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

void SlaveStack::check_watchdog(std::uint32_t events, base::SimTime now) {
  const bool signalled = (events & al_event::kProcessDataWatchdog) != 0 && !watchdog_runs();
  if (!signalled && (now < watchdog_due_ || !outputs_overdue(now))) {
    return;
  }
  ++statistics_.watchdog_expirations;
  reporter_.report(now, rules::kWatchdogExpired,
                   {EventArgument(watchdog_time().nanoseconds() / 1000)});
  application_layer_.step_down(AlState::safe_operational, AlStatusCode::sync_manager_watchdog, now);
}

bool SlaveStack::outputs_overdue(base::SimTime now) {
  const base::SimDuration before = std::exchange(watchdog_time_, watchdog_time());
  watchdog_due_ = now + kWatchdogPoll;
  if (watchdog_time_ == base::SimDuration(0)) {
    return false;
  }
  if (before == base::SimDuration(0)) {
    silent_since_ = now;  // switched on just now
  }
  const base::SimTime end = silent_since_ + watchdog_time_;
  watchdog_due_ = std::min(watchdog_due_, end);
  return now >= end;
}

bool SlaveStack::watchdog_runs() {
  std::array<std::byte, 2> status{};
  interface_.read(kProcessDataWatchdogStatus, status);
  return (status[0] & std::byte{1}) != std::byte{0};
}

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
