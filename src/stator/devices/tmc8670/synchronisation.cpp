#include "stator/devices/tmc8670/synchronisation.hpp"

#include <algorithm>
#include <utility>

namespace stator::devices::tmc8670 {

namespace {

constexpr std::uint16_t kOutputs = 0x1C32;
constexpr std::uint16_t kInputs = 0x1C33;

constexpr std::uint16_t kSync0 = 2;  // synchronisation type

constexpr base::EventRule kNoSync0{
    "tmc8670-no-sync0", base::Severity::refusal,
    "Operational refused, AL status {0:x4}: {1:x4}:01 was set to 2, DC SYNC0, which is not active; "
    "activate it by register 0981h, or write 1 (SM event) there"};

}  // namespace

Synchronisation::Synchronisation(dictionary::Dictionary& dictionary, base::EventReporter reporter)
    : reporter_(reporter),
      error_limit_(dictionary.variable<std::uint16_t>(0x10F1, 2)),
      output_type_(dictionary, kOutputs),
      output_cycle_(dictionary.variable<std::uint32_t>(kOutputs, 2)),
      input_type_(dictionary, kInputs),
      input_cycle_(dictionary.variable<std::uint32_t>(kInputs, 2)),
      pulses_(dictionary.variable<std::uint32_t>(0x20F0, 1)),
      errors_(dictionary.variable<std::uint16_t>(0x20F0, 2)),
      missed_(dictionary.variable<std::uint32_t>(0x20F0, 3)),
      losses_(dictionary.variable<std::uint32_t>(0x20F0, 4)) {
  using Written = dictionary::Entry::WrittenHook;
  dictionary.on_written(kOutputs, 1, Written::bind<&Synchronisation::on_output_type>(*this));
  dictionary.on_written(kInputs, 1, Written::bind<&Synchronisation::on_input_type>(*this));
  forget_wishes();
}

void Synchronisation::on_output_type(const dictionary::Entry& entry) {
  output_type_.want(entry.value());
}

void Synchronisation::on_input_type(const dictionary::Entry& entry) {
  input_type_.want(entry.value());
}

Synchronisation::Type::Type(dictionary::Dictionary& dictionary, std::uint16_t index)
    : entry_(dictionary.find(index, 1)), shown_(dictionary.variable<std::uint16_t>(index, 1)) {}

void Synchronisation::Type::show(bool synchronous) {
  shown_.set(synchronous ? kSync0 : wanted_);
}

void Synchronisation::forget_wishes() {
  output_type_.want_default();
  input_type_.want_default();
}

ethercat::AlStatusCode Synchronisation::permit_operational(const ethercat::SlaveStack& stack,
                                                           base::SimTime now) const {
  const bool outputs = output_type_.wanted() == kSync0;
  if (stack.synchronous() || (!outputs && input_type_.wanted() != kSync0)) {
    return ethercat::AlStatusCode::no_error;
  }
  constexpr auto kCode = ethercat::AlStatusCode::invalid_dc_sync_configuration;
  reporter_.report(now, kNoSync0, {static_cast<int>(kCode), int{outputs ? kOutputs : kInputs}});
  return kCode;
}

void Synchronisation::refresh(ethercat::SlaveStack& stack) {
  const ethercat::DcSupervision& clocks = stack.clocks();
  stack.set_sync_error_limit(error_limit_.get());
  output_type_.show(stack.synchronous());
  input_type_.show(stack.synchronous());
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
