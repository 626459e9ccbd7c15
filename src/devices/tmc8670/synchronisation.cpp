#include "devices/tmc8670/synchronisation.hpp"

#include <algorithm>
#include <utility>

namespace stator::devices::tmc8670 {

namespace {

constexpr std::uint16_t kOutputsComing = 1;  // SM event
constexpr std::uint16_t kSync0 = 2;

constexpr base::EventRule kNoSync0{
    "tmc8670-no-sync0", base::Severity::refusal,
    "Operational refused, AL status {0:x4}: 1C32h:01 asks for DC SYNC0, which is not active; "
    "activate it by register 0981h, or write 1 (SM event) there"};

}  // namespace

Synchronisation::Synchronisation(const dictionary::Dictionary& dictionary,
                                 base::EventReporter reporter)
    : reporter_(reporter),
      error_limit_(dictionary.variable<std::uint16_t>(0x10F1, 2)),
      output_type_(dictionary.variable<std::uint16_t>(0x1C32, 1)),
      output_cycle_(dictionary.variable<std::uint32_t>(0x1C32, 2)),
      input_type_(dictionary.variable<std::uint16_t>(0x1C33, 1)),
      input_cycle_(dictionary.variable<std::uint32_t>(0x1C33, 2)),
      pulses_(dictionary.variable<std::uint32_t>(0x20F0, 1)),
      errors_(dictionary.variable<std::uint16_t>(0x20F0, 2)),
      missed_(dictionary.variable<std::uint32_t>(0x20F0, 3)),
      losses_(dictionary.variable<std::uint32_t>(0x20F0, 4)) {}

ethercat::AlStatusCode Synchronisation::permit_operational(const ethercat::SlaveStack& stack,
                                                           base::SimTime now) const {
  if (output_type_.get() != kSync0 || stack.synchronous()) {
    return ethercat::AlStatusCode::no_error;
  }
  constexpr auto kCode = ethercat::AlStatusCode::invalid_dc_sync_configuration;
  reporter_.report(now, kNoSync0, {static_cast<int>(kCode)});
  return kCode;
}

void Synchronisation::refresh(ethercat::SlaveStack& stack) {
  const ethercat::DcSupervision& clocks = stack.clocks();
  stack.set_sync_error_limit(error_limit_.get());
  if (stack.synchronous()) {
    output_type_.set(kSync0);
    input_type_.set(kSync0);
  } else if (stack.state() == ethercat::AlState::operational && output_type_.get() == kSync0) {
    output_type_.set(kOutputsComing);
    input_type_.set(kOutputsComing);
  }
  const auto cycle =
      static_cast<std::uint32_t>(stack.synchronous() ? clocks.cycle().nanoseconds() : 0);
  output_cycle_.set(cycle);
  input_cycle_.set(cycle);
  errors_.set(static_cast<std::uint16_t>(std::min(clocks.sync_errors(), 0xFFFFU)));
  missed_.set(clocks.missed_outputs());
  count_losses(stack.status_code());
}

void Synchronisation::count_losses(ethercat::AlStatusCode code) {
  using enum ethercat::AlStatusCode;
  if (std::exchange(code_, code) != code &&
      (code == synchronization_error || code == dc_sync_timeout || code == fatal_sync_error ||
       code == pll_error)) {
    losses_.set(losses_.get() + 1);
  }
}

}  // namespace stator::devices::tmc8670
