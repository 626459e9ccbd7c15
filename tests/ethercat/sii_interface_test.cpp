// EEPROM access over 0500h in the ways of SOEM, IgH and TwinCAT, with errors, ownership and reload.
#include "stator/ethercat/units/sii_interface.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_ms;
using base::literals::operator""_us;
using testing::Answer;
using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::little_endian;
using testing::number;
using testing::TestBus;
using testing::valid_sii;

constexpr unsigned kBusy = 0x8000;

class Sii : public ::testing::Test {
 protected:
  unsigned status() { return static_cast<unsigned>(number(bus.read(0, 0x0502, 2).data)); }
  unsigned finished_status() {
    for (int poll = 0; poll < 1000; ++poll) {
      const unsigned value = status();
      if ((value & kBusy) == 0) {
        return value;
      }
    }
    return kBusy;
  }
  static Bytes command(unsigned code, std::uint32_t word, std::size_t length) {
    Bytes result = little_endian(code, 2);
    const Bytes address = little_endian(word, 4);
    result.insert(result.end(), address.begin(), address.end());
    result.resize(length);
    return result;
  }
  TestBus bus;
  SlaveController& slave = bus.slave();
};

TEST_F(Sii, ReadAsSoemAndEthercrabDo_SixByteCommandPollAndFourBytes) {
  bus.write(0, 0x0500, bytes({2}));
  bus.write(0, 0x0500, bytes({0}));
  EXPECT_EQ(bus.write(0, 0x0502, command(0x0100, 0x0040, 6)).working_counter, 1U);
  EXPECT_EQ(status() & kBusy, kBusy) << "busy is honest";
  EXPECT_EQ(finished_status() & 0xFF00U, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0508, 8).data), 0x00410040U) << "four bytes, the rest 0";
}

TEST_F(Sii, ReadAsIghDoes_FourByteCommandAndOneTenByteAnswer) {
  EXPECT_EQ(bus.write(0, 0x0502, bytes({0x80, 0x01, 0x0A, 0x00})).working_counter, 1U);
  bus.wait(1_ms);
  const Answer answer = bus.read(0, 0x0502, 10);
  EXPECT_EQ(number(answer.data) & 0xFFFFU, 0U);
  EXPECT_EQ(number(std::span(answer.data).subspan(6)), 0x000B000AU);
}

TEST_F(Sii, ReadAsTwinCatDoes_FourteenBytes) {
  bus.write(0, 0x0502, command(0x0100, 0x0008, 6));
  bus.wait(1_ms);
  const Answer answer = bus.read(0, 0x0502, 14);
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_EQ(number(std::span(answer.data).subspan(6, 4)), 0x00090008U);
}

TEST_F(Sii, EightByteRead_IsAnnouncedByBitSix) {
  SlaveControllerConfiguration configuration;
  configuration.features = configuration.features | ControllerFeature::sii_eight_byte_read;
  TestBus wide(1, configuration);
  EXPECT_EQ(number(wide.read(0, 0x0502, 2).data) & 0x40U, 0x40U);
  wide.write(0, 0x0502, command(0x0100, 0x0010, 6));
  wide.wait(1_ms);
  EXPECT_EQ(number(wide.read(0, 0x0508, 8).data), 0x0013001200110010U);
}

TEST_F(Sii, WriteAsSoemDoes_DataFirstThenCommandWithWriteEnable) {
  bus.write(0, 0x0508, bytes({0xCD, 0xAB}));
  EXPECT_EQ(bus.write(0, 0x0502, command(0x0201, 0x0100, 6)).working_counter, 1U);
  EXPECT_EQ(finished_status() & 0x7F00U, 0U);
  EXPECT_EQ(base::load_le<std::uint16_t>(slave.sii(), 0x200), 0xABCD);
}

TEST_F(Sii, WriteAsIghDoes_EightBytesInOneDatagram) {
  EXPECT_EQ(
      bus.write(0, 0x0502, bytes({0x81, 0x02, 0x00, 0x01, 0x00, 0x00, 0x34, 0x12})).working_counter,
      1U);
  EXPECT_EQ(finished_status() & 0x7F00U, 0U);
  EXPECT_EQ(base::load_le<std::uint16_t>(slave.sii(), 0x200), 0x1234)
      << "the command runs after the data of its datagram have landed";
}

TEST_F(Sii, WriteImmediatelyAfterWrite_IsRefusedWhileBusyAndWorksAfterwards) {
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x00, 0x01, 0x00, 0x00, 0x34, 0x12}));
  EXPECT_EQ(bus.write(0, 0x0502, bytes({0x81, 0x02, 0x01, 0x01, 0, 0, 0x78, 0x56})).working_counter,
            0U);
  EXPECT_EQ(finished_status() & 0xFF00U, 0U);
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x01, 0x01, 0, 0, 0x78, 0x56}));
  EXPECT_EQ(finished_status() & 0xFF00U, 0U);
  EXPECT_EQ(base::load_le<std::uint32_t>(slave.sii(), 0x200), 0x56781234U);
}

TEST_F(Sii, WriteWithoutWriteEnable_SetsBit14UntilTheNextCommand) {
  bus.write(0, 0x0508, bytes({0xCD, 0xAB}));
  bus.write(0, 0x0502, command(0x0200, 0x0100, 6));
  EXPECT_EQ(finished_status() & 0x6000U, 0x4000U);
  EXPECT_NE(base::load_le<std::uint16_t>(slave.sii(), 0x200), 0xABCD);
  bus.write(0, 0x0502, command(0x0000, 0, 2));
  EXPECT_EQ(status() & 0x6000U, 0U);
}

TEST_F(Sii, WriteEnableOfAnEarlierFrame_IsGone) {
  bus.write(0, 0x0502, bytes({0x01, 0x00}));
  bus.write(0, 0x0503, bytes({0x02}));
  EXPECT_EQ(finished_status() & 0x4000U, 0x4000U);
}

TEST_F(Sii, InvalidCommand_SetsBit13AndAValidOneClearsIt) {
  for (const unsigned code : {0x0300U, 0x0500U, 0x0600U, 0x0700U}) {
    bus.write(0, 0x0502, command(code, 0, 6));
    EXPECT_EQ(finished_status() & 0xE700U, 0x2000U) << "not busy, no command, error";
  }
  bus.write(0, 0x0502, command(0x0100, 0x10, 6));
  EXPECT_EQ(finished_status() & 0x6000U, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0508, 4).data), 0x00110010U);
}

TEST_F(Sii, Reload_TakesTheConfigurationAreaButNotTheAlias) {
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x04, 0x00, 0, 0, 0x77, 0x00}));
  finished_status();
  Bytes area(slave.sii().begin(), slave.sii().begin() + 16);
  const unsigned checksum = sii_checksum(area);
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x07, 0x00, 0, 0, checksum, 0x00}));
  finished_status();
  bus.write(0, 0x0502, command(0x0400, 0, 6));
  EXPECT_EQ(finished_status() & 0x7800U, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0012, 2).data), 0U);
  slave.power_on_reset();
  EXPECT_EQ(number(bus.read(0, 0x0012, 2).data), 0x77U);
}

TEST_F(Sii, BadChecksum_IsShownAndClosesTheMemoryUntilRepairedAndReloaded) {
  Bytes image = valid_sii();
  image[14] ^= std::byte{0xFF};
  slave.load_sii(image);
  EXPECT_EQ(status() & 0x1800U, 0x1800U);
  EXPECT_EQ(number(bus.read(0, 0x0110, 1).data) & 1U, 0U);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1})).working_counter, 0U);
  const unsigned good = sii_checksum(image);
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x07, 0x00, 0, 0, good, 0x00}));
  finished_status();
  bus.write(0, 0x0502, command(0x0400, 0, 6));
  EXPECT_EQ(finished_status() & 0x1800U, 0U);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1})).working_counter, 1U);
}

TEST_F(Sii, NotLoaded_KeepsBothSidesFromTheProcessDataRamFromEndToEnd) {
  // 16 KByte from 1000h to 4FFFh, open while 0110h bit 0 is 1.
  constexpr std::uint16_t kCells[] = {0x1000, 0x2FFF, 0x4FFF};
  const auto open_to_bus = [&](std::uint16_t address) {
    const unsigned written = bus.write(0, address, bytes({0x5A})).working_counter;
    const unsigned read = bus.read(0, address, 1).working_counter;
    EXPECT_EQ(written, read) << std::hex << address;
    return written == 1;
  };
  const auto open_to_host = [&](std::uint16_t address, unsigned value) {
    host_write(slave, address, bytes({value}));
    return number(host_read(slave, address, 1)) == value;
  };
  const auto operational = [&] { return number(bus.read(0, 0x0110, 1).data) & 1U; };
  Bytes damaged = valid_sii();
  damaged[14] ^= std::byte{0xFF};
  for (const Bytes& image : {damaged, Bytes{}}) {
    slave.load_sii(valid_sii());
    EXPECT_EQ(operational(), 1U);
    for (const std::uint16_t address : kCells) {
      EXPECT_TRUE(open_to_bus(address)) << std::hex << address;
      EXPECT_TRUE(open_to_host(address, 0x33)) << std::hex << address;
    }
    slave.load_sii(image);
    EXPECT_EQ(operational(), 0U);
    for (const std::uint16_t address : kCells) {
      EXPECT_FALSE(open_to_bus(address)) << std::hex << address;
      EXPECT_FALSE(open_to_host(address, 0x44)) << std::hex << address;
    }
    slave.load_sii(valid_sii());
    for (const std::uint16_t address : kCells) {
      EXPECT_NE(number(bus.read(0, address, 1).data), 0x44U)
          << "what the host wrote meanwhile was lost: " << std::hex << address;
    }
  }
  EXPECT_FALSE(open_to_bus(0x5000)) << "no memory there";
  EXPECT_FALSE(open_to_host(0x5000, 0x44));
}

TEST_F(Sii, WithoutEeprom_CommandsGetNoAcknowledge) {
  slave.load_sii({});
  bus.write(0, 0x0502, command(0x0100, 0, 6));
  EXPECT_EQ(finished_status() & 0x3000U, 0x3000U);
}

TEST_F(Sii, HostTakesTheEepromOnlyWhenOfferedAndTheMasterTakesItBack) {
  host_write(slave, 0x0501, bytes({1}));
  EXPECT_EQ(number(host_read(slave, 0x0501, 1)), 0U) << "not offered";
  bus.write(0, 0x0500, bytes({1}));
  host_write(slave, 0x0501, bytes({1}));
  EXPECT_EQ(status() & 1U, 1U) << "write enable reads 1 while the host owns it";
  EXPECT_EQ(bus.write(0, 0x0502, command(0x0100, 0x10, 6)).working_counter, 0U);
  host_write(slave, 0x0502, command(0x0100, 0x20, 6));
  bus.wait(1_ms);
  EXPECT_EQ(number(host_read(slave, 0x0508, 4)), 0x00210020U);
  EXPECT_EQ(bus.write(0, 0x0500, bytes({2, 0})).working_counter, 1U)
      << "two-byte write, second byte read-only";
  EXPECT_EQ(number(bus.read(0, 0x0501, 1).data), 0U);
  EXPECT_EQ(bus.write(0, 0x0502, command(0x0100, 0x10, 6)).working_counter, 1U);
}

TEST_F(Sii, AddressesBeyondTheEeprom_Repeat) {
  bus.write(0, 0x0502, command(0x0100, 0x0400 + 0x0040, 6));
  bus.wait(1_ms);
  EXPECT_EQ(number(bus.read(0, 0x0508, 4).data), 0x00410040U);
}

TEST_F(Sii, WholeImage_ReadWordPairByWordPairIsBitExact) {
  const Bytes image = valid_sii();
  for (std::uint32_t word = 0; word < image.size() / 2; word += 2) {
    bus.write(0, 0x0502, command(0x0100, word, 6));
    ASSERT_EQ(finished_status() & 0xF800U, 0U);
    ASSERT_EQ(number(bus.read(0, 0x0508, 4).data), base::load_le<std::uint32_t>(image, 2 * word));
  }
}

TEST_F(Sii, Load_FillsTheRegistersOfTheConfigurationArea) {
  Bytes image = valid_sii();
  const Bytes area =
      bytes({0x05, 0x0C, 0x03, 0xEE, 0x64, 0x00, 0x00, 0x00, 0x34, 0x12, 0, 0, 0, 0});
  std::copy(area.begin(), area.end(), image.begin());
  image[14] = std::byte{sii_checksum(image)};
  EXPECT_EQ(number(bus.read(0, 0x0151, 1).data), 0U) << "from the image before";
  slave.load_sii(image);
  EXPECT_EQ(number(bus.read(0, 0x0140, 2).data), 0x0C05U);
  EXPECT_EQ(bus.read(0, 0x0150, 4).data, bytes({0x03, 0xEE, 0x00, 0x00}));
  EXPECT_EQ(number(bus.read(0, 0x0982, 2).data), 100U);
  EXPECT_EQ(number(bus.read(0, 0x0012, 2).data), 0x1234U);
  EXPECT_EQ(number(bus.read(0, 0x014E, 2).data), 0x0006U) << "configured and active";
  EXPECT_EQ(bus.write(0, 0x0982, bytes({1, 0})).working_counter, 0U);
}

TEST_F(Sii, ExtendedHostConfiguration_IsWhatWordThreeSaysWhichIsReservedAsZero) {
  const auto shown = [&] { return number(bus.read(0, 0x0152, 2).data); };
  SlaveController bare{SlaveControllerConfiguration{}};
  EXPECT_EQ(number(host_read(bare, 0x0152, 2)), 0U) << "before the EEPROM is loaded";
  EXPECT_EQ(shown(), 0U);
  EXPECT_EQ(bus.write(0, 0x0152, bytes({0xC3, 0xA5})).working_counter, 0U);
  host_write(slave, 0x0152, bytes({0xC3, 0xA5}));
  EXPECT_EQ(shown(), 0U) << "neither side writes it";

  Bytes image = valid_sii();
  base::store_le(image.data() + 6, std::uint16_t{0xA5C3});
  image[14] = std::byte{sii_checksum(image)};
  slave.load_sii(image);
  EXPECT_EQ(shown(), 0xA5C3U) << "an EEPROM against the document is shown as it is";
  EXPECT_EQ(number(host_read(slave, 0x0152, 2)), 0xA5C3U);
  EXPECT_EQ(number(bus.read(0, 0x014E, 2).data), 0x0006U) << "and switches nothing";
  slave.load_sii(valid_sii());
  EXPECT_EQ(shown(), 0U);
}

TEST_F(Sii, Load_CopiesTheFirstCategoryToTheParameterRamAndClearsTheRest) {
  bus.write(0, 0x0580, Bytes(128, std::byte{0xEE}));
  Bytes image = valid_sii();
  base::store_le(image.data() + 0x80, std::uint16_t{1});
  base::store_le(image.data() + 0x82, std::uint16_t{49});
  slave.load_sii(image);
  const Bytes ram = bus.read(0, 0x0580, 128).data;
  EXPECT_TRUE(std::equal(ram.begin(), ram.begin() + 98, image.begin() + 0x84));
  EXPECT_EQ(Bytes(ram.begin() + 98, ram.end()), testing::zeros(30));

  base::store_le(image.data() + 0x82, std::uint16_t{100});
  slave.load_sii(image);
  const Bytes full = bus.read(0, 0x0580, 128).data;
  EXPECT_TRUE(std::equal(full.begin(), full.end(), image.begin() + 0x84)) << "128 bytes at most";
  EXPECT_EQ(number(bus.read(0, 0x0600, 4).data), 0U);

  bus.write(0, 0x0580, Bytes(128, std::byte{0xEE}));
  bus.write(0, 0x0502, command(0x0400, 0, 6));
  finished_status();
  EXPECT_EQ(bus.read(0, 0x0580, 128).data, full) << "a reload copies again";
}

TEST_F(Sii, AnotherHostInterfaceThanSpi_IsShownAsInvalid) {
  Bytes image = valid_sii();
  image[0] = std::byte{0x80};
  image[14] = std::byte{sii_checksum(image)};
  slave.load_sii(image);
  EXPECT_EQ(number(bus.read(0, 0x014E, 1).data), 0x0AU) << "configured, invalid, not active";
}

TEST_F(Sii, EnhancedLinkDetection_OfAnyPortIsShownInDlStatus) {
  EXPECT_EQ(number(bus.read(0, 0x0110, 1).data) & 4U, 0U);
  for (const unsigned setting : {0x02U, 0x10U, 0x20U}) {
    Bytes image = valid_sii();
    image[1] = static_cast<std::byte>(setting);
    image[14] = std::byte{sii_checksum(image)};
    slave.load_sii(image);
    EXPECT_EQ(number(bus.read(0, 0x0110, 1).data) & 4U, 4U) << setting;
  }
}

TEST_F(Sii, EnhancedLinkDetection_IsTakenAtTheFirstLoadOnly) {
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x00, 0x00, 0, 0, 0x05, 0x02}));
  finished_status();
  const unsigned checksum = sii_checksum(slave.sii());
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x07, 0x00, 0, 0, checksum, 0x00}));
  finished_status();
  bus.write(0, 0x0502, command(0x0400, 0, 6));
  EXPECT_EQ(finished_status() & 0x7800U, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0141, 1).data), 0x02U);
  EXPECT_EQ(number(bus.read(0, 0x0110, 1).data) & 4U, 0U);
  slave.power_on_reset();
  EXPECT_EQ(number(bus.read(0, 0x0110, 1).data) & 4U, 4U);
}

TEST_F(Sii, ReceiveFifoSize_ComesInvertedFromWord5) {
  EXPECT_EQ(number(bus.read(0, 0x0102, 1).data), 7U) << "word 5 is 0";
  for (unsigned size = 0; size < 8; ++size) {
    Bytes image = valid_sii();
    image[11] = static_cast<std::byte>((~size & 7U) << 1 | 0xF1);
    image[14] = std::byte{sii_checksum(image)};
    slave.load_sii(image);
    EXPECT_EQ(number(bus.read(0, 0x0102, 1).data), size);
    const std::int64_t gain = size <= 3 ? 40 : 0;
    EXPECT_EQ(slave.forwarding_delay().nanoseconds(), 300 - gain);
  }
}

TEST_F(Sii, ReceiveFifoSize_IsTakenAtTheFirstLoadOnly) {
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x05, 0x00, 0, 0, 0x00, 0x0A}));
  finished_status();
  const unsigned checksum = sii_checksum(slave.sii());
  bus.write(0, 0x0502, bytes({0x81, 0x02, 0x07, 0x00, 0, 0, checksum, 0x00}));
  finished_status();
  bus.write(0, 0x0502, command(0x0400, 0, 6));
  EXPECT_EQ(finished_status() & 0x7800U, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0102, 1).data), 7U) << "as it was";
  slave.power_on_reset();
  EXPECT_EQ(number(bus.read(0, 0x0102, 1).data), 2U);
  bus.write(0, 0x0102, bytes({0x06}));
  bus.write(0, 0x0502, command(0x0400, 0, 6));
  finished_status();
  EXPECT_EQ(number(bus.read(0, 0x0102, 1).data), 6U) << "what the master set";
}

TEST_F(Sii, NoCommandRaisesTheEventOfEepromEmulation) {
  for (const unsigned code : {0x0100U, 0x0201U, 0x0300U, 0x0400U}) {
    bus.write(0, 0x0502, command(code, 0x20, 6));
    finished_status();
    EXPECT_EQ(slave.al_event_request() & 0x20U, 0U);
    EXPECT_EQ(status() & 0x0020U, 0U) << "emulation is not there";
  }
}

TEST_F(Sii, AddressBits_FollowTheSizeOfTheEeprom) {
  EXPECT_EQ(status() & 0x0080U, 0U) << "16 kbit: one address byte";
  Bytes image = valid_sii();
  image.resize(4096);
  slave.load_sii(image);
  EXPECT_EQ(status() & 0x0080U, 0x0080U) << "32 kbit: two";
}

TEST(SiiOfTmc8670, CommandsAreIgnoredWhileAnErrorIsPending) {
  SlaveControllerConfiguration configuration;
  configuration.sii_error_blocks_commands = true;
  TestBus bus(1, configuration);
  bus.write(0, 0x0502, bytes({0x00, 0x03}));
  EXPECT_EQ(number(bus.read(0, 0x0502, 2).data) & 0xE700U, 0x2000U);
  bus.write(0, 0x0502, bytes({0x00, 0x01}));
  EXPECT_EQ(number(bus.read(0, 0x0502, 2).data) & 0xE700U, 0x2000U) << "neither run nor cleared";
  bus.write(0, 0x0502, bytes({0x00, 0x00}));
  EXPECT_EQ(number(bus.read(0, 0x0502, 2).data) & 0xE700U, 0U);
  bus.write(0, 0x0502, bytes({0x00, 0x01}));
  EXPECT_EQ(number(bus.read(0, 0x0502, 2).data) & 0x8700U, 0x8100U) << "runs";
}

TEST(SiiChecksum, MatchesVectorsComputedByAnIndependentTable) {
  EXPECT_EQ(sii_checksum(bytes({5, 0x0C, 3, 0xEE, 0x64, 0, 0, 0, 0, 0, 0, 0, 0, 0})), 0xA4);
  EXPECT_EQ(sii_checksum(bytes({5, 0x0C, 3, 0x66, 0xE8, 3, 0, 0, 0, 0, 0, 0, 0, 0})), 0x18);
  EXPECT_EQ(sii_checksum(testing::zeros(14)), 0x30);
  EXPECT_EQ(sii_checksum(bytes({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13})), 0xE0);
  EXPECT_EQ(sii_checksum(bytes({0x05, 0x0E, 0x03, 0x6E, 0x0A, 0, 0, 0, 0x34, 0x12, 0, 0, 0, 0})),
            0x8A);
}

}  // namespace
}  // namespace stator::ethercat
