#include "stator/canopen/pdo/transmit_pdo.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "stator/base/byte_order.hpp"

namespace stator::canopen {

namespace {

constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;

}  // namespace

TransmitPdo::TransmitPdo(dictionary::Dictionary& dictionary, std::uint16_t number,
                         can::Transmitter& transmitter, const PdoRules& limits)
    : dictionary_(&dictionary),
      number_(number),
      transmitter_(&transmitter),
      rules_(&limits),
      mapping_(dictionary,
               *dictionary.find(static_cast<std::uint16_t>(kTransmitPdoMapping + number)),
               PdoDirection::transmit, limits) {}

void TransmitPdo::reset() {
  sent_at_.reset();
  inhibited_until_ = base::SimTime();
}

bool TransmitPdo::configure(base::SimTime now) {
  const auto index = static_cast<std::uint16_t>(kTransmitPdoCommunication + number_);
  const auto value_of = [&](std::uint8_t subindex) -> std::int64_t {
    const dictionary::Entry* entry = dictionary_->find(index, subindex);
    return entry == nullptr ? 0 : entry->signed_value();
  };
  const auto cob_id = static_cast<std::uint64_t>(value_of(1));
  const auto identity = [this] { return std::tuple(valid_, can_id_, type_, sync_start_); };
  const auto before = identity();
  valid_ = (cob_id & kCobIdInvalid) == 0;
  remote_ = (cob_id & kCobIdNoRemote) == 0;
  can_id_ = can_id_of(cob_id);
  type_ = static_cast<std::uint8_t>(value_of(2));
  sync_start_ = static_cast<std::uint8_t>(value_of(6));
  inhibit_time_ = rules_->inhibit_unit * value_of(3);
  if (sent_at_) {
    inhibited_until_ = *sent_at_ + inhibit_time_;
  }
  const base::SimDuration event_time = base::SimDuration(kNanosecondsPerMillisecond) * value_of(5);
  if (std::exchange(event_time_, event_time) != event_time && running_) {
    timer_ = timed() ? now + event_time_ : base::SimTime::never();
  }
  const bool remapped = !mapping_.up_to_date();
  if (remapped) {
    mapping_.compile();
  }
  return remapped || identity() != before;
}

void TransmitPdo::start(base::SimTime now) {
  running_ = valid_ && !mapping_.empty();
  event_ = false;
  syncs_ = 0;
  awaits_start_ = sync_start_ != 0;
  timer_ = base::SimTime::never();
  if (!running_) {
    return;
  }
  last_data_ = mapping_.pack();
  if (timed()) {
    timer_ = now + event_time_;
  }
  on_event(now);
}

void TransmitPdo::stop() {
  running_ = false;
  event_ = false;
  timer_ = base::SimTime::never();
}

bool TransmitPdo::values_may_have_changed(base::SimTime now) {
  if (!running_ || event_ || !(event_driven() || type_ == kAcyclicSynchronous)) {
    return false;
  }
  const std::uint64_t data = mapping_.pack();
  if (data == last_data_) {
    return false;
  }
  event_ = true;
  if (event_driven() && now >= inhibited_until_) {
    send(data, now);
  }
  return true;
}

void TransmitPdo::request(base::SimTime now) {
  if (running_) {
    on_event(now);
  }
}

void TransmitPdo::on_event(base::SimTime now) {
  event_ = event_driven() || type_ == kAcyclicSynchronous;
  if (event_driven() && now >= inhibited_until_) {
    send_now(now);
  }
}

void TransmitPdo::on_sync(std::uint8_t counter, base::SimTime now) {
  if (!running_) {
    return;
  }
  if (rules_->inhibit_synchronous && now < inhibited_until_) {
    return;
  }
  if (type_ == kAcyclicSynchronous) {
    if (event_) {
      send_now(now);
    }
  } else if (type_ <= kLastCyclicSynchronous) {
    sync_cyclic(counter, now);
  } else if (type_ == kRemoteSynchronous) {
    last_data_ = mapping_.pack();
  }
}

void TransmitPdo::sync_cyclic(std::uint8_t counter, base::SimTime now) {
  if (awaits_start_ && counter != 0) {
    if (counter != sync_start_) {
      return;
    }
    // The SYNC with the start value is the first one that counts, and is answered.
    awaits_start_ = false;
    syncs_ = static_cast<std::uint8_t>(type_ - 1);
  }
  if (++syncs_ >= type_) {
    syncs_ = 0;
    send_now(now);
  }
}

void TransmitPdo::on_remote_frame(base::SimTime now) {
  if (!running_ || !remote_) {
    return;
  }
  if (type_ == kRemoteSynchronous) {
    send(last_data_, now);
  } else {
    send_now(now);
  }
}

void TransmitPdo::advance(base::SimTime now) {
  if (now >= timer_) {
    timer_ += event_time_;
    event_ = true;
  }
  if (event_ && event_driven() && now >= inhibited_until_) {
    send_now(now);
  }
}

base::SimTime TransmitPdo::next_deadline() const {
  return event_ && event_driven() ? std::min(timer_, inhibited_until_) : timer_;
}

void TransmitPdo::send(std::uint64_t data, base::SimTime now) {
  can::Frame frame{.identifier = can_id_, .length = mapping_.bytes()};
  base::store_le(frame.data.data(), data);
  const bool taken = transmitter_->send(frame);
  sent_ += taken ? 1U : 0U;
  lost_ += taken ? 0U : 1U;
  event_ = false;
  last_data_ = data;
  sent_at_ = now;
  inhibited_until_ = now + inhibit_time_;
  if (timed()) {
    timer_ = now + event_time_;
  }
}

}  // namespace stator::canopen
