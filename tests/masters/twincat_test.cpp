// What TwinCAT sends, as captures show it, and what it and mixed buses demand of a slave.

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "masters/device_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

class TwinCat : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kReceiveMailbox = 0x1000;
  static constexpr std::uint16_t kTransmitMailbox = 0x1200;
  static constexpr std::uint16_t kMailboxLength = 512;
  static constexpr std::uint16_t kLast = kMailboxLength - 1;

  TwinCat() : bus(3) {
    for (std::size_t i = 0; i < bus.size(); ++i) {
      bus.apwr(i, 0x0010, little_endian(station(i), 2));
      for (const std::uint16_t channel : {std::uint16_t{0x0800}, std::uint16_t{0x0808}}) {
        bus.fpwr(station(i), channel,
                 channel == 0x0800 ? sync_manager(kReceiveMailbox, kMailboxLength, 0x26)
                                   : sync_manager(kTransmitMailbox, kMailboxLength, 0x22));
      }
      bus.fpwr(station(i), 0x0120, little_endian(0x02, 2));
      EXPECT_EQ(number(bus.fprd(station(i), 0x0130, 2).data), 0x02U);
    }
  }
  static std::uint16_t station(std::size_t position) {
    return static_cast<std::uint16_t>(1001 + position);
  }
  static std::uint32_t at(std::size_t slave, std::uint16_t address) {
    return ethercat::physical_address(station(slave), address);
  }
  static Bytes sdo(unsigned counter, unsigned command, std::uint16_t index, unsigned subindex,
                   std::uint32_t data = 0) {
    Bytes message = hex("0A 00 00 00 00 03 00 20");
    message[5] |= static_cast<std::byte>(counter << 4);
    message.push_back(static_cast<std::byte>(command));
    for (const Bytes& field :
         {little_endian(index, 2), little_endian(subindex, 1), little_endian(data, 4)}) {
      message.insert(message.end(), field.begin(), field.end());
    }
    return message;
  }
  static Bytes upload(unsigned counter, std::uint16_t index, unsigned subindex) {
    return sdo(counter, 0x40, index, subindex);
  }

  /// The used bytes and the last one as two datagrams of a frame; both working counters.
  std::array<unsigned, 2> write_mailbox(std::size_t slave, const Bytes& message) {
    const auto answers = bus.with(Command::fpwr, at(slave, kReceiveMailbox), message)
                             .with(Command::fpwr, at(slave, kReceiveMailbox + kLast), zeros(1))
                             .send();
    return {answers[0].working_counter, answers[1].working_counter};
  }
  /// The poll: the first two bytes of the read mailbox.
  unsigned poll(std::size_t slave) {
    return bus.fprd(station(slave), kTransmitMailbox, 2).working_counter;
  }
  /// Polls for at most 100 ms.
  bool wait(std::size_t slave) {
    for (int i = 0; i < 100; ++i) {
      if (poll(slave) == 1) {
        return true;
      }
      bus.pass(1_ms);
    }
    return false;
  }
  /// Used bytes and last byte as two datagrams of a frame.
  Bytes read_mailbox(std::size_t slave, std::size_t used) {
    const auto answers = bus.with(Command::fprd, at(slave, kTransmitMailbox), zeros(used))
                             .with(Command::fprd, at(slave, kTransmitMailbox + kLast), zeros(1))
                             .send();
    EXPECT_EQ(answers[0].working_counter, 1U);
    EXPECT_EQ(answers[1].working_counter, 1U);
    return answers[0].data;
  }
  Bytes exchange(std::size_t slave, const Bytes& message) {
    EXPECT_EQ(write_mailbox(slave, message), (std::array<unsigned, 2>{1, 1}));
    EXPECT_TRUE(wait(slave));
    return read_mailbox(slave, 16);
  }

  DeviceBus bus;
};

TEST_F(TwinCat, TheBroadcastsOfAStartCountEverySlave) {
  struct Row {
    std::uint16_t address;
    std::size_t length;
  };
  for (const Row& row : {Row{0x0300, 8},
                         {0x0600, 256},
                         {0x0800, 256},
                         {0x0910, 32},
                         {0x0930, 2},
                         {0x0934, 2},
                         {0x0103, 1},
                         {0x0101, 1},
                         {0x0200, 2},
                         {0x0010, 2}}) {
    EXPECT_EQ(bus.bwr(row.address, zeros(row.length)).working_counter, 3U)
        << std::hex << row.address;
  }
  EXPECT_EQ(bus.aprd(0, 0x0600, 128).data, zeros(128));
  EXPECT_EQ(bus.aprd(0, 0x0920, 12).data, zeros(12)) << "offset and delay";
}

TEST_F(TwinCat, ThirtyTwoBytesAtTheSystemTimeSetOffsetAndDelayToo) {
  bus.fpwr(station(1), 0x0920, little_endian(123'456'789, 8));
  bus.fpwr(station(1), 0x0928, little_endian(310, 4));
  EXPECT_EQ(bus.bwr(0x0910, zeros(32)).working_counter, 3U);
  EXPECT_EQ(bus.fprd(station(1), 0x0920, 12).data, zeros(12));
}

TEST_F(TwinCat, OneByteOfTheLinkStatusAndSixOfTheStateAreReadAtOddPlaces) {
  EXPECT_EQ(number(bus.fprd(station(0), 0x0111, 1).data), 0x5AU) << "ports 0 and 1 open";
  EXPECT_EQ(number(bus.fprd(station(2), 0x0111, 1).data), 0x56U) << "port 0 open";
  EXPECT_EQ(to_hex(bus.fprd(station(0), 0x0130, 6).data), "02 00 00 00 00 00");
}

TEST_F(TwinCat, IdentityPortControlAndLinksAreReadInOneFrame) {
  for (std::size_t i = 0; i < bus.size(); ++i) {
    const auto answers = bus.with(Command::aprd, DeviceBus::at_position(i, 0x0000), zeros(10))
                             .with(Command::aprd, DeviceBus::at_position(i, 0x0102), zeros(2))
                             .with(Command::aprd, DeviceBus::at_position(i, 0x0111), zeros(1))
                             .send();
    for (const Answer& answer : answers) {
      EXPECT_EQ(answer.working_counter, 1U);
    }
    EXPECT_EQ(answers[0].data[4], std::byte{8}) << "FMMUs";
  }
}

TEST_F(TwinCat, EepromStatusAddressAndEightDataBytesAreReadAtOnce) {
  bus.fpwr(station(0), 0x0502, bytes({0x00, 0x01, 0x0A, 0, 0, 0}));
  bus.pass(600_us);
  const Answer answer = bus.aprd(0, 0x0502, 14);
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_EQ(number(part(answer.data, 0, 2)) & 0xF800, 0U);
  EXPECT_EQ(number(part(answer.data, 2, 4)), 0x0AU);
  EXPECT_EQ(number(part(answer.data, 6, 4)), 3315U);
}

TEST_F(TwinCat, SixtyDelayMeasurementsAgree) {
  std::uint64_t loop = 0;
  for (int round = 0; round < 60; ++round) {
    EXPECT_EQ(bus.bwr(0x0900, zeros(8)).working_counter, 3U);
    std::uint64_t received = 0;
    for (std::size_t i = 0; i < bus.size(); ++i) {
      const Answer times = bus.aprd(i, 0x0900, 32);
      EXPECT_EQ(times.working_counter, 1U);
      const auto port0 = number(part(times.data, 0, 4));
      EXPECT_EQ(number(part(times.data, 24, 8)), port0) << "processing unit, 0x0918";
      EXPECT_EQ(port0 - received, i == 0 ? port0 : 310U);
      received = port0;
    }
    const Bytes first = bus.aprd(0, 0x0900, 8).data;
    const auto measured = number(part(first, 4, 4)) - number(part(first, 0, 4));
    EXPECT_EQ(measured, round == 0 ? measured : loop);
    loop = measured;
  }
}

TEST_F(TwinCat, EightThousandTimeFramesBringTheClocksTogether) {
  ethercat::SlaveControllerConfiguration fast;
  fast.clock_deviation_ppb = 30'000;
  bus.add_controller(fast);
  bus.pass(1_s);
  for (int frame = 0; frame < 8'000; ++frame) {
    ASSERT_EQ(bus.armw(0, 0x0910, 4).working_counter, 4U) << frame;
  }
  EXPECT_LT(number(bus.aprd(3, 0x092C, 4).data) & 0x7FFFFFFF, 100U);
}

TEST_F(TwinCat, AMailboxIsWrittenAsUsedBytesAndLastByteInOneFrame) {
  EXPECT_EQ(write_mailbox(0, upload(1, 0x1018, 2)), (std::array<unsigned, 2>{1, 1}));
  ASSERT_TRUE(wait(0));
  EXPECT_EQ(to_hex(part(read_mailbox(0, 16), 6)), "00 30 43 18 10 02 F3 0C 00 00");
}

TEST_F(TwinCat, PollingTheFirstTwoBytesCountsOnlyAFullMailboxAndKeepsIt) {
  EXPECT_EQ(poll(0), 0U);
  write_mailbox(0, upload(1, 0x1018, 1));
  ASSERT_TRUE(wait(0));
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(poll(0), 1U);
  }
  EXPECT_EQ(to_hex(part(read_mailbox(0, 16), 6)), "00 30 43 18 10 01 86 02 00 00");
  EXPECT_EQ(poll(0), 0U) << "released with the last byte";
}

TEST_F(TwinCat, AMailboxReadInSeveralFramesIsReleasedByItsLastByteOnly) {
  write_mailbox(0, upload(1, 0x1018, 1));
  ASSERT_TRUE(wait(0));
  EXPECT_EQ(to_hex(bus.fprd(station(0), kTransmitMailbox, 6).data), "0A 00 00 00 00 13");
  EXPECT_EQ(to_hex(bus.fprd(station(0), kTransmitMailbox + 6, 10).data),
            "00 30 43 18 10 01 86 02 00 00");
  EXPECT_EQ(poll(0), 1U);
  EXPECT_EQ(bus.fprd(station(0), kTransmitMailbox + kLast, 1).working_counter, 1U);
  EXPECT_EQ(poll(0), 0U);
  EXPECT_EQ(bus.fprd(station(0), kTransmitMailbox + kLast, 1).working_counter, 0U);
}

TEST_F(TwinCat, ErrorCountersAreReadAndReset) {
  bus.device(1).controller().count_receive_error(0, ethercat::ReceiveError::invalid_frame);
  bus.device(1).controller().count_receive_error(1, ethercat::ReceiveError::physical);
  EXPECT_EQ(to_hex(bus.fprd(station(1), 0x0300, 8).data), "01 00 00 01 00 00 00 00");
  EXPECT_EQ(bus.fpwr(station(1), 0x0300, zeros(8)).working_counter, 1U);
  EXPECT_EQ(bus.fprd(station(1), 0x0300, 8).data, zeros(8));
}

TEST_F(TwinCat, AnyValueWrittenToAnErrorCounterClearsIt) {
  bus.device(1).controller().count_receive_error(0, ethercat::ReceiveError::invalid_frame);
  bus.fpwr(station(1), 0x0300, Bytes(8, std::byte{0x55}));
  EXPECT_EQ(bus.fprd(station(1), 0x0300, 8).data, zeros(8));
}

// Mixed buses

TEST_F(TwinCat, TheFrameComesBackFromTheMastersOwnAddressWithOneBitChanged) {
  Bytes frame =
      hex("01 01 05 01 00 00 00 0A CD 12 34 56 88 A4 0E 10 "
          "07 00 00 00 00 00 02 00 00 00 00 00 00 00");
  ASSERT_TRUE(bus.send_raw(frame));
  EXPECT_EQ(to_hex(part(frame, 0, 12)), "01 01 05 01 00 00 02 0A CD 12 34 56");
}

TEST_F(TwinCat, RepliesCountOnAsTheRequestsDo) {
  for (unsigned request = 0; request < 16; ++request) {
    const unsigned counter = request % 7 + 1;
    const Bytes answer = exchange(0, upload(counter, 0x1018, 1));
    EXPECT_EQ(std::to_integer<unsigned>(answer[5]), 3 | counter << 4);
  }
}

TEST_F(TwinCat, ARequestBeforeTheLastReplyWasReadIsAnsweredAfterIt) {
  write_mailbox(0, upload(1, 0x1018, 1));
  bus.pass(2_ms);
  EXPECT_EQ(write_mailbox(0, upload(2, 0x1018, 2)), (std::array<unsigned, 2>{1, 1}));
  bus.pass(2_ms);
  EXPECT_EQ(number(part(read_mailbox(0, 16), 12, 4)), 0x286U);
  ASSERT_TRUE(wait(0));
  EXPECT_EQ(number(part(read_mailbox(0, 16), 12, 4)), 3315U);
}

TEST_F(TwinCat, RewritingAllEightBytesOfASyncManagerLeavesItsStatusAlone) {
  write_mailbox(0, upload(1, 0x1018, 1));
  ASSERT_TRUE(wait(0));
  const Bytes before = bus.fprd(station(0), 0x0808, 8).data;
  ASSERT_EQ(before[5] & std::byte{0x08}, std::byte{0x08});
  EXPECT_EQ(bus.fpwr(station(0), 0x0808, sync_manager(kTransmitMailbox, kMailboxLength, 0x22))
                .working_counter,
            1U);
  EXPECT_EQ(bus.fprd(station(0), 0x0808, 8).data, before);
  EXPECT_EQ(number(part(read_mailbox(0, 16), 12, 4)), 0x286U) << "the reply is still there";
  EXPECT_EQ(number(bus.fprd(station(0), 0x0130, 2).data), 0x02U);
}

/// The full bits of the first two slaves as neighbouring bits of one logical byte.
class TwinCatMailboxBits : public TwinCat {
 protected:
  static constexpr std::uint32_t kLogical = 0x09000000;

  TwinCatMailboxBits() {
    for (std::uint8_t slave = 0; slave < 2; ++slave) {
      Bytes registers = fmmu(kLogical, 1, 0x080D, 1);
      registers[6] = std::byte{slave};  // logical start and stop bit
      registers[7] = std::byte{slave};
      registers[10] = std::byte{3};  // physical start bit
      bus.fpwr(station(slave), 0x0600, registers);
    }
  }
  unsigned full_bits() {
    const Answer answer = bus.transfer(Command::lrd, kLogical, zeros(1));
    EXPECT_EQ(answer.working_counter, 2U);
    return static_cast<unsigned>(number(answer.data));
  }
};

TEST_F(TwinCatMailboxBits, TwoSlavesShareOneByteOfTheCyclicRead) {
  EXPECT_EQ(full_bits(), 0U);
  write_mailbox(0, upload(1, 0x1018, 1));
  EXPECT_EQ(full_bits(), 1U);
  write_mailbox(1, upload(1, 0x1018, 1));
  EXPECT_EQ(full_bits(), 3U);
  read_mailbox(0, 16);
  EXPECT_EQ(full_bits(), 2U);
  read_mailbox(1, 16);
  EXPECT_EQ(full_bits(), 0U);
}

TEST_F(TwinCatMailboxBits, PollingByStateChangeSeesARisingEdgeForEveryReply) {
  unsigned last = full_bits();
  unsigned counter = 0;
  for (int round = 0; round < 20; ++round) {
    counter = counter % 7 + 1;
    write_mailbox(0, upload(counter, 0x1018, 2));
    bool rising = false;
    for (int cycle = 0; cycle < 100 && !rising; ++cycle) {
      const unsigned now = full_bits();
      rising = (now & 1) > (last & 1);
      last = now;
      bus.pass(1_ms);
    }
    ASSERT_TRUE(rising) << round;
    EXPECT_EQ(number(part(read_mailbox(0, 16), 12, 4)), 3315U);
    last = full_bits();
    EXPECT_EQ(last & 1, 0U) << "falls between two replies";
  }
}

TEST_F(TwinCatMailboxBits, WithASecondReplyWaitingTheBitFallsBeforeItRisesAgain) {
  write_mailbox(0, upload(1, 0x1018, 1));
  ASSERT_EQ(full_bits(), 1U);
  write_mailbox(0, upload(2, 0x1018, 2));
  bus.pass(2_ms);
  // The cyclic read travels in the frame that fetches the reply.
  const auto answers = bus.with(Command::fprd, at(0, kTransmitMailbox), zeros(16))
                           .with(Command::fprd, at(0, kTransmitMailbox + kLast), zeros(1))
                           .with(Command::lrd, kLogical, zeros(1))
                           .send();
  EXPECT_EQ(number(answers[2].data), 0U);
  EXPECT_EQ(full_bits(), 1U);
  EXPECT_EQ(number(part(read_mailbox(0, 16), 12, 4)), 3315U);
}

TEST_F(TwinCat, AStartUpListIsTakenWithAndWithoutCompleteAccess) {
  unsigned counter = 0;
  const auto write = [&](std::uint16_t index, unsigned subindex, std::uint32_t value,
                         unsigned length) {
    counter = counter % 7 + 1;
    const Bytes answer =
        exchange(0, sdo(counter, 0x23 | (4 - length) << 2, index, subindex, value));
    EXPECT_EQ(answer[8], std::byte{0x60}) << std::hex << index << ':' << subindex;
  };
  write(0x1C12, 0, 0, 1);
  write(0x1600, 0, 0, 1);
  write(0x1600, 1, 0x60400010, 4);
  write(0x1600, 2, 0x60FF0020, 4);
  write(0x1600, 0, 2, 1);
  write(0x1C12, 1, 0x1600, 2);
  write(0x1C12, 0, 1, 1);
  counter = counter % 7 + 1;
  EXPECT_EQ(number(part(exchange(0, upload(counter, 0x1600, 0)), 12, 1)), 2U);
  // 1C13h in one piece: sixteen bits of sub-index 0, then the assigned PDO.
  counter = counter % 7 + 1;
  EXPECT_EQ(exchange(0, sdo(counter, 0x33, 0x1C13, 0, 0x1A000001))[8] & std::byte{0xE0},
            std::byte{0x60});
}

TEST_F(TwinCat, EveryAbortHasTheCommandByte80) {
  const Bytes unknown = exchange(0, upload(1, 0x5FFF, 0));
  EXPECT_EQ(to_hex(part(unknown, 8)), "80 FF 5F 00 00 00 02 06");
  const Bytes read_only = exchange(0, sdo(2, 0x23, 0x1018, 1, 1));
  EXPECT_EQ(to_hex(part(read_only, 8)), "80 18 10 01 02 00 01 06");
  const Bytes complete = exchange(0, sdo(3, 0x50, 0x5FFF, 0));
  EXPECT_EQ(complete[8], std::byte{0x80});
}

}  // namespace
}  // namespace stator::tests
