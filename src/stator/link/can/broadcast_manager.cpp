#include "stator/link/can/broadcast_manager.hpp"

#include <algorithm>
#include <cstring>

#include "stator/link/can/socketcan_frame.hpp"

namespace stator::link {

namespace {

/// Linux, MAX_NFRAMES.
constexpr std::uint32_t kMaximumFrames = 256;
constexpr std::size_t kMaximumEntries = 1024;

std::chrono::microseconds to_interval(const bcm_timeval& value) {
  constexpr long kMaximumSeconds = 400L * 24 * 60 * 60;  // Linux, BCM_TIMER_SEC_MAX
  if (value.tv_sec < 0 || value.tv_sec > kMaximumSeconds || value.tv_usec < 0 ||
      value.tv_usec >= 1'000'000) {
    return std::chrono::microseconds(0);
  }
  return std::chrono::seconds(value.tv_sec) + std::chrono::microseconds(value.tv_usec);
}

std::string to_message(BroadcastHead head, std::uint32_t opcode,
                       std::span<const can_frame> frames) {
  head.opcode = opcode;
  head.nframes = static_cast<std::uint32_t>(frames.size());
  std::string message(sizeof head + frames.size_bytes(), '\0');
  std::memcpy(message.data(), &head, sizeof head);
  if (!frames.empty()) {
    std::memcpy(message.data() + sizeof head, frames.data(), frames.size_bytes());
  }
  return message;
}

template <typename Entries>
auto find(Entries& entries, canid_t identifier) {
  return std::ranges::find_if(entries,
                              [&](const auto& each) { return each.head.can_id == identifier; });
}

template <typename Entries>
bool remove(Entries& entries, canid_t identifier) {
  return std::erase_if(entries, [&](const auto& each) { return each.head.can_id == identifier; }) !=
         0;
}

/// The frames behind `head`; nothing if they are not as many as it says, or of CAN FD.
std::optional<std::vector<can_frame>> frames_of(const BroadcastHead& head,
                                                std::span<const std::byte> rest) {
  // Deleting and reading need none, whatever the head says.
  const std::size_t count = rest.size() / sizeof(can_frame);
  if ((head.flags & CAN_FD_FRAME) != 0 || rest.size() % sizeof(can_frame) != 0 ||
      count > kMaximumFrames) {
    return std::nullopt;
  }
  std::vector<can_frame> frames(count);
  if (count != 0) {
    std::memcpy(frames.data(), rest.data(), rest.size());
  }
  const bool valid = std::ranges::all_of(
      frames, [](const can_frame& each) { return each.can_dlc <= CAN_MAX_DLEN; });
  return valid ? std::optional(std::move(frames)) : std::nullopt;
}

/// `mask` has a 1 for each bit of the data whose change counts.
bool differs(const can_frame& a, const can_frame& b, const can_frame& mask, bool check_length) {
  if (check_length && a.can_dlc != b.can_dlc) {
    return true;
  }
  for (std::size_t i = 0; i < CAN_MAX_DLEN; ++i) {
    if (((a.data[i] ^ b.data[i]) & mask.data[i]) != 0) {
      return true;
    }
  }
  return false;
}

}  // namespace

bool BroadcastManager::execute(std::span<const std::byte> message, MachineTime now, Frames& to_bus,
                               Messages& to_program) {
  BroadcastHead head;
  if (message.size() < sizeof head) {
    return false;
  }
  std::memcpy(&head, message.data(), sizeof head);
  auto frames = frames_of(head, message.subspan(sizeof head));
  if (!frames) {
    return false;
  }
  switch (head.opcode) {
    case TX_SETUP:
      return set_up_transmission(head, std::move(*frames), now, to_bus);
    case TX_DELETE:
      return remove(transmissions_, head.can_id);
    case TX_SEND: {
      const auto frame = frames->size() == 1 ? from_socketcan(frames->front()) : std::nullopt;
      if (frame) {
        to_bus.push_back(*frame);
      }
      return frame.has_value();
    }
    case TX_READ: {
      const auto found = find(transmissions_, head.can_id);
      if (found == transmissions_.end()) {
        return false;
      }
      to_program.push_back(to_message(found->head, TX_STATUS, found->frames));
      return true;
    }
    case RX_SETUP:
      return set_up_reception(head, *frames, now);
    case RX_DELETE:
      return remove(receptions_, head.can_id);
    case RX_READ: {
      const auto found = find(receptions_, head.can_id);
      if (found == receptions_.end()) {
        return false;
      }
      to_program.push_back(to_message(found->head, RX_STATUS, {}));
      return true;
    }
    default:
      return false;
  }
}

bool BroadcastManager::set_up_transmission(const BroadcastHead& head, std::vector<can_frame> frames,
                                           MachineTime now, Frames& to_bus) {
  if (frames.empty() || head.nframes != frames.size()) {
    return false;
  }
  if ((head.flags & TX_CP_CAN_ID) != 0) {
    for (can_frame& each : frames) {
      each.can_id = head.can_id;
    }
  }
  auto found = find(transmissions_, head.can_id);
  if (found == transmissions_.end()) {
    if (transmissions_.size() == kMaximumEntries) {
      return false;
    }
    transmissions_.emplace_back().head = head;
    found = transmissions_.end() - 1;
  }
  found->frames = std::move(frames);
  found->head.flags = head.flags;
  found->head.nframes = head.nframes;
  if ((head.flags & TX_RESET_MULTI_IDX) != 0 || found->index >= found->frames.size()) {
    found->index = 0;
  }
  if ((head.flags & SETTIMER) != 0) {
    found->head.count = head.count;
    found->head.ival1 = head.ival1;
    found->head.ival2 = head.ival2;
    found->remaining = to_interval(head.ival1) > Interval{} ? head.count : 0;
    if (to_interval(head.ival1) <= Interval{} && to_interval(head.ival2) <= Interval{}) {
      found->next.reset();
    }
  }
  // As Linux does: starting the timer sends at once, too.
  if ((head.flags & (STARTTIMER | TX_ANNOUNCE)) != 0) {
    transmit(*found, to_bus);
  }
  if ((head.flags & STARTTIMER) != 0) {
    schedule(*found, now);
  }
  return true;
}

void BroadcastManager::transmit(Transmission& transmission, Frames& to_bus) {
  if (const auto frame = from_socketcan(transmission.frames[transmission.index])) {
    to_bus.push_back(*frame);
  }
  transmission.index = (transmission.index + 1) % transmission.frames.size();
  transmission.remaining -= transmission.remaining > 0 ? 1U : 0U;
}

void BroadcastManager::schedule(Transmission& transmission, MachineTime from) {
  const Interval interval =
      to_interval(transmission.remaining > 0 ? transmission.head.ival1 : transmission.head.ival2);
  transmission.next.reset();
  if (interval > Interval{}) {
    transmission.next = from + interval;
  }
}

bool BroadcastManager::set_up_reception(const BroadcastHead& head,
                                        const std::vector<can_frame>& frames, MachineTime now) {
  if (frames.size() > 1 || receptions_.size() == kMaximumEntries) {
    return false;
  }
  remove(receptions_, head.can_id);
  Reception& reception = receptions_.emplace_back();
  reception.head = head;
  if (!frames.empty() && (head.flags & RX_FILTER_ID) == 0) {
    reception.mask = frames.front();
  }
  const Interval timeout = to_interval(head.ival1);
  if ((head.flags & STARTTIMER) != 0 && timeout > Interval{}) {
    reception.timeout = now + timeout;
  }
  return true;
}

void BroadcastManager::on_frame(const can::Frame& frame, MachineTime now, Messages& to_program) {
  const can_frame received = to_socketcan(frame);
  for (Reception& each : receptions_) {
    if (each.head.can_id != received.can_id) {
      continue;
    }
    const Interval timeout = to_interval(each.head.ival1);
    if (timeout > Interval{} && (each.head.flags & RX_NO_AUTOTIMER) == 0) {
      each.timeout = now + timeout;
    }
    const bool resumed = each.timed_out && (each.head.flags & RX_ANNOUNCE_RESUME) != 0;
    const bool changed =
        !each.mask || !each.last ||
        differs(received, *each.last, *each.mask, (each.head.flags & RX_CHECK_DLC) != 0);
    each.timed_out = false;
    each.last = received;
    if (resumed || changed) {
      to_program.push_back(to_message(each.head, RX_CHANGED, std::span(&received, 1)));
    }
  }
}

std::optional<MachineTime> BroadcastManager::deadline() const {
  std::optional<MachineTime> earliest;
  const auto consider = [&](const std::optional<MachineTime>& time) {
    if (time && (!earliest || *time < *earliest)) {
      earliest = time;
    }
  };
  for (const Transmission& each : transmissions_) {
    consider(each.next);
  }
  for (const Reception& each : receptions_) {
    consider(each.timeout);
  }
  return earliest;
}

void BroadcastManager::advance(MachineTime now, Frames& to_bus, Messages& to_program) {
  for (Transmission& each : transmissions_) {
    if (!each.next || *each.next > now) {
      continue;
    }
    const bool counts = each.remaining > 0;
    transmit(each, to_bus);
    if (counts && each.remaining == 0 && (each.head.flags & TX_COUNTEVT) != 0) {
      to_program.push_back(to_message(each.head, TX_EXPIRED, {}));
    }
    schedule(each, std::max(*each.next, now - std::chrono::milliseconds(1)));
  }
  for (Reception& each : receptions_) {
    if (each.timeout && *each.timeout <= now) {
      each.timeout.reset();
      each.timed_out = true;
      to_program.push_back(to_message(each.head, RX_TIMEOUT, {}));
    }
  }
}

}  // namespace stator::link
