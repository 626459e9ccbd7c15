#include "stator/rack/core/bus_port.hpp"

#include <algorithm>

#include "stator/rack/core/internal/telling.hpp"

namespace stator::rack {

BusPort::BusPort(Rack& rack, std::size_t bus) : BusPort(rack, bus, Options{}) {}

BusPort::BusPort(Rack& rack, std::size_t bus, Options options)
    : rack_(rack), bus_(bus), options_(options) {
  port_.set_hears_errors(options.hears_errors);
  port_.set_lossy(options.lossy);
  RackParts::BusMembers& members = rack.parts_->buses[bus];
  const auto free = std::ranges::find(members.ports, nullptr);
  number_ = static_cast<std::size_t>(free - members.ports.begin());
  if (free == members.ports.end()) {
    members.ports.push_back(this);
  } else {
    *free = this;
  }
  members.network->add(port_);
  if (Journal* const journal = rack.listening(); journal != nullptr) {
    journal->port_opened(bus, number_, options.hears_errors, options.lossy);
  }
}

BusPort::~BusPort() {
  if (Journal* const journal = rack_.listening(); journal != nullptr) {
    journal->port_closes(bus_, number_);
  }
  RackParts::BusMembers& members = rack_.parts_->buses[bus_];
  members.network->remove(port_);
  members.ports[number_] = nullptr;
}

std::vector<BusPort::Open> BusPort::all(Rack& rack) {
  std::vector<Open> open;
  for (std::size_t bus = 0; bus < rack.parts_->buses.size(); ++bus) {
    for (const BusPort* const port : rack.parts_->buses[bus].ports) {
      if (port != nullptr) {
        open.push_back({bus, port->number_, port->options_});
      }
    }
  }
  return open;
}

bool BusPort::put(const can::Frame& frame) {
  const bool taken = port_.room() > 0;
  rack_.execute({command::PutCanFrame{bus_, number_, frame}});
  return taken;
}

std::optional<can::TimedFrame> BusPort::take() {
  const auto frame = port_.take();
  if (Journal* journal = rack_.listening(); journal != nullptr && frame) {
    journal->can_frame_leaves(bus_, number_, *frame);
  }
  return frame;
}

}  // namespace stator::rack
