// Messages between a chip and firmware in another process, and streams of them that break.
#include "stator/link/serial/chip_message.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::link {
namespace {

using Bytes = std::vector<std::byte>;

Bytes message(std::uint8_t kind, std::uint8_t tag, std::size_t length) {
  Bytes body(length);
  for (std::size_t i = 0; i < length; ++i) {
    body[i] = static_cast<std::byte>(i * 7 + tag);
  }
  Bytes out;
  append_chip_message(out, {.kind = kind, .tag = tag, .body = body});
  return out;
}

void feed(ChipMessageReader& reader, std::span<const std::byte> bytes) {
  const std::span<std::byte> space = reader.space();
  ASSERT_GE(space.size(), bytes.size());
  std::ranges::copy(bytes, space.begin());
  reader.received(bytes.size());
}

TEST(ChipMessage, HeaderIsLengthKindAndTag) {
  const Bytes expected{std::byte{2}, std::byte{0},    std::byte{4},
                       std::byte{9}, std::byte{0x34}, std::byte{0x12}};
  Bytes out;
  append_chip_message(out, {.kind = 4, .tag = 9, .body = std::span(expected).last(2)});
  EXPECT_EQ(out, expected);
}

TEST(ChipMessage, StreamIsCutWhereverItIsBroken) {
  base::Random random(7);
  for (int round = 0; round < 300; ++round) {
    Bytes stream;
    std::vector<std::size_t> lengths;
    for (std::uint8_t i = 0; i < 8; ++i) {
      lengths.push_back(random.below(4100));
      const Bytes next = message(i, i, lengths.back());
      stream.insert(stream.end(), next.begin(), next.end());
    }
    ChipMessageReader reader;
    std::size_t taken = 0;
    std::span<const std::byte> rest(stream);
    while (taken < lengths.size()) {
      while (const auto each = reader.next()) {
        ASSERT_EQ(each->tag, taken);
        ASSERT_EQ(each->body.size(), lengths[taken]);
        ++taken;
      }
      const std::size_t piece =
          std::min({rest.size(), reader.space().size(), 1 + random.below(3000)});
      feed(reader, rest.first(piece));
      rest = rest.subspan(piece);
    }
    EXPECT_FALSE(reader.broken());
  }
}

TEST(ChipMessage, LongerThanAnyRequestBreaksTheStream) {
  ChipMessageReader reader;
  feed(reader, message(2, 0, chip_protocol::kMaximumRequest));
  EXPECT_TRUE(reader.next());
  feed(reader, Bytes{std::byte{0x05}, std::byte{0x10}, std::byte{2}, std::byte{0}});
  EXPECT_FALSE(reader.next());
  EXPECT_TRUE(reader.broken());
  reader.reset();
  feed(reader, message(1, 0, 0));
  EXPECT_TRUE(reader.next());
}

}  // namespace
}  // namespace stator::link
