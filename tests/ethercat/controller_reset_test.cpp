// What a slave controller forgets at its reset, and what time does to it in between.

#include <array>

#include <gtest/gtest.h>

#include "ethercat/dc_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::literals::operator""_ms;
using testing::Bytes;
using testing::bytes;
using testing::number;
using testing::TestBus;
using testing::zeros;

TEST(ControllerReset, EndsTheUseOfTheAlias) {
  TestBus bus;
  bus.slave().load_sii(testing::valid_sii(0x1234));
  const auto by_alias = [&] {
    return bus.transfer(Command::fprd, physical_address(0x1234, 0x0000), zeros(1)).working_counter;
  };
  bus.write(0, 0x0103, bytes({1}));
  ASSERT_EQ(by_alias(), 1U);
  bus.slave().power_on_reset();
  EXPECT_EQ(number(bus.read(0, 0x0012, 2).data), 0x1234U) << "from the EEPROM again";
  EXPECT_EQ(by_alias(), 0U) << "until DL control says so";
}

TEST(ControllerReset, StopsTheProcessDataWatchdog) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {0x1100, 2, 0x64});
  bus.write(0, 0x1100, bytes({1, 2}));
  bus.wait(50_ms);
  bus.slave().power_on_reset();
  bus.wait(500_ms);
  EXPECT_EQ(number(bus.read(0, 0x0442, 1).data), 0U) << "nothing expires that was not triggered";
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kProcessDataWatchdog, 0U);
}

TEST(ControllerReset, OpensThePortsThatTheMasterHadClosed) {
  TestBus bus(2);
  bus.write(0, 0x0101, bytes({0x0C}));  // port 1 closed
  ASSERT_EQ(bus.broadcast_read(0x0000, 1).working_counter, 1U);
  bus.slave().power_on_reset();
  EXPECT_EQ(bus.broadcast_read(0x0000, 1).working_counter, 2U);
}

TEST(ControllerReset, KeysOfBusAndHostAreCountedApart) {
  TestBus bus;
  bus.write(0, 0x0040, bytes({'R'}));
  bus.write(0, 0x0040, bytes({'E'}));
  testing::host_write(bus.slave(), 0x0041, bytes({'R'}));
  EXPECT_EQ(number(testing::host_read(bus.slave(), 0x0041, 1)), 1U) << "the first of its own three";
}

TEST(ControllerTime, DoesNotGoBack) {
  SlaveController slave{SlaveControllerConfiguration{}};
  slave.advance(base::SimTime() + 10_ms);
  slave.advance(base::SimTime() + 4_ms);
  EXPECT_EQ(slave.now(), base::SimTime() + 10_ms);
}

TEST(ControllerTime, WhatIsDueWhenAFrameComesHasHappenedBeforeIt) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {0x1100, 2, 0x64});
  bus.write(0, 0x1100, bytes({1, 2}));
  const base::SimTime due = bus.slave().next_deadline();
  // A frame leaves 10 us after the bus was told to send it, and 10 ns of cable lie before the
  // slave.
  bus.wait(due - bus.now() - SimDuration(10'010));
  EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 0U);
  EXPECT_EQ(bus.slave().now(), due) << "the frame came at that very moment";
}

TEST(ControllerMemory, BeyondItsEndPeeksAsZero) {
  TestBus bus;
  bus.write(0, 0x4FFF, bytes({0x5A}));
  std::array<std::byte, 4> seen{};
  seen.fill(std::byte{0xEE});
  bus.slave().peek(0x4FFF, seen);
  EXPECT_EQ(Bytes(seen.begin(), seen.end()), bytes({0x5A, 0, 0, 0}));
  seen.fill(std::byte{0xEE});
  bus.slave().peek(0x8000, seen);
  EXPECT_EQ(Bytes(seen.begin(), seen.end()), zeros(4));
}

TEST(ControllerConfiguration, LoadedAnewActsOnPulsesFromThenOnOnly) {
  testing::DcBus bus;
  const std::uint64_t start = bus.system_time() + 1'000'000;
  bus.start_sync(start, 1'000'000);
  bus.wait_until(start + 2'500'000);  // three pulses that nobody has asked about
  bus.slave().load_sii(testing::dc_sii({.sync_latch = 0x6E, .pulse_length = 0}));
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kDcSync0, 0U)
      << "those came while SYNC0 was not mapped";
  EXPECT_EQ(bus.slave().sync_pulse_count(0), 3U);
}

TEST(ControllerConfiguration, TellsWhetherTheHostAcknowledgesByWriting) {
  for (const bool by_write : {false, true}) {
    SlaveControllerConfiguration chip;
    chip.acknowledge_by_write = by_write;
    TestBus bus(1, chip);
    EXPECT_EQ(number(bus.read(0, 0x014E, 1).data), by_write ? 0x07U : 0x06U);
  }
}

TEST(LockedAlControl, IsToldAndNoOtherRefusedWriteIs) {
  class Log final : public base::EventSink {
   public:
    void on_event(const base::Event& /*event*/) override { ++count; }
    int count = 0;
  } log;
  TestBus bus;
  static_cast<void>(testing::host_read(bus.slave(), 0x0130, 2));  // there is firmware
  bus.slave().set_event_reporter(base::EventReporter(&log, 0));
  EXPECT_EQ(bus.write(0, 0x0000, bytes({1, 2})).working_counter, 0U) << "the type is read-only";
  EXPECT_EQ(log.count, 0);
  EXPECT_EQ(bus.write(0, 0x0120, bytes({2, 0})).working_counter, 1U);
  EXPECT_EQ(log.count, 0) << "taken";
  EXPECT_EQ(bus.write(0, 0x0120, bytes({4, 0})).working_counter, 0U)
      << "the host has not read the first one";
  EXPECT_EQ(log.count, 1);
}

}  // namespace
}  // namespace stator::ethercat
