// The SII image that is built for a device, category by category, and read back (ETG.2010).
#include "stator/ethercat/sii/sii_image.hpp"

#include <stdexcept>

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using testing::ElementsAre;

class SiiImageTest : public testing::Test {
 protected:
  SiiImageTest() {
    fill_test_dictionary(dictionary);
    image = build_sii_image(description, dictionary);
  }
  unsigned word(std::size_t address) const {
    return base::load_le<std::uint16_t>(image, address * 2);
  }
  unsigned byte(std::size_t offset) const { return std::to_integer<unsigned>(image.at(offset)); }
  std::uint32_t long_word(std::size_t address) const {
    return word(address) | word(address + 1) << 16;
  }
  /// Byte offset of a category's body as a master searches for it; 0 if it is missing.
  std::size_t find(unsigned type) const {
    for (std::size_t at = 0x40; word(at) != 0xFFFF; at += 2 + word(at + 1)) {
      if (word(at) == type) {
        return (at + 2) * 2;
      }
    }
    return 0;
  }
  std::string string(unsigned number) const {
    std::size_t at = find(10) + 1;
    for (unsigned i = 1; i < number; ++i) {
      at += 1 + byte(at);
    }
    std::string text;
    for (unsigned i = 0; i < byte(at); ++i) {
      text += static_cast<char>(byte(at + 1 + i));
    }
    return text;
  }

  DeviceDescription description = test_description();
  dictionary::Dictionary dictionary;
  std::vector<std::byte> image;
};

TEST_F(SiiImageTest, Size_IsThatOfTheEeprom) {
  EXPECT_EQ(image.size(), 2048U);
  EXPECT_EQ(word(0x3E), 15U);
  EXPECT_EQ(word(0x3F), 1U);
  EXPECT_EQ(image.back(), std::byte{0xFF});
}

TEST_F(SiiImageTest, Checksum_CoversTheFirstFourteenBytes) {
  unsigned crc = 0xFF;
  for (std::size_t i = 0; i < 14; ++i) {
    for (int bit = 7; bit >= 0; --bit) {
      const bool feedback = ((crc >> 7) ^ (byte(i) >> bit & 1)) != 0;
      crc = (crc << 1 & 0xFF) ^ (feedback ? 0x07U : 0U);
    }
  }
  EXPECT_EQ(word(7), crc);
}

TEST_F(SiiImageTest, FixedPart_IdentifiesTheDeviceAndItsMailboxes) {
  EXPECT_EQ(word(0), 0x0005U);
  EXPECT_EQ(word(4), 0x1234U);
  EXPECT_EQ(long_word(0x08), 0x286U);
  EXPECT_EQ(long_word(0x0A), 3315U);
  EXPECT_EQ(long_word(0x0C), 0x00010009U);
  EXPECT_EQ(long_word(0x0E), 42U);
  EXPECT_EQ(word(0x14), 0U);
  EXPECT_EQ(word(0x15), 0U);
  EXPECT_EQ(word(0x18), 0x1000U);
  EXPECT_EQ(word(0x19), 128U);
  EXPECT_EQ(word(0x1A), 0x1080U);
  EXPECT_EQ(word(0x1B), 128U);
  EXPECT_EQ(word(0x1C), 0x0004U);
}

TEST_F(SiiImageTest, Strings_BeginWithTheName) {
  EXPECT_EQ(string(1), "TMCM-3315 Three axis stepper");
}

TEST_F(SiiImageTest, General_NamesGroupOrderCodeAndFeatures) {
  const std::size_t general = find(30);
  ASSERT_NE(general, 0U);
  EXPECT_EQ(word(general / 2 - 1), 16U);
  EXPECT_EQ(string(byte(general)), "Drives");
  EXPECT_EQ(byte(general + 1), 0U);
  EXPECT_EQ(string(byte(general + 2)), "TMCM-3315");
  EXPECT_EQ(byte(general + 3), 1U);
  EXPECT_EQ(byte(general + 5), 0x2FU);   // SDO, information, assign, configuration, complete access
  EXPECT_EQ(byte(general + 6), 0U);      // FoE
  EXPECT_EQ(byte(general + 7), 0U);      // EoE
  EXPECT_EQ(byte(general + 11), 0x04U);  // mailbox repetition
  EXPECT_EQ(word((general + 16) / 2), 0x0011U);
}

TEST_F(SiiImageTest, Fmmu_ListsOutputsInputsAndMailboxState) {
  const std::size_t fmmu = find(40);
  EXPECT_THAT(part(image, fmmu, 4),
              ElementsAre(std::byte{1}, std::byte{2}, std::byte{3}, std::byte{0xFF}));
}

TEST_F(SiiImageTest, SyncManagers_HaveTheDefaultLengths) {
  EXPECT_EQ(to_hex(part(image, find(41), 32)),
            "00 10 80 00 26 00 01 01 80 10 80 00 22 00 01 02 00 11 1E 00 64 00 01 03 00 14 1E 00 "
            "20 00 01 04");
}

TEST_F(SiiImageTest, Pdos_AreThoseOfTheDictionary) {
  const std::size_t rx = find(51);
  EXPECT_EQ(to_hex(part(image, rx, 5)), "00 16 09 02 00");
  EXPECT_EQ(string(byte(rx + 5)), "RxPDO 1");
  EXPECT_EQ(to_hex(part(image, rx + 8, 3)), "40 60 00");
  EXPECT_EQ(string(byte(rx + 11)), "Controlword");
  EXPECT_EQ(to_hex(part(image, rx + 12, 4)), "06 10 00 00");
  EXPECT_EQ(to_hex(part(image, rx + 80, 4)), "01 16 01 FF");  // 1601h is not assigned
  const std::size_t tx = find(50);
  EXPECT_EQ(to_hex(part(image, tx, 5)), "00 1A 09 03 00");
}

TEST_F(SiiImageTest, DistributedClocks_OfferSynchronAndDcSync) {
  const std::size_t dc = find(60);
  ASSERT_NE(dc, 0U);
  EXPECT_EQ(word(dc / 2 - 1), 24U);
  EXPECT_EQ(word((dc + 14) / 2), 0x0000U);
  EXPECT_EQ(word((dc + 24 + 14) / 2), 0x0300U);
}

TEST_F(SiiImageTest, TooSmallEeprom_IsAnErrorThatNamesBothSizes) {
  description.sii_size_kbit = 2;
  EXPECT_THROW(
      {
        try {
          static_cast<void>(build_sii_image(description, dictionary));
        } catch (const std::logic_error& error) {
          EXPECT_THAT(error.what(), testing::HasSubstr("the EEPROM has 256"));
          throw;
        }
      },
      std::logic_error);
}

TEST_F(SiiImageTest, Parser_ReadsWhatTheBuilderWrote) {
  const auto contents = parse_sii_image(image);
  ASSERT_TRUE(contents);
  EXPECT_EQ(contents->vendor_id, 0x286U);
  EXPECT_EQ(contents->serial_number, 42U);
  EXPECT_EQ(contents->transmit_mailbox.offset, 0x1080);
  EXPECT_EQ(contents->name, description.name);
  EXPECT_EQ(contents->order_code, description.order_code);
  ASSERT_EQ(contents->sync_managers.size(), 4U);
  EXPECT_EQ(contents->sync_managers[2].length, 30U);
  ASSERT_EQ(contents->rx_pdos.size(), 2U);
  EXPECT_EQ(contents->rx_pdos[0].entries[8].index, 0x70FF);
  EXPECT_EQ(contents->tx_pdos[0].entries[1].name, "Position actual value");
}

TEST_F(SiiImageTest, Parser_RefusesDamagedImages) {
  std::vector<std::byte> damaged = image;
  damaged[0] ^= std::byte{1};
  EXPECT_FALSE(parse_sii_image(damaged));
  EXPECT_FALSE(parse_sii_image(std::span(image).first(100)));
  for (std::size_t size = 128; size < 700; ++size) {
    static_cast<void>(parse_sii_image(std::span(image).first(size)));
  }
}

}  // namespace
}  // namespace stator::ethercat::test
