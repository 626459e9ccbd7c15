// What SOEM's config_init and eepromtool send, and what they check.

#include <array>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::tests {
namespace {

/// The EEPROM of one slave as SOEM reads it, double word by double word.
class SiiReader {
 public:
  SiiReader(Soem& soem, std::size_t position) : soem_(soem), position_(position) {}

  std::uint16_t word(std::uint16_t address) {
    const auto found = words_.find(address);
    if (found != words_.end()) {
      return found->second;
    }
    const std::uint32_t both = soem_.read_sii(position_, address);
    words_[static_cast<std::uint16_t>(address + 1)] = static_cast<std::uint16_t>(both >> 16);
    return words_[address] = static_cast<std::uint16_t>(both);
  }
  /// First word behind the header of category `type`, 0 if there is none.
  std::uint16_t category(unsigned type) {
    std::uint16_t at = 0x40;
    while (word(at) != 0xFFFF) {
      if (word(at) == type) {
        return static_cast<std::uint16_t>(at + 2);
      }
      at = static_cast<std::uint16_t>(at + 2 + word(static_cast<std::uint16_t>(at + 1)));
    }
    return 0;
  }
  unsigned category_words(unsigned type) {
    return word(static_cast<std::uint16_t>(category(type) - 1));
  }
  /// Byte `offset` of category `type`.
  unsigned byte(unsigned type, std::size_t offset) {
    const auto at = static_cast<std::uint16_t>(category(type) + offset / 2);
    return offset % 2 == 0 ? word(at) & 0xFFU : word(at) >> 8U;
  }
  std::string string(unsigned number) {
    std::size_t at = 1;
    for (; number > 1; --number) {
      at += 1 + byte(10, at);
    }
    std::string text;
    for (std::size_t i = 0; i < byte(10, at); ++i) {
      text += static_cast<char>(byte(10, at + 1 + i));
    }
    return text;
  }

 private:
  Soem& soem_;
  std::size_t position_;
  std::map<std::uint16_t, std::uint16_t> words_;
};

/// Bits per PDO category's list, as SOEM sums them when it maps by SII.
unsigned mapped_bits(SiiReader& sii, unsigned type) {
  unsigned bits = 0;
  for (std::size_t at = 0; at < 2 * std::size_t{sii.category_words(type)};) {
    const unsigned entries = sii.byte(type, at + 2);
    for (unsigned entry = 0; entry < entries; ++entry) {
      bits += sii.byte(type, at + 8 + 8 * entry + 5);
    }
    at += 8 + 8 * std::size_t{entries};
  }
  return bits;
}

TEST(SoemScan, ACountingBroadcastCountsEverySlaveUpToTheLimitOfTwoHundred) {
  for (const std::size_t slaves : {std::size_t{1}, std::size_t{3}, std::size_t{200}}) {
    DeviceBus bus(slaves);
    EXPECT_EQ(Soem(bus).count_slaves(), slaves);
  }
}

TEST(SoemScan, TheFirstBroadcastsBringARunningBusToInit) {
  DeviceBus bus(2);
  Soem soem(bus);
  soem.config_init();
  soem.config_map();
  soem.to_operational();
  soem.count_slaves();
  EXPECT_EQ(soem.wait_for_all(Soem::kInit), Soem::kInit);
  soem.config_init();
}

TEST(SoemScan, TheSecondAlControlMayCountNothingAndDoesNoHarm) {
  DeviceBus bus(2);
  bus.set_firmware_running(false);
  EXPECT_EQ(bus.bwr(0x0120, bytes({0x11})).working_counter, 2U);
  EXPECT_EQ(bus.bwr(0x0120, bytes({0x11})).working_counter, 0U);
  bus.set_firmware_running(true);
  EXPECT_EQ(Soem(bus).wait_for_all(Soem::kInit), Soem::kInit);
}

TEST(SoemScan, DefaultsBroadcast_CountsEverySlaveAtEachRegister) {
  DeviceBus bus(3);
  Soem(bus).set_defaults();
}

TEST(SoemScan, DefaultsBroadcast_ClearsWhatAnEarlierMasterLeft) {
  DeviceBus bus;
  Soem soem(bus);
  soem.config_init();
  soem.config_map();
  bus.device().controller().count_receive_error(0, ethercat::ReceiveError::invalid_frame);
  bus.fpwr(Soem::station(0), 0x0103, bytes({1}));
  ASSERT_NE(number(bus.aprd(0, 0x0300, 8).data), 0U);
  soem.set_defaults();
  for (const auto& [address, length] :
       {std::pair{0x0101, 1}, {0x0103, 1}, {0x0300, 8}, {0x0600, 48}, {0x0981, 1}, {0x0500, 1}}) {
    EXPECT_EQ(
        bus.aprd(0, static_cast<std::uint16_t>(address), static_cast<std::size_t>(length)).data,
        zeros(static_cast<std::size_t>(length)))
        << std::hex << address;
  }
  for (std::uint16_t channel = 0; channel < 4; ++channel) {
    const Bytes registers = bus.aprd(0, static_cast<std::uint16_t>(0x0800 + 8 * channel), 8).data;
    // The rest of an enabled channel is locked; it goes with the next configuration.
    EXPECT_EQ(registers[6], std::byte{0}) << channel;
  }
  EXPECT_EQ(number(bus.aprd(0, 0x0200, 2).data), 0x0004U);
  EXPECT_EQ(number(bus.aprd(0, 0x0930, 2).data), 0x1000U);
  EXPECT_EQ(number(bus.aprd(0, 0x0934, 2).data), 0x0C00U);
}

TEST(SoemScan, EverySlaveTakesItsStationAddressAndAnswersToIt) {
  DeviceBus bus(3);
  Soem soem(bus);
  soem.count_slaves();
  soem.set_defaults();
  soem.set_addresses();
  EXPECT_EQ(number(bus.fprd(Soem::station(0), 0x0100, 2).data) & 1, 1U)
      << "the first one keeps other frames out of the line";
  EXPECT_EQ(number(bus.fprd(Soem::station(1), 0x0100, 2).data) & 1, 0U);
  EXPECT_EQ(bus.fprd(0x1004, 0x0010, 2).working_counter, 0U);
}

TEST(SoemScan, TheEepromStatusTellsHowManyBytesAReadGives) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  const auto status = number(bus.fprd(Soem::station(0), 0x0502, 2).data);
  const std::size_t length = (status & 0x40) != 0 ? 8 : 4;
  soem.read_sii(0, 0x08);
  const Bytes data = bus.fprd(Soem::station(0), 0x0508, 8).data;
  const auto content = bus.device().controller().sii().subspan(0x10, length);
  EXPECT_EQ(part(data, 0, length), Bytes(content.begin(), content.end()));
}

TEST(SoemScan, SiiReadsInterleavedOverAllSlavesGiveEachItsOwnContent) {
  DeviceBus bus(0);
  for (std::uint32_t i = 0; i < 3; ++i) {
    devices::Tmcm3315Configuration configuration;
    configuration.serial_number = 100 + i;
    configuration.coe.station_alias = static_cast<std::uint16_t>(7 + i);
    bus.add_device(configuration);
  }
  Soem soem(bus);
  soem.set_addresses();
  const std::array<std::uint32_t, 5> identity{0x286, 3315, 0x00010009, 100, 0x02001000};
  constexpr std::array<std::uint16_t, 5> kWords{0x08, 0x0A, 0x0C, 0x0E, 0x18};
  for (std::size_t k = 0; k < kWords.size(); ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      soem.start_sii_read(i, kWords[k]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t serial = kWords[k] == 0x0E ? static_cast<std::uint32_t>(i) : 0;
      EXPECT_EQ(soem.finish_sii_read(i), identity[k] + serial) << std::hex << kWords[k];
    }
  }
  EXPECT_EQ(number(bus.fprd(Soem::station(2), 0x0012, 2).data), 9U) << "alias from word 4";
}

TEST(SoemScan, AnEepromErrorIsClearedByTheIdleCommandAndReadingGoesOn) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  bus.fpwr(Soem::station(0), 0x0502, bytes({0x00, 0x02, 0, 0, 0, 0}));  // write, not enabled
  EXPECT_NE(number(bus.fprd(Soem::station(0), 0x0502, 2).data) & 0x7800, 0U);
  bus.fpwr(Soem::station(0), 0x0502, zeros(2));
  EXPECT_EQ(number(bus.fprd(Soem::station(0), 0x0502, 2).data) & 0x7800, 0U);
  EXPECT_EQ(soem.read_sii(0, 0x0A), 3315U);
}

TEST(SoemScan, AMissingEepromIsRefusedEachTimeAndNeverBusy) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  bus.device().controller().load_sii({});
  for (int attempt = 0; attempt < 3; ++attempt) {
    soem.start_sii_read(0, 0x08);
    const auto status = number(bus.fprd(Soem::station(0), 0x0502, 2).data);
    EXPECT_EQ(status & 0xA000, 0x2000U) << attempt;
  }
}

TEST(SoemScan, FixedSiiWordsDescribeIdentityAndMailboxes) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  SiiReader sii(soem, 0);
  EXPECT_EQ(sii.word(0x08) | sii.word(0x09) << 16U, 0x286U);
  EXPECT_EQ(sii.word(0x0A), 3315U);
  EXPECT_EQ(sii.word(0x0C) | sii.word(0x0D) << 16U, 0x00010009U);
  EXPECT_EQ(sii.word(0x18), Soem::kReceiveMailbox);
  EXPECT_EQ(sii.word(0x19), Soem::kMailboxLength);
  EXPECT_EQ(sii.word(0x1A), Soem::kTransmitMailbox);
  EXPECT_EQ(sii.word(0x1B), Soem::kMailboxLength);
  EXPECT_EQ(sii.word(0x1C) & 0x0004, 0x0004) << "CoE";
}

TEST(SoemScan, TheGeneralCategoryAnnouncesWhatTheMailboxCan) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  SiiReader sii(soem, 0);
  const unsigned protocols = sii.word(0x1C);
  EXPECT_EQ(sii.byte(30, 0x05), 0x2FU) << "SDO, information, assign, configuration, complete";
  EXPECT_EQ(sii.byte(30, 0x06) != 0, (protocols & 0x08) != 0) << "FoE";
  EXPECT_EQ(sii.byte(30, 0x07) != 0, (protocols & 0x02) != 0) << "EoE";
  EXPECT_EQ(sii.byte(30, 0x08), 0U) << "SoE";
  EXPECT_EQ(sii.byte(30, 0x0B) & 0x02, 0U) << "LRW works";
  EXPECT_EQ(sii.byte(30, 0x0C), 0U) << "no current from the E-bus";
}

TEST(SoemScan, StringOneIsTheNameThatIsPrinted) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  EXPECT_EQ(SiiReader(soem, 0).string(1), "TMCM-3315");
}

TEST(SoemScan, SyncManagerAndFmmuCategoriesListTheChannelsInOrder) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  SiiReader sii(soem, 0);
  struct Row {
    unsigned start, length, control, enable, type;
  };
  constexpr std::array<Row, 4> kRows{{{Soem::kReceiveMailbox, Soem::kMailboxLength, 0x26, 1, 1},
                                      {Soem::kTransmitMailbox, Soem::kMailboxLength, 0x22, 1, 2},
                                      {Soem::kOutputs, Soem::kProcessData, 0x64, 1, 3},
                                      {Soem::kInputs, Soem::kProcessData, 0x20, 1, 4}}};
  ASSERT_GE(sii.category_words(41), 16U);
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    const std::size_t at = 8 * i;
    EXPECT_EQ(sii.byte(41, at) | sii.byte(41, at + 1) << 8U, kRows[i].start) << i;
    EXPECT_EQ(sii.byte(41, at + 2) | sii.byte(41, at + 3) << 8U, kRows[i].length) << i;
    EXPECT_EQ(sii.byte(41, at + 4), kRows[i].control) << i;
    EXPECT_EQ(sii.byte(41, at + 6) & 1, kRows[i].enable) << i;
    EXPECT_EQ(sii.byte(41, at + 7), kRows[i].type) << i;
  }
  for (const unsigned usage : {1U, 2U, 3U}) {
    EXPECT_EQ(sii.byte(40, usage - 1), usage);
  }
}

TEST(SoemScan, PdoCategoriesSumUpToTheLengthOfTheProcessData) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  SiiReader sii(soem, 0);
  EXPECT_EQ(mapped_bits(sii, 50), 8U * Soem::kProcessData);
  EXPECT_EQ(mapped_bits(sii, 51), 8U * Soem::kProcessData);
}

TEST(SoemScan, FeaturesAndPortsGiveTheLineAndTheParentOfEachSlave) {
  DeviceBus bus(4);
  Soem soem(bus);
  soem.set_addresses();
  for (std::size_t i = 0; i < bus.size(); ++i) {
    EXPECT_EQ(number(bus.fprd(Soem::station(i), 0x0008, 2).data) & 0x0004, 0x0004U) << "DC";
    const auto status = number(bus.fprd(Soem::station(i), 0x0110, 2).data);
    unsigned open = 0;
    for (unsigned port = 0; port < 4; ++port) {
      // Open: communication established (odd bit) and the loop not closed (even bit).
      const bool is_open = (status >> (8 + 2 * port) & 3) == 2;
      open |= (is_open ? 1U : 0U) << port;
    }
    EXPECT_EQ(open, i + 1 == bus.size() ? 0x1U : 0x3U) << i;
    EXPECT_EQ(number(bus.fprd(Soem::station(i), 0x0007, 1).data) & 0x0F, 0x0FU) << "two MII ports";
  }
}

TEST(SoemScan, OneWriteOfTwoMailboxesAndTheEepromGivenAwayLeadToPreOperational) {
  DeviceBus bus(3);
  Soem soem(bus);
  soem.config_init();
  for (std::size_t i = 0; i < bus.size(); ++i) {
    const Answer status = bus.fprd(Soem::station(i), 0x0130, 6);
    EXPECT_EQ(number(part(status.data, 0, 2)), 0x02U);
    EXPECT_EQ(number(part(status.data, 4, 2)), 0x00U) << "AL status code";
  }
}

TEST(SoemScan, FramesOnTheWireMayBeShorterThanSixtyBytesAndKeepTheirLength) {
  DeviceBus bus;
  const Bytes sent =
      hex("FF FF FF FF FF FF 01 01 01 01 01 01 88 A4 0D 10 "
          "07 00 00 00 00 00 01 00 00 00 00 00 00");
  ASSERT_EQ(sent.size(), 29U);
  Bytes frame = sent;
  EXPECT_TRUE(bus.send_raw(frame));
  EXPECT_EQ(frame.back(), std::byte{0});
  EXPECT_EQ(frame[27], std::byte{1}) << "working counter of one BRD";
}

TEST(SoemScan, TheSourceAddressKeepsItsRouteMark) {
  DeviceBus bus;
  for (const unsigned first : {0x01U, 0x04U}) {
    Bytes frame =
        hex("FF FF FF FF FF FF 01 01 01 01 01 01 88 A4 0E 10 "
            "07 00 00 00 00 00 02 00 00 00 00 00 00 00");
    for (std::size_t i = 6; i < 12; ++i) {
      frame[i] = static_cast<std::byte>(first);
    }
    ASSERT_TRUE(bus.send_raw(frame));
    EXPECT_EQ(frame[6], static_cast<std::byte>(first | 0x02));
    for (std::size_t i = 7; i < 12; ++i) {
      EXPECT_EQ(frame[i], static_cast<std::byte>(first));
    }
  }
}

TEST(SoemScan, EepromtoolReadsTheWholeContentBitExact) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  const auto content = bus.device().controller().sii();
  Bytes read;
  for (std::size_t word = 0; word < content.size() / 2; word += 2) {
    const Bytes both = little_endian(soem.read_sii(0, static_cast<std::uint16_t>(word)), 4);
    read.insert(read.end(), both.begin(), both.end());
  }
  EXPECT_EQ(read, Bytes(content.begin(), content.end()));
}

TEST(SoemScan, EepromtoolWritesWordByWordAndReadsBackWhatItWrote) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  for (std::uint16_t word = 0x40; word < 0x80; ++word) {
    soem.write_sii(0, word, static_cast<std::uint16_t>(0xA500 + word));
  }
  for (std::uint16_t word = 0x40; word < 0x80; word = static_cast<std::uint16_t>(word + 2)) {
    EXPECT_EQ(soem.read_sii(0, word), (0xA501U + word) << 16 | (0xA500U + word));
  }
}

TEST(SoemScan, AnAliasWrittenWithItsChecksumIsTheAliasAfterPowerOn) {
  DeviceBus bus;
  Soem soem(bus);
  soem.set_addresses();
  ethercat::SlaveController& controller = bus.device().controller();
  Bytes area(controller.sii().begin(), controller.sii().begin() + 14);
  base::store_le(area, 8, std::uint16_t{0x1234});
  soem.write_sii(0, 0x04, 0x1234);
  soem.write_sii(0, 0x07, ethercat::sii_checksum(area));
  controller.power_on_reset();
  EXPECT_EQ(number(bus.aprd(0, 0x0012, 2).data), 0x1234U);
  EXPECT_EQ(number(bus.aprd(0, 0x0502, 2).data) & 0x1800, 0U) << "loaded";
}

}  // namespace
}  // namespace stator::tests
