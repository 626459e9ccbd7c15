#include "stator/replay/byte_delta.hpp"

#include <algorithm>
#include <cstdint>

namespace stator::replay {

namespace {

/// So many equal bytes end a stretch of different ones: less would not pay for the next one's head.
constexpr std::size_t kWorthASkip = 3;

}  // namespace

// The length, then stretches: how many bytes to keep, how many follow, and those. What lies beyond
// `known` counts as different.
void write_delta(ByteWriter& writer, std::span<const std::byte> known,
                 std::span<const std::byte> bytes) {
  writer.number(bytes.size());
  const auto same = [&](std::size_t at) { return at < known.size() && known[at] == bytes[at]; };
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t begin = at;
    while (at < bytes.size() && same(at)) {
      ++at;
    }
    if (at == bytes.size()) {
      break;
    }
    const std::size_t first = at;
    std::size_t equal = 0;
    for (; at < bytes.size() && equal < kWorthASkip; ++at) {
      equal = same(at) ? equal + 1 : 0;
    }
    const std::size_t end = at - equal;
    writer.number(first - begin + 1);
    writer.bytes(bytes.subspan(first, end - first));
    at = end;
  }
  writer.number(0);
}

bool read_delta(ByteReader& reader, std::span<const std::byte> known, std::size_t limit,
                std::vector<std::byte>& bytes) {
  const std::uint64_t length = reader.number();
  if (!reader.good() || length > limit) {
    static_cast<void>(reader.raw(SIZE_MAX));
    return false;
  }
  const std::size_t kept = std::min(known.size(), static_cast<std::size_t>(length));
  bytes.assign(static_cast<std::size_t>(length), std::byte{0});
  std::ranges::copy(known.first(kept), bytes.begin());
  std::uint64_t at = 0;
  for (std::uint64_t skip = reader.number(); skip != 0; skip = reader.number()) {
    const auto stretch = reader.bytes();
    at += skip - 1;
    if (!reader.good() || at > length || stretch.size() > length - at) {
      static_cast<void>(reader.raw(SIZE_MAX));
      return false;
    }
    std::ranges::copy(stretch, bytes.begin() + static_cast<std::ptrdiff_t>(at));
    at += stretch.size();
  }
  return reader.good();
}

}  // namespace stator::replay
