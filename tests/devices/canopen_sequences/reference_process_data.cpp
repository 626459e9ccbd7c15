// PDOs and SYNC of the reference (CiA 301 §7.2.2, §7.2.5).

#include <algorithm>
#include <utility>

#include "devices/canopen_sequences/reference_node.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {

namespace {

using base::SimDuration;

constexpr SimDuration kMillisecond{1'000'000};
constexpr SimDuration kSoon{2'000'000};
constexpr std::uint8_t kEventDriven = 254;
constexpr std::uint8_t kEverySync = 1;
constexpr std::uint8_t kCommunicationBits = 0x11;
constexpr std::uint8_t kProfileBits = 0x21;

std::uint16_t at(unsigned first, std::size_t pdo) {
  return static_cast<std::uint16_t>(first + pdo);
}

std::string length_key(std::size_t pdo) {
  return "length of RPDO " + std::to_string(pdo + 1);
}

std::string value_key(std::size_t pdo, unsigned entry) {
  return "value in RPDO " + std::to_string(pdo + 1) + "." + std::to_string(entry);
}

}  // namespace

std::uint32_t ReferenceNode::transmit_value(std::size_t pdo, std::uint8_t subindex) const {
  return value(at(0x1800, pdo), subindex);
}

std::uint8_t ReferenceNode::mapped_bytes(std::uint16_t mapping) const {
  unsigned bits = 0;
  for (std::uint8_t entry = 1; entry <= value(mapping, 0); ++entry) {
    bits += value(mapping, entry) & 0xFF;
  }
  return static_cast<std::uint8_t>(bits / 8);
}

/// It exists and has something to say.
bool ReferenceNode::transmits(std::size_t pdo) const {
  return (transmit_value(pdo, 1) & kInvalid) == 0 && mapped_bytes(at(0x1A00, pdo)) != 0;
}

bool ReferenceNode::event_driven(std::size_t pdo) const {
  return transmit_value(pdo, 2) >= kEventDriven;
}

SimDuration ReferenceNode::inhibit(std::size_t pdo) const {
  return kMillisecond * std::int64_t{transmit_value(pdo, 3)};
}

void ReferenceNode::process_data_state(bool operational, Time now) {
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    TransmitState& transmit = transmit_[pdo];
    // Inhibit time counts from the last one, whatever was between.
    const TransmitState before = std::exchange(transmit, {});
    transmit.sent = before.sent;
    transmit.event_sent = before.event_sent;
    transmit.data = before.data;
    receive_[pdo].waiting.reset();
    make_receive_errors_uncertain(pdo);
    if (!operational) {
      continue;
    }
    // Entry into Operational is an event.
    transmit.timer_base = now;
    transmit.free_until =
        std::max(now, transmit.sent ? *transmit.sent + inhibit(pdo) : now) + kSoon;
    if (transmits(pdo) && event_driven(pdo)) {
      transmit.must_come_by = transmit.free_until;
    }
  }
}

void ReferenceNode::hear_sync(Time now) {
  sync_ = now;
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    TransmitState& transmit = transmit_[pdo];
    const bool inhibited = transmit.sent && now < *transmit.sent + inhibit(pdo);
    transmit.came_at_sync = false;
    transmit.awaits_sync = transmits(pdo) && transmit_value(pdo, 2) == kEverySync && !inhibited;
  }
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    if (const auto waiting = std::exchange(receive_[pdo].waiting, std::nullopt)) {
      apply(pdo, *waiting, now);
    }
  }
}

bool ReferenceNode::hear_process_data(const can::Frame& frame, Time now) {
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    const std::uint32_t cob_id = value(at(0x1400, pdo), 1);
    const std::uint8_t length = mapped_bytes(at(0x1600, pdo));
    if ((cob_id & kInvalid) != 0 || (cob_id & 0x7FF) != frame.identifier || length == 0) {
      continue;
    }
    const std::uint16_t error = frame.length < length ? 0x8210 : frame.length > length ? 0x8220 : 0;
    const std::uint16_t before = receive_[pdo].length_error;  // 0 also if that is uncertain
    if (error == 0 || (before != 0 && error != before)) {
      errors_.erase(length_key(pdo));
    }
    receive_[pdo].length_error = error;
    if (error != 0) {
      raise(error, length_key(pdo), kCommunicationBits, now);
      continue;
    }
    const auto data = base::load_le<std::uint64_t>(frame.data, 0);
    if (value(at(0x1400, pdo), 2) < kEventDriven) {
      receive_[pdo].waiting = data;
    } else {
      receive_[pdo].waiting.reset();
      apply(pdo, data, now);
    }
  }
  return true;
}

void ReferenceNode::apply(std::size_t pdo, std::uint64_t data, Time now) {
  const std::uint16_t mapping = at(0x1600, pdo);
  for (std::uint8_t entry = 1; entry <= value(mapping, 0); ++entry) {
    const std::uint32_t mapped = value(mapping, entry);
    const unsigned bits = mapped & 0xFF;
    const auto raw = static_cast<std::uint32_t>(data & ((std::uint64_t{1} << bits) - 1));
    data = bits == 64 ? 0 : data >> bits;
    const ObjectUnderTest& object = *find_object(static_cast<std::uint16_t>(mapped >> 16),
                                                 static_cast<std::uint8_t>(mapped >> 8));
    bool either = false;
    if (judge(object, raw, either).empty()) {
      values_[{object.index, object.subindex}] = raw;
      errors_.erase(value_key(pdo, entry));
    } else {
      raise(0x6320, value_key(pdo, entry), kProfileBits, now);
    }
  }
  stimulus_ = now;
}

void ReferenceNode::see_process_data(std::size_t pdo, const can::Frame& frame, Time now) {
  TransmitState& transmit = transmit_[pdo];
  const std::string name = "TPDO " + std::to_string(pdo + 1);
  if (!state_is(State::operational, now)) {
    fail(Rule::silence, name + " outside Operational", now);
    return;
  }
  if (!transmits(pdo) || frame.length != mapped_bytes(at(0x1A00, pdo))) {
    fail(Rule::transmit_pdo, name + " has not the length of its mapping", now);
  }
  const auto data = base::load_le<std::uint64_t>(frame.data, 0);
  if (!event_driven(pdo)) {
    if (sync_ != now || transmit.came_at_sync) {
      fail(Rule::synchronous_pdo, name + " is synchronous and came without a SYNC", now);
    }
    transmit.came_at_sync = true;
  } else {
    if (transmit.event_sent && now - *transmit.event_sent < inhibit(pdo)) {
      fail(Rule::inhibit_time,
           name + " came " + std::to_string((now - *transmit.event_sent) / SimDuration(1'000)) +
               " us after the one before, its inhibit time is " +
               std::to_string(transmit_value(pdo, 3)) + " ms",
           now);
    }
    const SimDuration period = kMillisecond * std::int64_t{transmit_value(pdo, 5)};
    const Time timer = std::max(transmit.timer_base, transmit.sent.value_or(Time())) + period;
    const bool by_timer = period > SimDuration() && now + kMillisecond >= timer;
    const bool changed = !transmit.sent || data != transmit.data || stimulus_ >= *transmit.sent;
    if (!by_timer && !changed && now > transmit.free_until) {
      fail(Rule::transmit_pdo, name + " came without an event", now);
    }
  }
  transmit.sent = now;
  if (event_driven(pdo)) {
    transmit.event_sent = now;
  }
  transmit.data = data;
  transmit.must_come_by.reset();
}

/// Whether what was wrong with its frames is forgotten then is not said anywhere.
void ReferenceNode::make_receive_errors_uncertain(std::size_t pdo) {
  make_uncertain(length_key(pdo));
  receive_[pdo].length_error = 0;
  for (unsigned entry = 1; entry <= 3; ++entry) {
    make_uncertain(value_key(pdo, entry));
  }
}

void ReferenceNode::pdo_written(const ObjectUnderTest& object, std::uint32_t before, Time now) {
  const std::size_t pdo = object.index & 3U;
  const std::uint32_t after = value(object.index, object.subindex);
  const bool becomes_invalid = object.subindex == 1 && (~before & after & kInvalid) != 0;
  const bool receives = object.index < 0x1800;
  if (receives) {
    // A frame that waits does so still if only the transmission type changes.
    if (becomes_invalid) {
      receive_[pdo].waiting.reset();
    }
    make_receive_errors_uncertain(pdo);
    return;
  }
  if (state_ != State::operational || object.index >= 0x1A00) {
    return;
  }
  TransmitState& transmit = transmit_[pdo];
  transmit.must_come_by.reset();
  transmit.timer_base = now;
  transmit.free_until = std::max(now, transmit.sent ? *transmit.sent + inhibit(pdo) : now) + kSoon;
}

void ReferenceNode::check_process_data(Time now) {
  if (state_ != State::operational) {
    return;
  }
  for (std::size_t pdo = 0; pdo < kPdos; ++pdo) {
    TransmitState& transmit = transmit_[pdo];
    const std::string name = "TPDO " + std::to_string(pdo + 1);
    if (transmit.must_come_by && now > *transmit.must_come_by) {
      fail(Rule::transmit_pdo, name + " did not come when Operational was entered", now);
      transmit.must_come_by.reset();
    }
    const SimDuration period = kMillisecond * std::int64_t{transmit_value(pdo, 5)};
    if (!transmits(pdo) || !event_driven(pdo) || period == SimDuration()) {
      continue;
    }
    const Time from = std::max(transmit.timer_base, transmit.sent.value_or(Time()));
    if (now > from + std::max(period, inhibit(pdo)) + kSoon) {
      fail(Rule::event_timer, name + " did not come when its event timer had elapsed", now);
      transmit.timer_base = now;
    }
  }
}

}  // namespace stator::tests
