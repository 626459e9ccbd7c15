// What the IgH EtherCAT master sends, and what it checks.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "masters/device_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

class Igh : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kMailboxLength = 512;

  Igh() : bus(3) {
    for (std::size_t i = 0; i < bus.size(); ++i) {
      EXPECT_EQ(bus.apwr(i, 0x0010, little_endian(station(i), 2)).working_counter, 1U);
    }
  }
  static std::uint16_t station(std::size_t position) {
    return static_cast<std::uint16_t>(position + 1);
  }

  /// One double word: command and address in four bytes, then status, address and data in one read.
  std::uint32_t read_sii(std::uint16_t address, std::uint16_t word) {
    Bytes command = bytes({0x80, 0x01, 0, 0});
    base::store_le(command, 2, word);
    EXPECT_EQ(bus.fpwr(address, 0x0502, command).working_counter, 1U);
    const Bytes answer = wait_for_sii(address);
    EXPECT_EQ(number(part(answer, 2, 2)), word);
    return static_cast<std::uint32_t>(number(part(answer, 6, 4)));
  }
  Bytes wait_for_sii(std::uint16_t address) {
    const base::SimTime limit = bus.now() + 20_ms;
    for (;;) {
      const Answer answer = bus.fprd(address, 0x0502, 10);
      EXPECT_EQ(answer.working_counter, 1U);
      const auto status = number(part(answer.data, 0, 2));
      EXPECT_EQ(status & 0x2000, 0U) << "error";
      if ((status & 0x8100) == 0) {
        return answer.data;
      }
      if (bus.now() > limit) {
        ADD_FAILURE() << "EEPROM busy for 20 ms";
        return answer.data;
      }
      bus.pass(1_ms);
    }
  }

  /// Requests a state and reads AL status until it is as wanted; the last status byte otherwise.
  unsigned change_state(std::uint16_t address, unsigned state) {
    base::SimTime limit = bus.now() + 3_s;
    while (bus.fpwr(address, 0x0120, little_endian(state, 2)).working_counter == 0) {
      if (bus.now() > limit) {
        ADD_FAILURE() << "AL control locked for 3 s";
        return 0;
      }
      bus.pass(1_ms);
    }
    limit = bus.now() + 5_s;
    for (;;) {
      const Bytes status = bus.fprd(address, 0x0130, 2).data;
      const auto now = std::to_integer<unsigned>(status[0]);
      if (now == state || (now & 0x10) != 0 || bus.now() > limit) {
        return now;
      }
      bus.pass(1_ms);
    }
  }
  void configure_mailboxes(std::uint16_t address) {
    Bytes pages = sync_manager(0x1000, kMailboxLength, 0x26);
    const Bytes second = sync_manager(0x1200, kMailboxLength, 0x22);
    pages.insert(pages.end(), second.begin(), second.end());
    EXPECT_EQ(bus.fpwr(address, 0x0800, pages).working_counter, 1U);
  }
  void clear(std::uint16_t address) {
    EXPECT_EQ(bus.fpwr(address, 0x0600, zeros(16 * 8)).working_counter, 1U);
    EXPECT_EQ(bus.fpwr(address, 0x0800, zeros(8 * 8)).working_counter, 1U);
    EXPECT_EQ(bus.fpwr(address, 0x0980, zeros(2)).working_counter, 1U);
  }
  void go_pre_operational(std::uint16_t address) {
    ASSERT_EQ(change_state(address, 0x01), 0x01U);
    clear(address);
    configure_mailboxes(address);
    ASSERT_EQ(change_state(address, 0x02), 0x02U);
  }
  void configure_process_data(std::uint16_t address, std::uint32_t logical) {
    Bytes channels = sync_manager(0x1800, 30, 0x64);
    const Bytes inputs = sync_manager(0x1C00, 30, 0x20);
    channels.insert(channels.end(), inputs.begin(), inputs.end());
    EXPECT_EQ(bus.fpwr(address, 0x0810, channels).working_counter, 1U);
    Bytes units = fmmu(logical, 30, 0x1800, 2);
    const Bytes second = fmmu(logical + 30, 30, 0x1C00, 1);
    units.insert(units.end(), second.begin(), second.end());
    EXPECT_EQ(bus.fpwr(address, 0x0600, units).working_counter, 1U);
  }

  /// A mailbox message with the station address in its header, written in full length.
  unsigned send(std::uint16_t address, unsigned type, const Bytes& body) {
    counter_ = counter_ % 7 + 1;
    Bytes message(kMailboxLength);
    base::store_le(message, 0, static_cast<std::uint16_t>(body.size()));
    base::store_le(message, 2, address);
    message[5] = static_cast<std::byte>(type | counter_ << 4);
    std::ranges::copy(body, message.begin() + 6);
    return bus.fpwr(address, 0x1000, message).working_counter;
  }
  /// Reads the eight registers of the read mailbox until it is full, then all of it.
  Bytes fetch(std::uint16_t address, base::SimDuration patience) {
    const base::SimTime limit = bus.now() + patience;
    for (;;) {
      const Answer registers = bus.fprd(address, 0x0808, 8);
      EXPECT_EQ(registers.working_counter, 1U);
      if ((registers.data[5] & std::byte{0x08}) != std::byte{0}) {
        break;
      }
      if (bus.now() > limit) {
        ADD_FAILURE() << "no answer";
        return zeros(16);
      }
      bus.pass(1_ms);
    }
    const Answer mailbox = bus.fprd(address, 0x1200, kMailboxLength);
    EXPECT_EQ(mailbox.working_counter, 1U);
    return part(mailbox.data, 0, 6 + number(part(mailbox.data, 0, 2)));
  }

  DeviceBus bus;
  unsigned counter_ = 0;
};

TEST_F(Igh, TheStateOfTheBusIsWatchedByOneBroadcastForEver) {
  for (int cycle = 0; cycle < 1000; ++cycle) {
    const Answer answer = bus.brd(0x0130, 2);
    ASSERT_EQ(answer.working_counter, 3U);
    ASSERT_EQ(number(answer.data), 0x01U);
    bus.pass(1_ms);
  }
}

TEST_F(Igh, ABrokenAndAHealedCableChangeTheCount) {
  bus.segment().set_link(2, false);
  EXPECT_EQ(bus.brd(0x0130, 2).working_counter, 2U);
  bus.segment().set_link(2, true);
  EXPECT_EQ(bus.brd(0x0130, 2).working_counter, 3U);
}

TEST_F(Igh, StationAddressesAreClearedAndReceiveTimesLatchedByOneByte) {
  EXPECT_EQ(bus.bwr(0x0010, zeros(2)).working_counter, 3U);
  EXPECT_EQ(bus.fprd(station(0), 0x0010, 2).working_counter, 0U);
  EXPECT_EQ(bus.bwr(0x0900, zeros(1)).working_counter, 3U);
  std::uint64_t former = 0;
  for (std::size_t i = 0; i < bus.size(); ++i) {
    const Answer times = bus.aprd(i, 0x0900, 16);
    EXPECT_EQ(times.working_counter, 1U);
    EXPECT_GT(number(part(times.data, 0, 4)), former) << "later behind the slave before";
    former = number(part(times.data, 0, 4));
  }
}

TEST_F(Igh, TheScanReadsWhatTheSlaveIs) {
  for (std::size_t i = 0; i < bus.size(); ++i) {
    EXPECT_EQ(number(bus.fprd(station(i), 0x0130, 2).data), 0x01U);
    const Answer base = bus.fprd(station(i), 0x0000, 12);
    EXPECT_EQ(base.working_counter, 1U);
    EXPECT_EQ(base.data[4], std::byte{8}) << "FMMUs";
    EXPECT_EQ(base.data[5], std::byte{8}) << "sync managers";
    EXPECT_EQ(base.data[7], std::byte{0x0F}) << "two MII ports";
    EXPECT_EQ(base.data[8] & std::byte{0x0C}, std::byte{0x0C}) << "DC, of 64 bits";
    const Answer link = bus.fprd(station(i), 0x0110, 2);
    EXPECT_EQ(number(link.data) >> 4 & 0x0F, i == 2 ? 0x1U : 0x3U) << "links of ports 0 and 1";
    EXPECT_EQ(bus.fprd(station(i), 0x0012, 2).working_counter, 1U);
    EXPECT_EQ(bus.fpwr(station(i), 0x0500, bytes({2})).working_counter, 1U);
    EXPECT_EQ(bus.fpwr(station(i), 0x0500, bytes({0})).working_counter, 1U);
  }
}

TEST_F(Igh, ASlaveWithoutSystemTimeDoesNotCountAtIt) {
  ethercat::SlaveControllerConfiguration plain;
  plain.features = ethercat::ControllerFeature::write_protection;
  bus.add_controller(plain);
  bus.apwr(3, 0x0010, little_endian(station(3), 2));
  EXPECT_EQ(bus.fprd(station(2), 0x0910, 8).working_counter, 1U);
  EXPECT_EQ(bus.fprd(station(2), 0x0910, 4).working_counter, 1U);
  EXPECT_EQ(bus.fprd(station(3), 0x0910, 8).working_counter, 0U);
  EXPECT_EQ(bus.fprd(station(3), 0x0910, 4).working_counter, 0U);
}

TEST_F(Igh, TheWholeSiiIsReadByFourByteCommandsAndTenByteReads) {
  const auto content = bus.device().controller().sii();
  Bytes read;
  for (std::size_t word = 0; word < content.size() / 2; word += 2) {
    const Bytes both = little_endian(read_sii(station(0), static_cast<std::uint16_t>(word)), 4);
    read.insert(read.end(), both.begin(), both.end());
  }
  EXPECT_EQ(read, Bytes(content.begin(), content.end()));
}

TEST_F(Igh, ASiiWordIsWrittenWithCommandAddressAndDataInOneDatagram) {
  for (std::uint16_t word = 0x60; word < 0x68; ++word) {
    Bytes command = bytes({0x81, 0x02, 0, 0, 0, 0, 0, 0});
    base::store_le(command, 2, word);
    base::store_le(command, 6, static_cast<std::uint16_t>(0x1100 + word));
    EXPECT_EQ(bus.fpwr(station(1), 0x0502, command).working_counter, 1U);
    const Bytes status = wait_for_sii(station(1));
    EXPECT_EQ(number(part(status, 0, 2)) & 0x7800, 0U);
  }
  for (std::uint16_t word = 0x60; word < 0x68; word = static_cast<std::uint16_t>(word + 2)) {
    EXPECT_EQ(read_sii(station(1), word), (0x1101U + word) << 16 | (0x1100U + word));
  }
}

TEST_F(Igh, TheStatusTellsWhetherTheEepromWasLoaded) {
  const auto not_loaded = [this] {
    return (number(part(bus.fprd(station(0), 0x0502, 10).data, 0, 2)) & 0x1000) != 0;
  };
  EXPECT_FALSE(not_loaded());
  ethercat::SlaveController& controller = bus.device().controller();
  Bytes broken(controller.sii().begin(), controller.sii().end());
  broken[14] ^= std::byte{0xFF};  // checksum
  controller.load_sii(broken);
  EXPECT_TRUE(not_loaded());
}

TEST_F(Igh, ConfigurationRunsFromInitToOperational) {
  const std::uint16_t slave = station(1);
  go_pre_operational(slave);
  configure_process_data(slave, 0);
  ASSERT_EQ(change_state(slave, 0x04), 0x04U);
  EXPECT_EQ(bus.lrw(0, zeros(60)).working_counter, 3U);
  ASSERT_EQ(change_state(slave, 0x08), 0x08U);
}

TEST_F(Igh, WatchdogTimesThatWereAskedForAreObeyed) {
  const std::uint16_t slave = station(0);
  go_pre_operational(slave);
  EXPECT_EQ(bus.fpwr(slave, 0x0400, little_endian(0x09C2, 2)).working_counter, 1U);
  EXPECT_EQ(bus.fpwr(slave, 0x0420, little_endian(50, 2)).working_counter, 1U);  // 5 ms
  configure_process_data(slave, 0);
  ASSERT_EQ(change_state(slave, 0x04), 0x04U);
  bus.lrw(0, zeros(60));
  ASSERT_EQ(change_state(slave, 0x08), 0x08U);
  bus.lrw(0, zeros(60));
  bus.pass(4_ms);
  EXPECT_EQ(number(bus.fprd(slave, 0x0130, 2).data), 0x08U);
  bus.pass(2_ms);
  EXPECT_EQ(number(bus.fprd(slave, 0x0130, 2).data), 0x14U);
  EXPECT_EQ(number(bus.fprd(slave, 0x0134, 2).data), 0x001BU);
}

TEST_F(Igh, AStateRequestIsRepeatedWhileTheSlaveHasNotTakenTheLastOne) {
  bus.set_firmware_running(false);
  EXPECT_EQ(bus.fpwr(station(0), 0x0120, little_endian(0x01, 2)).working_counter, 1U);
  EXPECT_EQ(bus.fpwr(station(0), 0x0120, little_endian(0x01, 2)).working_counter, 0U);
  bus.set_firmware_running(true);
  bus.pass(1_ms);
  EXPECT_EQ(bus.fpwr(station(0), 0x0120, little_endian(0x01, 2)).working_counter, 1U);
}

TEST_F(Igh, ARefusedStateIsToldAndAcknowledgedUntilTheErrorBitClears) {
  const std::uint16_t slave = station(0);
  ASSERT_EQ(change_state(slave, 0x01), 0x01U);
  clear(slave);
  EXPECT_EQ(change_state(slave, 0x02), 0x11U) << "no mailbox configured";
  EXPECT_EQ(number(bus.fprd(slave, 0x0134, 2).data), 0x0016U);
  EXPECT_EQ(bus.fpwr(slave, 0x0120, little_endian(0x11, 2)).working_counter, 1U);
  const base::SimTime limit = bus.now() + 5_s;
  while ((number(bus.fprd(slave, 0x0130, 2).data) & 0x10) != 0 && bus.now() < limit) {
    bus.pass(1_ms);
  }
  EXPECT_EQ(number(bus.fprd(slave, 0x0130, 2).data), 0x01U);
}

TEST_F(Igh, SystemTimeOffsetAndDelayAreReadAtOnceAndWrittenAtOnce) {
  const std::uint16_t slave = station(1);
  constexpr std::uint64_t kOffset = 700'000'000'000'000'000;
  Bytes settings = little_endian(kOffset, 8);
  const Bytes delay = little_endian(310, 4);
  settings.insert(settings.end(), delay.begin(), delay.end());
  EXPECT_EQ(bus.fpwr(slave, 0x0920, settings).working_counter, 1U);
  EXPECT_EQ(bus.fpwr(slave, 0x0930, little_endian(0x1000, 2)).working_counter, 1U);
  const Answer answer = bus.fprd(slave, 0x0910, 28);
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_GT(number(part(answer.data, 0, 8)), kOffset);
  EXPECT_EQ(number(part(answer.data, 16, 8)), kOffset);
  EXPECT_EQ(number(part(answer.data, 24, 4)), 310U);
}

TEST_F(Igh, TheReferenceFollowsTheApplicationAndTheOthersFollowIt) {
  // As ecrt_master_sync_reference_clock, _sync_slave_clocks and _sync_monitor do it.
  const auto application_time = [this] {
    return static_cast<std::uint64_t>((bus.now() - base::SimTime()).nanoseconds()) + 40'000;
  };
  std::uint64_t difference = 0;
  for (int cycle = 0; cycle < 3000; ++cycle) {
    const auto answers =
        bus.with(Command::fpwr, ethercat::physical_address(station(0), 0x0910),
                 little_endian(application_time(), 4))
            .with(Command::frmw, ethercat::physical_address(station(0), 0x0910), zeros(4))
            .with(Command::brd, ethercat::physical_address(0, 0x092C), zeros(4))
            .send();
    ASSERT_EQ(answers[0].working_counter, 1U);
    ASSERT_EQ(answers[1].working_counter, 3U);
    ASSERT_EQ(answers[2].working_counter, 3U);
    difference = number(answers[2].data) & 0x7FFFFFFF;
    bus.pass(1_ms);
  }
  EXPECT_LE(difference, 10'000U) << "ns, as it waits for before SYNC is started";
  const auto times =
      bus.with(Command::fprd, ethercat::physical_address(station(0), 0x0910), zeros(8))
          .with(Command::fprd, ethercat::physical_address(station(2), 0x0910), zeros(8))
          .send();
  EXPECT_LE(number(times[0].data) - number(times[1].data) + 1000, 2000U);
}

TEST_F(Igh, TheDifferenceRegisterSettlesBelowTenMicrosecondsWithinFiveSeconds) {
  ethercat::SlaveControllerConfiguration fast;
  fast.clock_deviation_ppb = 50'000;
  bus.add_controller(fast);
  bus.apwr(3, 0x0010, little_endian(station(3), 2));
  bus.pass(1_s);
  const base::SimTime limit = bus.now() + 5_s;
  const auto settled = [&] {
    return (number(bus.fprd(station(3), 0x092C, 4).data) & 0x7FFFFFFF) <= 10'000;
  };
  bus.frmw(station(0), 0x0910, 4);
  EXPECT_FALSE(settled()) << "50 us apart after a second";
  while (!settled() && bus.now() < limit) {
    bus.frmw(station(0), 0x0910, 4);
    bus.pass(1_ms);
  }
  EXPECT_TRUE(settled());
}

TEST_F(Igh, SyncIsConfiguredByCycleTimesStartTimeAndActivationWord) {
  const std::uint16_t slave = station(0);
  go_pre_operational(slave);
  Bytes cycles = little_endian(1'000'000, 4);
  const Bytes second = little_endian(500'000, 4);
  cycles.insert(cycles.end(), second.begin(), second.end());
  EXPECT_EQ(bus.fpwr(slave, 0x09A0, cycles).working_counter, 1U);
  const std::uint64_t start = number(bus.fprd(slave, 0x0910, 8).data) + 100'000'000;
  EXPECT_EQ(bus.fpwr(slave, 0x0990, little_endian(start, 8)).working_counter, 1U);
  EXPECT_EQ(bus.fpwr(slave, 0x0980, little_endian(0x0700, 2)).working_counter, 1U);
  EXPECT_EQ(bus.fprd(slave, 0x09A0, 8).data, cycles);
  EXPECT_EQ(number(bus.fprd(slave, 0x0980, 2).data), 0x0700U);
}

TEST_F(Igh, TheMailboxAnswersWithTheAddressOfTheRequestWithinASecond) {
  go_pre_operational(station(2));
  ASSERT_EQ(send(station(2), 3, hex("00 20 40 18 10 01 00 00 00 00")), 1U);
  const Bytes answer = fetch(station(2), 1_s);
  EXPECT_EQ(number(part(answer, 2, 2)), station(2));
  EXPECT_EQ(to_hex(part(answer, 6)), "00 30 43 18 10 01 86 02 00 00");
}

TEST_F(Igh, TheWholeDictionaryIsReadBySdoInformationInPreOperational) {
  const std::uint16_t slave = station(0);
  go_pre_operational(slave);
  std::vector<std::uint16_t> indices;
  ASSERT_EQ(send(slave, 3, hex("00 80 01 00 00 00 01 00")), 1U);
  for (std::uint64_t left = 1; left != 0;) {
    const Bytes answer = fetch(slave, 1_s);
    left = number(part(answer, 10, 2));
    for (std::size_t at = indices.empty() ? 14 : 12; at < answer.size(); at += 2) {
      indices.push_back(base::load_le<std::uint16_t>(answer, at));
    }
  }
  ASSERT_EQ(indices.size(), bus.device().dictionary().objects().size());
  std::size_t entries = 0;
  for (const std::uint16_t index : indices) {
    Bytes request = hex("00 80 03 00 00 00 00 00");
    base::store_le(request, 6, index);
    ASSERT_EQ(send(slave, 3, request), 1U);
    const Bytes object = fetch(slave, 1_s);
    ASSERT_EQ(object[8], std::byte{0x04}) << std::hex << index;
    const auto last = std::to_integer<unsigned>(object[16]);
    for (unsigned subindex = 0; subindex <= last; ++subindex) {
      request = hex("00 80 05 00 00 00 00 00 00 00");
      base::store_le(request, 6, index);
      request[8] = static_cast<std::byte>(subindex);
      ASSERT_EQ(send(slave, 3, request), 1U);
      const Bytes entry = fetch(slave, 1_s);
      entries += entry[8] == std::byte{0x06} ? 1 : 0;
    }
  }
  std::size_t declared = 0;
  for (const dictionary::Object& object : bus.device().dictionary().objects()) {
    declared += object.entries.size();
  }
  EXPECT_EQ(entries, declared);
}

TEST_F(Igh, TheLettersOfResetBringTheSlaveBackAsAfterPowerOn) {
  go_pre_operational(station(1));
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    EXPECT_EQ(bus.fpwr(station(1), 0x0040, bytes({key})).working_counter, 1U);
  }
  EXPECT_EQ(bus.fprd(station(1), 0x0130, 2).working_counter, 0U) << "its address is gone";
  EXPECT_EQ(number(bus.aprd(1, 0x0130, 2).data), 0x01U);
  EXPECT_EQ(bus.brd(0x0130, 2).working_counter, 3U);
}

}  // namespace
}  // namespace stator::tests
