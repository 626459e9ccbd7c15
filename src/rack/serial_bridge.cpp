#include "rack/serial_bridge.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/logger.h>

namespace stator::rack {

namespace {

// The thread sleeps until bytes come; the timeout only bounds how long it is not seen to work.
constexpr base::SimDuration kSleep{1'000'000'000};

}  // namespace

SerialBridge::SerialBridge(std::unique_ptr<link::SerialLink> link, std::string device,
                           std::shared_ptr<spdlog::logger> logger)
    : link_(std::move(link)), device_(std::move(device)), logger_(std::move(logger)) {
  thread_ = std::thread([this] { run(); });
}

SerialBridge::~SerialBridge() {
  stopping_ = true;
  link_->wake();
  thread_.join();
}

void SerialBridge::run() {
  std::array<std::byte, 256> buffer{};
  while (!stopping_) {
    const auto received = link_->receive(buffer, kSleep);
    if (!received) {
      logger_->error("{}: {}; its serial port stops", device_, received.error().text);
      return;
    }
    queue(std::span(buffer).first(*received));
  }
}

void SerialBridge::queue(std::span<const std::byte> bytes) {
  if (bytes.empty()) {
    return;
  }
  const std::scoped_lock lock(mutex_);
  for (const std::byte byte : bytes) {
    if (queued_ == queue_.size()) {
      ++bytes_dropped_;
      continue;
    }
    queue_[(first_ + queued_++) % queue_.size()] = byte;
  }
  waiting_ = true;
}

std::size_t SerialBridge::take(std::span<std::byte> buffer) {
  if (!waiting_.load(std::memory_order_relaxed)) {
    return 0;
  }
  const std::scoped_lock lock(mutex_);
  const std::size_t length = std::min(buffer.size(), queued_);
  for (std::size_t i = 0; i < length; ++i) {
    buffer[i] = queue_[(first_ + i) % queue_.size()];
  }
  first_ = (first_ + length) % queue_.size();
  queued_ -= length;
  waiting_ = queued_ != 0;
  return length;
}

void SerialBridge::send(std::span<const std::byte> bytes) {
  if (const auto sent = link_->send(bytes); !sent && !send_failure_logged_) {
    send_failure_logged_ = true;
    logger_->warn("{}: {}; further failures are not told", device_, sent.error().text);
  }
}

void SerialBridges::open(Rack& rack, const RackConfiguration& configuration,
                         const std::shared_ptr<spdlog::logger>& logger) {
  for (std::size_t segment = 0; segment < configuration.segments.size(); ++segment) {
    const std::vector<DeviceConfiguration>& devices = configuration.segments[segment].devices;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (devices[i].usb.empty()) {
        continue;
      }
      auto line = link::open_serial_link(devices[i].usb);
      if (!line) {
        throw std::runtime_error(fmt::format("{}: {}", devices[i].name, line.error().text));
      }
      const std::string name = (*line)->name();
      auto bridge = std::make_unique<SerialBridge>(std::move(*line), devices[i].name, logger);
      devices::EtherCatDevice& device = *rack.devices(segment)[i].device;
      if (!device.connect_usb(bridge.get())) {
        throw std::runtime_error(fmt::format("{} has no USB interface", devices[i].name));
      }
      connections_.push_back({&device, std::move(bridge)});
      logger->info("{}: its USB interface is the serial port {}", devices[i].name, name);
    }
  }
}

void SerialBridges::close() {
  for (const Connection& connection : connections_) {
    static_cast<void>(connection.device->connect_usb(nullptr));
  }
  connections_.clear();
}

}  // namespace stator::rack
