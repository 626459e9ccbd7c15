#include "stator/bench/local_can_port.hpp"

#include "stator/rack/networks/can_network.hpp"

namespace stator::bench {

LocalCanPort::LocalCanPort(rack::Rack& rack, std::size_t bus, base::SimDuration cycle,
                           base::SimDuration step)
    : rack_(rack), bus_(bus), own_clock_(cycle, step), clock_(own_clock_) {
  attach();
}

LocalCanPort::LocalCanPort(rack::Rack& rack, std::size_t bus, rack::LockstepClock& clock)
    : rack_(rack), bus_(bus), own_clock_(clock), clock_(clock) {
  attach();
}

void LocalCanPort::attach() {
  port_.set_lossy(true);  // one thread: nobody would take what the bus waits for
  rack_.bus(bus_).add(port_);
}

LocalCanPort::~LocalCanPort() {
  rack_.bus(bus_).remove(port_);
}

void LocalCanPort::send(const can::Frame& frame) {
  rack_.advance(clock_.on_frame(frame));
  port_.put(frame);
  rack_.settle(bus_, clock_);
}

void LocalCanPort::wait(base::SimDuration duration) {
  clock_.wait(duration);
  rack_.advance(clock_.now());
}

}  // namespace stator::bench
