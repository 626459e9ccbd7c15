#include "stator/link/ethernet/capturing_link.hpp"

namespace stator::link {

base::Expected<std::size_t, LinkError> CapturingLink::receive(std::span<std::byte> buffer,
                                                              base::SimDuration timeout) {
  auto received = link_.receive(buffer, timeout);
  if (received && *received != 0) {
    writer_.write(clock_(), buffer.first(*received));
  }
  return received;
}

base::Expected<void, LinkError> CapturingLink::send(std::span<const std::byte> frame) {
  auto sent = link_.send(frame);
  if (sent) {
    writer_.write(clock_(), frame);
  }
  return sent;
}

}  // namespace stator::link
