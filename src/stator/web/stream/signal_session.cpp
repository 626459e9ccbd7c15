#include "stator/web/stream/signal_session.hpp"

#include <utility>
#include <variant>

namespace stator::web {

SignalSession::SignalSession(State& state, RackAccess& access)
    : state_(state), access_(access), queue_(state.counters) {}

void SignalSession::take(std::string_view message) {
  const auto parsed = parse_subscription(message, state_, access_.values_left(*this));
  if (const auto* wrong = std::get_if<Response>(&parsed)) {
    queue_.push_problem(*wrong);
    return;
  }
  const auto& subscription = std::get<Subscription>(parsed);
  queue_.forget_tap();
  queue_.push_subscribed(state_, subscription);
  access_.untap(*this);
  access_.unwatch_events(*this);
  if (subscription.events) {
    access_.watch_events(shared<TapOwner>(this));
  }
  if (!subscription.signals.empty()) {
    ready_ = false;
    access_.tap(shared<TapOwner>(this), subscription);
  }
}

void SignalSession::end() {
  if (!std::exchange(ended_, true)) {
    access_.untap(*this);
    access_.unwatch_events(*this);
  }
}

void SignalSession::tapped() {
  ready_ = true;
  tell();
}

void SignalSession::collect(rack::SignalTap& tap) {
  queue_.collect(tap);
  tell();
}

void SignalSession::collect_events() {
  queue_.collect_events(state_);
  tell();
}

}  // namespace stator::web
