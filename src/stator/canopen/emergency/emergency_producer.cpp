#include "stator/canopen/emergency/emergency_producer.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::canopen {

namespace {

using base::SimTime;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Verdict;

constexpr std::uint8_t kGenericError = 0x01;
constexpr std::uint16_t kErrorReset = 0x0000;
constexpr std::int64_t kNanosecondsPerInhibitUnit = 100'000;

// What becomes of a message.
constexpr base::StaticText kSent = "its emergency has been handed to the CAN controller";
constexpr base::StaticText kInhibited =
    "its emergency waits for the inhibit time 1015h or for earlier ones";
constexpr base::StaticText kStopped = "its emergency waits until the node has left Stopped";
constexpr base::StaticText kStarting =
    "its emergency comes after the boot-up message, if the error lasts until then";
constexpr base::StaticText kSwitchedOff =
    "no emergency is sent, for bit 31 of 1014h switches them off";
constexpr base::StaticText kMissing = "no emergency is sent, for the node has no 1014h";
constexpr base::StaticText kCrowded = "its emergency is lost, for eight wait already";
constexpr base::StaticText kNoRoom =
    "its emergency is lost, for the transmit buffer of the CAN controller is full";
constexpr base::StaticText kNotTold =
    "no emergency is sent, for the product has no code for it: only 1001h tells";

/// Codes 81xxh and 82xxh: communication, protocol (CiA 301 table 26).
bool is_communication_error(std::uint16_t code) {
  return code >= 0x8100 && code <= 0x82FF;
}

}  // namespace

EmergencyProducer::EmergencyProducer(dictionary::Dictionary& dictionary,
                                     can::Transmitter& transmitter, base::EventReporter reporter,
                                     const EmergencyRules& limits)
    : dictionary_(dictionary),
      transmitter_(transmitter),
      reporter_(reporter),
      rules_(limits),
      error_register_(dictionary.find(kErrorRegister, 0)),
      history_(dictionary.find(kPredefinedErrorField)),
      cob_id_(dictionary.find(kCobIdEmergency, 0)),
      inhibit_time_(dictionary.find(kInhibitTimeEmergency, 0)) {
  using Check = Entry::CheckHook;
  if (cob_id_ != nullptr) {
    dictionary_.on_check(kCobIdEmergency, 0,
                         Check::bind<&EmergencyProducer::check_cob_id_written>(*this));
  }
  if (history_ != nullptr) {
    dictionary_.on_check(kPredefinedErrorField, 0,
                         Check::bind<&EmergencyProducer::check_history_written>(*this));
    for (const Entry& entry : history_->entries.subspan(1)) {
      dictionary_.on_read_check(
          kPredefinedErrorField, entry.subindex(),
          Entry::ReadCheckHook::bind<&EmergencyProducer::check_history_read>(*this));
    }
  }
}

void EmergencyProducer::start(SimTime now) {
  inhibited_until_ = now;
  // The dictionary has its defaults, 1001h included. Messages that wait were raised during
  // Initialisation, before 1014h had its value, and their errors may be gone: the messages are made
  // anew from the errors that last.
  update_register();
  message_count_ = 0;
  for (std::size_t i = 0; i < error_count_; ++i) {
    if (const Error& error = errors_[i]; error.sent) {
      static_cast<void>(queue({.code = error.code, .information = error.information}, now));
    }
  }
}

void EmergencyProducer::begin_anew() {
  message_count_ = 0;
  const auto end =
      std::remove_if(errors_.begin(), errors_.begin() + static_cast<std::ptrdiff_t>(error_count_),
                     [](const Error& error) { return is_communication_error(error.code); });
  error_count_ = static_cast<std::size_t>(end - errors_.begin());
  update_register();
}

void EmergencyProducer::forget() {
  message_count_ = 0;
  error_count_ = 0;
  update_register();
}

void EmergencyProducer::on_state(NmtState state, SimTime now) {
  state_ = state;
  if (state == NmtState::initialisation) {
    begin_anew();
  }
  send_waiting(now);
}

Emergency EmergencyProducer::completed(const Emergency& emergency) const {
  Emergency result = emergency;
  const auto rule = std::ranges::find(rules_.codes, emergency.code, &EmergencyRule::code);
  if (rule != rules_.codes.end()) {
    result.error_register = rule->error_register;
    for (std::size_t i = 0; i < result.information.size(); ++i) {
      if (result.information[i] == 0) {
        result.information[i] = rule->information[i];
      }
    }
  }
  result.error_register |= kGenericError;
  return result;
}

EmergencyProducer::Error* EmergencyProducer::find(std::uint16_t code, std::uint8_t cause) {
  const auto end = errors_.begin() + static_cast<std::ptrdiff_t>(error_count_);
  const auto found = std::find_if(errors_.begin(), end, [=](const Error& error) {
    return error.code == code && error.cause == cause;
  });
  return found == end ? nullptr : &*found;
}

bool EmergencyProducer::lasts(std::uint16_t code, std::uint8_t cause) const {
  const auto end = errors_.begin() + static_cast<std::ptrdiff_t>(error_count_);
  return std::any_of(errors_.begin(), end, [=](const Error& error) {
    return error.code == code && error.cause == cause;
  });
}

void EmergencyProducer::raise(const Emergency& emergency, SimTime now) {
  const Emergency complete = completed(emergency);
  if (add(complete, true)) {
    report(complete, queue(complete, now), now);
  }
}

void EmergencyProducer::note(const Emergency& emergency, SimTime now) {
  const Emergency complete = completed(emergency);
  if (add(complete, false)) {
    report(complete, kNotTold, now);
  }
}

void EmergencyProducer::report(const Emergency& emergency, base::StaticText fate,
                               SimTime now) const {
  reporter_.report(now, rules::kEmergencyRaised,
                   {int{emergency.code}, error_register_->signed_value(),
                    int{emergency.information[0]}, int{emergency.information[1]}, fate});
}

bool EmergencyProducer::add(const Emergency& emergency, bool sent) {
  if (find(emergency.code, emergency.cause) != nullptr) {
    return false;
  }
  if (error_count_ < errors_.size()) {
    errors_[error_count_++] = {emergency.code, emergency.cause, emergency.error_register,
                               emergency.information, sent};
  }
  update_register();
  record(emergency);
  return true;
}

bool EmergencyProducer::remove(std::uint16_t code, std::uint8_t cause) {
  Error* error = find(code, cause);
  if (error == nullptr) {
    return false;
  }
  *error = errors_[--error_count_];
  update_register();
  return true;
}

void EmergencyProducer::clear(std::uint16_t code, std::uint8_t cause, SimTime now) {
  if (!remove(code, cause)) {
    return;
  }
  reporter_.report(now, rules::kEmergencyCleared, {int{code}, error_register_->signed_value()});
  if (state_ != NmtState::initialisation) {
    report_reset(now);
  }
}

void EmergencyProducer::withdraw(std::uint16_t code, std::uint8_t cause) {
  static_cast<void>(remove(code, cause));
}

void EmergencyProducer::report_reset(SimTime now) {
  static_cast<void>(queue({.code = kErrorReset}, now));
}

void EmergencyProducer::update_register() {
  std::uint8_t bits = 0;
  for (std::size_t i = 0; i < error_count_; ++i) {
    bits |= errors_[i].error_register;
  }
  error_register_->set_value(bits);
}

/// Puts the error in front of the others of 1003h (CiA 301 §7.5.2.4): the code below, the first two
/// bytes of information above.
void EmergencyProducer::record(const Emergency& emergency) {
  if (history_ == nullptr) {
    return;
  }
  const std::span<Entry> history = dictionary_.entries_of(*history_);
  const std::span<Entry> entries = history.subspan(1);
  for (std::size_t i = entries.size(); i > 1; --i) {
    entries[i - 1].set_value(entries[i - 2].value());
  }
  const auto additional =
      static_cast<std::uint32_t>(emergency.information[0] | emergency.information[1] << 8);
  entries.front().set_value(additional << 16 | emergency.code);
  Entry& count = history.front();
  count.set_value(std::min<std::uint64_t>(count.value() + 1, entries.size()));
}

base::StaticText EmergencyProducer::queue(const Emergency& emergency, SimTime now) {
  // In Initialisation 1014h has yet to take the value with which the message is sent.
  const bool valid = cob_id_ != nullptr && (state_ == NmtState::initialisation ||
                                            (cob_id_->value() & kCobIdInvalid) == 0);
  if (!valid || message_count_ == messages_.size()) {
    ++statistics_.dropped;
    return valid ? kCrowded : (cob_id_ == nullptr ? kMissing : kSwitchedOff);
  }
  can::Frame& frame = messages_[(first_message_ + message_count_) % messages_.size()];
  frame = {.length = can::kMaximumData};
  base::store_le(frame.data.data(), emergency.code);
  frame.data[2] = static_cast<std::byte>(error_register_->value());
  std::ranges::transform(emergency.information, frame.data.begin() + 3,
                         [](std::uint8_t byte) { return std::byte{byte}; });
  ++message_count_;
  const std::uint64_t sent = statistics_.sent;
  send_waiting(now);
  deadline_changed();
  if (message_count_ == 0) {
    return statistics_.sent > sent ? kSent : kNoRoom;
  }
  return state_ == NmtState::initialisation ? kStarting
         : state_ == NmtState::stopped      ? kStopped
                                            : kInhibited;
}

bool EmergencyProducer::may_send() const {
  return message_count_ > 0 &&
         (state_ == NmtState::pre_operational || state_ == NmtState::operational);
}

void EmergencyProducer::send_waiting(SimTime now) {
  while (may_send() && now >= inhibited_until_) {
    can::Frame& frame = messages_[first_message_];
    frame.identifier = can_id_of(cob_id_->value());
    first_message_ = (first_message_ + 1) % messages_.size();
    --message_count_;
    const bool valid = (cob_id_->value() & kCobIdInvalid) == 0;
    const bool sent = valid && transmitter_.send(frame);
    statistics_.sent += sent ? 1U : 0U;
    statistics_.dropped += sent ? 0U : 1U;
    const std::int64_t inhibit = inhibit_time_ == nullptr ? 0 : inhibit_time_->signed_value();
    inhibited_until_ = now + base::SimDuration(kNanosecondsPerInhibitUnit) * inhibit;
  }
}

void EmergencyProducer::advance(SimTime now) {
  send_waiting(now);
}

SimTime EmergencyProducer::next_deadline() const {
  return may_send() ? inhibited_until_ : SimTime::never();
}

Verdict EmergencyProducer::check_cob_id_written(const Entry& entry, std::uint64_t value) {
  return check_cob_id(entry, CobIdKind::emergency, value,
                      {.change_valid_emergency = rules_.change_valid_cob_id});
}

Verdict EmergencyProducer::check_history_written(const Entry& entry, std::uint64_t value) {
  if (value == 0) {
    return {};
  }
  return dictionary::refuse(
      AbortCode::value_range_exceeded, rules::kHistoryValue,
      {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), value});
}

Verdict EmergencyProducer::check_history_read(const Entry& entry) {
  const std::uint64_t count = history_->entries.front().value();
  if (entry.subindex() <= count) {
    return {};
  }
  return dictionary::refuse(
      AbortCode::no_data_available, rules::kHistoryEmpty,
      {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), count});
}

}  // namespace stator::canopen
