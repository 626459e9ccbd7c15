#include "ethercat/distributed_clock.hpp"

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::Answer;
using testing::bytes;
using testing::little_endian;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr SimDuration kCables[] = {SimDuration(50), SimDuration(120), SimDuration(35)};

class ThreeClocks : public ::testing::Test {
 protected:
  ThreeClocks() : bus(0) {
    for (const SimDuration cable : kCables) {
      bus.add({}, cable);
    }
  }
  std::uint32_t receive_time(std::uint16_t slave, unsigned port) {
    return static_cast<std::uint32_t>(
        number(bus.read(slave, static_cast<std::uint16_t>(0x0900 + 4 * port), 4).data));
  }
  TestBus bus;
};

TEST_F(ThreeClocks, ReceiveTimes_GiveAMasterTheTrueDelays) {
  EXPECT_EQ(bus.broadcast_write(0x0900, zeros(4)).working_counter, 3U);
  // Half of what a slave waits for the answer of those behind it, less what they wait themselves.
  const auto waits = [&](std::uint16_t slave) {
    return receive_time(slave, 1) - receive_time(slave, 0);
  };
  const std::uint32_t delay1 = (waits(0) - waits(1)) / 2;
  const std::uint32_t delay2 = delay1 + waits(1) / 2;
  EXPECT_EQ(delay1, 300U + 120U);
  EXPECT_EQ(delay2, 2 * 300U + 120U + 35U);
}

TEST_F(ThreeClocks, ProcessingUnitTime_EqualsPortZeroAsAWhole64BitTime) {
  bus.wait(SimDuration(6'000'000'000));
  bus.broadcast_write(0x0900, zeros(1));
  const std::uint64_t time = number(bus.read(1, 0x0918, 8).data);
  EXPECT_EQ(static_cast<std::uint32_t>(time), receive_time(1, 0));
  EXPECT_GT(time, 6'000'000'000U);
}

TEST_F(ThreeClocks, LatchedTimes_AreNotYetVisibleInTheSameFrame) {
  bus.broadcast_write(0x0900, zeros(4));
  const std::uint64_t before = receive_time(0, 0);
  bus.with(Command::bwr, physical_address(0, 0x0900), zeros(4))
      .with(Command::aprd, physical_address(0, 0x0900), zeros(4));
  EXPECT_EQ(number(bus.send()[1].data), before);
  EXPECT_GT(receive_time(0, 0), before);
}

TEST(DistributedClock, LatchingCountsOnlySlavesThatHaveAClock) {
  TestBus bus(1);
  SlaveControllerConfiguration without;
  without.features = ControllerFeature::user_ram;
  bus.add(without);
  EXPECT_EQ(bus.broadcast_write(0x0900, zeros(4)).working_counter, 1U);
  EXPECT_EQ(bus.read(1, 0x0910, 8).working_counter, 0U);
  EXPECT_EQ(number(bus.read(1, 0x0008, 2).data) & 0x0CU, 0U);
}

TEST_F(ThreeClocks, OffsetAndDelay_MakeAllSystemTimesEqualAtTheReference) {
  const std::uint64_t epoch = 800'000'000'000'000'000;
  const std::uint32_t delays[] = {0, 420, 755};
  for (std::uint16_t i = 0; i < 3; ++i) {
    // 0x0920 (64 bit) and 0x0928 (32 bit) in one datagram, as IgH writes them.
    testing::Bytes settings = little_endian(epoch, 8);
    const testing::Bytes delay = little_endian(delays[i], 4);
    settings.insert(settings.end(), delay.begin(), delay.end());
    EXPECT_EQ(bus.write(i, 0x0920, settings).working_counter, 1U);
  }
  for (std::uint16_t i = 0; i < 3; ++i) {
    bus.with(Command::aprd, physical_address(auto_increment_address(i), 0x0910), zeros(8));
  }
  const auto answers = bus.send();
  EXPECT_EQ(number(answers[1].data), number(answers[0].data))
      << "the time at which this frame passed the reference";
  EXPECT_EQ(number(answers[2].data), number(answers[0].data));
}

TEST_F(ThreeClocks, Frmw_CarriesTheReferenceTimeAndShowsTheDifference) {
  bus.write(0, 0x0010, bytes({0x01, 0x10}));
  bus.write(1, 0x0920, little_endian(5'000, 8));
  bus.write(1, 0x0928, little_endian(420, 4));
  bus.broadcast_write(0x0930, bytes({0x00, 0x10}));
  const Answer answer = bus.transfer(Command::frmw, physical_address(0x1001, 0x0910), zeros(8));
  EXPECT_EQ(answer.working_counter, 3U);
  EXPECT_GT(number(answer.data), 0U);
  const std::uint64_t ahead = number(bus.read(1, 0x092C, 4).data);
  EXPECT_NEAR(static_cast<double>(ahead), 5'000.0, 50.0) << "local ahead: sign bit 0";
  EXPECT_EQ(number(bus.read(0, 0x092C, 4).data), 0U) << "the reference itself is only read";
  bus.write(1, 0x0920, little_endian(static_cast<std::uint64_t>(-5'000), 8));
  bus.broadcast_write(0x0930, bytes({0x00, 0x10}));
  EXPECT_EQ(number(bus.read(1, 0x092C, 4).data), 0U) << "0x0930 resets the difference";
  bus.transfer(Command::frmw, physical_address(0x1001, 0x0910), zeros(4));
  const std::uint64_t behind = number(bus.read(1, 0x092C, 4).data);
  EXPECT_EQ(behind & 0x80000000U, 0x80000000U) << "local behind: sign bit 1";
  EXPECT_NEAR(static_cast<double>(behind & 0x7FFFFFFFU), 5'000.0, 100.0);
}

TEST(DistributedClock, ControlLoop_PullsADriftingClockIn) {
  TestBus bus(1);
  SlaveControllerConfiguration fast;
  fast.clock_deviation_ppb = 50'000;
  bus.add(fast);
  bus.write(0, 0x0010, bytes({0x01, 0x10}));
  bus.write(1, 0x0928, little_endian(310, 4));
  std::uint64_t magnitude = 0;
  for (int cycle = 0; cycle < 3'000; ++cycle) {
    bus.wait(SimDuration(990'000));
    bus.transfer(Command::armw, physical_address(0, 0x0910), zeros(4));
    magnitude = number(bus.read(1, 0x092C, 4).data) & 0x7FFFFFFFU;
  }
  EXPECT_LE(magnitude, 100U) << "ns after 3 s";
}

TEST(DistributedClock, HostReadsSystemTimeOfItsOwnAccess) {
  TestBus bus(1);
  bus.write(0, 0x0928, little_endian(1'000, 4));
  bus.wait(SimDuration(1'000'000));
  EXPECT_EQ(number(testing::host_read(bus.slave(), 0x0910, 8)),
            static_cast<std::uint64_t>(bus.now().nanoseconds()));
}

}  // namespace
}  // namespace stator::ethercat
