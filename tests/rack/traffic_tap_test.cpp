// The ring of frames between a network's thread and those who watch its traffic.
#include "stator/rack/observe/traffic_tap.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace stator::rack {
namespace {

std::vector<std::byte> frame_of(std::size_t length, std::uint8_t value) {
  return std::vector<std::byte>(length, std::byte{value});
}

TEST(TrafficTap, GivesFramesBackInTheirOrder) {
  TrafficTap tap(4096);
  EXPECT_FALSE(tap.take());
  tap.put(1, TrafficTap::Direction::request, base::SimTime(base::SimDuration(5)), frame_of(60, 7));
  tap.put(2, TrafficTap::Direction::answer, base::SimTime(base::SimDuration(6)), frame_of(3, 9));
  const auto first = tap.take();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->header.number, 1U);
  EXPECT_EQ(first->header.network, 1U);
  EXPECT_EQ(first->header.direction, TrafficTap::Direction::request);
  EXPECT_EQ(first->header.time, base::SimTime(base::SimDuration(5)));
  EXPECT_EQ(first->bytes, frame_of(60, 7));
  const auto second = tap.take();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->bytes, frame_of(3, 9));
  EXPECT_TRUE(tap.empty());
}

TEST(TrafficTap, LosesAndCountsWhatFindsNoRoom) {
  TrafficTap tap(1000);
  for (int i = 0; i < 100; ++i) {
    tap.put(0, TrafficTap::Direction::bus, {}, frame_of(100, static_cast<std::uint8_t>(i)));
  }
  std::uint64_t taken = 0;
  while (const auto record = tap.take()) {
    EXPECT_EQ(record->header.number, ++taken) << "the first ones are there, the later ones lost";
    EXPECT_EQ(record->bytes.size(), 100U);
  }
  EXPECT_GT(taken, 0U);
  EXPECT_EQ(tap.lost() + taken, 100U);
}

TEST(TrafficTap, GoesRoundItsRingManyTimes) {
  TrafficTap tap(257);
  for (std::size_t i = 0; i < 1000; ++i) {
    const auto frame = frame_of(i % 150, static_cast<std::uint8_t>(i));
    tap.put(0, TrafficTap::Direction::bus, {}, frame);
    const auto record = tap.take();
    ASSERT_TRUE(record) << i;
    ASSERT_EQ(record->bytes, frame) << i;
  }
  EXPECT_EQ(tap.lost(), 0U);
  tap.put(0, TrafficTap::Direction::bus, {}, frame_of(8, 1));
  EXPECT_TRUE(tap.skip());
  EXPECT_FALSE(tap.skip());
}

TEST(TrafficTap, CarriesCanFrames) {
  TrafficTap tap;
  const can::Frame frame = can::data_frame(0x181, {0x27, 0x06});
  tap.put(0, TrafficTap::Direction::bus, {}, frame);
  const auto record = tap.take();
  ASSERT_TRUE(record);
  EXPECT_EQ(TrafficTap::decode_can(record->bytes), frame);
  EXPECT_FALSE(TrafficTap::decode_can(std::span(record->bytes).first(3)));
}

}  // namespace
}  // namespace stator::rack
