// Latch inputs of distributed clocks and event times of buffers, with their events and
// acknowledgements.
#include "stator/ethercat/units/latch_unit.hpp"

#include <gtest/gtest.h>

#include "ethercat/dc_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::DcBus;
using testing::host_read;
using testing::number;
using testing::zeros;

constexpr std::uint16_t kStatus0 = 0x09AE;
constexpr std::uint16_t kStatus1 = 0x09AF;
constexpr std::uint16_t kRising0 = 0x09B0;
constexpr std::uint16_t kFalling0 = 0x09B8;
constexpr std::uint16_t kRising1 = 0x09C0;
constexpr std::uint16_t kFalling1 = 0x09C8;

class LatchInputs : public ::testing::Test {
 protected:
  LatchInputs() { bus.set(0x0920, 0x1'FFFF'F000'0000, 8); }

  /// Sets the level a little later; the system time of that moment.
  std::uint64_t set_input(unsigned input, bool level) {
    bus.wait(SimDuration(123'456));
    bus.slave().set_latch_input(input, level);
    return bus.system_time();
  }
  std::uint64_t host_get(std::uint16_t address, std::size_t length) {
    return number(host_read(bus.slave(), address, length));
  }
  /// 0x0210 bit 0, as a frame shows it.
  bool bus_event() { return (bus.get(0x0210, 2) & 1U) != 0; }
  bool host_event() { return (bus.slave().al_event_request() & al_event::kDcLatch) != 0; }

  DcBus bus;
};

TEST_F(LatchInputs, KeepTheSystemTimeOfEachEdgeOfEachInput) {
  const std::uint64_t rising0 = set_input(0, true);
  const std::uint64_t rising1 = set_input(1, true);
  const std::uint64_t falling1 = set_input(1, false);
  const std::uint64_t falling0 = set_input(0, false);
  EXPECT_EQ(bus.get(kRising0, 8), rising0);
  EXPECT_EQ(bus.get(kFalling0, 8), falling0);
  EXPECT_EQ(bus.get(kRising1, 8), rising1);
  EXPECT_EQ(bus.get(kFalling1, 8), falling1);
  EXPECT_EQ(host_get(kRising0, 8), rising0);
}

TEST_F(LatchInputs, ContinuousMode_KeepsTheLatestEdgeAndShowsNoFlag) {
  set_input(0, true);
  set_input(0, false);
  const std::uint64_t latest = set_input(0, true);
  EXPECT_EQ(bus.get(kStatus0, 1), 0x04U) << "only the pin";
  EXPECT_EQ(bus.get(kRising0, 8), latest);
}

TEST_F(LatchInputs, SingleEventMode_KeepsTheFirstEdgeUntilItsTimeIsRead) {
  bus.set(0x09A8, 0x01, 1);
  const std::uint64_t first = set_input(0, true);
  set_input(0, false);
  const std::uint64_t falling = bus.get(kFalling0, 8);
  set_input(0, true);
  EXPECT_EQ(bus.get(kStatus0, 1), 0x05U);
  EXPECT_EQ(bus.get(kFalling0, 8), falling) << "another edge's time does not clear it";
  EXPECT_EQ(bus.get(kStatus0, 1), 0x05U);
  EXPECT_EQ(bus.get(kRising0, 8), first);
  EXPECT_EQ(bus.get(kStatus0, 1), 0x04U);
  set_input(0, false);
  const std::uint64_t next = set_input(0, true);
  EXPECT_EQ(bus.get(kRising0, 8), next);
}

TEST_F(LatchInputs, EachEdgeHasItsOwnFlag) {
  bus.set(0x09A8, 0x03, 1);
  bus.set(0x09A9, 0x03, 1);
  for (const unsigned input : {0U, 1U}) {
    set_input(input, true);
    set_input(input, false);
  }
  EXPECT_EQ(bus.get(kStatus0, 2), 0x0303U);
  bus.get(kFalling1, 8);
  EXPECT_EQ(bus.get(kStatus1, 1), 0x01U);
  bus.get(kRising1, 8);
  EXPECT_EQ(bus.get(kStatus0, 2), 0x0003U);
}

TEST_F(LatchInputs, ControlOnlyTakesItsTwoBits) {
  bus.set(0x09A8, 0xFFFF, 2);
  EXPECT_EQ(bus.get(0x09A8, 2), 0x0303U);
}

TEST_F(LatchInputs, ControlIsWrittenByTheControllingSideOnly) {
  testing::host_write(bus.slave(), 0x09A8, testing::bytes({3, 3}));
  EXPECT_EQ(bus.get(0x09A8, 2), 0U);
  bus.set(0x0980, 0x20, 1);
  EXPECT_EQ(bus.set(0x09A9, 3, 1), 0U);
  EXPECT_EQ(bus.set(0x09A8, 1, 1), 1U);
  testing::host_write(bus.slave(), 0x09A8, testing::bytes({3, 2}));
  EXPECT_EQ(bus.get(0x09A8, 2), 0x0201U);
}

TEST_F(LatchInputs, EdgesOfABusControlledUnitRaiseTheEcatEvent) {
  bus.set(0x0200, 0x0001, 2);
  set_input(0, true);
  EXPECT_TRUE(bus_event());
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0x0001U) << "in the IRQ field, by the mask";
  EXPECT_FALSE(host_event());
  host_get(kRising0, 8);
  EXPECT_TRUE(bus_event()) << "the host does not control the unit";
  bus.get(kRising0, 8);
  EXPECT_FALSE(bus_event());
}

TEST_F(LatchInputs, EcatEventStaysUntilNoFlagIsLeft) {
  bus.set(0x09A8, 0x03, 1);
  set_input(0, true);
  set_input(0, false);
  bus.get(kRising0, 8);
  EXPECT_TRUE(bus_event());
  bus.get(kFalling0, 8);
  EXPECT_FALSE(bus_event());
}

TEST_F(LatchInputs, EdgesOfAHostControlledUnitRaiseTheAlEvent) {
  bus.set(0x0980, 0x10, 1);
  testing::host_write(bus.slave(), 0x09A8, testing::bytes({1}));
  set_input(0, true);
  EXPECT_TRUE(host_event());
  EXPECT_FALSE(bus_event());
  bus.get(kRising0, 8);
  EXPECT_TRUE(host_event()) << "the bus does not control the unit";
  EXPECT_EQ(host_get(kStatus0, 1), 0x05U);
  host_get(kRising0, 8);
  EXPECT_FALSE(host_event());
  EXPECT_EQ(host_get(kStatus0, 1), 0x04U);
  set_input(1, true);
  EXPECT_TRUE(bus_event()) << "unit 1 is still the bus's";
}

TEST_F(LatchInputs, InAcknowledgeByWriteModeTheHostWritesToAcknowledge) {
  SlaveControllerConfiguration chip;
  chip.acknowledge_by_write = true;
  DcBus written({}, chip);
  written.set(0x0980, 0x10, 1);
  written.slave().set_latch_input(0, true);
  const auto event = [&] { return (written.slave().al_event_request() & al_event::kDcLatch) != 0; };
  const std::uint64_t time = number(host_read(written.slave(), kRising0, 8));
  EXPECT_TRUE(event());
  testing::host_write(written.slave(), kRising0, zeros(8));
  EXPECT_FALSE(event());
  EXPECT_EQ(number(host_read(written.slave(), kRising0, 8)), time) << "nothing is stored";
}

TEST_F(LatchInputs, NeitherSideWritesTimes) {
  const std::uint64_t time = set_input(0, true);
  EXPECT_EQ(bus.set(kRising0, 0, 8), 0U);
  testing::host_write(bus.slave(), kRising0, zeros(8));
  EXPECT_EQ(bus.get(kRising0, 8), time);
}

TEST_F(LatchInputs, ReadingTheLowestByteFreezesTheOthersForThatSideAlone) {
  const std::uint64_t first = set_input(0, true);
  ASSERT_NE(first >> 8 & 0xFF, 0U);
  EXPECT_EQ(bus.get(kRising0, 1), first & 0xFF);
  set_input(0, false);
  bus.wait(SimDuration(9'000'000'000));
  const std::uint64_t second = set_input(0, true);
  EXPECT_EQ(bus.get(kRising0 + 1, 7), first >> 8) << "the bus has begun to read the first time";
  EXPECT_EQ(host_get(kRising0, 4), second & 0xFFFFFFFF);
  EXPECT_EQ(host_get(kRising0 + 4, 4), second >> 32);
  EXPECT_EQ(bus.get(kRising0, 8), second);
}

TEST_F(LatchInputs, SwitchedOffByTheEepromShowThePinAndLatchNothing) {
  DcBus off({.esc_configuration = 0x04});
  off.wait(SimDuration(1'000));
  off.slave().set_latch_input(1, true);
  EXPECT_EQ(off.get(kStatus1, 1), 0x04U);
  EXPECT_EQ(off.get(kRising1, 8), 0U);
}

TEST_F(LatchInputs, ResetForgetsTimesAndKeepsThePins) {
  set_input(0, true);
  bus.slave().power_on_reset();
  EXPECT_EQ(bus.get(kStatus0, 1), 0x04U);
  EXPECT_EQ(bus.get(kRising0, 8), 0U);
  EXPECT_FALSE(bus_event());
}

class BufferEventTimes : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kBusChange = 0x09F0;
  static constexpr std::uint16_t kHostStart = 0x09F8;
  static constexpr std::uint16_t kHostChange = 0x09FC;

  /// A buffered sync manager the bus writes, with time stamps as `activate` says.
  void configure(std::uint8_t activate) {
    bus.set_sync_manager(0, 2, {0x1100, 8, 0x24, activate});
    bus.wait(SimDuration(5'000));
  }
  std::uint64_t local_time() { return static_cast<std::uint64_t>(bus.now().nanoseconds()); }

  DcBus bus;
};

TEST_F(BufferEventTimes, OfTheBusIsTheStartOfTheFrameThatCompletedTheBuffer) {
  bus.set(0x0920, 1'000'000'000, 8);
  configure(0x41);
  bus.write(0, 0x1100, zeros(7));
  EXPECT_EQ(bus.get(kBusChange, 4), 0U);
  bus.write(0, 0x1107, zeros(1));
  const std::uint64_t completed = local_time() + 10;  // cable
  EXPECT_EQ(bus.get(kBusChange, 4), completed) << "local time, no offset";
  host_read(bus.slave(), 0x1100, 8);
  EXPECT_EQ(bus.get(kHostStart, 8), 0U) << "bit 7 is not set";
}

TEST_F(BufferEventTimes, OfTheBusIsTakenForLogicalAccessToo) {
  configure(0x41);
  bus.set_fmmu(0, 0, {0x10000, 8, 0x1100, 2});
  bus.transfer(Command::lwr, 0x10000, zeros(8));
  const std::uint64_t completed = local_time() + 10;
  EXPECT_EQ(bus.get(kBusChange, 4), completed);
}

TEST_F(BufferEventTimes, AreSwitchedOnAndOffWhileTheSyncManagerRuns) {
  configure(0x01);
  bus.set_fmmu(0, 0, {0x10000, 8, 0x1100, 2});
  bus.transfer(Command::lwr, 0x10000, zeros(8));
  EXPECT_EQ(bus.get(kBusChange, 4), 0U);
  bus.set(0x0816, 0x41, 1);
  bus.transfer(Command::lwr, 0x10000, zeros(8));
  const std::uint64_t stamped = bus.get(kBusChange, 4);
  EXPECT_NE(stamped, 0U);
  bus.set(0x0816, 0x01, 1);
  bus.transfer(Command::lwr, 0x10000, zeros(8));
  EXPECT_EQ(bus.get(kBusChange, 4), stamped);
}

TEST_F(BufferEventTimes, OfTheHostAreThoseOfItsFirstAndLastByte) {
  configure(0x81);
  bus.write(0, 0x1100, zeros(8));
  EXPECT_EQ(bus.get(kBusChange, 4), 0U) << "bit 6 is not set";
  bus.wait(SimDuration(5'000));
  const std::uint64_t started = local_time();
  host_read(bus.slave(), 0x1100, 4);
  bus.wait(SimDuration(5'000));
  const std::uint64_t changed = local_time();
  host_read(bus.slave(), 0x1104, 4);
  EXPECT_EQ(bus.get(kHostStart, 4), started);
  EXPECT_EQ(bus.get(kHostChange, 4), changed);
}

TEST_F(BufferEventTimes, AreFrozenByReadingTheLowestByte) {
  configure(0xC1);
  bus.wait(SimDuration(1'000'000));
  bus.write(0, 0x1100, zeros(8));
  const std::uint64_t first = local_time() + 10;
  EXPECT_EQ(bus.get(kBusChange, 1), first & 0xFF);
  bus.wait(SimDuration(70'000));
  bus.write(0, 0x1100, zeros(8));
  const std::uint64_t second = local_time() + 10;
  EXPECT_EQ(bus.get(kBusChange + 1, 3), first >> 8);
  EXPECT_EQ(number(host_read(bus.slave(), kBusChange, 4)), second);
}

TEST_F(BufferEventTimes, DoNotExistWithoutTheirFeature) {
  SlaveControllerConfiguration chip;
  chip.features = ControllerFeature::distributed_clocks;
  DcBus without({}, chip);
  EXPECT_EQ(without.read(0, kBusChange, 4).working_counter, 0U);
}

}  // namespace
}  // namespace stator::ethercat
