#include "stator/rack/core/internal/coupling_ground.hpp"

#include <algorithm>
#include <stdexcept>

#include "stator/rack/core/internal/rack_parts.hpp"

namespace stator::rack {

product::Signal CouplingGround::signal(DeviceAddress device, const std::string& name) {
  const auto signals = parts_.device(device).signals();
  const auto found = std::ranges::find(signals, name, &product::Signal::name);
  if (found == signals.end()) {
    throw std::runtime_error("the device has no such signal");
  }
  return *found;
}

CoupledInput CouplingGround::input(DeviceAddress device, const std::string& name) {
  const auto inputs = parts_.inputs(device);
  const auto found = std::ranges::find(inputs, name, &product::Input::name);
  if (found == inputs.end()) {
    throw std::runtime_error("the device has no such input");
  }
  const CoupledInput::Touched touched =
      device.kind == NetworkKind::bus
          ? CoupledInput::Touched::bind<&CanNetwork::touched>(*parts_.buses[device.network].network)
          : CoupledInput::Touched();
  return {*found, parts_.held_inputs[{device, name}], device.device, touched};
}

}  // namespace stator::rack
