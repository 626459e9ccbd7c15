#include "stator/manual/network_master.hpp"

#include <chrono>

namespace stator::manual {

using master::ErrorCode;
using master::Result;

NetworkMaster::~NetworkMaster() {
  const std::scoped_lock lock(running_.mutex);
  seat_.leave(*this);
}

Result<void> NetworkMaster::open() {
  {
    const std::scoped_lock lock(running_.mutex);
    if (!seat_.take(*this, running_.now())) {
      return master::fail(ErrorCode::port,
                          "another master is speaking on this network; end it, or wait until it "
                          "has been silent for a second");
    }
  }
  return begin();
}

Result<void> NetworkMaster::set_outputs(rack::DeviceAddress /*device*/, std::size_t /*offset*/,
                                        std::span<const std::byte> /*data*/) {
  return master::fail(ErrorCode::argument, "there are no process data on this network");
}

void NetworkMaster::close() {
  if (!displaced_) {
    finish();
  }
  end();
  const std::scoped_lock lock(running_.mutex);
  seat_.leave(*this);
}

void NetworkMaster::make_way(base::SimTime /*now*/) {
  displaced_ = true;
  displace();
  changed_.notify_all();
}

void NetworkMaster::end() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
}

// Who displaces the master notifies without its mutex, as it holds the rack, so a wait may miss
// that once and last until its end.
void NetworkMaster::wait(base::SimDuration duration) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::nanoseconds(duration.nanoseconds()),
                    [this] { return ended(); });
}

master::Error NetworkMaster::why_ended() {
  return {ErrorCode::port, 0, "another master spoke on this network, which is its from then on"};
}

}  // namespace stator::manual
