#include "stator/canopen/nmt/heartbeat_consumer.hpp"

#include <algorithm>

#include "stator/canopen/nmt_command.hpp"
#include "stator/canopen/node_id.hpp"

namespace stator::canopen {

namespace {

using base::SimDuration;
using base::SimTime;
using dictionary::AbortCode;
using dictionary::Entry;
using dictionary::Verdict;

constexpr std::uint16_t kConsumerHeartbeatTime = 0x1016;
constexpr std::uint64_t kReservedBits = 0xFF000000;

constexpr base::EventRule kMissed{
    "heartbeat-missed", base::Severity::fault,
    "heartbeat of node {0} missing for {1} ms, the time that 1016h:{2:x2} allows"};
constexpr base::EventRule kBack{"heartbeat-back", base::Severity::information,
                                "heartbeat of node {0} is back"};
constexpr base::EventRule kTwice{
    "heartbeat-watched-twice", base::Severity::refusal,
    "write to {0:x4}:{1:x2} refused: node {2} is watched by sub-index {3} already; set that to 0 "
    "first"};
constexpr base::EventRule kReserved{
    "heartbeat-reserved-bits", base::Severity::refusal,
    "write to {0:x4}:{1:x2} refused: bits 31 to 24 are reserved and must be 0, {2:x8} came"};

struct Setting {
  std::uint8_t node_id = 0;
  SimDuration time{};
  /// CiA 301: an entry with a time of 0 or without a node-ID from 1 to 127 is not used.
  [[nodiscard]] bool used() const { return is_node_id(node_id) && time > SimDuration(); }
};

Setting decode(std::uint64_t value) {
  return {.node_id = static_cast<std::uint8_t>(value >> 16),
          .time = SimDuration(static_cast<std::int64_t>(value & 0xFFFF) * 1'000'000)};
}

}  // namespace

HeartbeatConsumer::HeartbeatConsumer(dictionary::Dictionary& dictionary,
                                     base::EventReporter reporter, CommunicationErrors& errors)
    : reporter_(reporter), errors_(errors) {
  const dictionary::Object* object = dictionary.find(kConsumerHeartbeatTime);
  if (object == nullptr) {
    return;
  }
  for (const Entry& entry : object->entries.subspan(1)) {
    producers_.push_back({.entry = &entry});
    dictionary.on_check(entry.index(), entry.subindex(),
                        Entry::CheckHook::bind<&HeartbeatConsumer::check>(*this));
    dictionary.on_written(entry.index(), entry.subindex(),
                          Entry::WrittenHook::bind<&HeartbeatConsumer::on_written>(*this));
  }
}

Verdict HeartbeatConsumer::check(const Entry& entry, std::uint64_t value) {
  if ((value & kReservedBits) != 0) {
    return dictionary::refuse(
        AbortCode::value_range_exceeded, kReserved,
        {int{entry.index()}, int{entry.subindex()}, static_cast<std::int64_t>(value)});
  }
  const Setting setting = decode(value);
  for (const Producer& other : producers_) {
    const Setting theirs = decode(other.entry->value());
    if (other.entry != &entry && setting.used() && theirs.used() &&
        setting.node_id == theirs.node_id) {
      return dictionary::refuse(AbortCode::parameter_incompatible, kTwice,
                                {int{entry.index()}, int{entry.subindex()}, int{setting.node_id},
                                 int{other.entry->subindex()}});
    }
  }
  return {};
}

void HeartbeatConsumer::on_written(const Entry& entry) {
  const auto producer = std::ranges::find(producers_, &entry, &Producer::entry);
  producer->configuration_changed = true;
  deadline_changed();
}

void HeartbeatConsumer::start(SimTime /*now*/) {
  std::ranges::for_each(producers_, [this](Producer& producer) { configure(producer); });
}

void HeartbeatConsumer::configure(Producer& producer) {
  const Setting setting = decode(producer.entry->value());
  producer.configuration_changed = false;
  producer.watch = setting.used() ? Watch::waiting : Watch::unused;
  producer.node_id = setting.node_id;
  producer.time = setting.time;
  producer.due = SimTime::never();
}

bool HeartbeatConsumer::receive(const can::Frame& frame, SimTime now) {
  if (frame.remote || frame.identifier <= kErrorControlBase ||
      frame.identifier > kErrorControlBase + kMaximumNodeId) {
    return false;
  }
  const std::uint32_t node = frame.identifier - kErrorControlBase;
  const auto producer = std::ranges::find_if(producers_, [node](const Producer& candidate) {
    return candidate.watch != Watch::unused && candidate.node_id == node;
  });
  if (producer == producers_.end()) {
    return false;
  }
  if (frame.length != 1) {
    return true;
  }
  if (producer->watch == Watch::missed) {
    reporter_.report(now, kBack, {int{producer->node_id}});
    errors_.clear(producer->entry->subindex(), now);
  }
  producer->watch = Watch::running;
  producer->due = now + producer->time;
  return true;
}

void HeartbeatConsumer::advance(SimTime now) {
  for (Producer& producer : producers_) {
    if (producer.configuration_changed) {
      if (producer.watch == Watch::missed) {
        errors_.clear(producer.entry->subindex(), now);
      }
      configure(producer);
    }
    if (now >= producer.due) {
      producer.due = SimTime::never();
      producer.watch = Watch::missed;
      reporter_.report(now, kMissed,
                       {int{producer.node_id}, producer.time.nanoseconds() / 1'000'000,
                        int{producer.entry->subindex()}});
      errors_.raise(producer.entry->subindex(), now);
    }
  }
}

SimTime HeartbeatConsumer::next_deadline() const {
  SimTime deadline = SimTime::never();
  for (const Producer& producer : producers_) {
    deadline = std::min(deadline, producer.configuration_changed ? SimTime() : producer.due);
  }
  return deadline;
}

}  // namespace stator::canopen
