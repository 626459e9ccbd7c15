// Frames that get lost or broken on a cable on demand.

#include <stdexcept>

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::bytes;
using testing::number;
using testing::TestBus;

unsigned counter(TestBus& bus, std::uint16_t slave, std::uint16_t address) {
  return static_cast<unsigned>(number(bus.read(slave, address, 1).data));
}
/// Writes a word into the memory of all slaves; false: the frame did not come back.
bool broadcast(TestBus& bus, std::uint8_t value) {
  bus.with(Command::bwr, physical_address(0, 0x0010), bytes({value, 0}));
  return bus.send().front().returned;
}
unsigned word(TestBus& bus, std::uint16_t slave) {
  return static_cast<unsigned>(number(bus.read(slave, 0x0010, 2).data));
}

TEST(FrameFault, DroppedFrameIsProcessedByThoseBeforeAndCountedNowhere) {
  TestBus bus(3);
  bus.segment().inject({FrameFaultKind::drop, {1, 0}, false, 1});
  EXPECT_FALSE(broadcast(bus, 0x44));
  EXPECT_EQ(bus.segment().statistics().dropped, 1U);
  EXPECT_EQ(bus.segment().statistics().corrupted, 0U);
  EXPECT_EQ(word(bus, 0), 0x44U);
  EXPECT_EQ(word(bus, 1), 0U);
  EXPECT_EQ(word(bus, 2), 0U);
  for (std::uint16_t slave = 0; slave < 3; ++slave) {
    for (std::uint16_t address = 0x0300; address < 0x030C; ++address) {
      EXPECT_EQ(counter(bus, slave, address), 0U) << slave << " " << address;
    }
  }
}

TEST(FrameFault, CorruptFrameIsCountedWhereItArrivesAndAsForwardedBehind) {
  TestBus bus(3);
  bus.segment().inject({FrameFaultKind::corrupt, {1, 0}, false, 1});
  EXPECT_FALSE(broadcast(bus, 0x55));
  EXPECT_EQ(bus.segment().statistics().corrupted, 1U);
  EXPECT_EQ(word(bus, 0), 0x55U);
  EXPECT_EQ(word(bus, 1), 0U);
  EXPECT_EQ(word(bus, 2), 0U);
  EXPECT_EQ(counter(bus, 1, 0x0300), 1U) << "wrong check sequence at port 0";
  EXPECT_EQ(counter(bus, 1, 0x0308), 0U);
  EXPECT_EQ(counter(bus, 2, 0x0300), 0U);
  EXPECT_EQ(counter(bus, 2, 0x0308), 1U) << "marked by the one before";
  EXPECT_EQ(counter(bus, 1, 0x0309), 1U) << "back at port 1";
  EXPECT_EQ(counter(bus, 0, 0x0309), 1U);
  EXPECT_EQ(counter(bus, 0, 0x0300), 0U) << "before the place";
}

TEST(FrameFault, OnTheWayBackAllHaveProcessedIt) {
  TestBus bus(2);
  bus.segment().inject({FrameFaultKind::corrupt, {0, 1}, false, 1});
  EXPECT_FALSE(broadcast(bus, 0x66));
  EXPECT_EQ(word(bus, 0), 0x66U);
  EXPECT_EQ(word(bus, 1), 0x66U);
  EXPECT_EQ(counter(bus, 0, 0x0302), 1U) << "wrong check sequence at port 1";
}

TEST(FrameFault, LeavingAPortIsArrivingAtTheOtherEndOfItsCable) {
  TestBus bus(2);
  bus.segment().inject({FrameFaultKind::corrupt, {0, 1}, true, 1});
  EXPECT_FALSE(broadcast(bus, 0x77));
  EXPECT_EQ(counter(bus, 1, 0x0300), 1U);
  bus.segment().inject({FrameFaultKind::corrupt, {0, 0}, true, 1});
  EXPECT_FALSE(broadcast(bus, 0x78)) << "the master's interface refuses it";
  EXPECT_EQ(word(bus, 1), 0x78U);
  EXPECT_EQ(counter(bus, 0, 0x0300), 0U);
  EXPECT_EQ(bus.segment().statistics().corrupted, 2U);
}

TEST(FrameFault, HitsAsManyFramesAsAskedForAndThenAllIsWell) {
  TestBus bus(2);
  bus.segment().inject({FrameFaultKind::drop, {0, 0}, false, 2});
  bus.segment().inject({FrameFaultKind::corrupt, {0, 0}, false, 1});
  EXPECT_FALSE(broadcast(bus, 1));
  EXPECT_FALSE(broadcast(bus, 2));
  EXPECT_FALSE(broadcast(bus, 3));
  EXPECT_TRUE(broadcast(bus, 4));
  EXPECT_EQ(bus.segment().statistics().dropped, 2U);
  EXPECT_EQ(bus.segment().statistics().corrupted, 1U);
  EXPECT_EQ(counter(bus, 0, 0x0300), 1U);
  EXPECT_EQ(word(bus, 1), 4U);
}

TEST(FrameFault, WaitsWhereNoFramePasses) {
  TestBus bus(2);
  bus.segment().set_link(1, false);
  bus.segment().inject({FrameFaultKind::drop, {1, 0}, false, 1});
  EXPECT_TRUE(broadcast(bus, 1));
  bus.segment().set_link(1, true);
  EXPECT_FALSE(broadcast(bus, 2));
  EXPECT_TRUE(broadcast(bus, 3));
}

TEST(FrameFault, PortWithoutACableIsAMistake) {
  TestBus bus(1);
  EXPECT_THROW(bus.segment().inject({FrameFaultKind::drop, {0, 1}, false, 1}), std::logic_error);
}

}  // namespace
}  // namespace stator::ethercat
