// A rack of an EtherCAT module and a CAN drive with the web server in front of it, for tests of the
// server.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/manual/manual_control.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/web/server/server.hpp"
#include "web/http_client.hpp"

namespace stator::web {

inline constexpr const char* kToken = "a-token-for-tests-0123456789";

inline std::uint16_t free_udp_port() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  return probe ? (*probe)->local_port() : std::uint16_t{0};
}

/// With time for answers that take long on a busy machine with sanitizers.
inline ServerLimits patient_limits() {
  ServerLimits limits;
  limits.request_time = std::chrono::minutes(2);
  return limits;
}

/// A TMCM-3315 "drive" behind UDP, a TMCC160 "servo" on a CAN bus, and a server for both.
class ServedRack {
 public:
  explicit ServedRack(const ServerLimits& limits = patient_limits(),
                      rack::ClockKind clock = rack::ClockKind::real,
                      const std::string& address = "127.0.0.1", const std::string& record = {},
                      SessionControl* session = nullptr, RackFileControl* rack_file = nullptr)
      : ServedRack(configuration(clock, record), limits, address, session, rack_file) {}
  explicit ServedRack(rack::RackConfiguration configuration,
                      const ServerLimits& limits = patient_limits(),
                      const std::string& address = "127.0.0.1", SessionControl* session = nullptr,
                      RackFileControl* rack_file = nullptr)
      : configuration_(std::move(configuration)),
        rack_(configuration_, log_),
        runner_(rack_, configuration_, tests::no_log()),
        manual_(runner_, configuration_, log_) {
    server_ = std::make_unique<Server>(ServerConfiguration{.address = {address, 0},
                                                           .token = kToken,
                                                           .limits = limits,
                                                           .session = session,
                                                           .rack_file = rack_file,
                                                           .manual = &manual_,
                                                           .catalogue = devices::products()},
                                       rack_, configuration_, log_, runner_);
    runner_.start();
    server_->start();
  }
  ~ServedRack() {
    manual_.stop();
    runner_.stop();
    server_.reset();
  }
  ServedRack(const ServedRack&) = delete;
  ServedRack& operator=(const ServedRack&) = delete;

  [[nodiscard]] std::uint16_t port() const { return server_->address().port; }
  [[nodiscard]] const rack::RackConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] rack::Runner& runner() { return runner_; }

  Answer get(const std::string& target) { return HttpClient(port()).request("GET", target); }
  Answer put(const std::string& target, const std::string& body) {
    return send("PUT", target, body);
  }
  /// Any other method, with the token.
  Answer send(const std::string& method, const std::string& target, const std::string& body = {}) {
    return HttpClient(port()).request(method, target, body,
                                      "Authorization: Bearer " + std::string(kToken) + "\r\n");
  }

  static rack::RackConfiguration configuration(rack::ClockKind clock, const std::string& record) {
    rack::RackConfiguration configuration =
        rack::single_device_rack("tmcm-3315", devices::products());
    configuration.clock = clock;
    configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_udp_port()};
    configuration.segments[0].devices[0].name = "drive";
    configuration.buses = rack::single_device_rack("tmcc160", devices::products()).buses;
    configuration.buses[0].devices[0].name = "servo";
    configuration.buses[0].ports = {"slcan:" + ::testing::TempDir() + "stator-web-" +
                                    std::to_string(::getpid())};
    if (!record.empty()) {
      configuration.record.emplace();
      configuration.record->file = record;
    }
    return configuration;
  }

  /// One TMCL module "module" on a CAN bus, with a program in its memory.
  static rack::RackConfiguration module_with(std::vector<tmcl::Instruction> program) {
    rack::RackConfiguration configuration =
        rack::single_device_rack("tmcm-142", devices::products());
    rack::DeviceConfiguration& device = configuration.buses[0].devices[0];
    device.name = "module";
    device.setup.as<devices::Tmcm142Configuration>().program = std::move(program);
    configuration.buses[0].ports = {"slcan:" + ::testing::TempDir() + "stator-web-tmcl-" +
                                    std::to_string(::getpid())};
    return configuration;
  }

 private:
  rack::RackConfiguration configuration_;
  rack::EventLog log_;
  rack::Rack rack_;
  std::unique_ptr<Server> server_;
  rack::Runner runner_;
  manual::ManualControl manual_;
};

}  // namespace stator::web
