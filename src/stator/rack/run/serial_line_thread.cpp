#include "stator/rack/run/serial_line_thread.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/tmcl/telegram.hpp"

namespace stator::rack {

namespace {

using base::SimDuration;
using base::SimTime;

// Longest sleep, which is how late an idle rack is brought to the present. kBusyTick holds while a
// device has something to look at in its next period, and for kIdleAfter after that.
constexpr SimDuration kIdleTick{10'000'000};
constexpr SimDuration kBusyTick{1'000'000};
constexpr SimDuration kIdleAfter{100'000'000};
constexpr std::size_t kBytesAtOnce = 512;

}  // namespace

SerialLineThread::SerialLineThread(RunningRack& shared, std::size_t index,
                                   const std::vector<std::unique_ptr<BusThread>>& buses)
    : shared_(shared),
      index_(index),
      line_(shared.rack.line(index)),
      buses_(buses),
      last_wait_(SimTime() - kIdleAfter) {
  const SerialLineConfiguration& configuration = line_.configuration();
  auto opened = link::open_serial_link(
      configuration.link, {.wait = configuration.wait, .spin_time = configuration.spin_time});
  if (!opened) {
    throw std::runtime_error(opened.error().text);
  }
  link_ = std::move(*opened);
  connect();
}

SerialLineThread::~SerialLineThread() {
  stop();
  shared_.rack.connect_line(index_, {});
}

void SerialLineThread::connect() {
  shared_.rack.connect_line(index_, SerialLine::Output::bind<&SerialLineThread::send>(*this));
}

void SerialLineThread::start() {
  thread_ = std::thread([this] { run(); });
}

void SerialLineThread::stop() {
  shared_.stopping = true;
  if (thread_.joinable()) {
    link_->wake();
    thread_.join();
  }
}

SerialLineThreadStatistics SerialLineThread::statistics() {
  const std::scoped_lock lock(shared_.mutex);
  SerialLineThreadStatistics statistics = statistics_;
  statistics.line = line_.statistics();
  statistics.link = link_->statistics();
  return statistics;
}

SerialLineThreadStatistics SerialLineThread::statistics_in_task() const {
  SerialLineThreadStatistics statistics = statistics_;
  statistics.line = line_.statistics();
  return statistics;
}

void SerialLineThread::run() {
  shared_.enter_thread(line_.configuration().cpu);
  std::array<std::byte, kBytesAtOnce> buffer{};
  room_ = buffer.size();
  while (!shared_.stopping) {
    if (room_ == 0) {
      // Bytes are not read while there is no room: they wait in the link, and finally in the
      // program.
      std::this_thread::sleep_for(std::chrono::nanoseconds(time_to_sleep_.nanoseconds()));
    }
    const auto received =
        room_ == 0 ? base::Expected<std::size_t, link::LinkError>(std::size_t{0})
                   : link_->receive(std::span(buffer).first(std::min(room_, buffer.size())),
                                    time_to_sleep_);
    if (!received) {
      shared_.logger->error(fmt::format("{}; this serial line stops", received.error().text));
      return;
    }
    {
      const std::scoped_lock lock(shared_.mutex);
      if (*received != 0) {
        take(std::span(buffer).first(*received));
      } else if (shared_.clock_kind == ClockKind::real) {
        catch_up();
      }
      plan();
    }
    shared_.keep_files();
    shared_.serve_tasks();
  }
}

void SerialLineThread::take(std::span<const std::byte> bytes) {
  seat_.hear(shared_.now());
  const SimTime before = shared_.rack.next_bus_deadline();
  if (shared_.clock_kind == ClockKind::lockstep) {
    put_in_lockstep(bytes);
  } else {
    shared_.catch_up(statistics_);
    shared_.rack.put(index_, bytes, shared_.reached);
  }
  wake_buses(before);
}

void SerialLineThread::put_in_lockstep(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::size_t length = std::min(bytes.size(), tmcl::kTelegramLength - bytes_in_step_);
    shared_.rack.put(index_, bytes.first(length), shared_.lockstep_clock.now());
    bytes = bytes.subspan(length);
    bytes_in_step_ = (bytes_in_step_ + length) % tmcl::kTelegramLength;
    if (line_.waits()) {
      continue;
    }
    if (bytes_in_step_ == 0) {
      shared_.lockstep_clock.on_telegram();
      shared_.rack.advance(shared_.lockstep_clock.now());
    }
    shared_.rack.settle_line(index_, shared_.lockstep_clock);
  }
}

// A device may have sent frames on its bus, or may do so earlier than the bus's thread wakes.
void SerialLineThread::wake_buses(SimTime before) {
  if (shared_.rack.next_bus_deadline() >= before) {
    return;
  }
  for (const auto& bus : buses_) {
    if (bus != nullptr) {
      bus->wake();
    }
  }
}

void SerialLineThread::catch_up() {
  shared_.catch_up(statistics_);
}

// How many bytes to take next, and how long to wait for them.
void SerialLineThread::plan() {
  room_ = line_.room();
  tell_losses();
  if (shared_.clock_kind == ClockKind::lockstep) {
    time_to_sleep_ = kIdleTick;
    return;
  }
  const SimTime now = shared_.machine_now();
  if (line_.waits()) {
    last_wait_ = now;
  }
  if (shared_.lags()) {
    time_to_sleep_ = {};
    return;
  }
  time_to_sleep_ = std::min(now - last_wait_ < kIdleAfter ? kBusyTick : kIdleTick,
                            std::max(shared_.rack.next_line_deadline(index_) - now, SimDuration()));
}

void SerialLineThread::send(std::span<const std::byte> bytes) {
  if (const auto sent = link_->send(bytes); !sent && !std::exchange(send_failure_logged_, true)) {
    shared_.logger->warning(fmt::format("{}; further losses are only counted", sent.error().text));
  }
}

void SerialLineThread::tell_losses() {
  if (line_.statistics().bytes_lost != 0 && !std::exchange(loss_logged_, true)) {
    shared_.logger->warning(fmt::format(
        "serial line {}: bytes were lost because they came faster than its devices take them; "
        "further losses are only counted",
        link_->name()));
  }
}

}  // namespace stator::rack
