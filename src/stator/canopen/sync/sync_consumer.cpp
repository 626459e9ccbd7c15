#include "stator/canopen/sync/sync_consumer.hpp"

namespace stator::canopen {

namespace {

using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Verdict;

constexpr std::int64_t kNanosecondsPerMicrosecond = 1'000;
constexpr std::uint16_t kSyncLengthError = 0x8240;

}  // namespace

SyncConsumer::SyncConsumer(dictionary::Dictionary& dictionary, EmergencySink& emergencies,
                           const SyncRules& limits)
    : dictionary_(dictionary),
      emergencies_(emergencies),
      rules_(limits),
      cob_id_(dictionary.find(kCobIdSync, 0)),
      period_(dictionary.find(kCommunicationCyclePeriod, 0)),
      window_(dictionary.find(kSynchronousWindowLength, 0)),
      overflow_(dictionary.find(kSynchronousCounterOverflow, 0)) {
  using Hook = Entry::CheckHook;
  dictionary_.on_check(kCobIdSync, 0, Hook::bind<&SyncConsumer::check_identifier>(*this));
  if (overflow_ != nullptr) {
    dictionary_.on_check(kSynchronousCounterOverflow, 0,
                         Hook::bind<&SyncConsumer::check_overflow>(*this));
  }
}

void SyncConsumer::start(base::SimTime /*now*/) {
  malformed_ = 0;
}

bool SyncConsumer::receive(const can::Frame& frame, base::SimTime now) {
  if (frame.extended || frame.remote || frame.identifier != can_id()) {
    return false;
  }
  if (!length_fits(frame)) {
    ++malformed_;
    emergencies_.raise({.code = kSyncLengthError, .error_register = kErrorRegisterCommunication},
                       now);
    return true;
  }
  if (malformed_ != 0) {
    emergencies_.clear(kSyncLengthError, 0, now);
  }
  notify(frame.length == 0 ? 0 : std::to_integer<std::uint8_t>(frame.data[0]), now);
  return true;
}

bool SyncConsumer::length_fits(const can::Frame& frame) const {
  return overflow_ == nullptr || frame.length == (overflow_->value() == 0 ? 0 : 1);
}

void SyncConsumer::notify(std::uint8_t counter, base::SimTime now) {
  if (!listener_) {
    return;
  }
  const std::int64_t window = window_ == nullptr ? 0 : window_->signed_value();
  listener_({.time = now,
             .counter = counter,
             .window_end = window == 0
                               ? base::SimTime::never()
                               : now + base::SimDuration(kNanosecondsPerMicrosecond) * window});
}

Verdict SyncConsumer::check_identifier(const Entry& entry, std::uint64_t value) {
  const CobIdRules limits{.produce_sync = period_ != nullptr};
  if (Verdict verdict = check_cob_id(entry, CobIdKind::sync, value, limits); !verdict) {
    return verdict;
  }
  if (!rules_.refuse_shared_can_id) {
    return {};
  }
  const Entry* user = user_of_can_id(dictionary_, can_id_of(value), entry);
  if (user == nullptr) {
    return {};
  }
  return dictionary::refuse(AbortCode::value_range_exceeded, rules::kCobIdShared,
                            {int{entry.index()}, int{entry.subindex()}, entry.shared_name(),
                             int{can_id_of(value)}, int{user->index()}, int{user->subindex()}});
}

Verdict SyncConsumer::check_overflow(const Entry& entry, std::uint64_t value) {
  constexpr std::uint64_t kMaximumCounter = 240;
  const auto refuse = [&](AbortCode code, const base::EventRule& rule) {
    return dictionary::refuse(
        code, rule, {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), value});
  };
  if (value == 1 || value > kMaximumCounter) {
    return refuse(AbortCode::value_range_exceeded, rules::kSyncOverflowRange);
  }
  if (period_ != nullptr && period_->value() != 0) {
    return refuse(AbortCode::device_state, rules::kSyncOverflowPeriod);
  }
  return {};
}

}  // namespace stator::canopen
