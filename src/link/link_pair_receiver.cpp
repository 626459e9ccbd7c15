#include "link/link_pair_receiver.hpp"

#include <algorithm>

#include <poll.h>
#include <time.h>

namespace stator::link {

namespace {

std::int64_t monotonic_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

/// One look at both links.
base::Expected<LinkPairReceiver::Received, LinkError> LinkPairReceiver::take(
    std::span<std::byte> buffer) {
  for (const std::size_t index : {preferred_, 1 - preferred_}) {
    const auto received = links_[index]->receive(buffer, base::SimDuration(0));
    if (!received && received.error().code != LinkErrorCode::interface_down) {
      return base::Unexpected{received.error()};
    }
    if (received && *received > 0) {
      preferred_ = 1 - index;
      return Received{*received, index};
    }
  }
  return Received{};
}

/// Sleeps until a link has something or `until` has passed; false when nothing came.
bool LinkPairReceiver::sleep(std::int64_t until) const {
  const std::int64_t left = until - monotonic_now();
  if (left <= 0) {
    return false;
  }
  std::array<pollfd, 2> descriptors{
      {{links_[0]->descriptor(), POLLIN, 0}, {links_[1]->descriptor(), POLLIN, 0}}};
  const timespec limit{left / 1'000'000'000, left % 1'000'000'000};
  return ::ppoll(descriptors.data(), descriptors.size(), &limit, nullptr) > 0;
}

base::Expected<LinkPairReceiver::Received, LinkError> LinkPairReceiver::receive(
    std::span<std::byte> buffer, base::SimDuration timeout) {
  const std::int64_t start = monotonic_now();
  const std::int64_t end = start + timeout.nanoseconds();
  std::int64_t spin_end = start;
  if (wait_ == WaitMode::spin) {
    spin_end = end;
  } else if (wait_ == WaitMode::adaptive) {
    spin_end = std::clamp(last_frame_ + spin_time_.nanoseconds(), start, end);
  }
  std::int64_t now = start;
  do {
    auto received = take(buffer);
    now = monotonic_now();
    if (!received || received->length > 0) {
      last_frame_ = now;
      return received;
    }
  } while (now < spin_end);
  return sleep(end) ? take(buffer) : Received{};
}

}  // namespace stator::link
