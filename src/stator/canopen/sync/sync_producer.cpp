#include "stator/canopen/sync/sync_producer.hpp"

namespace stator::canopen {

namespace {

base::SimDuration period_of(const dictionary::Entry& entry) {
  constexpr std::int64_t kNanosecondsPerMicrosecond = 1'000;
  return base::SimDuration(kNanosecondsPerMicrosecond) * entry.signed_value();
}

}  // namespace

SyncProducer::SyncProducer(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
                           SyncConsumer& consumer)
    : transmitter_(transmitter),
      consumer_(consumer),
      cob_id_(dictionary.find(kCobIdSync, 0)),
      period_(dictionary.find(kCommunicationCyclePeriod, 0)),
      overflow_(dictionary.find(kSynchronousCounterOverflow, 0)) {
  const auto hook = dictionary::Entry::WrittenHook::bind<&SyncProducer::on_written>(*this);
  dictionary.on_written(kCobIdSync, 0, hook);
  dictionary.on_written(kCommunicationCyclePeriod, 0, hook);
}

void SyncProducer::start(base::SimTime /*now*/) {
  state_ = NmtState::initialisation;
  due_ = base::SimTime::never();
  counter_ = 1;
  changed_ = false;
}

void SyncProducer::on_state(NmtState state, base::SimTime now) {
  const bool worked = state_ == NmtState::pre_operational || state_ == NmtState::operational;
  const bool works = state == NmtState::pre_operational || state == NmtState::operational;
  state_ = state;
  if (worked != works) {
    counter_ = 1;
    follow_objects(now);
  }
}

void SyncProducer::on_written(const dictionary::Entry& /*entry*/) {
  changed_ = true;
  deadline_changed();
}

void SyncProducer::follow_objects(base::SimTime now) {
  const bool works = state_ == NmtState::pre_operational || state_ == NmtState::operational;
  const bool produces = works && (cob_id_->value() & kCobIdProduce) != 0 && period_->value() != 0;
  if (due_ == base::SimTime::never()) {
    counter_ = 1;
  }
  due_ = produces ? now + period_of(*period_) : base::SimTime::never();
}

void SyncProducer::advance(base::SimTime now) {
  if (changed_) {
    changed_ = false;
    follow_objects(now);
  }
  while (now >= due_) {
    const base::SimTime time = due_;
    due_ += period_of(*period_);
    produce(time);
  }
}

base::SimTime SyncProducer::next_deadline() const {
  return changed_ ? base::SimTime() : due_;
}

void SyncProducer::produce(base::SimTime now) {
  can::Frame frame{.identifier = consumer_.can_id()};
  std::uint8_t counter = 0;
  if (overflow_ != nullptr && overflow_->value() != 0) {
    counter = counter_;
    counter_ =
        counter >= overflow_->value() ? std::uint8_t{1} : static_cast<std::uint8_t>(counter + 1);
    frame.length = 1;
    frame.data[0] = std::byte{counter};
  }
  sent_ += transmitter_.send(frame) ? 1U : 0U;
  consumer_.notify(counter, now);
}

}  // namespace stator::canopen
