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
      open(devices[i], *rack.devices(segment)[i].device, logger);
    }
  }
  for (std::size_t bus = 0; bus < configuration.buses.size(); ++bus) {
    const std::vector<DeviceConfiguration>& devices = configuration.buses[bus].devices;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      open(devices[i], *rack.bus(bus).devices()[i].device, logger);
    }
  }
}

void SerialBridges::open(const DeviceConfiguration& configuration, devices::Device& device,
                         const std::shared_ptr<spdlog::logger>& logger) {
  for (const auto& [interface, line] : configuration.serial) {
    auto opened = link::open_serial_link(line);
    if (!opened) {
      throw std::runtime_error(fmt::format("{}: {}", configuration.name, opened.error().text));
    }
    const std::string name = (*opened)->name();
    auto bridge = std::make_unique<SerialBridge>(std::move(*opened), configuration.name, logger);
    if (!device.connect_serial(interface, bridge.get())) {
      throw std::runtime_error(
          fmt::format("{} has no {} interface", configuration.name, interface));
    }
    connections_.push_back({device, interface, std::move(bridge)});
    logger->info("{}: its {} interface is the serial port {}", configuration.name, interface, name);
  }
}

void SerialBridges::close() {
  for (const Connection& connection : connections_) {
    static_cast<void>(connection.device.connect_serial(connection.interface, nullptr));
  }
  connections_.clear();
}

}  // namespace stator::rack
