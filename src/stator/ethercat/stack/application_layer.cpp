#include "stator/ethercat/stack/application_layer.hpp"

#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

using base::EventArgument;

constexpr unsigned kStateMask = 0x0F;
constexpr unsigned kErrorBit = 0x10;           ///< control: acknowledge; status: indication
constexpr unsigned kIdentificationBit = 0x20;  ///< control: request; status: 0x0134 holds the ID

}  // namespace

ApplicationLayer::ApplicationLayer(ProcessDataInterface& interface, AlActions& actions,
                                   std::optional<std::uint16_t> identification,
                                   base::EventReporter reporter, SlaveStackStatistics& statistics)
    : interface_(interface),
      actions_(actions),
      identification_(identification),
      reporter_(reporter),
      statistics_(statistics) {}

void ApplicationLayer::reset() {
  state_ = AlState::init;
  code_ = AlStatusCode::no_error;
  pending_.reset();
  identification_requested_ = false;
  write_status();
}

void ApplicationLayer::handle_al_control(base::SimTime now) {
  std::array<std::byte, 2> bytes{};
  interface_.read(kAlControl, bytes);
  const unsigned control = base::load_le<std::uint16_t>(bytes);
  const std::optional<AlState> requested = to_al_state(control & kStateMask);
  if (pending_ != requested) {
    abandon_request();
  }
  pending_.reset();  // the same request once more goes on waiting from when it began

  if ((control & kErrorBit) != 0) {
    code_ = AlStatusCode::no_error;
  } else if (code_ != AlStatusCode::no_error && requested != AlState::init) {
    // An unacknowledged error blocks every request except the one for Init (ETG.1000.6 §6.4.1.4).
    reporter_.report(now, rules::kAlErrorNotAcknowledged,
                     {EventArgument(requested ? to_text(*requested) : "an unknown state"),
                      EventArgument(static_cast<int>(code_))});
    ++statistics_.refused_state_changes;
    return;
  }
  code_ = AlStatusCode::no_error;
  const bool identify = (control & kIdentificationBit) != 0;
  identification_requested_ = identification_ && identify;
  if (identify && !identification_) {
    reporter_.report(now, rules::kAlNoIdentification);
  }

  AlStatusCode result = AlStatusCode::unknown_requested_state;
  if (requested) {
    result = change_state(*requested, now);
  } else {
    reporter_.report(now, rules::kAlUnknownState,
                     {EventArgument(static_cast<int>(control & kStateMask))});
  }
  answer(result);
}

void ApplicationLayer::answer(AlStatusCode result) {
  if (result != AlStatusCode::no_error) {
    ++statistics_.refused_state_changes;
    indicate_error(result);
  } else {
    write_status();
  }
}

void ApplicationLayer::abandon_request() {
  if (pending_) {
    pending_.reset();
    actions_.request_abandoned();
  }
}

void ApplicationLayer::continue_change(base::SimTime now) {
  if (!pending_) {
    return;
  }
  const AlState requested = *pending_;
  pending_.reset();
  const AlStatusCode result = change_state(requested, now);
  if (!pending_) {
    answer(result);
  }
}

AlStatusCode ApplicationLayer::change_state(AlState requested, base::SimTime now) {
  if (requested == state_) {
    return AlStatusCode::no_error;
  }
  const AlTransition* transition = find_transition(state_, requested);
  if (transition == nullptr) {
    return refuse_invalid(requested, now);
  }
  for (const AlStep step : transition->path()) {
    const std::optional<AlStatusCode> verdict = actions_.perform(step, now);
    if (!verdict) {
      pending_ = requested;
      return AlStatusCode::no_error;
    }
    if (goes_up(step) && *verdict != AlStatusCode::no_error) {
      return *verdict;
    }
    state_ = step.to;
    ++statistics_.state_changes;
    reporter_.report(now, rules::kAlStateChanged,
                     {EventArgument(to_text(step.from)), EventArgument(to_text(step.to))});
    actions_.entered(step, now);
  }
  return AlStatusCode::no_error;
}

AlStatusCode ApplicationLayer::refuse_invalid(AlState requested, base::SimTime now) const {
  reporter_.report(now, rules::kAlInvalidChange,
                   {EventArgument(to_text(state_)), EventArgument(to_text(requested))});
  return AlStatusCode::invalid_requested_state_change;
}

void ApplicationLayer::step_down(AlState target, AlStatusCode code, base::SimTime now) {
  const AlState before = state_;
  if (find_transition(before, target) == nullptr || goes_up({before, target})) {
    return;
  }
  abandon_request();
  reporter_.report(now, rules::kAlSteppedDown,
                   {EventArgument(to_text(before)), EventArgument(to_text(target)),
                    EventArgument(static_cast<int>(code))});
  static_cast<void>(change_state(target, now));  // steps down are never refused
  indicate_error(code);
}

void ApplicationLayer::leave_for_init(base::SimTime now) {
  pending_.reset();
  static_cast<void>(change_state(AlState::init, now));  // steps down are never refused
}

void ApplicationLayer::raise_error(AlStatusCode code, base::SimTime now) {
  abandon_request();
  reporter_.report(now, rules::kAlErrorRaised,
                   {EventArgument(to_text(state_)), EventArgument(static_cast<int>(code))});
  indicate_error(code);
}

void ApplicationLayer::indicate_error(AlStatusCode code) {
  code_ = code;
  identification_requested_ = false;
  write_status();
}

void ApplicationLayer::write_status() {
  const bool error = code_ != AlStatusCode::no_error;
  auto status = static_cast<unsigned>(state_);
  auto code = static_cast<unsigned>(code_);
  if (error) {
    status |= kErrorBit;
  } else if (identification_requested_) {
    status |= kIdentificationBit;
    code = *identification_;
  }
  // The code first: a master that sees the error bit must find the reason in place.
  std::array<std::byte, 2> bytes{};
  base::store_le(bytes, 0, static_cast<std::uint16_t>(code));
  interface_.write(kAlStatusCode, bytes);
  base::store_le(bytes, 0, static_cast<std::uint16_t>(status));
  interface_.write(kAlStatus, bytes);
}

}  // namespace stator::ethercat
