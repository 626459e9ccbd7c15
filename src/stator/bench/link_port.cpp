#include "stator/bench/link_port.hpp"

#include <chrono>
#include <thread>

namespace stator::bench {

master::Result<std::size_t> LinkPort::exchange(std::span<const std::byte> frame,
                                               std::span<std::byte> reply,
                                               base::SimDuration timeout) {
  if (!frame.empty()) {
    if (const auto sent = link_.send(frame); !sent) {
      return master::fail(master::ErrorCode::port, sent.error().text);
    }
  }
  const auto received = link_.receive(reply, timeout);
  if (!received) {
    return master::fail(master::ErrorCode::port, received.error().text);
  }
  return *received;
}

void LinkPort::wait(base::SimDuration duration) {
  std::this_thread::sleep_for(std::chrono::nanoseconds(duration.nanoseconds()));
}

}  // namespace stator::bench
