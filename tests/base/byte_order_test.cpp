// Loading and storing of little-endian numbers at any address, and reversal of their bytes.
#include "stator/base/byte_order.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

constexpr std::array kBytes{std::byte{0x01}, std::byte{0x23}, std::byte{0x45},
                            std::byte{0x67}, std::byte{0x89}, std::byte{0xAB},
                            std::byte{0xCD}, std::byte{0xEF}, std::byte{0x10}};

TEST(ByteOrder, LoadTakesTheLowestByteFirst) {
  EXPECT_EQ(load_le<std::uint8_t>(kBytes), 0x01);
  EXPECT_EQ(load_le<std::uint16_t>(kBytes), 0x2301);
  EXPECT_EQ(load_le<std::uint32_t>(kBytes), 0x67452301U);
  EXPECT_EQ(load_le<std::uint64_t>(kBytes), 0xEFCDAB8967452301U);
}

TEST(ByteOrder, LoadWorksAtOddAddresses) {
  EXPECT_EQ(load_le<std::uint16_t>(kBytes, 1), 0x4523);
  EXPECT_EQ(load_le<std::uint64_t>(kBytes, 1), 0x10EFCDAB89674523U);
}

TEST(ByteOrder, LoadKeepsTheSign) {
  EXPECT_EQ(load_le<std::int16_t>(kBytes, 7), 0x10EF);
  EXPECT_EQ(load_le<std::int32_t>(kBytes, 4), static_cast<std::int32_t>(0xEFCDAB89U));
}

TEST(ByteOrder, StoreWritesTheLowestByteFirstAndNothingElse) {
  std::array<std::byte, 6> bytes{};
  store_le<std::uint32_t>(bytes, 1, 0x67452301U);
  const std::array expected{std::byte{0},    std::byte{0x01}, std::byte{0x23},
                            std::byte{0x45}, std::byte{0x67}, std::byte{0}};
  EXPECT_EQ(bytes, expected);
}

TEST(ByteOrder, WhatIsStoredIsLoadedAgain) {
  std::array<std::byte, 8> bytes{};
  store_le(bytes, 0, -1.5);
  EXPECT_EQ(load_le<double>(bytes), -1.5);
  store_le(bytes, 0, std::int64_t{-2});
  EXPECT_EQ(load_le<std::int64_t>(bytes), -2);
}

TEST(ByteOrder, ReversingBytesIsWhatABigEndianHostNeeds) {
  EXPECT_EQ(detail::reverse_bytes(std::uint32_t{0x01234567}), 0x67452301U);
  EXPECT_EQ(detail::reverse_bytes(std::uint16_t{0x0123}), 0x2301);
  EXPECT_EQ(detail::reverse_bytes(detail::reverse_bytes(2.5)), 2.5);
}

}  // namespace
}  // namespace stator::base
