#include "stator/rack/run/bus_thread.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/link/can/can_link_address.hpp"
#include "stator/rack/networks/can_network.hpp"

namespace stator::rack {

namespace {

using base::SimDuration;
using base::SimTime;

// Longest sleep: how late devices without any bus traffic are brought to the present.
constexpr SimDuration kIdleTick{10'000'000};

}  // namespace

BusThread::BusThread(RunningRack& shared, std::size_t index, const BusConfiguration& configuration)
    : shared_(shared), index_(index), cpu_(configuration.cpu) {
  if (configuration.ports.empty()) {
    throw std::runtime_error(
        fmt::format(R"(the bus "{}" has no port to run on; give it ports = ["..."] with {})",
                    configuration.name, link::kCanLinkForms));
  }
  for (const std::string& text : configuration.ports) {
    auto opened = link::open_can_link(text, {.bit_rate = configuration.bit_rate.value_or(0) / 1000,
                                             .epoch = shared_.epoch(),
                                             .reporter = shared_.rack.bus_reporter(index)});
    if (!opened) {
      throw std::runtime_error(opened.error().text);
    }
    auto port = std::make_unique<OutsidePort>();
    port->link = std::move(*opened);
    wait_.add(port->link->descriptor());
    ports_.push_back(std::move(port));
  }
  for (const auto& port : ports_) {
    port->port.emplace(shared_.rack, index_);
  }
  shared_.rack.set_bus_epoch(index_, shared_.epoch());
}

BusThread::~BusThread() {
  stop();
}

void BusThread::start() {
  thread_ = std::thread([this] { run(); });
}

void BusThread::stop() {
  shared_.stopping = true;
  if (thread_.joinable()) {
    wait_.wake();
    thread_.join();
  }
}

BusThreadStatistics BusThread::statistics() {
  const std::scoped_lock lock(shared_.mutex);
  return statistics_;
}

void BusThread::run() {
  shared_.enter_thread(cpu_);
  while (!shared_.stopping) {
    wait_.sleep(time_to_sleep());
    bool more = true;
    while (more && !shared_.stopping) {
      more = take_frames();
      if (shared_.clock_kind == ClockKind::real) {
        catch_up();
      }
      hand_out();
    }
    shared_.keep_files();
    shared_.serve_tasks();
  }
}

// True: a link may have more frames than its port had room for.
bool BusThread::take_frames() {
  bool more = false;
  for (const auto& port : ports_) {
    Batch batch;
    const std::size_t room = look_at(*port);
    const std::size_t count = receive(*port, std::span(batch).first(room));
    const std::span<const can::Frame> frames = std::span(batch).first(count);
    more |= count > 0 && count == room;
    if (frames.empty()) {
      continue;
    }
    const std::scoped_lock lock(shared_.mutex);
    statistics_.frames_in += count;
    seat_.hear(shared_.now());
    if (shared_.clock_kind == ClockKind::lockstep) {
      put_in_lockstep(*port, frames);
      continue;
    }
    shared_.catch_up(statistics_);
    for (const can::Frame& frame : frames) {
      port->port->put(frame);
    }
  }
  return more;
}

// Frames are not read from the link of a full port: they wait there, and finally in the program.
std::size_t BusThread::look_at(OutsidePort& port) {
  if (port.failed) {
    return 0;
  }
  const std::scoped_lock lock(shared_.mutex);
  now_ = shared_.now();
  const std::size_t room = port.port->room();
  if ((room > 0) != port.minded) {
    port.minded = room > 0;
    wait_.mind(port.link->descriptor(), port.minded);
  }
  return room;
}

std::size_t BusThread::receive(OutsidePort& port, std::span<can::Frame> frames) {
  if (frames.empty()) {
    return 0;
  }
  const auto received = port.link->receive(frames, now_);
  if (received) {
    return *received;
  }
  shared_.logger->error(fmt::format("{}; this port stops", received.error().text));
  port.failed = true;
  wait_.mind(port.link->descriptor(), false);
  return 0;
}

// Devices are brought to a frame before it passes: its time is the master's.
// Each frame may move time by a cycle, and a cycle may take long to record: who is asked to end
// does not wait for all of them.
void BusThread::put_in_lockstep(OutsidePort& port, std::span<const can::Frame> frames) {
  for (const can::Frame& frame : frames) {
    if (shared_.stopping) {
      return;
    }
    const SimTime arrival = shared_.lockstep_clock.on_frame(frame);
    shared_.rack.advance(arrival);
    port.port->put(frame);
    shared_.rack.settle(index_, shared_.lockstep_clock);
    drain();
  }
}

void BusThread::catch_up() {
  const std::scoped_lock lock(shared_.mutex);
  shared_.catch_up(statistics_);
}

// Queueing a frame is cheap and happens under the lock, handing it to the system does not.
void BusThread::hand_out() {
  {
    const std::scoped_lock lock(shared_.mutex);
    drain();
  }
  for (const auto& port : ports_) {
    if (std::exchange(port->to_flush, false)) {
      port->link->flush();
    }
  }
}

void BusThread::drain() {
  for (const auto& port : ports_) {
    while (const auto entry = port->port->take()) {
      if (withholds(*port, *entry)) {
        continue;
      }
      port->to_flush = true;
      if (entry->destroyed) {
        port->link->send_error(link::bus_error_frame(), entry->time);
        continue;
      }
      port->link->send(entry->frame, entry->time);
      ++statistics_.frames_out;
    }
  }
}

void BusThread::withhold(const FramePredicate& is_answer, SimTime until) {
  for (const auto& port : ports_) {
    port->withheld.push_back({is_answer, until});
  }
}

bool BusThread::withholds(OutsidePort& port, const can::TimedFrame& entry) {
  std::erase_if(port.withheld, [&](const Withheld& each) { return each.until < entry.time; });
  const auto found = std::ranges::find_if(port.withheld, [&](const Withheld& each) {
    return !entry.destroyed && each.is_answer(entry.frame);
  });
  if (found == port.withheld.end()) {
    return false;
  }
  port.withheld.erase(found);
  return true;
}

SimDuration BusThread::time_to_sleep() {
  if (shared_.clock_kind == ClockKind::lockstep) {
    return kIdleTick;
  }
  if (shared_.lags()) {
    return {};
  }
  const std::scoped_lock lock(shared_.mutex);
  return std::min(kIdleTick, shared_.rack.next_bus_deadline() - shared_.machine_now());
}

}  // namespace stator::rack
