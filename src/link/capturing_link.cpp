#include "link/capturing_link.hpp"

namespace stator::link {

base::Expected<std::size_t, LinkError> CapturingLink::receive(std::span<std::byte> buffer,
                                                              base::SimDuration timeout) {
  auto received = link_.receive(buffer, timeout);
  if (received && *received != 0) {
    capture(buffer.first(*received));
  }
  return received;
}

base::Expected<void, LinkError> CapturingLink::send(std::span<const std::byte> frame) {
  auto sent = link_.send(frame);
  if (sent) {
    capture(frame);
  }
  return sent;
}

void CapturingLink::capture(std::span<const std::byte> frame) {
  if (capture_error_) {
    return;
  }
  if (const auto written = writer_.write(clock_(), frame); !written) {
    capture_error_ = written.error();
  }
}

}  // namespace stator::link
