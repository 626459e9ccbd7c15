#include "stator/canopen/emergency/error_behaviour.hpp"

#include <algorithm>

namespace stator::canopen {

using dictionary::Entry;
using dictionary::Verdict;

ErrorBehaviour::ErrorBehaviour(dictionary::Dictionary& dictionary, const NmtAccess& nmt,
                               base::EventReporter reporter,
                               std::span<const ErrorBehaviourValue> values)
    : dictionary_(dictionary), nmt_(nmt), reporter_(reporter), values_(values) {
  const dictionary::Object* object = dictionary.find(kErrorBehaviour);
  if (object == nullptr) {
    return;
  }
  for (const Entry& entry : object->entries.subspan(1)) {
    dictionary.on_check(kErrorBehaviour, entry.subindex(),
                        Entry::CheckHook::bind<&ErrorBehaviour::check_value>(*this));
  }
}

ErrorReaction ErrorBehaviour::reaction_to(std::uint8_t error_class) const {
  const Entry* entry = dictionary_.find(kErrorBehaviour, error_class);
  if (entry == nullptr && error_class != kCommunicationError) {
    return ErrorReaction::none;
  }
  const std::uint64_t value = entry == nullptr ? 0 : entry->value();
  const auto found = std::ranges::find(values_, value, &ErrorBehaviourValue::value);
  return found == values_.end() ? ErrorReaction::none : found->reaction;
}

void ErrorBehaviour::react(std::uint8_t error_class, base::SimTime now) {
  if (nmt_.state() != NmtState::operational) {
    return;
  }
  const ErrorReaction reaction = reaction_to(error_class);
  if (reaction == ErrorReaction::none) {
    return;
  }
  const NmtState state =
      reaction == ErrorReaction::stopped ? NmtState::stopped : NmtState::pre_operational;
  reporter_.report(now, rules::kErrorReaction, {to_text(state), int{error_class}});
  nmt_.enter(state, now);
}

Verdict ErrorBehaviour::check_value(const Entry& entry, std::uint64_t value) {
  if (std::ranges::find(values_, value, &ErrorBehaviourValue::value) != values_.end()) {
    return {};
  }
  return dictionary::refuse(
      dictionary::AbortCode::value_range_exceeded, rules::kErrorBehaviourValue,
      {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), value});
}

}  // namespace stator::canopen
