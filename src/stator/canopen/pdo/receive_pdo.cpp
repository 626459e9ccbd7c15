#include "stator/canopen/pdo/receive_pdo.hpp"

#include "stator/base/byte_order.hpp"

namespace stator::canopen {

namespace {

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;

std::uint16_t plus(std::uint16_t first, std::uint16_t number) {
  return static_cast<std::uint16_t>(first + number);
}

}  // namespace

ReceivePdo::ReceivePdo(dictionary::Dictionary& dictionary, std::uint16_t number,
                       const PdoRules& limits)
    : number_(number),
      rules_(&limits),
      cob_id_(dictionary.find(plus(kReceivePdoCommunication, number), 1)),
      transmission_type_(dictionary.find(plus(kReceivePdoCommunication, number), 2)),
      event_timer_(dictionary.find(plus(kReceivePdoCommunication, number), 5)),
      mapping_(dictionary, *dictionary.find(plus(kReceivePdoMapping, number)),
               PdoDirection::receive, limits) {}

bool ReceivePdo::becomes_another() const {
  const std::uint64_t cob_id = cob_id_->value();
  return valid_ != ((cob_id & kCobIdInvalid) == 0) || can_id_ != can_id_of(cob_id) ||
         !mapping_.up_to_date();
}

void ReceivePdo::configure() {
  if (becomes_another()) {
    valid_ = (cob_id_->value() & kCobIdInvalid) == 0;
    can_id_ = can_id_of(cob_id_->value());
    mapping_.compile();
    stop();
  }
  type_ = static_cast<std::uint8_t>(transmission_type_->value());
  const base::SimDuration before = timeout_;
  timeout_ = base::SimDuration(kNanosecondsPerMillisecond) *
             (event_timer_ == nullptr ? 0 : event_timer_->signed_value());
  if (!supervised()) {
    expire();
  } else if (deadline_ != base::SimTime::never()) {
    deadline_ = deadline_ - before + timeout_;  // counted from the last frame
  }
}

void ReceivePdo::stop() {
  waiting_ = false;
  deadline_ = base::SimTime::never();
}

ReceivePdo::Reception ReceivePdo::receive(const can::Frame& frame, base::SimTime now,
                                          PdoMapping::RefusedHook on_refused) {
  if (mapping_.empty()) {
    return Reception::no_mapping;
  }
  if (frame.length < mapping_.bytes()) {
    return Reception::too_short;
  }
  if (frame.length > mapping_.bytes() && rules_->long_pdo == LongPdo::reject) {
    return Reception::too_long;
  }
  if (supervised()) {
    deadline_ = now + timeout_;
  }
  data_ = base::load_le<std::uint64_t>(frame.data);
  if (synchronous()) {
    waiting_ = true;
    return Reception::waiting;
  }
  waiting_ = false;  // older than this one: the transmission type was another
  mapping_.unpack(data_, on_refused);
  return Reception::written;
}

bool ReceivePdo::apply(PdoMapping::RefusedHook on_refused) {
  if (!waiting_) {
    return false;
  }
  waiting_ = false;
  mapping_.unpack(data_, on_refused);
  return true;
}

}  // namespace stator::canopen
