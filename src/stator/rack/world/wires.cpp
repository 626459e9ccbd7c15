#include "stator/rack/world/wires.hpp"

#include <algorithm>
#include <stdexcept>

namespace stator::rack {

void Wires::add(const WireConfiguration& wire, std::span<const product::Signal> signals,
                std::span<const product::Input> inputs, Held<double>& held, Touched touched) {
  const auto signal = std::ranges::find(signals, wire.signal, &product::Signal::name);
  const auto input = std::ranges::find(inputs, wire.input, &product::Input::name);
  if (signal == signals.end() || input == inputs.end()) {
    throw std::runtime_error("a wire from \"" + wire.signal + "\" to \"" + wire.input +
                             "\": the device has no " +
                             (signal == signals.end() ? "such signal" : "such input"));
  }
  // A value is put into the ring and taken out of it at the same instant when there is no delay.
  const auto places = static_cast<std::size_t>(wire.delay / kWirePeriod) + 1;
  wires_.push_back({wire, *signal, *input, &held, touched,
                    std::vector<std::optional<double>>(places, std::nullopt)});
  next_ = base::SimTime(base::SimDuration(0));
}

double Wires::value_of(const Wire& wire) {
  const WireConfiguration& configuration = wire.configuration;
  const double value = wire.signal.read();
  if (configuration.threshold) {
    return value >= *configuration.threshold ? configuration.high : configuration.low;
  }
  return std::clamp(configuration.scale * value + configuration.offset, wire.input.minimum,
                    wire.input.maximum);
}

void Wires::act(base::SimTime instant) {
  for (Wire& wire : wires_) {
    wire.delayed[wire.place] = value_of(wire);
    wire.place = wire.place + 1 == wire.delayed.size() ? 0 : wire.place + 1;
    wire.arrived = wire.delayed[wire.place];
  }
  for (Wire& wire : wires_) {
    if (!wire.arrived || wire.arrived == wire.set) {
      continue;
    }
    wire.set = wire.arrived;
    if (!wire.held->set(*wire.arrived)) {
      continue;
    }
    wire.input.set(*wire.arrived);
    if (wire.touched) {
      wire.touched(wire.configuration.to.device);
    }
  }
  next_ = instant + kWirePeriod;
}

}  // namespace stator::rack
