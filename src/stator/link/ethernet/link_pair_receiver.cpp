#include "stator/link/ethernet/link_pair_receiver.hpp"

#include <ctime>

#include <poll.h>

namespace stator::link {

base::Expected<LinkPairReceiver::Received, LinkError> LinkPairReceiver::receive(
    std::span<std::byte> buffer, base::SimDuration timeout) {
  const auto length = wait_.receive(*this, buffer, timeout);
  if (!length) {
    return base::Unexpected{length.error()};
  }
  return Received{*length, source_};
}

base::Expected<ReceiveWait::Taken, LinkError> LinkPairReceiver::take(std::span<std::byte> buffer,
                                                                     base::SimDuration wait) {
  if (wait > base::SimDuration() && !sleep(wait)) {
    return ReceiveWait::Taken{};
  }
  for (const std::size_t index : {preferred_, 1 - preferred_}) {
    const auto received = links_[index]->receive(buffer, base::SimDuration());
    if (!received && received.error().code != LinkErrorCode::interface_down) {
      return base::Unexpected{received.error()};
    }
    if (received && *received > 0) {
      preferred_ = 1 - index;
      source_ = index;
      return ReceiveWait::Taken{.length = *received};
    }
  }
  return ReceiveWait::Taken{};
}

/// Sleeps until a link has something; false when `limit` has passed or a signal came.
bool LinkPairReceiver::sleep(base::SimDuration limit) const {
  std::array<pollfd, 2> descriptors{
      {{links_[0]->descriptor(), POLLIN, 0}, {links_[1]->descriptor(), POLLIN, 0}}};
  constexpr std::int64_t kBillion = 1'000'000'000;
  const timespec until{limit.nanoseconds() / kBillion, limit.nanoseconds() % kBillion};
  return ::ppoll(descriptors.data(), descriptors.size(), &until, nullptr) > 0;
}

}  // namespace stator::link
