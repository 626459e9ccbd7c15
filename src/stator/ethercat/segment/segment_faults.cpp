// What happens to frames on demand: a part of Segment that only segments with faults run.

#include <algorithm>
#include <stdexcept>
#include <string>

#include "stator/ethercat/segment/segment.hpp"

namespace stator::ethercat {

namespace {

/// Numbers of frame faults count from 1, those of count faults from here on.
constexpr std::uint64_t kCountFaults = std::uint64_t{1} << 63U;
/// Frames that may wait on cables at one time; further ones get lost.
constexpr std::size_t kMostHeld = 32;
/// Preamble, start delimiter, check sequence and inter-frame gap around each frame.
constexpr std::size_t kFrameOverhead = 24;
constexpr std::int64_t kNanosecondsPerByte = 80;

}  // namespace

std::uint64_t Segment::inject(const FrameFault& fault) {
  if (!has_cable(fault.port)) {
    throw std::logic_error("port " + std::to_string(fault.port.port) + " of slave " +
                           std::to_string(fault.port.slave) + " has no cable");
  }
  std::optional<SlavePort> at = fault.port;
  if (fault.leaving) {
    const Wiring::Peer& peer = wiring_.peer(fault.port);
    at = peer.kind == Wiring::Peer::Kind::slave ? std::optional(peer.slave_port) : std::nullopt;
  }
  held_.reserve(kMostHeld);
  const std::uint64_t number = faults_.add(fault, at);
  note_faults();
  return number;
}

std::uint64_t Segment::inject(const CountFault& fault) {
  const std::uint64_t number = kCountFaults | ++newest_count_fault_;
  count_faults_.push_back({number, stations_.at(fault.slave).slave, fault.commands,
                           base::Recurrence(fault.datagrams, fault.probability, fault.seed)});
  note_faults();
  return number;
}

void Segment::withdraw(std::uint64_t number) {
  faults_.withdraw(number);
  std::erase_if(count_faults_,
                [number](const CountingFault& fault) { return fault.number == number; });
  note_faults();
}

std::optional<std::uint64_t> Segment::hits(std::uint64_t number) const {
  if (number < kCountFaults) {
    return faults_.hits(number);
  }
  const auto found = std::ranges::find(count_faults_, number, &CountingFault::number);
  return found == count_faults_.end() ? std::nullopt : std::optional(found->recurrence.times());
}

void Segment::observe(FrameObserver* observer) {
  observer_ = observer;
  note_faults();
}

/// Looks for the place where a frame of this length is torn in a receive FIFO or hit by a fault.
/// Nothing: it passes.
std::optional<Segment::Interruption> Segment::interrupt(const Way& way, std::size_t length) {
  const std::span<const Reception> receptions = way.route.receptions;
  for (std::size_t i = 0; i < receptions.size(); ++i) {
    if (receptions[i].longest_frame < length) {
      ++statistics_.torn;
      count_broken_frame(receptions.subspan(i));
      return Interruption{receptions[i].visits};
    }
    if (const auto interruption = meet(way, i, receptions[i].visits)) {
      return interruption;
    }
  }
  return way.route.exit ? meet(way, receptions.size(), way.stops.size()) : std::nullopt;
}

/// The fault that hits a frame at the given reception of its way, or at the master behind the last
/// one.
std::optional<Segment::Interruption> Segment::meet(const Way& way, std::size_t reception,
                                                   std::size_t passed) {
  const std::span<const Reception> receptions = way.route.receptions;
  const bool at_slave = reception < receptions.size();
  const auto fault = faults_.hit(at_slave ? std::optional(receptions[reception].at) : std::nullopt);
  if (!fault) {
    return std::nullopt;
  }
  if (fault->kind == FrameFaultKind::drop) {
    ++statistics_.dropped;
    return Interruption{passed};
  }
  if (fault->kind == FrameFaultKind::corrupt) {
    ++statistics_.corrupted;
    if (at_slave) {
      count_broken_frame(receptions.subspan(reception));
    }
    return Interruption{passed};
  }
  ++statistics_.held;
  return Interruption{passed, fault};
}

std::optional<MasterInterface> Segment::process_with_faults(std::span<std::byte> frame,
                                                            base::SimTime arrival,
                                                            MasterInterface entry,
                                                            std::size_t datagrams) {
  const Way& way = ways_[static_cast<std::size_t>(entry)];
  const std::span<DatagramView> active = std::span(datagrams_).first(datagrams);
  const std::optional<Interruption> interruption = interrupt(way, frame.size());
  note_faults();
  const std::span<const Stop> stops = way.stops;
  const std::size_t before = interruption ? interruption->passed : stops.size();
  std::optional<MasterInterface> exit;
  if (!visit(stops.first(before), active, arrival)) {
    return std::nullopt;
  }
  const bool goes_on = !interruption || interruption->fault.has_value();
  if (goes_on) {
    for (const DatagramView& datagram : active) {
      datagram.store();
    }
  }
  if (interruption && interruption->fault) {
    hold(frame, entry, arrival, *interruption);
  }
  const bool passes = !interruption || (interruption->fault &&
                                        interruption->fault->kind == FrameFaultKind::duplicate);
  if (passes) {
    if (!visit(stops.subspan(before), active, arrival)) {
      return std::nullopt;
    }
    for (const DatagramView& datagram : active) {
      datagram.store();
    }
    exit = leave(way.route);
  }
  if (observer_ != nullptr) {
    observer_->frame_passed(active, exit.has_value(), arrival);
  }
  if (passes) {
    release_overtaken(arrival);
  }
  return exit;
}

/// False: the frame was destroyed as a circulating one.
bool Segment::visit(std::span<const Stop> stops, std::span<DatagramView> datagrams,
                    base::SimTime sent) {
  for (const Stop& stop : stops) {
    if (stop.marks_circulating && !mark_circulating(datagrams)) {
      ++statistics_.destroyed;
      return false;
    }
    const auto counts = std::ranges::find(count_faults_, stop.slave, &CountingFault::slave);
    if (counts == count_faults_.end()) {
      stop.slave->process(datagrams, {sent, sent + stop.processing_unit, *stop.arrivals});
      continue;
    }
    std::array<std::uint16_t, kMaximumDatagrams> counters{};
    std::ranges::transform(datagrams, counters.begin(), &DatagramView::working_counter);
    stop.slave->process(datagrams, {sent, sent + stop.processing_unit, *stop.arrivals});
    for (std::size_t i = 0; i < datagrams.size(); ++i) {
      DatagramView& datagram = datagrams[i];
      const auto command = static_cast<unsigned>(datagram.command);
      for (CountingFault& fault : count_faults_) {
        if (fault.slave == stop.slave && datagram.working_counter != counters[i] &&
            (fault.commands >> command & 1U) != 0 && fault.recurrence.next()) {
          datagram.working_counter = counters[i];
        }
      }
    }
    std::erase_if(count_faults_,
                  [](const CountingFault& fault) { return fault.recurrence.over(); });
    note_faults();
  }
  return true;
}

void Segment::hold(std::span<const std::byte> frame, MasterInterface entry, base::SimTime arrival,
                   const Interruption& at) {
  if (held_.size() == kMostHeld || frame.size() > kMaximumFrameLength) {
    ++statistics_.dropped;
    return;
  }
  HeldFrame held;
  std::ranges::copy(frame, held.bytes.begin());
  held.length = frame.size();
  held.entry = entry;
  held.passed = at.passed;
  held.plan = plans_;
  held.overtaken = at.fault->kind == FrameFaultKind::reorder;
  const base::SimDuration wait =
      at.fault->kind == FrameFaultKind::duplicate
          ? base::SimDuration(static_cast<std::int64_t>(frame.size() + kFrameOverhead) *
                              kNanosecondsPerByte)
          : at.fault->delay;
  held.sent = arrival;
  held.release = arrival + wait;
  held_.push_back(held);
  find_next_release();
}

/// A frame has passed: those it has overtaken follow it.
void Segment::release_overtaken(base::SimTime now) {
  for (HeldFrame& held : held_) {
    if (held.overtaken) {
      held.overtaken = false;
      held.release = std::min(held.release, now);
    }
  }
  find_next_release();
}

void Segment::find_next_release() {
  next_release_ = base::SimTime::never();
  for (const HeldFrame& held : held_) {
    next_release_ = std::min(next_release_, held.release);
  }
}

std::optional<ReleasedFrame> Segment::release(base::SimTime now, std::span<std::byte> buffer) {
  while (next_release_ <= now) {
    const auto due = std::ranges::min_element(held_, {}, &HeldFrame::release);
    HeldFrame held = *due;
    held_.erase(due);
    find_next_release();
    const std::optional<MasterInterface> exit = go_on(held, now);
    if (exit) {
      std::ranges::copy(std::span(held.bytes).first(held.length), buffer.begin());
      return ReleasedFrame{held.length, *exit};
    }
  }
  return std::nullopt;
}

/// The rest of a frame's way, with cables and loops as they were when it was sent: a change in
/// between loses it.
std::optional<MasterInterface> Segment::go_on(HeldFrame& held, base::SimTime now) {
  const Way& way = this->way(held.entry);
  if (held.plan != plans_) {
    ++statistics_.lost;
    return std::nullopt;
  }
  std::size_t count = 0;
  DatagramCursor cursor(std::span(held.bytes).first(held.length));
  while (cursor.next(datagrams_[count])) {
    ++count;
  }
  const std::span<DatagramView> active = std::span(datagrams_).first(count);
  const base::SimTime sent = held.sent + (std::max(now, held.release) - held.sent);
  if (!visit(std::span<const Stop>(way.stops).subspan(held.passed), active, sent)) {
    return std::nullopt;
  }
  for (const DatagramView& datagram : active) {
    datagram.store();
  }
  return leave(way.route);
}

}  // namespace stator::ethercat
