// Slaves that are plugged, unplugged, switched off and on while the segment runs.

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

unsigned reachable(TestBus& bus) {
  return bus.broadcast_read(0x0000, 1).working_counter;
}

/// A junction, a fixed slave behind its port 1 and a group of two that can be plugged into port 2.
class Group : public ::testing::Test {
 protected:
  Group() : bus(0) {
    SlaveControllerConfiguration junction;
    junction.port_descriptor = 0x3F;
    bus.add(junction);
    bus.add({});
    bus.add_unconnected();
    bus.add_unconnected();
    bus.segment().connect(SlavePort{2, 1}, SlavePort{3, 0});
    bus.segment().connect(SlavePort{0, 2}, SlavePort{2, 0});
    bus.segment().set_cable({2, 0}, false);
  }
  TestBus bus;
};

TEST_F(Group, Plugging_TellsTheMasterByTheEventOfTheJunction) {
  bus.write(0, 0x0200, bytes({0x04, 0x00}));
  bus.read(0, 0x0110, 2);
  EXPECT_EQ(reachable(bus), 2U);
  bus.segment().set_cable({2, 0}, true);
  EXPECT_EQ(bus.broadcast_read(0x0000, 1).interrupt & 0x04U, 0x04U);
  EXPECT_EQ(reachable(bus), 4U);
}

TEST_F(Group, UnpluggedAndPluggedAgain_KeepsItsStateAndTheOthersRunOn) {
  bus.segment().set_cable({2, 0}, true);
  for (std::uint16_t i = 0; i < 4; ++i) {
    bus.write(i, 0x0010, bytes({1U + i, 0x10}));
  }
  bus.segment().set_cable({0, 2}, false);
  EXPECT_EQ(reachable(bus), 2U);
  EXPECT_EQ(bus.transfer(Command::fprd, physical_address(0x1002, 0), zeros(1)).working_counter, 1U);
  EXPECT_EQ(bus.transfer(Command::fprd, physical_address(0x1004, 0), zeros(1)).working_counter, 0U);
  bus.segment().set_cable({0, 2}, true);
  EXPECT_EQ(bus.transfer(Command::fprd, physical_address(0x1004, 0), zeros(1)).working_counter, 1U)
      << "it had power all the time";
}

TEST_F(Group, CableHealedAtEitherEnd_IsWholeAgain) {
  bus.segment().set_cable({2, 0}, true);
  bus.segment().set_cable({0, 2}, false);
  bus.segment().set_cable({2, 0}, true);
  EXPECT_EQ(reachable(bus), 4U);
}

TEST(PowerCycle, SlaveOff_TakesAwayThoseBehindItAndTheLinkBeforeIt) {
  TestBus bus(3);
  bus.segment().set_power(1, false);
  EXPECT_FALSE(bus.segment().powered(1));
  EXPECT_EQ(reachable(bus), 1U);
  EXPECT_EQ(number(bus.read(0, 0x0110, 2).data), 0x5613U);
  EXPECT_EQ(number(bus.read(0, 0x0311, 1).data), 1U);
  EXPECT_FALSE(bus.slave(2).link(0));
  bus.segment().set_power(1, true);
  EXPECT_EQ(reachable(bus), 3U);
}

TEST(PowerCycle, SlaveOn_StartsAsAfterAReset) {
  TestBus bus(2);
  bus.write(0, 0x0010, bytes({0x34, 0x12}));
  bus.write(0, 0x1000, bytes({0xAB}));
  bus.write(0, 0x0101, bytes({0x0C}));
  bus.segment().set_power(0, false);
  EXPECT_FALSE(bus.broadcast_read(0x0000, 1).returned);
  EXPECT_FALSE(bus.slave(0).take_reset_request());
  bus.segment().set_power(0, true);
  EXPECT_EQ(number(bus.read(0, 0x0010, 2).data), 0U);
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 0U);
  EXPECT_EQ(number(bus.read(0, 0x0130, 2).data), 1U) << "INIT";
  EXPECT_EQ(number(bus.read(0, 0x0300, 20).data), 0U);
  EXPECT_EQ(number(bus.read(0, 0x0110, 2).data), 0x5A33U) << "links and loops as wired";
  EXPECT_TRUE(bus.slave(0).take_reset_request()) << "the firmware starts again too";
  EXPECT_EQ(reachable(bus), 2U);
}

TEST(PowerCycle, LocalClock_StartsFromZero) {
  TestBus bus(1);
  bus.wait(SimDuration(5'000'000'000));
  bus.segment().set_power(0, false);
  bus.wait(SimDuration(1'000'000'000));
  bus.segment().set_power(0, true);
  EXPECT_LT(number(bus.read(0, 0x0910, 8).data), 1'000'000U);
}

TEST(PowerCycle, BrokenCableStaysBroken) {
  TestBus bus(2);
  bus.segment().set_link(1, false);
  bus.segment().set_power(1, false);
  bus.segment().set_power(1, true);
  EXPECT_EQ(reachable(bus), 1U);
}

TEST(HotConnect, NewSlaveIsReachedFromTheNextFrameOn) {
  TestBus bus(1);
  const std::size_t added = bus.add_unconnected();
  EXPECT_EQ(reachable(bus), 1U);
  bus.segment().connect(SlavePort{0, 1}, SlavePort{added, 0});
  EXPECT_EQ(reachable(bus), 2U);
}

}  // namespace
}  // namespace stator::ethercat
