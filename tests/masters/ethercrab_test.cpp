// What ethercrab sends, and what it checks. Nearly every working counter is an error if it is not
// exactly as expected.

#include <string>

#include <gtest/gtest.h>

#include "masters/device_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

class Ethercrab : public ::testing::Test {
 protected:
  Ethercrab() : bus(2) {
    for (std::size_t i = 0; i < bus.size(); ++i) {
      bus.apwr(i, 0x0010, little_endian(station(i), 2));
    }
  }
  static std::uint16_t station(std::size_t position) {
    return static_cast<std::uint16_t>(0x1000 + position);
  }

  void expect_write(std::uint16_t address, std::uint16_t register_address, const Bytes& data) {
    EXPECT_EQ(bus.fpwr(address, register_address, data).working_counter, 1U)
        << "FPWR " << std::hex << register_address;
  }
  /// The bytes of one EEPROM read: four or eight, as bit 6 of the status says.
  Bytes read_sii(std::uint16_t address, std::uint16_t word) {
    Bytes command = bytes({0x00, 0x01, 0, 0, 0, 0});
    base::store_le(command, 2, word);
    expect_write(address, 0x0502, command);
    const base::SimTime limit = bus.now() + 10_ms;
    std::uint64_t status = 0x8000;
    while ((status & 0x8000) != 0) {
      if (bus.now() > limit) {
        ADD_FAILURE() << "EEPROM busy for 10 ms";
        return zeros(8);
      }
      status = number(bus.fprd(address, 0x0502, 2).data);
    }
    EXPECT_EQ(status & 0x7800, 0U);
    return bus.fprd(address, 0x0508, (status & 0x40) != 0 ? 8 : 4).data;
  }
  /// `length` bytes of the EEPROM from `byte` on.
  Bytes sii_bytes(std::uint16_t address, std::size_t byte, std::size_t length) {
    Bytes content;
    for (std::size_t at = byte / 2 * 2; content.size() < length + byte % 2;) {
      const Bytes chunk = read_sii(address, static_cast<std::uint16_t>(at / 2));
      content.insert(content.end(), chunk.begin(), chunk.end());
      at += chunk.size();
    }
    return part(content, byte % 2, length);
  }
  /// The content of one EEPROM category.
  Bytes category(std::uint16_t address, unsigned type) {
    for (std::size_t at = 0x80;;) {
      const Bytes header = sii_bytes(address, at, 4);
      const auto found = number(part(header, 0, 2));
      const std::size_t length = 2 * number(part(header, 2, 2));
      if (found == type) {
        return sii_bytes(address, at + 4, length);
      }
      if (found == 0xFFFF) {
        return {};
      }
      at += 4 + length;
    }
  }

  unsigned state(std::size_t slave) {
    const Answer answer = bus.fprd(station(slave), 0x0130, 2);
    EXPECT_EQ(answer.working_counter, 1U);
    return static_cast<unsigned>(number(answer.data));
  }
  void request(std::size_t slave, unsigned wanted) {
    expect_write(station(slave), 0x0120, little_endian(wanted, 2));
    const base::SimTime limit = bus.now() + 5_s;
    while (state(slave) != wanted && bus.now() < limit) {
      bus.pass(1_ms);
    }
    ASSERT_EQ(state(slave), wanted);
  }
  /// Mailbox channels as the category of sync managers lists them.
  void configure_mailboxes(std::size_t slave) {
    const Bytes channels = category(station(slave), 41);
    for (std::size_t channel = 0; channel < 2; ++channel) {
      Bytes registers = part(channels, 8 * channel, 8);
      registers[7] = std::byte{0};
      expect_write(station(slave), static_cast<std::uint16_t>(0x0800 + 8 * channel), registers);
    }
  }
  /// A single expedited upload; the write mailbox must be empty within 100 ms, the answer there
  /// within 1 s.
  std::uint32_t upload(std::size_t slave, std::uint16_t index, std::uint8_t subindex) {
    counter_ = counter_ % 7 + 1;
    Bytes message(512);
    message[0] = std::byte{10};
    message[5] = static_cast<std::byte>(3 | counter_ << 4);
    base::store_le(message, 6, std::uint16_t{0x2000});
    message[8] = std::byte{0x40};
    base::store_le(message, 9, index);
    message[11] = std::byte{subindex};
    wait_for_mailbox(slave, 0x0805, 0, 100_ms);
    expect_write(station(slave), 0x1000, message);
    wait_for_mailbox(slave, 0x080D, 8, 1_s);
    const Answer answer = bus.fprd(station(slave), 0x1200, 512);
    EXPECT_EQ(answer.working_counter, 1U);
    EXPECT_EQ(number(part(answer.data, 9, 2)), index);
    EXPECT_EQ(answer.data[8] & std::byte{0xE2}, std::byte{0x42}) << "expedited";
    const auto unused = std::to_integer<unsigned>(answer.data[8]) >> 2 & 3;
    return static_cast<std::uint32_t>(number(part(answer.data, 12, 4 - unused)));
  }
  void wait_for_mailbox(std::size_t slave, std::uint16_t status, unsigned full,
                        base::SimDuration patience) {
    const base::SimTime limit = bus.now() + patience;
    while ((number(bus.fprd(station(slave), status, 1).data) & 8) != full) {
      if (bus.now() > limit) {
        FAIL() << "mailbox status " << std::hex << status;
      }
      bus.pass(100_us);
    }
  }

  DeviceBus bus;
  unsigned counter_ = 0;
};

TEST_F(Ethercrab, OneByteOfTheTypeRegisterCountsTheSlaves) {
  EXPECT_EQ(bus.brd(0x0000, 1).working_counter, 2U);
}

TEST_F(Ethercrab, TheResetBroadcastsCountEverySlave) {
  EXPECT_EQ(bus.bwr(0x0120, bytes({0x11, 0})).working_counter, 2U);
  for (unsigned unit = 0; unit < 16; ++unit) {
    const Answer answer = bus.bwr(static_cast<std::uint16_t>(0x0600 + 16 * unit), zeros(16));
    EXPECT_TRUE(answer.returned);
    EXPECT_EQ(answer.working_counter, unit < 8 ? 2U : 0U) << "FMMU " << unit;
  }
  for (unsigned channel = 0; channel < 16; ++channel) {
    const Answer answer = bus.bwr(static_cast<std::uint16_t>(0x0800 + 8 * channel), zeros(8));
    EXPECT_TRUE(answer.returned);
    EXPECT_EQ(answer.working_counter, channel < 8 ? 2U : 0U) << "sync manager " << channel;
  }
  struct Row {
    std::uint16_t address;
    std::size_t length;
    unsigned count;
  };
  // The difference 0x092C is read-only.
  for (const Row& row : {Row{0x0910, 8, 2},
                         {0x0920, 8, 2},
                         {0x0928, 4, 2},
                         {0x092C, 4, 0},
                         {0x0981, 1, 2},
                         {0x0990, 8, 2},
                         {0x09A0, 4, 2},
                         {0x09A4, 4, 2}}) {
    EXPECT_EQ(bus.bwr(row.address, zeros(row.length)).working_counter, row.count)
        << std::hex << row.address;
  }
  EXPECT_EQ(bus.bwr(0x0934, bytes({0x00, 0x0C})).working_counter, 2U);
  EXPECT_EQ(bus.bwr(0x0930, bytes({0x00, 0x10})).working_counter, 2U);
  EXPECT_EQ(number(bus.brd(0x0120, 2).data) & 0x0F, 0x01U);
}

TEST_F(Ethercrab, TheEepromChangesOwnerByTwoByteWrites) {
  for (const unsigned owner : {2U, 0U, 1U, 2U, 0U}) {
    expect_write(station(0), 0x0500, bytes({owner, 0}));
    EXPECT_EQ(number(bus.fprd(station(0), 0x0500, 2).data), owner);
  }
  EXPECT_EQ(number(part(read_sii(station(0), 0x0A), 0, 4)), 3315U);
}

TEST_F(Ethercrab, TheEepromReadsInChunksAsItsStatusSays) {
  const auto content = bus.device().controller().sii();
  EXPECT_EQ(sii_bytes(station(0), 0, 512), Bytes(content.begin(), content.begin() + 512));
}

TEST_F(Ethercrab, TheNameOfTheSlaveIsTheOrderStringOfTheGeneralCategory) {
  const Bytes general = category(station(0), 30);
  const Bytes strings = category(station(0), 10);
  auto wanted = std::to_integer<unsigned>(general[2]);
  ASSERT_NE(wanted, 0U);
  std::size_t at = 1;
  for (; wanted > 1; --wanted) {
    at += 1 + std::to_integer<std::size_t>(strings[at]);
  }
  std::string name;
  for (const std::byte c : part(strings, at + 1, std::to_integer<std::size_t>(strings[at]))) {
    name += static_cast<char>(c);
  }
  EXPECT_EQ(name, "TMCM-3315");
}

TEST_F(Ethercrab, TheFmmuCategoryListsOutputsInputsAndMailboxStatus) {
  EXPECT_EQ(to_hex(part(category(station(0), 40), 0, 3)), "01 02 03");
}

TEST_F(Ethercrab, TheSyncManagerCategoryLeadsToPreOperational) {
  for (std::size_t slave = 0; slave < bus.size(); ++slave) {
    configure_mailboxes(slave);
    request(slave, 0x02);
  }
}

TEST_F(Ethercrab, FeaturesAliasAndLinkStatusAreRead) {
  EXPECT_EQ(number(bus.fprd(station(0), 0x0008, 2).data) & 0x000C, 0x000CU) << "DC, 64 bits";
  EXPECT_EQ(bus.fprd(station(0), 0x0012, 2).working_counter, 1U);
  EXPECT_EQ(bus.fprd(station(0), 0x0110, 2).working_counter, 1U);
}

TEST_F(Ethercrab, PhysicalLinksAgreeWithCommunicationAndLoops) {
  for (const bool broken : {false, true}) {
    bus.segment().set_link(1, !broken);
    const std::size_t reachable = broken ? 1 : 2;
    for (std::size_t slave = 0; slave < reachable; ++slave) {
      const auto status = number(bus.fprd(station(slave), 0x0110, 2).data);
      const unsigned expected = slave + 1 == reachable ? 0x1 : 0x3;
      for (unsigned port = 0; port < 4; ++port) {
        const unsigned up = expected >> port & 1;
        EXPECT_EQ(status >> (4 + port) & 1, up) << "physical link of port " << port;
        EXPECT_EQ(status >> (8 + 2 * port) & 3, up != 0 ? 2U : 1U) << "loop of port " << port;
      }
    }
  }
}

TEST_F(Ethercrab, LatchingTheReceiveTimesCountsExactlyTheSlavesWithClocks) {
  ethercat::SlaveControllerConfiguration coupler;
  coupler.features = ethercat::ControllerFeature::write_protection;
  bus.add_controller(coupler);
  ASSERT_EQ(bus.brd(0x0000, 1).working_counter, 3U);
  EXPECT_EQ(bus.bwr(0x0900, zeros(4)).working_counter, 2U);
  for (std::size_t slave = 0; slave < 2; ++slave) {
    EXPECT_EQ(bus.fprd(station(slave), 0x0918, 8).working_counter, 1U);
    EXPECT_EQ(bus.fprd(station(slave), 0x0900, 16).working_counter, 1U);
    expect_write(station(slave), 0x0920, zeros(8));
    expect_write(station(slave), 0x0928, zeros(4));
  }
  EXPECT_EQ(bus.frmw(station(0), 0x0910, 8).working_counter, 2U);
}

TEST_F(Ethercrab, TenThousandDriftFramesBringTheClocksTogether) {
  ethercat::SlaveControllerConfiguration slow;
  slow.clock_deviation_ppb = -30'000;
  bus.add_controller(slow);
  bus.apwr(2, 0x0010, little_endian(station(2), 2));
  bus.pass(1_s);
  for (int frame = 0; frame < 10'000; ++frame) {
    ASSERT_EQ(bus.frmw(station(0), 0x0910, 8).working_counter, 3U) << frame;
  }
  EXPECT_LT(number(bus.fprd(station(2), 0x092C, 4).data) & 0x7FFFFFFF, 100U);
}

TEST_F(Ethercrab, PdoSizesComeFromSingleExpeditedUploads) {
  configure_mailboxes(0);
  request(0, 0x02);
  for (const std::uint16_t assignment : {std::uint16_t{0x1C12}, std::uint16_t{0x1C13}}) {
    unsigned bits = 0;
    const std::uint32_t pdos = upload(0, assignment, 0);
    for (std::uint8_t pdo = 1; pdo <= pdos; ++pdo) {
      const auto mapping = static_cast<std::uint16_t>(upload(0, assignment, pdo));
      const std::uint32_t entries = upload(0, mapping, 0);
      for (std::uint8_t entry = 1; entry <= entries; ++entry) {
        bits += upload(0, mapping, entry) & 0xFF;
      }
    }
    EXPECT_EQ(bits, 8U * 30) << std::hex << assignment;
  }
}

TEST_F(Ethercrab, SyncRegistersTakeWhatIsWrittenEightBytesForTheCycleTime) {
  expect_write(station(0), 0x0981, bytes({0}));
  const std::uint64_t start = number(bus.fprd(station(0), 0x0910, 8).data) + 100'000'000;
  expect_write(station(0), 0x0990, little_endian(start, 8));
  expect_write(station(0), 0x09A0, little_endian(2'000'000, 8));
  EXPECT_EQ(number(bus.fprd(station(0), 0x09A0, 4).data), 2'000'000U);
  EXPECT_EQ(number(bus.fprd(station(0), 0x09A4, 4).data), 0U);
  expect_write(station(0), 0x09A4, little_endian(1'000'000, 4));
  expect_write(station(0), 0x0981, bytes({7}));
  EXPECT_EQ(number(bus.fprd(station(0), 0x0981, 1).data), 7U);
}

TEST_F(Ethercrab, TheCycleIsOneFrameAndTheStatesOfAllSlavesAnother) {
  for (std::size_t slave = 0; slave < bus.size(); ++slave) {
    const auto logical = static_cast<std::uint32_t>(60 * slave);
    configure_mailboxes(slave);
    request(slave, 0x02);
    expect_write(station(slave), 0x0810, sync_manager(0x1800, 30, 0x64));
    expect_write(station(slave), 0x0818, sync_manager(0x1C00, 30, 0x20));
    expect_write(station(slave), 0x0600, fmmu(logical, 30, 0x1800, 2));
    expect_write(station(slave), 0x0610, fmmu(logical + 30, 30, 0x1C00, 1));
    request(slave, 0x04);
  }
  for (const unsigned wanted : {0x04U, 0x08U}) {
    for (std::size_t slave = 0; slave < bus.size(); ++slave) {
      expect_write(station(slave), 0x0120, little_endian(wanted, 2));
    }
    for (int cycle = 0; cycle < 20; ++cycle) {
      const auto answers =
          bus.with(Command::frmw, ethercat::physical_address(station(0), 0x0910), zeros(8))
              .with(Command::lrw, 0, zeros(120))
              .send();
      ASSERT_EQ(answers[0].working_counter, 2U);
      ASSERT_EQ(answers[1].working_counter, 6U);
      bus.pass(1_ms);
    }
    for (std::size_t slave = 0; slave < bus.size(); ++slave) {
      bus.with(Command::fprd, ethercat::physical_address(station(slave), 0x0130), zeros(2));
    }
    for (const Answer& answer : bus.send()) {
      EXPECT_EQ(answer.working_counter, 1U);
      EXPECT_EQ(number(answer.data), wanted);
    }
  }
}

}  // namespace
}  // namespace stator::tests
