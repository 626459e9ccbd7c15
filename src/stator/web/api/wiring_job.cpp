#include "stator/web/api/wiring_job.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/run/connections.hpp"
#include "stator/web/json_text.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;
using ethercat::SlaveController;

/// What a port shows at one moment.
struct PortState {
  bool present = false;
  bool link = false;
  bool open = false;
  std::uint8_t invalid_frames = 0;
  std::uint8_t receive_errors = 0;
  std::uint8_t forwarded_errors = 0;
  std::uint8_t lost_links = 0;
};
using PortStates = std::array<PortState, SlaveController::kPorts>;

std::uint8_t byte_at(const SlaveController& controller, unsigned address) {
  std::array<std::byte, 1> byte{};
  controller.peek(static_cast<std::uint16_t>(address), byte);
  return std::to_integer<std::uint8_t>(byte[0]);
}

PortStates read_ports(const SlaveController& controller) {
  namespace address = ethercat::register_address;
  PortStates states;
  for (unsigned port = 0; port < states.size(); ++port) {
    states[port] = {.present = controller.has_port(port),
                    .link = controller.link(port),
                    .open = controller.port_open(port),
                    .invalid_frames = byte_at(controller, address::kReceiveErrors + 2 * port),
                    .receive_errors = byte_at(controller, address::kReceiveErrors + 2 * port + 1),
                    .forwarded_errors = byte_at(controller, address::kForwardedErrors + port),
                    .lost_links = byte_at(controller, address::kLostLinks + port)};
  }
  return states;
}

/// Who is at the other end of the cable of a port.
Json neighbour(const rack::SegmentConfiguration& segment, std::size_t index, unsigned port) {
  const rack::Attachment attachment = rack::attachment_of(segment.devices, index);
  if (port == attachment.port) {
    return attachment.parent ? Json(segment.devices[*attachment.parent].name) : Json("master");
  }
  if (const auto next = rack::device_at(segment.devices, index, port)) {
    return segment.devices[*next].name;
  }
  return rack::has_cable(segment, index, port) ? Json("master") : Json(nullptr);
}

class WiringJob final : public LookJob {
 public:
  explicit WiringJob(const State& state) : state_(state) {
    const rack::RackConfiguration& configuration = state.configuration();
    for (const rack::SegmentConfiguration& segment : configuration.segments) {
      ports_.emplace_back(segment.devices.size());
    }
    carriers_.resize(configuration.segments.size());
    loads_.resize(configuration.buses.size());
  }

  /// One segment or all buses in each call.
  bool look(const rack::View& rack, base::SimTime now) override {
    if (segment_ < ports_.size()) {
      using ethercat::MasterInterface;
      const std::size_t count = ports_[segment_].size();
      for (std::size_t i = 0; i < kDevicesAtOnce && device_ < count; ++i, ++device_) {
        ports_[segment_][device_] =
            read_ports(rack.slave({segment_, device_, rack::NetworkKind::segment}).controller());
      }
      carriers_[segment_] = {rack.segment(segment_).carrier(MasterInterface::primary),
                             rack.segment(segment_).carrier(MasterInterface::secondary)};
      if (device_ == count) {
        device_ = 0;
        ++segment_;
      }
      return false;
    }
    for (std::size_t i = 0; i < loads_.size(); ++i) {
      loads_[i] = rack.bus(i).bus().load(now);
    }
    return true;
  }

  Response response() override {
    const rack::RackConfiguration& configuration = state_.configuration();
    Json segments = Json::array();
    for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
      segments.push_back(segment_json(i));
    }
    Json buses = Json::array();
    for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
      if (configuration.buses[i].wire) {
        buses.push_back(bus_json(i));
      }
    }
    return json_response(
        {{"segments", std::move(segments)}, {"buses", std::move(buses)}, {"lines", lines_json()}});
  }

 private:
  static constexpr std::size_t kDevicesAtOnce = 16;

  Json segment_json(std::size_t number) const {
    const rack::SegmentConfiguration& segment = state_.configuration().segments[number];
    Json devices = Json::array();
    for (std::size_t i = 0; i < segment.devices.size(); ++i) {
      const rack::Attachment attachment = rack::attachment_of(segment.devices, i);
      Json ports = Json::array();
      for (unsigned port = 0; port < SlaveController::kPorts; ++port) {
        const PortState& state = ports_[number][i][port];
        if (state.present) {
          ports.push_back({{"number", port},
                           {"link", state.link},
                           {"loop_closed", !state.open},
                           {"neighbour", neighbour(segment, i, port)},
                           {"invalid_frames", state.invalid_frames},
                           {"rx_errors", state.receive_errors},
                           {"forwarded_errors", state.forwarded_errors},
                           {"lost_links", state.lost_links}});
        }
      }
      devices.push_back(
          {{"name", segment.devices[i].name},
           {"after",
            attachment.parent ? Json(segment.devices[*attachment.parent].name) : Json(nullptr)},
           {"port", attachment.parent ? Json(attachment.parent_port) : Json(nullptr)},
           {"entry_port", attachment.port},
           {"ports", std::move(ports)}});
    }
    return {{"name", fmt::format("segment {}", number)},
            {"link", to_text(segment.link)},
            {"redundant", segment.redundant()},
            {"carrier", carriers_[number]},
            {"devices", std::move(devices)}};
  }

  Json bus_json(std::size_t number) const {
    const rack::BusConfiguration& bus = state_.configuration().buses[number];
    Json devices = Json::array();
    for (const rack::DeviceConfiguration& device : bus.devices) {
      devices.push_back(device.name);
    }
    return {{"name", bus.name},
            {"bit_rate", bus.bit_rate ? Json(*bus.bit_rate) : Json(nullptr)},
            {"load", loads_[number]},
            {"ports", bus.ports},
            {"devices", std::move(devices)}};
  }

  /// Serial lines in the order in which the rack has them.
  Json lines_json() const {
    std::vector<std::string> links;
    std::vector<Json> members;
    const auto add = [&](const rack::DeviceConfiguration& device) {
      for (const rack::SerialConnection& serial : device.serial) {
        auto found = std::ranges::find(links, serial.line);
        if (found == links.end()) {
          links.push_back(serial.line);
          members.push_back(Json::array());
          found = links.end() - 1;
        }
        members[static_cast<std::size_t>(found - links.begin())].push_back(device.name);
      }
    };
    for (const auto& segment : state_.configuration().segments) {
      std::ranges::for_each(segment.devices, add);
    }
    for (const auto& bus : state_.configuration().buses) {
      std::ranges::for_each(bus.devices, add);
    }
    Json lines = Json::array();
    for (std::size_t i = 0; i < links.size(); ++i) {
      lines.push_back({{"link", links[i]}, {"devices", members[i]}});
    }
    return lines;
  }

  const State& state_;
  std::vector<std::vector<PortStates>> ports_;  ///< by segment and device
  std::vector<std::array<bool, 2>> carriers_;
  std::vector<double> loads_;
  std::size_t segment_ = 0;
  std::size_t device_ = 0;
};

Json link_json(std::string_view network, std::string_view link,
               const rack::Connections& connections) {
  Json programs = Json::array();
  for (const rack::Connection& each : connections.programs) {
    programs.push_back({{"program", each.program},
                        {"lines", each.lines},
                        {"explanation", each.explanation},
                        {"guide", each.guide}});
  }
  return {{"network", network},
          {"link", link},
          {"where", connections.where},
          {"programs", std::move(programs)}};
}

}  // namespace

std::unique_ptr<Job> make_wiring_job(const State& state) {
  return std::make_unique<WiringJob>(state);
}

Response describe_connections(const State& state) {
  const rack::RackConfiguration& configuration = state.configuration();
  const rack::Runner& runner = state.runner();
  Json links = Json::array();
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentConfiguration& segment = configuration.segments[i];
    if (!segment.link.in_process()) {
      links.push_back(link_json("segment " + std::to_string(i), to_text(segment.link),
                                rack::connections_of(segment)));
    }
  }
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    const rack::BusConfiguration& bus = configuration.buses[i];
    for (std::size_t port = 0; bus.wire && port < runner.bus(i).ports(); ++port) {
      const std::string& name = runner.bus(i).port(port).name();
      links.push_back(link_json(bus.name, name, rack::connections_of(bus, name)));
    }
  }
  for (std::size_t i = 0; i < state.lines().size(); ++i) {
    const std::string& opened = runner.line(i).link().name();
    links.push_back(link_json(state.lines()[i].link, opened,
                              rack::connections_of(configuration, state.lines()[i], opened)));
  }
  return json_response({{"links", std::move(links)}});
}

}  // namespace stator::web
