// A ring: the master's primary interface at port 0 of the first slave, its secondary one at port 1
// of the last.

#include <gtest/gtest.h>

#include "ethercat/master_delays.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::Answer;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr std::size_t kSlaves = 4;
constexpr std::uint32_t kLogical = 0x1000;

/// Four slaves with one byte of outputs and one of inputs each.
class Ring : public ::testing::Test {
 protected:
  Ring() : bus(0) {
    for (std::size_t i = 0; i < kSlaves; ++i) {
      bus.add({}, SimDuration(static_cast<std::int64_t>(20 + 10 * i)));
    }
    bus.segment().connect(MasterInterface::secondary, SlavePort{kSlaves - 1, 1}, SimDuration(70));
    for (std::uint16_t i = 0; i < kSlaves; ++i) {
      bus.set_sync_manager(i, 2, {0x1100, 1, 0x64});
      bus.set_sync_manager(i, 3, {0x1200, 1, 0x20});
      bus.set_fmmu(i, 0, {kLogical + i, 1, 0x1100, 2});
      bus.set_fmmu(i, 1, {kLogical + i, 1, 0x1200, 1});
    }
  }
  /// Cable 0 is the primary one, 1..3 lie between slaves, 4 is the secondary one.
  void set_cable(std::size_t cable, bool intact) {
    if (cable == kSlaves) {
      bus.segment().set_cable({kSlaves - 1, 1}, intact);
    } else {
      bus.segment().set_cable({cable, 0}, intact);
    }
  }
  Answer exchange(MasterInterface interface) {
    return bus.from(interface).transfer(Command::lrw, kLogical, zeros(kSlaves));
  }
  TestBus bus;
};

TEST_F(Ring, Whole_PrimaryFrameIsProcessedAndComesOutOnTheSecondary) {
  EXPECT_EQ(exchange(MasterInterface::primary).working_counter, 3 * kSlaves);
  EXPECT_EQ(bus.exit(), MasterInterface::secondary);
  EXPECT_EQ(number(bus.read(0, 0x0110, 2).data), 0x5A33U);
  EXPECT_EQ(number(bus.read(kSlaves - 1, 0x0110, 2).data), 0x5A33U);
}

TEST_F(Ring, Whole_SecondaryFramePassesUnprocessed) {
  const Answer answer =
      bus.from(MasterInterface::secondary).transfer(Command::bwr, 0x01010000, bytes({0xFF}));
  EXPECT_TRUE(answer.returned);
  EXPECT_EQ(bus.exit(), MasterInterface::primary);
  EXPECT_EQ(answer.working_counter, 0U);
  EXPECT_EQ(answer.address, 0x01010000U) << "positions are not counted";
  EXPECT_FALSE(answer.circulating);
  EXPECT_EQ(exchange(MasterInterface::primary).working_counter, 3 * kSlaves) << "nothing written";
}

TEST_F(Ring, BrokenAnywhere_HalvesTogetherCountAsTheWholeAndHealingRestoresIt) {
  for (std::size_t cable = 0; cable <= kSlaves; ++cable) {
    set_cable(cable, false);
    const Answer primary = exchange(MasterInterface::primary);
    const auto primary_exit = bus.exit();
    const Answer secondary = exchange(MasterInterface::secondary);
    const auto secondary_exit = bus.exit();
    EXPECT_EQ(primary.working_counter, 3 * cable) << "cable " << cable;
    EXPECT_EQ(secondary.working_counter, 3 * (kSlaves - cable)) << "cable " << cable;
    EXPECT_EQ(primary.returned, cable != 0);
    EXPECT_EQ(secondary.returned, cable != kSlaves);
    if (cable != 0) {
      EXPECT_EQ(primary_exit, MasterInterface::primary);
      EXPECT_FALSE(primary.circulating);
    }
    if (cable != kSlaves) {
      EXPECT_EQ(secondary_exit, MasterInterface::secondary);
      EXPECT_TRUE(secondary.circulating) << "it turned at a closed port 0";
    }
    set_cable(cable, true);
    EXPECT_EQ(exchange(MasterInterface::primary).working_counter, 3 * kSlaves);
    EXPECT_EQ(bus.exit(), MasterInterface::secondary);
  }
}

TEST_F(Ring, BrokenCable_IsSeenAtItsTwoPortsAndCountedThere) {
  set_cable(2, false);
  bus.from(MasterInterface::primary);
  EXPECT_EQ(number(bus.read(1, 0x0110, 2).data), 0x5613U);
  EXPECT_EQ(number(bus.read(1, 0x0310, 4).data), 0x00000100U);
  bus.from(MasterInterface::secondary);
  EXPECT_EQ(number(bus.read(0, 0x0110, 2).data), 0x5923U) << "third slave: first of this half";
  EXPECT_EQ(number(bus.read(0, 0x0310, 4).data), 0x00000001U);
  EXPECT_EQ(number(bus.read(1, 0x0310, 4).data), 0U);
}

TEST_F(Ring, PrimaryInterfaceOff_SecondaryFramesTurnAtTheFirstSlave) {
  bus.segment().set_carrier(MasterInterface::primary, false);
  EXPECT_FALSE(exchange(MasterInterface::primary).returned);
  EXPECT_EQ(exchange(MasterInterface::secondary).working_counter, 3 * kSlaves);
  EXPECT_EQ(bus.exit(), MasterInterface::secondary);
  EXPECT_EQ(number(bus.read(0, 0x0110, 2).data), 0x5923U);
  EXPECT_EQ(number(bus.read(0, 0x0310, 1).data), 1U) << "lost link at port 0";
  bus.segment().set_carrier(MasterInterface::primary, true);
  EXPECT_EQ(exchange(MasterInterface::primary).working_counter, 3 * kSlaves);
}

TEST_F(Ring, TwoBreaks_LeaveTheMiddleUnreached) {
  set_cable(1, false);
  set_cable(3, false);
  EXPECT_EQ(exchange(MasterInterface::primary).working_counter, 3U);
  EXPECT_EQ(exchange(MasterInterface::secondary).working_counter, 3U);
}

TEST_F(Ring, CirculatingFrame_IsDestroyedWherePortZeroHasNoLink) {
  set_cable(2, false);
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
  builder.append(Command::lrw, 0, kLogical, kSlaves);
  const std::span<std::byte> frame = builder.finish();
  frame[kFirstDatagramOffset + 7] |= std::byte{0x40};
  EXPECT_FALSE(bus.segment().process(frame, bus.now(), MasterInterface::secondary));
  EXPECT_EQ(bus.segment().statistics().destroyed, 1U);
  EXPECT_TRUE(bus.segment().process(frame, bus.now(), MasterInterface::primary))
      << "no slave of the other half looks for it";
}

TEST_F(Ring, CirculatingFrame_DoesNotReachTheProcessingUnit) {
  set_cable(2, false);
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
  builder.append(Command::bwr, 0, physical_address(0, 0x0010), bytes({0x34, 0x12}));
  const std::span<std::byte> frame = builder.finish();
  frame[kFirstDatagramOffset + 7] |= std::byte{0x40};
  EXPECT_FALSE(bus.segment().process(frame, bus.now(), MasterInterface::secondary));
  testing::Bytes address(2);
  bus.slave(2).peek(0x0010, address);
  EXPECT_EQ(address, zeros(2));
}

TEST_F(Ring, ManuallyClosedPortZeroWithLink_DoesNotLookForCirculatingFrames) {
  bus.write(2, 0x0101, bytes({0x03}));
  const Answer answer = exchange(MasterInterface::secondary);
  EXPECT_EQ(answer.working_counter, 6U);
  EXPECT_FALSE(answer.circulating);
}

TEST_F(Ring, SecondSlaveWithoutLinkAtPortZero_DestroysWhatTheFirstMarked) {
  // Two slaves wired the wrong way round, behind one another's port 3 and 1.
  TestBus odd(0);
  SlaveControllerConfiguration four_ports;
  four_ports.port_descriptor = 0xFF;
  const std::size_t first = odd.add_unconnected(four_ports);
  const std::size_t second = odd.add_unconnected(four_ports);
  odd.segment().connect(MasterInterface::primary, SlavePort{first, 1});
  EXPECT_EQ(odd.broadcast_read(0x0000, 1).working_counter, 1U);
  odd.segment().connect(SlavePort{first, 3}, SlavePort{second, 1});
  EXPECT_FALSE(odd.broadcast_read(0x0000, 1).returned);
  EXPECT_EQ(odd.segment().statistics().destroyed, 1U);
}

TEST_F(Ring, HalvesGiveAMasterTheTrueDelays) {
  set_cable(2, false);
  const testing::MasterDelays primary(testing::measure_delays(bus.from(MasterInterface::primary)));
  EXPECT_EQ(primary[1], 300U + 30U);

  // In the other half, frames come in at port 1 of the last slave, which is entered first but
  // passed last: the two are taken in the order of their cables.
  auto measured = testing::measure_delays(bus.from(MasterInterface::secondary));
  ASSERT_EQ(measured.size(), 2U);
  std::swap(measured[0], measured[1]);
  const testing::MasterDelays secondary(measured);
  EXPECT_EQ(secondary[1], 300U + 50U);
}

TEST_F(Ring, WholeRingDelays_AreThoseOfTheWayThroughAllSlaves) {
  // No port receives twice in a whole ring; each slave's time at port 0 tells the way itself.
  const auto measured = testing::measure_delays(bus.from(MasterInterface::primary));
  ASSERT_EQ(measured.size(), kSlaves);
  const std::uint32_t start = measured[0].receive_times[0];
  EXPECT_EQ(measured[1].receive_times[0] - start, 300U + 30U);
  EXPECT_EQ(measured[2].receive_times[0] - start, 600U + 70U);
  EXPECT_EQ(measured[3].receive_times[0] - start, 900U + 120U);
  EXPECT_EQ(measured[3].receive_times[1], 0U);
}

}  // namespace
}  // namespace stator::ethercat
