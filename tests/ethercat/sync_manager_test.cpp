// Sync managers as mailbox and three-buffer memory: locks, repeat requests, interrupts, interleaved
// access.
#include "stator/ethercat/units/sync_manager.hpp"

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"
#include "stator/base/random.hpp"

namespace stator::ethercat {
namespace {

using testing::Answer;
using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr std::uint8_t kMailboxOut = 0x26;  // mailbox, bus writes, host interrupt
constexpr std::uint8_t kMailboxIn = 0x22;
constexpr std::uint8_t kBufferedOut = 0x64;  // buffered, bus writes, host interrupt, watchdog
constexpr std::uint8_t kBufferedIn = 0x20;
constexpr std::uint16_t kMailboxStart = 0x1000;
constexpr std::uint16_t kMailboxLength = 64;

Bytes pattern(std::size_t length, unsigned seed) {
  Bytes result(length);
  for (std::size_t i = 0; i < length; ++i) {
    result[i] = static_cast<std::byte>(seed + i);
  }
  return result;
}

class Mailbox : public ::testing::Test {
 protected:
  Mailbox() {
    bus.set_sync_manager(0, 0, {kMailboxStart, kMailboxLength, kMailboxOut});
    bus.set_sync_manager(0, 1, {kIn, kMailboxLength, kMailboxIn});
  }
  unsigned status(unsigned channel) {
    return static_cast<unsigned>(
        number(bus.read(0, static_cast<std::uint16_t>(0x0805 + 8 * channel), 1).data));
  }
  static constexpr std::uint16_t kIn = 0x1080;
  TestBus bus;
  SlaveController& slave = bus.slave();
};

TEST_F(Mailbox, FullMailbox_RefusesTheMasterUntilTheHostHasReadTheLastByte) {
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 1)).working_counter, 1U);
  EXPECT_EQ(status(0), 0x09U) << "full, write interrupt";
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(0), al_event::sync_manager(0));
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 9)).working_counter, 0U);
  EXPECT_EQ(host_read(slave, kMailboxStart, 10), pattern(10, 1));
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(0), 0U)
      << "the first byte acknowledges";
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 9)).working_counter, 0U);
  EXPECT_EQ(host_read(slave, kMailboxStart, kMailboxLength), pattern(kMailboxLength, 1));
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 9)).working_counter, 1U);
  EXPECT_EQ(host_read(slave, kMailboxStart, kMailboxLength), pattern(kMailboxLength, 9));
}

TEST_F(Mailbox, EmptyMailbox_CannotBeRead) {
  const Answer empty = bus.transfer(Command::aprd, physical_address(0, kIn), bytes({0xEE, 0xEE}));
  EXPECT_EQ(empty.working_counter, 0U);
  EXPECT_EQ(empty.data, bytes({0xEE, 0xEE})) << "refused data stay as they were sent";
}

TEST_F(Mailbox, SplitAccess_WritesUsedBytesAndThenTheLastByteInOneFrame) {
  bus.with(Command::apwr, physical_address(0, kMailboxStart), pattern(16, 1))
      .with(Command::apwr, physical_address(0, kMailboxStart + kMailboxLength - 1), bytes({0}));
  const auto answers = bus.send();
  EXPECT_EQ(answers[0].working_counter, 1U);
  EXPECT_EQ(answers[1].working_counter, 1U);
  EXPECT_EQ(status(0) & 0x08U, 0x08U);
  EXPECT_EQ(host_read(slave, kMailboxStart, 16), pattern(16, 1));
}

TEST_F(Mailbox, SplitAccess_PollsTheFirstTwoBytesAndReleasesAtTheLastByteOnly) {
  EXPECT_EQ(bus.read(0, kIn, 2).working_counter, 0U);
  host_write(slave, kIn, pattern(kMailboxLength, 7));
  EXPECT_EQ(status(1) & 0x08U, 0x08U);
  EXPECT_EQ(bus.read(0, kIn, 2).data, pattern(2, 7));
  EXPECT_EQ(bus.read(0, kIn, 2).working_counter, 1U) << "polling does not empty it";
  EXPECT_EQ(bus.read(0, kIn, 16).data, pattern(16, 7));
  EXPECT_EQ(status(1) & 0x08U, 0x08U);
  EXPECT_EQ(bus.read(0, kIn + kMailboxLength - 1, 1).working_counter, 1U);
  EXPECT_EQ(status(1), 0x02U) << "empty, read interrupt";
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(1), al_event::sync_manager(1));
  EXPECT_EQ(bus.read(0, kIn, 2).working_counter, 0U);
  host_write(slave, kIn, bytes({1}));
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(1), 0U)
      << "writing the first byte acknowledges the read";
}

TEST_F(Mailbox, AccessThatDoesNotStartAtTheFirstByte_IsRefused) {
  EXPECT_EQ(bus.write(0, kMailboxStart + 4, pattern(4, 1)).working_counter, 0U);
  EXPECT_EQ(bus.write(0, kMailboxStart + kMailboxLength - 1, bytes({1})).working_counter, 0U);
  EXPECT_EQ(status(0), 0U);
}

TEST_F(Mailbox, DirectionIsEnforcedOnBothSides) {
  bus.write(0, kMailboxStart, pattern(kMailboxLength, 1));
  EXPECT_EQ(bus.read(0, kMailboxStart, 4).working_counter, 0U) << "the writer does not read";
  host_write(slave, kMailboxStart, pattern(kMailboxLength, 9));
  EXPECT_EQ(host_read(slave, kMailboxStart, 4), pattern(4, 1)) << "the reader does not write";
}

TEST_F(Mailbox, WrittenThroughAnFmmu_BehavesAlike) {
  bus.set_fmmu(0, 0, {0x10000, kMailboxLength, kMailboxStart, 2});
  EXPECT_EQ(bus.transfer(Command::lwr, 0x10000, pattern(kMailboxLength, 3)).working_counter, 1U);
  EXPECT_EQ(bus.transfer(Command::lwr, 0x10000, pattern(kMailboxLength, 4)).working_counter, 0U);
  EXPECT_EQ(host_read(slave, kMailboxStart, kMailboxLength), pattern(kMailboxLength, 3));
}

TEST_F(Mailbox, RepeatRequest_ReachesTheHostAndItsAcknowledgeTheMaster) {
  host_read(slave, 0x080E, 1);
  host_read(slave, 0x0806, 1);
  EXPECT_EQ(slave.al_event_request() & al_event::kSyncManagerActivation, 0U);
  bus.write(0, 0x080E, bytes({0x03}));
  EXPECT_NE(slave.al_event_request() & al_event::kSyncManagerActivation, 0U);
  EXPECT_EQ(number(host_read(slave, 0x080E, 1)), 0x03U);
  EXPECT_EQ(slave.al_event_request() & al_event::kSyncManagerActivation, 0U);
  host_write(slave, 0x080F, bytes({0x02}));
  EXPECT_EQ(number(bus.read(0, 0x080F, 1).data), 0x02U);
  EXPECT_EQ(bus.write(0, 0x080F, bytes({0})).working_counter, 0U) << "PDI control is the host's";
}

TEST_F(Mailbox, ActivationEvent_StaysUntilEveryChangedChannelWasRead) {
  EXPECT_NE(slave.al_event_request() & al_event::kSyncManagerActivation, 0U);
  host_read(slave, 0x0806, 1);
  EXPECT_NE(slave.al_event_request() & al_event::kSyncManagerActivation, 0U);
  host_read(slave, 0x080E, 1);
  EXPECT_EQ(slave.al_event_request() & al_event::kSyncManagerActivation, 0U);
}

TEST_F(Mailbox, DeactivatedByTheHost_TheAreaIsLockedUntilTheMasterEnablesAgain) {
  host_write(slave, 0x0807, bytes({1}));
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 1)).working_counter, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0807, 1).data), 1U);
  bus.write(0, 0x0806, bytes({0}));
  bus.write(0, 0x0806, bytes({1}));
  EXPECT_EQ(number(bus.read(0, 0x0807, 1).data), 0U);
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 1)).working_counter, 1U);
}

TEST_F(Mailbox, DisablingEmptiesIt) {
  bus.write(0, kMailboxStart, pattern(kMailboxLength, 1));
  bus.write(0, 0x0806, bytes({0}));
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(0), 0U);
  bus.write(0, 0x0806, bytes({1}));
  EXPECT_EQ(bus.write(0, kMailboxStart, pattern(kMailboxLength, 2)).working_counter, 1U);
}

TEST_F(Mailbox, RewritingAllEightBytes_LeavesStatusAloneAndAnEnabledSetUpAsItIs) {
  bus.write(0, kMailboxStart, pattern(kMailboxLength, 1));
  const Bytes other = bytes({0x00, 0x20, 0x10, 0x00, 0x22, 0xFF, 0x01, 0xFF});
  EXPECT_EQ(bus.write(0, 0x0800, other).working_counter, 1U);
  EXPECT_EQ(bus.read(0, 0x0800, 8).data, bytes({0x00, 0x10, 64, 0x00, 0x26, 0x09, 0x01, 0x00}));
  EXPECT_EQ(bus.write(0, 0x0800, bytes({0, 0})).working_counter, 0U) << "locked while enabled";
}

TEST_F(Mailbox, MemoryOutsideAnyChannel_IsPlainRamForBothSides) {
  EXPECT_EQ(bus.write(0, 0x2000, pattern(8, 5)).working_counter, 1U);
  EXPECT_EQ(host_read(slave, 0x2000, 8), pattern(8, 5));
  host_write(slave, 0x2004, bytes({0xAA}));
  EXPECT_EQ(number(bus.read(0, 0x2004, 1).data), 0xAAU);
}

class ThreeBuffer : public ::testing::Test {
 protected:
  ThreeBuffer() {
    bus.set_sync_manager(0, 2, {kOut, 8, kBufferedOut});
    bus.set_sync_manager(0, 3, {kInputs, 8, kBufferedIn});
  }
  static constexpr std::uint16_t kOut = 0x1100;
  static constexpr std::uint16_t kInputs = 0x1200;
  TestBus bus;
  SlaveController& slave = bus.slave();
};

TEST_F(ThreeBuffer, ReaderAlwaysGetsTheLastCompleteWrite) {
  bus.write(0, kOut, pattern(8, 1));
  bus.write(0, kOut, pattern(8, 2));
  bus.write(0, kOut, pattern(4, 3));
  EXPECT_EQ(host_read(slave, kOut, 8), pattern(8, 2)) << "the third write is not complete";
  bus.write(0, kOut + 4, pattern(4, 7));
  EXPECT_EQ(host_read(slave, kOut, 8), pattern(8, 3));
  EXPECT_EQ(host_read(slave, kOut, 8), pattern(8, 3)) << "nothing new: the same again";
}

TEST_F(ThreeBuffer, ReadUnderWay_IsNotDisturbedByWrites) {
  host_write(slave, kInputs, pattern(8, 1));
  EXPECT_EQ(bus.read(0, kInputs, 4).data, pattern(4, 1));
  host_write(slave, kInputs, pattern(8, 0x21));
  host_write(slave, kInputs, pattern(8, 0x31));
  EXPECT_EQ(bus.read(0, kInputs + 4, 4).data, pattern(4, 5));
  EXPECT_EQ(bus.read(0, kInputs, 8).data, pattern(8, 0x31));
}

TEST_F(ThreeBuffer, RandomInterleaving_NeverMixesTwoWrites) {
  base::Random random(42);
  unsigned written = 0;
  std::size_t write_position = 0;
  std::size_t read_position = 0;
  Bytes read;
  for (int step = 0; step < 20'000; ++step) {
    const std::size_t count = 1 + random.below(4);
    if (random.below(2) == 0) {
      written += write_position == 0 ? 1 : 0;
      const std::size_t n = std::min(count, 8 - write_position);
      bus.write(0, static_cast<std::uint16_t>(kOut + write_position),
                Bytes(n, static_cast<std::byte>(written)));
      write_position = (write_position + n) % 8;
    } else {
      const std::size_t n = std::min(count, 8 - read_position);
      const Bytes part = host_read(slave, static_cast<std::uint16_t>(kOut + read_position), n);
      read.insert(read.end(), part.begin(), part.end());
      read_position = (read_position + n) % 8;
      if (read_position == 0) {
        ASSERT_EQ(read, Bytes(8, read.front())) << "step " << step;
        read.clear();
      }
    }
  }
}

TEST_F(ThreeBuffer, Status_TellsTheLastBufferAndWhoHasOneOpen) {
  const auto status = [&] { return number(bus.read(0, 0x0815, 1).data); };
  EXPECT_EQ(status(), 0x30U) << "no buffer written";
  bus.write(0, kOut, pattern(4, 1));
  EXPECT_EQ(status(), 0xB0U) << "write buffer open";
  bus.write(0, kOut + 4, pattern(4, 1));
  EXPECT_EQ(status(), 0x01U) << "buffer 0 written";
  host_read(slave, kOut, 2);
  EXPECT_EQ(status(), 0x40U) << "read buffer open, interrupt acknowledged";
  host_read(slave, kOut + 2, 6);
  EXPECT_EQ(status(), 0x02U) << "read completely";
}

TEST_F(ThreeBuffer, SecondAndThirdBuffer_AreNobodysMemory) {
  EXPECT_EQ(bus.write(0, kOut + 8, bytes({1})).working_counter, 0U);
  EXPECT_EQ(bus.read(0, kOut + 23, 1).working_counter, 0U);
  EXPECT_EQ(bus.write(0, kOut + 24, bytes({1})).working_counter, 1U) << "behind them is RAM";
}

TEST_F(ThreeBuffer, HostInterrupt_ComesWithACompleteWriteAndGoesWithTheFirstByteRead) {
  bus.write(0, kOut, pattern(7, 1));
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(2), 0U);
  bus.write(0, kOut + 7, bytes({1}));
  EXPECT_NE(slave.al_event_request() & al_event::sync_manager(2), 0U);
  host_read(slave, kOut, 1);
  EXPECT_EQ(slave.al_event_request() & al_event::sync_manager(2), 0U);
}

TEST_F(ThreeBuffer, BusInterrupt_IsMirroredInTheEcatEventRequest) {
  bus.set_sync_manager(0, 3, {kInputs, 8, 0x10});
  bus.write(0, 0x0200, bytes({0x80, 0}));
  host_write(slave, kInputs, pattern(8, 1));
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0x0080U);
  bus.read(0, kInputs, 8);
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0U);
}

/// Eight input buffers of three times two bytes each, behind one another, for the bus to read.
class BusInterrupts : public ::testing::Test {
 protected:
  static constexpr unsigned kChannels = 8;

  BusInterrupts() {
    for (unsigned channel = 0; channel < kChannels; ++channel) {
      bus.set_sync_manager(0, channel, {start_of(channel), 2, 0x10});
    }
    bus.write(0, 0x0200, bytes({0xFF, 0xFF}));
    bus.read(0, 0x0110, 2);  // the link that came up at the start is no news any more
  }
  static std::uint16_t start_of(unsigned channel) {
    return static_cast<std::uint16_t>(0x1000 + 8 * channel);
  }
  /// The IRQ field of a frame and 0x0210, which have to agree: 0x0200 lets everything pass.
  std::uint64_t events() {
    const Answer answer = bus.read(0, 0x0210, 2);
    EXPECT_EQ(number(answer.data), answer.interrupt);
    return number(answer.data);
  }

  TestBus bus;
};

TEST_F(BusInterrupts, OfEachSyncManagerAreAtTheirOwnBitOfTheEcatEventRequest) {
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    EXPECT_EQ(events(), 0U);
    host_write(bus.slave(), start_of(channel), bytes({1, 2}));
    EXPECT_EQ(events(), 0x10U << channel);
    bus.read(0, start_of(channel), 2);
  }
  EXPECT_EQ(events(), 0U);
}

TEST_F(BusInterrupts, OfAllSyncManagersStandTogetherAndGoOneByOne) {
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    host_write(bus.slave(), start_of(channel), bytes({1, 2}));
  }
  std::uint64_t pending = 0x0FF0;
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    EXPECT_EQ(events(), pending) << "bits 1 and 15:12 are reserved";
    bus.read(0, start_of(channel), 2);
    pending &= ~(std::uint64_t{0x10} << channel);
  }
  EXPECT_EQ(events(), 0U);
}

TEST_F(BusInterrupts, AreMaskedBitByBit) {
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    host_write(bus.slave(), start_of(channel), bytes({1, 2}));
  }
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    const unsigned mask = 0x10U << channel;
    bus.write(0, 0x0200, bytes({mask & 0xFF, mask >> 8}));
    const Answer answer = bus.read(0, 0x0210, 2);
    EXPECT_EQ(answer.interrupt, mask);
    EXPECT_EQ(number(answer.data), 0x0FF0U) << "the register shows what the mask hides";
  }
}

struct InvalidSetUp {
  std::uint16_t start;
  std::uint16_t length;
  std::uint8_t control;
};

TEST(SyncManager, InvalidSetUps_StayInactiveAndGuardNothing) {
  for (const InvalidSetUp& setting : {InvalidSetUp{0x1000, 0, 0x24},
                                      {0x1000, 1, 0x20},
                                      {0x0F80, 16, 0x24},
                                      {0x4FF0, 16, 0x24},
                                      {0x4FF1, 16, 0x26},
                                      {0x1000, 8, 0x25},
                                      {0x1000, 8, 0x28}}) {
    TestBus bus;
    bus.set_sync_manager(0, 2, {setting.start, setting.length, setting.control});
    EXPECT_FALSE(bus.slave().sync_manager(2).active()) << setting.start << ' ' << setting.length;
    EXPECT_EQ(bus.slave().sync_manager(2).guarded_length(), 0U);
    EXPECT_EQ(bus.write(0, 0x1001, bytes({1})).working_counter, 1U);
  }
}

TEST(SyncManager, LengthOne_OnlyTriggersTheWatchdog) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {0x1000, 1, kBufferedOut});
  EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 0U);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({0x55})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 1U);
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 0x55U) << "plain memory";
}

}  // namespace
}  // namespace stator::ethercat
