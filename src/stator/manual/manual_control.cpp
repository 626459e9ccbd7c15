#include "stator/manual/manual_control.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "stator/manual/bus_master.hpp"
#include "stator/manual/line_master.hpp"
#include "stator/manual/segment_master.hpp"
#include "stator/product/catalogue/io_configuration.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::manual {

namespace {

unsigned axes_of(const rack::DeviceConfiguration& device) {
  product::Setup setup = device.setup;
  return static_cast<unsigned>(setup.axes().size());
}

/// The address of a module on a serial line, with what switches on its board add.
std::uint8_t address_on(const rack::DeviceConfiguration& device) {
  const auto address =
      device.setup.product().tmcl_address_on(device.setup, device.serial.front().interface);
  return address ? static_cast<std::uint8_t>(*address) : device.setup.tmcl_address()->serial;
}

/// The same on CAN.
product::TmclAddress address_on_can(const rack::DeviceConfiguration& device) {
  product::TmclAddress address = *device.setup.tmcl_address();
  if (const auto identifier = device.setup.product().tmcl_identifier(device.setup)) {
    address.can = static_cast<std::uint16_t>(*identifier);
  }
  return address;
}

}  // namespace

ManualControl::ManualControl(rack::Runner& runner, const rack::RackConfiguration& configuration,
                             rack::EventLog& log)
    : runner_(runner),
      configuration_(configuration),
      log_(log),
      devices_(runner.running().rack.addresses()) {}

ManualControl::~ManualControl() {
  stop();
}

const rack::DeviceConfiguration& ManualControl::configuration_of(rack::DeviceAddress device) const {
  return device.kind == rack::NetworkKind::segment
             ? configuration_.segments[device.network].devices[device.device]
             : configuration_.buses[device.network].devices[device.device];
}

base::Expected<ManualControl::Place, std::string> ManualControl::place_of(
    rack::DeviceAddress device) const {
  if (runner_.clock_kind() != rack::ClockKind::real) {
    return base::Unexpected{
        std::string("in lockstep time is the master's; run the rack with clock = \"real\" to move "
                    "axes by hand")};
  }
  const rack::DeviceConfiguration& configuration = configuration_of(device);
  if (device.kind == rack::NetworkKind::segment) {
    if (configuration.setup.product().waits_for_host(configuration.setup)) {
      return base::Unexpected{
          std::string("its firmware is a program beside it, which only that program's master "
                      "knows how to command")};
    }
    if (configuration.setup.coe() == nullptr &&
        configuration.setup.product().io_configuration() == nullptr) {
      return base::Unexpected{std::string("it has no process data")};
    }
    return Place{Medium::segment, device.network};
  }
  const bool wired = configuration_.buses[device.network].wire;
  if (configuration.setup.node_id() != nullptr && wired) {
    return Place{Medium::bus, device.network};
  }
  if (configuration.setup.tmcl_address() != nullptr) {
    if (!configuration.serial.empty()) {
      const rack::Rack& rack = runner_.running().rack;
      for (std::size_t line = 0; line < rack.line_count(); ++line) {
        if (rack.line(line).configuration().link == configuration.serial.front().line) {
          return Place{Medium::line, line};
        }
      }
    }
    if (wired) {
      return Place{Medium::bus, device.network};
    }
  }
  return base::Unexpected{
      std::string("it is wired to neither a bus nor a serial line; give it one in the rack file")};
}

std::string ManualControl::impediment(rack::DeviceAddress device) const {
  if (axes_of(configuration_of(device)) == 0) {
    return "it has no axis that could be moved";
  }
  const auto place = place_of(device);
  return place ? std::string() : place.error();
}

std::unique_ptr<Session> ManualControl::make_session(Place place, rack::DeviceAddress first) {
  std::vector<Session::Member> members;
  std::vector<std::size_t> devices;
  std::vector<BusMember> nodes;
  std::vector<LineMember> modules;
  for (const rack::DeviceAddress device : devices_) {
    const auto its_place = place_of(device);
    if (!its_place || *its_place != place) {
      continue;
    }
    const rack::DeviceConfiguration& configuration = configuration_of(device);
    members.push_back({device, axes_of(configuration), configuration.setup.product().motion_units(),
                       base::EventReporter(&log_, runner_.running().rack.number_of(device))});
    const bool node = configuration.setup.node_id() != nullptr;
    switch (place.medium) {
      case Medium::segment:
        devices.push_back(device.device);
        break;
      case Medium::bus:
        nodes.push_back(
            {.device = device.device,
             .node_id = node ? std::optional(*configuration.setup.node_id()) : std::nullopt,
             .tmcl = node ? std::nullopt : std::optional(address_on_can(configuration))});
        break;
      case Medium::line:
        modules.push_back({device, address_on(configuration)});
        break;
    }
  }
  rack::RunningRack& running = runner_.running();
  std::unique_ptr<NetworkMaster> master;
  switch (place.medium) {
    case Medium::segment:
      master = std::make_unique<SegmentMaster>(running, runner_.seat(place.index), place.index,
                                               std::move(devices));
      break;
    case Medium::bus:
      master = std::make_unique<BusMaster>(running, runner_.bus(place.index), place.index,
                                           std::move(nodes));
      break;
    case Medium::line:
      master = std::make_unique<LineMaster>(running, runner_.line(place.index), place.index,
                                            std::move(modules));
      break;
  }
  return std::make_unique<Session>(running, std::move(master), std::move(members), first);
}

DeviceStatus ManualControl::status(rack::DeviceAddress device) const {
  const auto place = place_of(device);
  if (!place) {
    return {};
  }
  const std::scoped_lock lock(mutex_);
  const auto session = sessions_.find(*place);
  return session != sessions_.end() ? session->second->status(device) : DeviceStatus{};
}

base::Expected<void, std::string> ManualControl::start(rack::DeviceAddress device) {
  const auto place = place_of(device);
  if (!place) {
    return base::Unexpected{place.error()};
  }
  const std::scoped_lock lock(mutex_);
  if (stopped_) {
    return base::Unexpected{std::string("the rack is about to end")};
  }
  std::unique_ptr<Session>& session = sessions_[*place];
  if (session == nullptr || !session->start(device)) {
    session.reset();  // it leaves its seat before another sits down
    session = make_session(*place, device);
  }
  return {};
}

void ManualControl::release(rack::DeviceAddress device) {
  const auto place = place_of(device);
  const std::scoped_lock lock(mutex_);
  if (place && sessions_.contains(*place)) {
    static_cast<void>(sessions_.at(*place)->release(device));
  }
}

base::Expected<void, std::string> ManualControl::command(rack::DeviceAddress device,
                                                         std::size_t axis, const Command& command) {
  const auto place = place_of(device);
  const std::scoped_lock lock(mutex_);
  const DeviceStatus status =
      place && sessions_.contains(*place) ? sessions_.at(*place)->status(device) : DeviceStatus{};
  if (status.phase != Phase::active) {
    return base::Unexpected{
        std::string("it is not under manual control; begin with that first, or see why it ended")};
  }
  if (axis >= status.axes.size()) {
    return base::Unexpected{"it has no axis " + std::to_string(axis) + "; the last is " +
                            std::to_string(status.axes.size() - 1)};
  }
  if (std::ranges::find(status.axes[axis].description.commands, command.kind) ==
      status.axes[axis].description.commands.end()) {
    return base::Unexpected{"its axes have no \"" + std::string(name_of(command.kind)) + '"'};
  }
  static_cast<void>(sessions_.at(*place)->command(device, axis, command));
  return {};
}

base::Expected<void, std::string> ManualControl::set_outputs(rack::DeviceAddress device,
                                                             std::size_t offset,
                                                             std::vector<std::byte> data) {
  const auto place = place_of(device);
  const std::scoped_lock lock(mutex_);
  if (!place || !sessions_.contains(*place) ||
      sessions_.at(*place)->status(device).phase != Phase::active) {
    return base::Unexpected{std::string("it is not under manual control")};
  }
  static_cast<void>(sessions_.at(*place)->set_outputs(device, offset, std::move(data)));
  return {};
}

void ManualControl::stop() {
  const std::scoped_lock lock(mutex_);
  stopped_ = true;
  sessions_.clear();
}

}  // namespace stator::manual
