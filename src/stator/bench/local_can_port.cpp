#include "stator/bench/local_can_port.hpp"

#include "stator/rack/networks/can_network.hpp"

namespace stator::bench {

namespace {

/// The bus must not wait for room in the port: the one thread that could take frames is the one
/// that lets time pass.
constexpr rack::BusPort::Options kPort{.hears_errors = false, .lossy = true};

}  // namespace

LocalCanPort::LocalCanPort(rack::Rack& rack, std::size_t bus, base::SimDuration cycle,
                           base::SimDuration step)
    : rack_(rack),
      bus_(bus),
      own_clock_(cycle, step),
      clock_(own_clock_),
      port_(std::make_unique<rack::BusPort>(rack, bus, kPort)) {}

LocalCanPort::LocalCanPort(rack::Rack& rack, std::size_t bus, rack::LockstepClock& clock)
    : rack_(rack),
      bus_(bus),
      own_clock_(clock),
      clock_(clock),
      port_(std::make_unique<rack::BusPort>(rack, bus, kPort)) {}

void LocalCanPort::send(const can::Frame& frame) {
  rack_.advance(clock_.on_frame(frame));
  port_->put(frame);
  rack_.settle(bus_, clock_);
}

void LocalCanPort::wait(base::SimDuration duration) {
  clock_.wait(duration);
  rack_.advance(clock_.now());
}

}  // namespace stator::bench
