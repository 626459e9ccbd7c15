#include "stator/can/bus.hpp"

#include <algorithm>
#include <bit>

#include "stator/can/arbitration.hpp"
#include "stator/can/frame_length.hpp"

namespace stator::can {

namespace {

using base::SimDuration;
using base::SimTime;

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
/// At which errors of an unlimited bus take their time.
constexpr std::uint32_t kErrorBitRate = 1'000'000;
constexpr std::uint32_t kIdentifiers = AcceptanceFilter::kIdentifiers;
constexpr SimDuration kLoadWindow{kNanosecondsPerSecond};

SimDuration bits_at(unsigned count, std::uint32_t bit_rate) {
  return SimDuration(std::int64_t{count} * kNanosecondsPerSecond / std::int64_t{bit_rate});
}

}  // namespace

Bus::Bus(const BusSettings& settings) : settings_(settings) {}

Bus::~Bus() {
  for (const Member& member : members_) {
    if (member.controller != nullptr) {
      member.controller->attach(nullptr, 0);
      member.controller->filter().count_changes(nullptr);
    } else if (member.port != nullptr) {
      member.port->attach(nullptr, 0);
    }
  }
}

void Bus::advance(SimTime now) {
  if (stalled_ && !blocked()) {
    stalled_ = false;
    plan();
  }
  if (due_ < now) {  // before what came since
    perform(due_);
    return;
  }
  now_ = std::max(now_, now);
  collect();
  if (due_ <= now_) {
    perform(now_);
  }
}

SimTime Bus::next_deadline() const {
  const bool at_once = noted_.any() || (stalled_ && !blocked());
  return at_once ? std::min(due_, now_) : due_;
}

void Bus::perform(SimTime now) {
  now_ = std::max(now_, now);
  if (transmitting_ && current_.end <= now_) {
    finish();
  } else if (next_recovery_ <= now_) {
    recover(now_);
  } else {
    begin(now_);
  }
  plan();
}

// The one deadline of everything: the end of the present frame, the begin of the next one, or a
// recovery from bus-off.
void Bus::plan() {
  if (transmitting_) {
    due_ = current_.end;
  } else if (contenders_.empty() || stalled_) {
    due_ = SimTime::never();
  } else if (last_hold_ <= std::max(idle_from_, now_)) {
    due_ = std::max(idle_from_, now_);
  } else {
    due_ = SimTime::never();
    for (const Contenders::Entry entry : contenders_.all()) {
      due_ = std::min(due_, std::max(held_until_[entry.member()], std::max(idle_from_, now_)));
    }
  }
  due_ = std::min(due_, next_recovery_);
}

void Bus::collect() {
  if (!noted_.any()) {
    return;
  }
  noted_.take([this](std::size_t member) { refresh(member); });
  plan();
}

void Bus::refresh(std::size_t index) {
  const Member& member = members_[index];
  const Frame* frame = member.active() ? member.pending() : nullptr;
  const std::uint64_t key = frame != nullptr ? arbitration_field(*frame) : kNothing;
  if (key == keys_[index]) {
    return;
  }
  if (keys_[index] != kNothing) {
    contenders_.erase(contender(index));
  }
  keys_[index] = key;
  if (key != kNothing) {
    contenders_.insert(contender(index));
  }
}

Contenders::Entry Bus::contender(std::size_t index) const {
  return {static_cast<std::uint32_t>(keys_[index]), index};
}

// Frames that members have put in since the last call count from the next step on; those that were
// taken back or replaced are removed from the contenders now.
void Bus::forget_vanished() {
  noted_.look([this](std::size_t i) {
    const Frame* frame = members_[i].pending();
    if (keys_[i] != kNothing && (frame == nullptr || arbitration_field(*frame) != keys_[i])) {
      refresh(i);
    }
  });
}

// Equal fields are served in turn.
std::size_t Bus::arbitrate(SimTime now) {
  std::size_t winner = kNobody;
  contested_ = false;
  for (const Contenders::Entry entry : contenders_.all()) {
    if (winner != kNobody && entry.field() != keys_[winner]) {
      break;
    }
    if (held_until_[entry.member()] > now) {
      continue;
    }
    contested_ = winner != kNobody;
    if (!contested_ || (winner <= last_winner_ && entry.member() > last_winner_)) {
      winner = entry.member();
    }
  }
  return winner;
}

void Bus::begin(SimTime now) {
  if (blocked()) {
    stalled_ = true;
    return;
  }
  if (noted_.any()) {
    forget_vanished();
  }
  const std::size_t winner = arbitrate(now);
  if (winner == kNobody) {
    return;
  }
  Member& member = members_[winner];
  current_ = {};
  current_.frame = *member.pending();
  if (!faults_.empty() && !member.delayed) {
    if (const auto fault = faults_.hit(current_.frame, winner)) {
      if (fault->kind == FrameFaultKind::delay) {
        member.delayed = true;
        held_until_[winner] = now + fault->delay;
        last_hold_ = std::max(last_hold_, held_until_[winner]);
        return;
      }
      current_.fault = fault->kind;
    }
  }
  last_winner_ = winner;
  gather_senders(winner, now);
  current_.duration = duration_of(current_.frame, now);
  current_.end = now + current_.duration;
  transmitting_ = true;
  if (current_.end <= now) {
    finish();
  }
}

// Nodes that send the same arbitration field at once do not notice each other unless a later bit
// differs.
void Bus::gather_senders(std::size_t winner, SimTime now) {
  senders_.clear();
  senders_.push_back(winner);
  if (!contested_ || members_[winner].controller == nullptr) {
    return;
  }
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const bool node = members_[i].controller != nullptr;
    if (node && i != winner && keys_[i] == keys_[winner] && held_until_[i] <= now) {
      senders_.push_back(i);
      current_.collision |= *members_[i].pending() != current_.frame;
    }
  }
}

SimDuration Bus::duration_of(const Frame& frame, SimTime now) {
  if (settings_.bit_rate) {
    return bits(frame_length_in_bits(frame));
  }
  begun_at_once_ = now == last_begin_ ? begun_at_once_ + 1 : 0;
  last_begin_ = now;
  return begun_at_once_ < kMaximumAtOneInstant
             ? SimDuration()
             : bits_at(frame_length_in_bits(frame), kErrorBitRate);
}

void Bus::finish() {
  transmitting_ = false;
  const SimTime end = current_.end;
  account(end, current_.duration);
  const Verdict result = verdict();
  if (result == Verdict::good) {
    deliver(end);
  } else {
    destroy(result, end);
  }
  if (tap_) {
    tap_({end, result == Verdict::good ? TraceEntry::Kind::frame : TraceEntry::Kind::error_frame,
          current_.frame, senders_.front(), members_[senders_.front()].port != nullptr});
  }
}

Bus::Verdict Bus::verdict() const {
  if (current_.collision || current_.fault == FrameFaultKind::corrupt) {
    return Verdict::bit_error;
  }
  if (mismatched_ != 0) [[unlikely]] {
    if (mismatched(members_[senders_.front()])) {
      return Verdict::bit_error;
    }
    for (const Member& member : members_) {
      if (mismatched(member) && member.active() && member.state == ErrorState::error_active) {
        return Verdict::bit_error;
      }
    }
  }
  if (!members_[senders_.front()].active()) {
    return Verdict::sender_gone;
  }
  if (settings_.ports_acknowledge && ports_ > 0) {
    return Verdict::good;
  }
  const bool heard = std::ranges::any_of(listeners_, [this](const Listener& listener) {
    return listener.controller != nullptr && !is_sender(listener.member);
  });
  return heard || senders_.size() > 1 ? Verdict::good : Verdict::not_acknowledged;
}

void Bus::deliver(SimTime end) {
  idle_from_ = end + bits(kIntermissionBits);
  ++statistics_.frames;
  for (const std::size_t sender : senders_) {
    Member& member = members_[sender];
    ++member.statistics.sent;
    member.delayed = false;
    member.errors.transmitted();
    if (current_.fault != FrameFaultKind::duplicate) {
      if (member.controller != nullptr) {
        member.controller->transmitted(current_.frame);
      } else {
        member.port->transmitted(current_.frame);
      }
      refresh(sender);
    }
  }
  if (current_.fault == FrameFaultKind::drop) {
    ++statistics_.frames_dropped;
  } else {
    hand_over(end);
  }
  if (errors_counted_) [[unlikely]] {
    count_success(end);
  }
}

void Bus::hand_over(SimTime end) {
  if (current_.frame.extended || current_.frame.remote) {
    for (const Listener& listener : listeners_) {
      if (listener.port != nullptr || listener.controller->filter().accepts(current_.frame)) {
        hand_over_to(listener, end);
      }
    }
    return;
  }
  const std::uint64_t* takers = takers_of(current_.frame.identifier % kIdentifiers);
  for (std::size_t i = 0; i < taker_words_; ++i) {
    for (std::uint64_t word = takers[i]; word != 0; word &= word - 1) {
      hand_over_to(listeners_[i * 64 + static_cast<std::size_t>(std::countr_zero(word))], end);
    }
  }
}

void Bus::hand_over_to(const Listener& listener, SimTime end) {
  if (is_sender(listener.member)) {
    return;
  }
  ++members_[listener.member].statistics.received;
  if (listener.port != nullptr) {
    listener.port->deliver(current_.frame, end);
  } else {
    listener.controller->deliver(current_.frame);
    reached_.note(listener.member);
  }
}

const std::uint64_t* Bus::takers_of(std::uint32_t identifier) {
  if (filter_changes_ != filter_changes_seen_) {
    filter_changes_seen_ = filter_changes_;
    takers_known_.assign(kIdentifiers, false);
  }
  std::uint64_t* const takers = takers_.data() + identifier * taker_words_;
  if (!takers_known_[identifier]) {
    takers_known_[identifier] = true;
    std::fill_n(takers, taker_words_, 0);
    const Frame frame{.identifier = identifier};
    for (std::size_t i = 0; i < listeners_.size(); ++i) {
      const Listener& listener = listeners_[i];
      if (listener.port != nullptr || listener.controller->filter().accepts(frame)) {
        takers[i / 64] |= std::uint64_t{1} << (i % 64);
      }
    }
  }
  return takers;
}

void Bus::count_success(SimTime end) {
  errors_counted_ = false;
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    if (!is_sender(i) && member.active() && !mismatched(member)) {
      member.errors.received();
    }
    errors_counted_ |= member.errors.transmit() + member.errors.receive() != 0;
    update_state(i, end);
  }
}

// The frame was destroyed: an error frame follows, then whoever lost it tries again.
void Bus::destroy(Verdict verdict, SimTime end) {
  ++statistics_.error_frames;
  errors_counted_ = true;
  // The end of frame did not take place; the error frame came instead.
  idle_from_ = end + error_bits(kErrorFrameBits + kIntermissionBits - 7);
  if (!settings_.bit_rate) {
    idle_from_ += error_bits(frame_length_in_bits(current_.frame));
  }
  if (settings_.bit_rate) {
    account(end, bits(kErrorFrameBits - 7));
  }
  for (const std::size_t sender : senders_) {
    Member& member = members_[sender];
    if (verdict == Verdict::sender_gone || member.controller == nullptr) {
      continue;
    }
    const bool passive = member.state == ErrorState::error_passive;
    if (verdict == Verdict::not_acknowledged) {
      ++member.statistics.not_acknowledged;
    } else {
      ++member.statistics.bit_errors;
    }
    if (!(passive && verdict == Verdict::not_acknowledged)) {
      member.errors.transmit_error();
    }
    if (passive) {
      held_until_[sender] = idle_from_ + error_bits(kSuspendTransmissionBits);
      last_hold_ = std::max(last_hold_, held_until_[sender]);
    }
    update_state(sender, end);
  }
  count_errors_of_others(end);
  for (const Listener& listener : listeners_) {
    if (listener.port != nullptr) {
      listener.port->deliver_error(current_.frame, end);
    }
  }
}

void Bus::count_errors_of_others(SimTime end) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = members_[i];
    if (member.controller != nullptr && member.active() && !is_sender(i)) {
      member.errors.receive_error(mismatched(member));
      update_state(i, end);
    }
  }
}

// Idle time counts from the last frame on, so both windows may be over.
void Bus::account(SimTime end, SimDuration duration) {
  if (!settings_.bit_rate) {
    return;
  }
  statistics_.busy += duration;
  if (end >= load_window_ + kLoadWindow) {
    const bool just_over = end < load_window_ + kLoadWindow * 2;
    busy_before_ = just_over ? busy_in_window_ : SimDuration();
    load_window_ = SimTime(kLoadWindow * (end.since_power_on() / kLoadWindow));
    busy_in_window_ = SimDuration();
  }
  busy_in_window_ += duration;
}

double Bus::load(SimTime now) const {
  if (now < load_window_ + kLoadWindow) {
    return busy_before_.seconds() / kLoadWindow.seconds();
  }
  return now < load_window_ + kLoadWindow * 2 ? busy_in_window_.seconds() / kLoadWindow.seconds()
                                              : 0.0;
}

bool Bus::is_sender(std::size_t member) const {
  return std::ranges::find(senders_, member) != senders_.end();
}

// An unlimited bus is as fast as the slowest port, so that no frame is lost.
bool Bus::blocked() const {
  return !settings_.bit_rate && std::ranges::any_of(listening_ports_, [](const Port* port) {
    return port->full() && !port->lossy();
  });
}

SimDuration Bus::bits(unsigned count) const {
  return settings_.bit_rate ? bits_at(count, *settings_.bit_rate) : SimDuration();
}

SimDuration Bus::error_bits(unsigned count) const {
  return bits_at(count, settings_.bit_rate.value_or(kErrorBitRate));
}

}  // namespace stator::can
