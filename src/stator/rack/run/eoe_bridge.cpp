#include "stator/rack/run/eoe_bridge.hpp"

#include <mutex>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/networks/eoe_port.hpp"
#include "stator/rack/world/device_configuration.hpp"

namespace stator::rack {

namespace {

// The thread sleeps until a frame comes; without one it looks this often whether it has to stop.
constexpr base::SimDuration kSleep{1'000'000'000};

}  // namespace

EoeBridge::EoeBridge(std::unique_ptr<link::TapLink> link, std::string device,
                     std::shared_ptr<Log> logger, Deliver deliver)
    : link_(std::move(link)),
      device_(std::move(device)),
      logger_(std::move(logger)),
      deliver_(std::move(deliver)) {
  thread_ = std::thread([this] { run(); });
}

EoeBridge::~EoeBridge() {
  stopping_ = true;
  link_->wake();
  thread_.join();
}

void EoeBridge::run() {
  std::array<std::byte, ethercat::kMaximumEoeFrame> frame{};
  while (!stopping_) {
    const auto received = link_->receive(frame, kSleep);
    if (!received) {
      logger_->error(fmt::format("{}: {}; its EoE bridge stops", device_, received.error().text));
      return;
    }
    if (*received != 0) {
      deliver_(std::span(frame).first(*received));
    }
  }
}

void EoeBridge::send(std::span<const std::byte> frame) {
  if (const auto sent = link_->send(frame); !sent && !send_failure_logged_) {
    send_failure_logged_ = true;
    logger_->warning(
        fmt::format("{}: EoE: {}; further failures are only counted", device_, sent.error().text));
  }
}

void EoeBridge::set_ip_parameters(const ethercat::IpParameters& parameters) {
  const auto set = link_->set_address({.mac_address = parameters.mac_address,
                                       .address = parameters.address,
                                       .subnet_mask = parameters.subnet_mask});
  if (set) {
    logger_->information(fmt::format("{}: EoE: interface {} has the address that the master set",
                                     device_, link_->name()));
  } else {
    logger_->warning(fmt::format("{}: EoE: {}", device_, set.error().text));
  }
}

void EoeBridges::open(RunningRack& shared, const RackConfiguration& configuration) {
  shared_ = &shared;
  for (std::size_t segment = 0; segment < configuration.segments.size(); ++segment) {
    const std::vector<DeviceConfiguration>& devices = configuration.segments[segment].devices;
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (devices[i].eoe_interface.empty()) {
        continue;
      }
      const DeviceAddress device{segment, i, NetworkKind::segment};
      if (!shared.rack.connect_eoe(device, {})) {
        throw std::runtime_error(
            fmt::format("device \"{}\" is to be bridged to {}, but its EoE is not switched on",
                        devices[i].name, devices[i].eoe_interface));
      }
      auto tap =
          link::TapLink::open({.interface = devices[i].eoe_interface, .ether_type = std::nullopt});
      if (!tap) {
        throw std::runtime_error(tap.error().text);
      }
      auto bridge =
          std::make_unique<EoeBridge>(std::move(*tap), devices[i].name, shared.logger,
                                      [&shared, device](std::span<const std::byte> frame) {
                                        const std::scoped_lock lock(shared.mutex);
                                        shared.rack.put_eoe_frame(device, frame);
                                      });
      shared.rack.connect_eoe(
          device, {.frame = [&to = *bridge](std::span<const std::byte> frame) { to.send(frame); },
                   .ip_parameters =
                       [&to = *bridge](const ethercat::IpParameters& parameters) {
                         to.set_ip_parameters(parameters);
                       }});
      connections_.push_back({device, std::move(bridge)});
    }
  }
}

void EoeBridges::close() {
  for (const Connection& connection : connections_) {
    shared_->rack.connect_eoe(connection.device, {});
  }
  connections_.clear();
}

}  // namespace stator::rack
