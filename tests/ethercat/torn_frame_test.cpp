// Receive FIFOs and clocks that drift apart.

#include <vector>

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::Answer;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

SlaveControllerConfiguration clock(std::int32_t deviation_ppb) {
  SlaveControllerConfiguration configuration;
  configuration.clock_deviation_ppb = deviation_ppb;
  return configuration;
}
/// A frame of 1514 bytes without check sequence that reads memory nobody maps; its first datagram
/// counts who processes it.
Answer long_frame(TestBus& bus) {
  bus.with(Command::brd, physical_address(0, 0), zeros(1))
      .with(Command::nop, 0, zeros(kMaximumDatagramData - 13));
  return bus.send().front();
}
unsigned counter(TestBus& bus, std::uint16_t slave, std::uint16_t address) {
  return static_cast<unsigned>(number(bus.read(slave, address, 1).data));
}

TEST(TornFrame, LimitsAreThoseOfTheDocumentForTheLongestFrame) {
  for (const auto& [size, accuracy_ppb] : {std::pair{7U, 100'000}, {0U, 25'000}}) {
    EXPECT_GE(longest_frame(size, 2 * accuracy_ppb), kMaximumFrameLength);
    EXPECT_GE(longest_frame(size, -2 * accuracy_ppb), kMaximumFrameLength);
    EXPECT_LT(longest_frame(size, 2 * accuracy_ppb + 1'000), kMaximumFrameLength);
    EXPECT_LT(longest_frame(size, -2 * accuracy_ppb - 1'000), kMaximumFrameLength);
  }
}

TEST(TornFrame, LimitIsInProportionToLengthAndSize) {
  EXPECT_EQ(longest_frame(7, 400'000), 761U - 4U) << "half as long at twice the difference";
  EXPECT_EQ(longest_frame(0, 100'000), 761U - 4U);
  for (unsigned size = 1; size < 8; ++size) {
    EXPECT_GT(longest_frame(size, 400'000), longest_frame(size - 1, 400'000));
  }
}

TEST(TornFrame, LongFramesGetLostWhereClocksDifferTooMuchAndAreCountedThere) {
  TestBus bus(1);
  bus.add(clock(250'000));
  bus.add({});
  const Answer answer = long_frame(bus);
  EXPECT_FALSE(answer.returned);
  EXPECT_EQ(bus.segment().statistics().torn, 1U);
  EXPECT_EQ(bus.broadcast_read(0x0000, 1).working_counter, 3U) << "a short one passes";
  EXPECT_EQ(counter(bus, 1, 0x0300), 1U) << "torn here";
  EXPECT_EQ(counter(bus, 1, 0x0308), 0U);
  EXPECT_EQ(counter(bus, 2, 0x0300), 0U);
  EXPECT_EQ(counter(bus, 2, 0x0308), 1U) << "marked by the one before";
  EXPECT_EQ(counter(bus, 0, 0x0300), 0U);
  EXPECT_EQ(counter(bus, 0, 0x0309), 1U) << "comes back marked";
}

TEST(TornFrame, SlavesBeforeTheTearHaveProcessedItThoseBehindHaveNot) {
  TestBus bus(1);
  bus.add(clock(-250'000));
  bus.with(Command::bwr, physical_address(0, 0x0010), bytes({0x44, 0x33}))
      .with(Command::nop, 0, zeros(kMaximumDatagramData - 14));
  EXPECT_FALSE(bus.send().front().returned);
  EXPECT_EQ(number(bus.read(0, 0x0010, 2).data), 0x3344U);
  EXPECT_EQ(number(bus.read(1, 0x0010, 2).data), 0U);
}

TEST(TornFrame, ClocksWithin100ppmPassTheLongestFrameAtSize7Only) {
  TestBus bus(0);
  bus.add(clock(100'000));
  bus.add(clock(-100'000));
  EXPECT_EQ(long_frame(bus).working_counter, 2U);
  bus.write(1, 0x0102, bytes({0x00}));
  EXPECT_FALSE(long_frame(bus).returned) << "size 0 needs 25 ppm";
  bus.write(1, 0x0102, bytes({0x07}));
  EXPECT_EQ(long_frame(bus).working_counter, 2U);
}

TEST(TornFrame, ClocksWithin25ppmPassItAtSize0) {
  TestBus bus(0);
  bus.add(clock(25'000));
  bus.add(clock(-25'000));
  bus.broadcast_write(0x0102, bytes({0x00}));
  EXPECT_EQ(long_frame(bus).working_counter, 2U);
}

}  // namespace
}  // namespace stator::ethercat
