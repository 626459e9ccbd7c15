// Receive times, offset, delay, drift and control loop of distributed clocks, over several slaves.
#include "stator/ethercat/units/distributed_clock.hpp"

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

TEST(DistributedClock, BroadcastsOfAnyLengthTo0900_CountTheClocksAndLatch) {
  TestBus bus(2);
  SlaveControllerConfiguration without;
  without.features = ControllerFeature::user_ram;
  bus.add(without);
  std::uint64_t before = 0;
  for (const std::size_t length : {1U, 4U, 8U}) {
    EXPECT_EQ(bus.broadcast_write(0x0900, zeros(length)).working_counter, 2U) << length;
    const std::uint64_t latched = number(bus.read(1, 0x0900, 4).data);
    EXPECT_GT(latched, before);
    before = latched;
  }
  EXPECT_EQ(number(bus.read(0, 0x0908, 8).data), 0U) << "ports that are not connected";
}

TEST(DistributedClock, SystemTimeIsTakenInFourAndEightBytes) {
  TestBus bus(1);
  for (const std::size_t length : {4U, 8U, 32U}) {
    bus.write(0, 0x0930, bytes({0, 0x10}));
    bus.write(0, 0x0920, little_endian(1'000'000, 8));
    testing::Bytes data = little_endian(static_cast<std::uint64_t>(bus.now().nanoseconds()), 8);
    data.resize(length);
    if (length == 32U) {  // as TwinCAT clears the whole group
      data.assign(32, std::byte{0});
    }
    EXPECT_EQ(bus.write(0, 0x0910, data).working_counter, 1U);
    if (length == 32U) {
      EXPECT_EQ(number(bus.read(0, 0x0920, 8).data), 0U);
    } else {
      EXPECT_NEAR(static_cast<double>(number(bus.read(0, 0x092C, 4).data)), 1'010'010.0, 50.0);
    }
  }
}

TEST(DistributedClock, SlewsADifferenceAwayAndNeverRunsBackwards) {
  TestBus bus(1);
  SlaveController& slave = bus.slave();
  bus.write(0, 0x0920, little_endian(200'000, 8));
  bus.write(0, 0x0930, bytes({0, 0x10}));
  bus.write(0, 0x0934, bytes({0, 0x0C}));
  std::uint64_t former = 0;
  for (int cycle = 0; cycle < 500; ++cycle) {
    const auto reference = static_cast<std::uint64_t>(bus.now().nanoseconds()) + 10'010;
    bus.write(0, 0x0910, little_endian(reference, 4));
    for (int step = 0; step < 10; ++step) {
      bus.wait(SimDuration(97'000));
      const std::uint64_t time = slave.system_time(bus.now());
      ASSERT_GT(time, former);
      ASSERT_GE(time - former, former == 0 ? 0U : 96'900U) << "0x1000 allows 762 ppm";
      former = time;
    }
  }
  EXPECT_NEAR(static_cast<double>(slave.system_time(bus.now())),
              static_cast<double>(bus.now().nanoseconds()), 2.0);
}

TEST(DistributedClock, SpeedCounterDifference_GivesTheDeviationByTheFormula) {
  for (const std::int32_t deviation : {20'000, -35'000}) {
    TestBus bus(1);
    SlaveControllerConfiguration off;
    off.clock_deviation_ppb = deviation;
    bus.add(off);
    bus.write(0, 0x0010, bytes({0x01, 0x10}));
    bus.write(1, 0x0928, little_endian(310, 4));
    bus.write(1, 0x0934, bytes({4, 8}));
    EXPECT_EQ(number(bus.read(1, 0x0932, 2).data), 0U);
    for (int cycle = 0; cycle < 6'000; ++cycle) {
      bus.wait(SimDuration(990'000));
      bus.transfer(Command::frmw, physical_address(0x1001, 0x0910), zeros(8));
    }
    const auto difference = static_cast<std::int16_t>(number(bus.read(1, 0x0932, 2).data));
    const double start = 0x1000;
    const double compensated =
        difference / (5.0 * (start + difference + 2) * (start - difference + 2)) * 1e9;
    // The rate of a fast clock is lowered: its period is shorter than the reference's.
    EXPECT_NEAR(compensated, -deviation, 300.0);
    bus.write(1, 0x0930, bytes({0, 0x10}));
    EXPECT_EQ(number(bus.read(1, 0x0932, 2).data), 0U) << "0x0930 resets it";
  }
}

TEST(DistributedClock, SpeedCounterDifference_StaysWithinItsRange) {
  SlaveControllerConfiguration off;
  off.clock_deviation_ppb = 2'000'000;  // more than the loop can do
  TestBus bus(1);
  bus.add(off);
  for (const unsigned start : {0x0080U, 0x0200U, 0x1000U}) {
    bus.write(1, 0x0930, little_endian(start, 2));
    bus.write(1, 0x0934, bytes({0, 0}));
    for (int cycle = 0; cycle < 50; ++cycle) {
      bus.wait(SimDuration(990'000));
      bus.transfer(Command::armw, physical_address(0, 0x0910), zeros(4));
    }
    const auto difference = static_cast<std::int16_t>(number(bus.read(1, 0x0932, 2).data));
    EXPECT_EQ(difference, -static_cast<int>(start - 0x7F));
  }
}

TEST(DistributedClock, FilterDepths_ResetWhatTheyFilterAndSmoothIt) {
  TestBus bus(1);
  const auto mean = [&] { return number(bus.read(0, 0x092C, 4).data); };
  const auto compare = [&](std::int64_t ahead) {
    const std::int64_t reference = bus.now().nanoseconds() + 10'010 - ahead;
    bus.write(0, 0x0910, little_endian(static_cast<std::uint64_t>(reference), 4));
  };
  bus.write(0, 0x0934, bytes({3}));
  compare(0);
  compare(8'000);
  EXPECT_NEAR(static_cast<double>(mean()), 1'000.0, 10.0) << "an eighth of the step";
  bus.write(0, 0x0934, bytes({0}));
  EXPECT_EQ(mean(), 0U);
  compare(8'000);
  EXPECT_NEAR(static_cast<double>(mean()), 8'000.0, 50.0) << "the first one counts whole";
  bus.write(0, 0x0935, bytes({0}));
  bus.wait(SimDuration(1'000'000));
  compare(9'000);
  EXPECT_NE(number(bus.read(0, 0x0932, 2).data), 0U);
  bus.write(0, 0x0935, bytes({12}));
  EXPECT_EQ(number(bus.read(0, 0x0932, 2).data), 0U);
}

TEST(DistributedClock, TheHostDoesNotWriteTimeRegisters) {
  TestBus bus(1);
  for (std::uint16_t address = 0x0900; address < 0x0936; ++address) {
    const auto before = bus.read(0, address, 1).data;
    testing::host_write(bus.slave(), address, bytes({0x5A}));
    if (address < 0x0910 || address >= 0x0918) {
      EXPECT_EQ(bus.read(0, address, 1).data, before) << std::hex << address;
    }
  }
  EXPECT_EQ(bus.slave().system_time(bus.now()),
            static_cast<std::uint64_t>(bus.now().nanoseconds()));
}

TEST(DistributedClock, SystemTimeReadInParts_BelongsToOneMoment) {
  TestBus bus(1);
  bus.write(0, 0x0920, little_endian(0x7'FFFF'0000, 8));
  const std::uint64_t low = number(bus.read(0, 0x0910, 4).data);
  const std::uint64_t host_low = number(testing::host_read(bus.slave(), 0x0910, 1));
  const std::uint64_t host_time = bus.slave().system_time(bus.slave().now());
  EXPECT_EQ(host_low, host_time & 0xFF);
  bus.wait(SimDuration(1'000'000'000));
  EXPECT_EQ(number(bus.read(0, 0x0914, 4).data), 7U);
  EXPECT_EQ(number(testing::host_read(bus.slave(), 0x0911, 7)), host_time >> 8);
  EXPECT_LT(low, 0xFFFFFFFFU);
  EXPECT_EQ(number(bus.read(0, 0x0910, 8).data) >> 32, 8U);
}

TEST(DistributedClock, FrmwBurstBeforePreOperational_SettlesEveryClock) {
  // 10,000 FRMW of eight bytes as ethercrab sends them.
  TestBus bus(0);
  for (const std::int32_t deviation : {0, 40'000, -25'000}) {
    SlaveControllerConfiguration chip;
    chip.clock_deviation_ppb = deviation;
    bus.add(chip);
  }
  bus.broadcast_write(0x0934, bytes({0, 0x0C}));
  bus.broadcast_write(0x0930, bytes({0, 0x10}));
  bus.write(0, 0x0010, bytes({0, 0x10}));
  bus.write(1, 0x0928, little_endian(310, 4));
  bus.write(2, 0x0928, little_endian(620, 4));
  for (int i = 0; i < 10'000; ++i) {
    bus.transfer(Command::frmw, physical_address(0x1000, 0x0910), zeros(8));
  }
  for (const std::uint16_t slave : {std::uint16_t{1}, std::uint16_t{2}}) {
    EXPECT_LE(number(bus.read(slave, 0x092C, 4).data) & 0x7FFFFFFFU, 10U);
    EXPECT_NEAR(static_cast<double>(bus.slave(slave).system_time(bus.now())),
                static_cast<double>(bus.slave(0).system_time(bus.now())), 10.0);
  }
  const auto all = number(bus.broadcast_read(0x092C, 4).data);
  EXPECT_LE(all & 0x7FFFFFFFU, 15U) << "IgH: the OR of all differences";
}

}  // namespace
}  // namespace stator::ethercat
