#include "stator/rack/core/host_pins.hpp"

#include "stator/rack/core/command.hpp"
#include "stator/rack/core/internal/rack_parts.hpp"
#include "stator/rack/core/rack.hpp"

namespace stator::rack {

product::HostPort* HostPins::port_of(Rack& rack, DeviceAddress device) {
  return rack.parts_->slave(device).host_port();
}

bool HostPins::exist(Rack& rack, DeviceAddress device) {
  return port_of(rack, device) != nullptr;
}

void HostPins::select(product::HostSpi spi) {
  rack_.execute({command::SelectHostSpi{device_, spi}});
}

void HostPins::transfer(product::HostSpi spi, std::span<const std::byte> mosi,
                        std::span<std::byte> miso, std::optional<base::SimDuration> read_pause) {
  rack_.execute({command::TransferHostSpi{device_, spi, mosi, miso, read_pause}});
}

void HostPins::deselect(product::HostSpi spi, unsigned surplus_clocks) {
  rack_.execute({command::DeselectHostSpi{device_, spi, surplus_clocks}});
}

void HostPins::set_pin(product::HostPin pin, bool level) {
  rack_.execute({command::SetHostPin{device_, pin, level}});
}

product::HostLines HostPins::levels() {
  return port_of(rack_, device_)->levels();
}

void HostPins::watch(product::HostLines watched, product::HostLineSink* sink) {
  port_of(rack_, device_)->watch(watched, sink);
}

base::SimTime HostPins::next_line_change() {
  return port_of(rack_, device_)->next_line_change();
}

}  // namespace stator::rack
