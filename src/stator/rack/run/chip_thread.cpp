#include "stator/rack/run/chip_thread.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

namespace stator::rack {

namespace {

using base::SimDuration;
using link::ChipServer;

/// Longest sleep: how late the end of a connection is noticed when nothing happens.
constexpr SimDuration kIdleTick{100'000'000};

}  // namespace

ChipThread::ChipThread(RunningRack& shared, DeviceAddress device,
                       const DeviceConfiguration& configuration)
    : shared_(shared), device_(device), pins_(shared.rack, device) {
  if (!HostPins::exist(shared.rack, device)) {
    throw std::runtime_error(fmt::format(
        "{} has its own firmware and no pins for one of yours; \"spi\" belongs to a chip, e.g. a "
        "tmc8461",
        configuration.name));
  }
  auto opened = ChipServer::open(configuration.host_link);
  if (!opened) {
    throw std::runtime_error(opened.error().text);
  }
  server_ = std::move(*opened);
  ChipServer& server = *server_;
  session_.emplace(
      pins_, configuration.name,
      ChipSession::Output{
          .reply = [&server](const link::ChipMessage& message) { server.send(message); },
          .event =
              [&server](const link::ChipMessage& message) { return server.send_event(message); },
          .refuse = [&server](std::uint8_t tag, link::chip_protocol::Refusal refusal,
                              std::string_view text) { server.refuse(tag, refusal, text); },
          .greeted = [&server] { server.greeted(); },
          .power = [this](bool on) { switch_power(on); }});
}

ChipThread::~ChipThread() {
  stop();
}

void ChipThread::start() {
  thread_ = std::thread([this] { run(); });
}

void ChipThread::stop() {
  shared_.stopping = true;
  if (thread_.joinable()) {
    server_->wake();
    thread_.join();
  }
}

ChipThreadStatistics ChipThread::statistics() {
  const std::scoped_lock lock(shared_.mutex);
  ChipThreadStatistics statistics = statistics_;
  statistics.server = server_->statistics();
  return statistics;
}

void ChipThread::run() {
  shared_.enter_thread(std::nullopt);
  while (!shared_.stopping) {
    link::ChipMessage message;
    const ChipServer::News news = server_->receive(message, time_to_sleep());
    const std::scoped_lock lock(shared_.mutex);
    switch (news) {
      case ChipServer::News::message:
        take(message);
        break;
      case ChipServer::News::connected:
        session_->begin();
        break;
      case ChipServer::News::left:
        session_->leave();
        break;
      case ChipServer::News::nothing:
        if (shared_.clock_kind == ClockKind::real) {
          shared_.catch_up();
        }
        break;
    }
  }
}

void ChipThread::take(const link::ChipMessage& message) {
  const base::SimTime received = shared_.real_clock.now();
  if (shared_.clock_kind == ClockKind::real) {
    shared_.catch_up();
  }
  session_->take(message, shared_.now());
  const std::int64_t took = (shared_.real_clock.now() - received).nanoseconds();
  ++statistics_.requests;
  statistics_.processing_ns += took;
  statistics_.worst_processing_ns = std::max(statistics_.worst_processing_ns, took);
}

SimDuration ChipThread::time_to_sleep() {
  if (shared_.clock_kind == ClockKind::lockstep) {
    return kIdleTick;
  }
  const std::scoped_lock lock(shared_.mutex);
  const base::SimTime next = pins_.next_line_change();
  return std::clamp(next - shared_.machine_now(), SimDuration(), kIdleTick);
}

void ChipThread::switch_power(bool on) {
  shared_.rack.apply(PowerEvent{.device = device_, .on = on}, shared_.now());
}

}  // namespace stator::rack
