#include "stator/rack/observe/traffic_tap.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace stator::rack {

namespace {

static_assert(std::is_trivially_copyable_v<TrafficTap::Header>);
static_assert(std::is_trivially_copyable_v<can::Frame>);

}  // namespace

void TrafficTap::put(std::uint16_t network, Direction direction, base::SimTime time,
                     std::span<const std::byte> frame) {
  const Header header{.number = ++numbered_,
                      .time = time,
                      .network = network,
                      .length = static_cast<std::uint16_t>(frame.size()),
                      .direction = direction};
  const std::size_t written = written_.load(std::memory_order_relaxed);
  const std::size_t used = written - read_.load(std::memory_order_acquire);
  if (ring_.size() - used < sizeof(header) + frame.size()) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  copy_in(written, std::as_bytes(std::span(&header, 1)));
  copy_in(written + sizeof(header), frame);
  written_.store(written + sizeof(header) + frame.size(), std::memory_order_release);
}

void TrafficTap::put(std::uint16_t network, Direction direction, base::SimTime time,
                     const can::Frame& frame) {
  put(network, direction, time, std::as_bytes(std::span(&frame, 1)));
}

std::optional<TrafficTap::Record> TrafficTap::take() {
  if (empty()) {
    return std::nullopt;
  }
  const std::size_t read = read_.load(std::memory_order_relaxed);
  Record record;
  copy_out(read, std::as_writable_bytes(std::span(&record.header, 1)));
  record.bytes.resize(record.header.length);
  copy_out(read + sizeof(Header), record.bytes);
  read_.store(read + sizeof(Header) + record.bytes.size(), std::memory_order_release);
  return record;
}

bool TrafficTap::skip() {
  if (empty()) {
    return false;
  }
  const std::size_t read = read_.load(std::memory_order_relaxed);
  Header header;
  copy_out(read, std::as_writable_bytes(std::span(&header, 1)));
  read_.store(read + sizeof(Header) + header.length, std::memory_order_release);
  return true;
}

std::optional<can::Frame> TrafficTap::decode_can(std::span<const std::byte> bytes) {
  can::Frame frame;
  if (bytes.size() != sizeof frame) {
    return std::nullopt;
  }
  std::memcpy(&frame, bytes.data(), sizeof frame);
  return frame;
}

void TrafficTap::copy_in(std::size_t at, std::span<const std::byte> bytes) {
  at %= ring_.size();
  const auto first = bytes.first(std::min(bytes.size(), ring_.size() - at));
  std::ranges::copy(first, ring_.begin() + static_cast<std::ptrdiff_t>(at));
  std::ranges::copy(bytes.subspan(first.size()), ring_.begin());
}

void TrafficTap::copy_out(std::size_t at, std::span<std::byte> bytes) const {
  at %= ring_.size();
  const auto first = bytes.first(std::min(bytes.size(), ring_.size() - at));
  std::ranges::copy(std::span(ring_).subspan(at, first.size()), first.begin());
  const auto second = bytes.subspan(first.size());
  std::ranges::copy(std::span(ring_).first(second.size()), second.begin());
}

}  // namespace stator::rack
