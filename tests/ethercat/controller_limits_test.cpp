// A slave controller at the limits of its rules: keys, frames with one side effect of several, and
// the last byte or the last moment to which something holds.

#include <gtest/gtest.h>

#include "ethercat/dc_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::literals::operator""_ms;
using testing::Bytes;
using testing::bytes;
using testing::DcBus;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

class Counter final : public base::EventSink {
 public:
  void on_event(const base::Event& /*event*/) override { ++count; }
  int count = 0;
};

class ResetOfABoard : public ::testing::Test {
 protected:
  static SlaveControllerConfiguration chip() {
    SlaveControllerConfiguration result;
    result.reset_by_board = true;
    return result;
  }
  void bus_key(std::initializer_list<unsigned> letters) {
    for (const unsigned letter : letters) {
      bus.write(0, 0x0040, bytes({letter}));
    }
  }
  void host_key(std::initializer_list<unsigned> letters) {
    for (const unsigned letter : letters) {
      host_write(bus.slave(), 0x0041, bytes({letter}));
    }
  }

  TestBus bus{1, chip()};
};

// Datasheet "ESC Reset": three letters, in three frames from the bus.
TEST_F(ResetOfABoard, IsAskedForByTheBusEachTimeWithTheWholeKey) {
  bus.write(0, 0x0010, bytes({0x01, 0x10}));
  static_cast<void>(bus.slave().take_reset_request());
  bus_key({'R', 'E', 'S'});
  EXPECT_TRUE(bus.slave().take_reset_request());
  EXPECT_EQ(number(bus.read(0, 0x0010, 2).data), 0x1001U) << "the board has not reset it yet";
  EXPECT_EQ(number(bus.read(0, 0x0040, 1).data), 0U);
  bus_key({'E', 'S'});
  EXPECT_FALSE(bus.slave().take_reset_request());
  bus_key({'R', 'E', 'S'});
  EXPECT_TRUE(bus.slave().take_reset_request());
}

TEST_F(ResetOfABoard, IsAskedForByTheHostEachTimeWithTheWholeKey) {
  static_cast<void>(bus.slave().take_reset_request());
  host_key({'R', 'E', 'S'});
  EXPECT_TRUE(bus.slave().take_reset_request());
  host_key({'R', 'E', 'S'});
  EXPECT_TRUE(bus.slave().take_reset_request());
}

TEST_F(ResetOfABoard, OfTheBusIsNotDelayedByALetterOfTheHost) {
  static_cast<void>(bus.slave().take_reset_request());
  bus_key({'R'});
  host_key({'R'});
  bus_key({'E', 'S'});
  EXPECT_TRUE(bus.slave().take_reset_request());
}

TEST(ChangedSyncManager, IsSeenWhenTheHostHasReadItsActivateRegister) {
  TestBus bus;
  bus.set_sync_manager(0, 1, {0x1080, 64, 0x22});
  ASSERT_NE(bus.slave().al_event_request() & al_event::kSyncManagerActivation, 0U);
  host_read(bus.slave(), 0x080E, 1);
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kSyncManagerActivation, 0U);
}

TEST(EnabledSyncManager, KeepsItsControlByteButForTheWatchdogTrigger) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {0x1100, 2, 0x64});
  bus.write(0, 0x0814, bytes({0x1B}));
  EXPECT_EQ(number(bus.read(0, 0x0814, 1).data), 0x24U);
  bus.write(0, 0x0814, bytes({0x5B}));
  EXPECT_EQ(number(bus.read(0, 0x0814, 1).data), 0x64U);
}

TEST(LockedAlControlOfABoard, IsNotOpenedByOtherBitsOfTheEscConfiguration) {
  DcBus bus({.esc_configuration = 0x0E});  // all but bit 0, device emulation
  EXPECT_EQ(bus.set(0x0120, 2, 2), 1U);
  EXPECT_EQ(bus.set(0x0120, 2, 2), 0U) << "the host has not read the first";
}

TEST(LockedAlControlOfABoard, IsToldForAlControlOnlyAndForAWholeWord) {
  Counter log;
  TestBus bus;
  host_read(bus.slave(), 0x0130, 2);  // there is firmware
  bus.slave().set_event_reporter(base::EventReporter(&log, 0));
  ASSERT_EQ(bus.write(0, 0x0120, bytes({2, 0})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x0000, bytes({1, 2})).working_counter, 0U);
  EXPECT_EQ(log.count, 0) << "the type is read-only, whatever AL control does";
  EXPECT_EQ(bus.write(0, 0x0120, bytes({4})).working_counter, 0U);
  EXPECT_EQ(log.count, 0) << "half of it names no state";
  EXPECT_EQ(bus.write(0, 0x0120, bytes({4, 0})).working_counter, 0U);
  EXPECT_EQ(log.count, 1);
}

TEST(EepromWithAValidChecksum, IsNothingToTell) {
  Counter log;
  TestBus bus;
  bus.slave().set_event_reporter(base::EventReporter(&log, 0));
  Bytes image = testing::valid_sii();
  bus.slave().load_sii(image);
  EXPECT_EQ(log.count, 0);
  image[14] ^= std::byte{1};
  bus.slave().load_sii(image);
  EXPECT_EQ(log.count, 1);
}

TEST(FrameWithAnotherSideEffect, LatchesNoReceiveTimes) {
  DcBus bus;
  bus.set(0x0900, 0, 4);
  const std::uint64_t latched = bus.get(0x0900, 4);
  bus.set(0x0020, 0, 1);  // unlocks registers for the rest of its frame
  EXPECT_EQ(bus.get(0x0900, 4), latched);
}

TEST(FrameWithAnotherSideEffect, DoesNotExtendAStartTime) {
  DcBus bus;
  bus.set(0x0981, 0x10, 1);  // a start time of 32 bits is extended by the system time
  bus.set(0x0990, 0x5'0000'1000, 8);
  bus.set(0x0020, 0, 1);
  EXPECT_EQ(bus.get(0x0990, 8), 0x5'0000'1000U);
}

TEST(TemporaryLoopControl, EndsAtItsVeryDeadline) {
  TestBus bus(2);
  bus.write(0, 0x0100, bytes({0x03, 0x0C}));
  Bytes shown(1);
  bus.slave().peek(0x0101, shown);
  ASSERT_EQ(number(shown), 0x0CU);
  const base::SimTime due = bus.slave().next_deadline();
  bus.slave().advance(due - SimDuration(1));
  bus.slave().peek(0x0101, shown);
  EXPECT_EQ(number(shown), 0x0CU);
  bus.slave().advance(due);
  bus.slave().peek(0x0101, shown);
  EXPECT_EQ(number(shown), 0U);
}

TEST(ProcessMemory, OfAChipWithAllSixteenSyncManagersIsOpenBesideThem) {
  SlaveControllerConfiguration chip;
  chip.sync_manager_count = 16;
  TestBus bus(1, chip);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({0x5A})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 0x5AU);
}

TEST(ProcessMemory, MappedFromTheMiddleOfAByteIsWrittenWholeBehindIt) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {0x1100, 3, 0x24});
  bus.set_fmmu(
      0, 0,
      {.logical = 0x10000, .length = 3, .physical = 0x10FF, .type = 2, .physical_start_bit = 4});
  EXPECT_EQ(bus.transfer(Command::lwr, 0x10000, bytes({0x21, 0x43, 0x65})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x10FF, 1).data), 0x10U);
  EXPECT_EQ(host_read(bus.slave(), 0x1100, 3), bytes({0x32, 0x54, 0x06}));
}

// 0x09F8 and 0x09FC: a buffer that the host writes starts with its first byte.
TEST(BufferEventTimesOfAWriter, AreThoseOfItsFirstAndLastByte) {
  DcBus bus;
  bus.set_sync_manager(0, 3, {0x1400, 4, 0x20, 0x81});
  bus.wait(1_ms);
  const auto started = static_cast<std::uint64_t>(bus.now().nanoseconds());
  host_write(bus.slave(), 0x1400, zeros(2));
  bus.wait(1_ms);
  const auto changed = static_cast<std::uint64_t>(bus.now().nanoseconds());
  host_write(bus.slave(), 0x1402, zeros(2));
  EXPECT_EQ(bus.get(0x09F8, 4), started);
  EXPECT_EQ(bus.get(0x09FC, 4), changed);
}

}  // namespace
}  // namespace stator::ethercat
