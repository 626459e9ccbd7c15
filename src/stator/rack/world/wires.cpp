#include "stator/rack/world/wires.hpp"

#include <algorithm>
#include <stdexcept>

namespace stator::rack {

void Wires::connect(CouplingPoints& points) {
  for (const WireConfiguration& wire : configurations_) {
    // A value is put into the ring and taken out of it at the same instant when there is no delay.
    const auto places = static_cast<std::size_t>(wire.delay / kWirePeriod) + 1;
    try {
      wires_.push_back({wire, points.signal(wire.from, wire.signal),
                        points.input(wire.to, wire.input),
                        std::vector<std::optional<double>>(places, std::nullopt)});
    } catch (const std::runtime_error& error) {
      throw std::runtime_error("a wire from \"" + wire.signal + "\" to \"" + wire.input +
                               "\": " + error.what());
    }
  }
}

double Wires::value_of(const Wire& wire) {
  const WireConfiguration& configuration = wire.configuration;
  const double value = wire.signal.read();
  if (configuration.threshold) {
    return value >= *configuration.threshold ? configuration.high : configuration.low;
  }
  const product::InputRange& range = wire.input.range();
  return std::clamp(configuration.scale * value + configuration.offset, range.minimum,
                    range.maximum);
}

void Wires::act(base::SimTime instant) {
  for (Wire& wire : wires_) {
    wire.delayed[wire.place] = value_of(wire);
    wire.place = wire.place + 1 == wire.delayed.size() ? 0 : wire.place + 1;
    wire.arrived = wire.delayed[wire.place];
  }
  for (Wire& wire : wires_) {
    if (wire.arrived && wire.arrived != wire.set) {
      wire.set = wire.arrived;
      wire.input.set(*wire.arrived);
    }
  }
  next_ = instant + kWirePeriod;
}

}  // namespace stator::rack
