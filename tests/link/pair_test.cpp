// Two ends of a link in one process: order, full queues, waking, statistics, two threads.
#include "stator/link/ethernet/pair.hpp"

#include <array>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "link/ethernet_frames.hpp"

namespace stator::link {
namespace {

using base::SimDuration;
using namespace base::literals;

std::vector<std::byte> receive(EthernetLink& link, SimDuration timeout = SimDuration(0)) {
  std::vector<std::byte> buffer(kMaximumFrameLength);
  const auto length = link.receive(buffer, timeout);
  buffer.resize(length ? *length : 0);
  return buffer;
}

TEST(Pair, WhatOneEndSendsTheOtherReceivesInOrder) {
  Pair pair;
  ASSERT_TRUE(pair.first().send(make_frame(60, 1)));
  ASSERT_TRUE(pair.first().send(make_frame(1514, 2)));
  ASSERT_TRUE(pair.second().send(make_frame(29, 3)));

  EXPECT_EQ(receive(pair.second()), make_frame(60, 1));
  EXPECT_EQ(receive(pair.second()), make_frame(1514, 2));
  EXPECT_EQ(receive(pair.second()).size(), 0U);
  EXPECT_EQ(receive(pair.first()), make_frame(29, 3));
}

TEST(Pair, AFullQueueRefusesTheFrameAndCountsItAtBothEnds) {
  Pair pair(2);
  ASSERT_TRUE(pair.first().send(make_frame(60, 1)));
  ASSERT_TRUE(pair.first().send(make_frame(60, 2)));
  const auto third = pair.first().send(make_frame(60, 3));
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().code, LinkErrorCode::queue_full);
  EXPECT_EQ(pair.first().statistics().send_errors, 1U);
  EXPECT_EQ(pair.second().statistics().frames_dropped, 1U);

  EXPECT_EQ(receive(pair.second()), make_frame(60, 1));
  ASSERT_TRUE(pair.first().send(make_frame(60, 4)));
  EXPECT_EQ(receive(pair.second()), make_frame(60, 2));
  EXPECT_EQ(receive(pair.second()), make_frame(60, 4));
}

TEST(Pair, AFrameOfAnImpossibleLengthIsRefused) {
  Pair pair;
  for (const std::size_t length : {std::size_t{0}, std::size_t{13}, std::size_t{1519}}) {
    const auto sent = pair.first().send(std::vector<std::byte>(length));
    ASSERT_FALSE(sent) << length;
    EXPECT_EQ(sent.error().code, LinkErrorCode::frame_length);
    EXPECT_THAT(sent.error().text, testing::HasSubstr(std::to_string(length) + " bytes"));
  }
}

TEST(Pair, AFrameLongerThanTheBufferIsCutToIt) {
  Pair pair;
  ASSERT_TRUE(pair.first().send(make_frame(60)));
  std::array<std::byte, 20> buffer{};
  const auto length = pair.second().receive(buffer, SimDuration(0));
  ASSERT_TRUE(length);
  EXPECT_EQ(*length, 20U);
  EXPECT_EQ(receive(pair.second()).size(), 0U);
}

TEST(Pair, StatisticsCountFramesAndBytesOfEachDirection) {
  Pair pair;
  ASSERT_TRUE(pair.first().send(make_frame(60)));
  ASSERT_TRUE(pair.first().send(make_frame(100)));
  receive(pair.second());
  EXPECT_EQ(pair.first().statistics().frames_sent, 2U);
  EXPECT_EQ(pair.first().statistics().bytes_sent, 160U);
  EXPECT_EQ(pair.second().statistics().frames_received, 1U);
  EXPECT_EQ(pair.second().statistics().bytes_received, 60U);
}

TEST(Pair, WakeEndsAWaitOfAnotherThread) {
  Pair pair;
  std::size_t length = 1;
  std::thread waiting([&] { length = receive(pair.second(), SimDuration::max()).size(); });
  pair.second().wake();
  waiting.join();
  EXPECT_EQ(length, 0U);
}

TEST(Pair, WakeEndsOneWaitOnly) {
  Pair pair;
  ASSERT_TRUE(pair.first().send(make_frame(60)));
  pair.second().wake();
  EXPECT_EQ(receive(pair.second()).size(), 0U);
  EXPECT_EQ(receive(pair.second()).size(), 60U);
}

TEST(Pair, TwoThreadsExchangeManyFramesWithoutLoss) {
  constexpr unsigned kFrames = 20'000;
  Pair pair;
  std::thread echo([&] {
    for (unsigned i = 0; i < kFrames; ++i) {
      ASSERT_TRUE(pair.second().send(receive(pair.second(), SimDuration::max())));
    }
  });
  for (unsigned i = 0; i < kFrames; ++i) {
    ASSERT_TRUE(pair.first().send(make_frame(60, i)));
    ASSERT_EQ(receive(pair.first(), SimDuration::max()), make_frame(60, i)) << "frame " << i;
  }
  echo.join();
}

}  // namespace
}  // namespace stator::link
