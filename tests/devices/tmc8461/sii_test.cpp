// The category of the TMC8461's EEPROM image that configures its I/O block.
#include "stator/devices/tmc8461/sii.hpp"

#include <gmock/gmock.h>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::devices::tmc8461 {
namespace {

mfc::Configuration example() {
  mfc::Configuration configuration;
  configuration.set_block_start(0, 0x1000);
  configuration.set_block_start(1, 0x2000);
  configuration.set_signal(0, 4);
  for (const std::uint8_t number :
       {mfc::register_number::kSdCfg, mfc::register_number::kSdSteplength,
        mfc::register_number::kGpi, mfc::register_number::kSpiRxData}) {
    configuration.set_mapping(number, {true, mfc::Trigger::always});
  }
  return configuration;
}

// SII-1 of the examples: 49 words of category 1 first (L8189-L8199).
TEST(Tmc8461Sii, HasTheWholeVectorAsItsFirstCategory) {
  const auto image = ethercat::compose_sii_image(sii_contents(example(), {}));
  ASSERT_EQ(image.size(), 2048U);
  EXPECT_EQ(base::load_le<std::uint16_t>(image, 0x80), 1);
  EXPECT_EQ(base::load_le<std::uint16_t>(image, 0x82), 49);
  EXPECT_EQ(image[0x84], std::byte{4});
  EXPECT_EQ(image[0x84 + 0x22 + mfc::register_number::kGpi], std::byte{0x10});
}

TEST(Tmc8461Sii, ReadsBackAsItWasComposed) {
  const auto contents = sii_contents(example(), {});
  const auto parsed = ethercat::parse_sii_image(ethercat::compose_sii_image(contents));
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->parameter_ram, contents.parameter_ram);
  EXPECT_EQ(parsed->pdi_control, 0x0D05);
  EXPECT_EQ(parsed->name, contents.name);
  EXPECT_EQ(parsed->vendor_id, 0x286U);
  EXPECT_TRUE(parsed->distributed_clocks);
  ASSERT_EQ(parsed->sync_managers.size(), 2U);
  EXPECT_EQ(parsed->sync_managers[0].start, 0x1000);
  EXPECT_EQ(parsed->sync_managers[0].length, 12);
  EXPECT_EQ(parsed->sync_managers[1].start, 0x2000);
  EXPECT_EQ(parsed->sync_managers[1].length, 12);
  ASSERT_EQ(parsed->rx_pdos.size(), 1U);
  ASSERT_EQ(parsed->rx_pdos[0].entries.size(), 4U) << "two registers and their padding";
  EXPECT_EQ(parsed->rx_pdos[0].entries[0].name, "SD_STEPLENGTH");
  EXPECT_EQ(parsed->rx_pdos[0].entries[0].bits, 48);
  EXPECT_EQ(parsed->rx_pdos[0].entries[1].index, 0);
  EXPECT_EQ(parsed->rx_pdos[0].entries[1].bits, 16);
  EXPECT_EQ(parsed->tx_pdos[0].entries[0].index, 0x6006);
}

TEST(Tmc8461Sii, ThatDoesNotFitIsRefused) {
  BoardIdentity identity;
  identity.sii_size_kbit = 2;
  EXPECT_THROW(static_cast<void>(ethercat::compose_sii_image(sii_contents(example(), identity))),
               std::logic_error);
}

}  // namespace
}  // namespace stator::devices::tmc8461
