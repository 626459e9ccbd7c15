// Where registers and parameters of the I/O block stand in memory, against the document's example
// and formula.
#include "stator/mfc/block/memory_map.hpp"

#include <vector>

#include <gmock/gmock.h>

#include "mfc/csv_file.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using testing::document_table;
namespace number = register_number;

Configuration with(std::initializer_list<std::uint8_t> registers, std::uint16_t writes,
                   std::uint16_t reads) {
  Configuration configuration;
  configuration.set_block_start(0, writes);
  configuration.set_block_start(1, reads);
  for (const std::uint8_t entry : registers) {
    configuration.set_mapping(entry, {true, Trigger::always});
  }
  return configuration;
}

std::vector<std::uint32_t> addresses(const MemoryMap& map, unsigned block) {
  std::vector<std::uint32_t> list;
  for (const MappedRegister& entry : map.registers(block)) {
    list.push_back(entry.address);
  }
  return list;
}

// The example of the document: sizes 2, 8, 1, 4 in a block at 2000h (L8809-L8827).
TEST(MemoryMap, RegistersFollowAtMultiplesOfFourBytes) {
  const MemoryMap map(
      with({number::kEncMode, number::kSpiTxData, number::kSpiLength, number::kSdCh0Steprate},
           0x2000, 0x3000));
  ASSERT_EQ(addresses(map, 0), (std::vector<std::uint32_t>{0x2000, 0x2004, 0x200C, 0x2010}));
  EXPECT_EQ(map.registers(0)[0].end(), 0x2002U);
  EXPECT_EQ(map.registers(0)[1].end(), 0x200CU);
  EXPECT_EQ(map.registers(0)[2].end(), 0x200DU);
  EXPECT_EQ(map.block(0).end(), 0x2014U);
  EXPECT_EQ(map.block(1).length, 0U);
}

TEST(MemoryMap, OfFiveWriteRegistersComesFromTheseParameterBytes) {
  const Configuration configuration =
      with({number::kEncMode, number::kPositionWrite, number::kEncConst, number::kSpiTxData,
            number::kSpiConf},
           0x1000, 0);
  const auto bytes = configuration.bytes();
  const auto at = [&](std::size_t address) {
    return std::to_integer<int>(bytes[address - Configuration::kAddress]);
  };
  EXPECT_EQ(at(0x059E), 0x00);
  EXPECT_EQ(at(0x059F), 0x10);
  for (const std::size_t address : {0x05A2U, 0x05A4U, 0x05A6U, 0x05A9U, 0x05AAU}) {
    EXPECT_EQ(at(address), 0x10) << std::hex << address;
  }
  EXPECT_EQ(addresses(MemoryMap(configuration), 0),
            (std::vector<std::uint32_t>{0x1000, 0x1004, 0x1008, 0x100C, 0x1014}));
}

TEST(MemoryMap, ParameterBytesStandWhereTheDocumentSays) {
  for (const auto& row : document_table("mfc_parameter_map.csv")) {
    if (row.at("group") != "mfc_register") {
      continue;
    }
    const std::size_t address = std::stoul(row.at("esc_address"), nullptr, 16);
    const std::size_t entry = std::stoul(row.at("mfc_register"));
    Configuration configuration;
    configuration.set_mapping(entry, {true, Trigger::pwm_zero});
    EXPECT_EQ(configuration.bytes()[address - Configuration::kAddress], std::byte{0x1D});
    EXPECT_EQ(configuration.mapping(entry), (Mapping{true, Trigger::pwm_zero}));
    const MemoryMap map(configuration);
    EXPECT_TRUE(map.mapped(entry)) << row.at("function");
    EXPECT_EQ(map.registers(row.at("direction") == "W" ? 0 : 1).size(), 1U) << row.at("function");
  }
}

TEST(MemoryMap, OfRandomConfigurationsFollowsTheFormula) {
  const auto overview = document_table("mfc_register_overview.csv");
  base::Random random(8461);
  for (int run = 0; run < 2000; ++run) {
    std::array<std::byte, Configuration::kLength> bytes{};
    for (std::byte& byte : bytes) {
      byte = static_cast<std::byte>(random.next());
    }
    const Configuration configuration(bytes);
    const MemoryMap map(configuration);
    for (const unsigned block : {0U, 1U}) {
      const std::string direction = block == 0 ? "W" : "R";
      const std::size_t low = block == 0 ? 0x1E : 0x20;
      std::uint32_t next =
          std::to_integer<unsigned>(bytes[low]) | std::to_integer<unsigned>(bytes[low + 1]) << 8;
      std::size_t position = 0;
      for (std::size_t entry = 0; entry < 64; ++entry) {
        const unsigned size = static_cast<unsigned>(std::stoul(overview[entry].at("size_bytes")));
        const bool enabled = (std::to_integer<unsigned>(bytes[0x22 + entry]) & 0x10) != 0;
        if (!enabled || overview[entry].at("write_read") != direction) {
          continue;
        }
        ASSERT_LT(position, map.registers(block).size());
        const MappedRegister& mapped = map.registers(block)[position++];
        EXPECT_EQ(mapped.number, entry);
        EXPECT_EQ(mapped.address, next);
        EXPECT_EQ(mapped.size, size);
        EXPECT_EQ(static_cast<unsigned>(mapped.trigger),
                  std::to_integer<unsigned>(bytes[0x22 + entry]) & 0xF);
        next += (size + 3) / 4 * 4;
      }
      EXPECT_EQ(position, map.registers(block).size());
      EXPECT_EQ(map.block(block).end(), next);
      EXPECT_EQ(map.block(block).valid(), map.block(block).start >= 0x1000 && next <= 0x5000);
    }
  }
}

TEST(MemoryMap, WithoutConfigurationIsEmpty) {
  const MemoryMap map{Configuration{}};
  EXPECT_EQ(map.registers(0).size() + map.registers(1).size(), 0U);
  for (std::size_t entry = 0; entry < kRegisterCount; ++entry) {
    EXPECT_FALSE(map.mapped(entry));
  }
}

TEST(MemoryMap, RegistersWithoutAMappingCanNotBeMapped) {
  Configuration configuration = with({60, 61, 62}, 0x1000, 0x2000);
  const MemoryMap map(configuration);
  EXPECT_EQ(map.registers(0).size() + map.registers(1).size(), 0U);
  for (std::size_t entry : {60U, 61U, 62U, 64U, 65U, 66U}) {
    EXPECT_FALSE(map.mapped(entry));
  }
}

TEST(Configuration, MirrorsTheRegistersOfTheAnalogBlock) {
  Configuration configuration;
  configuration.set_high_voltage(0x0F030201);
  configuration.set_regulators(0x8BA5);
  const auto bytes = configuration.bytes();
  EXPECT_EQ(bytes[0x0598 - 0x0580], std::byte{0x01});
  EXPECT_EQ(bytes[0x0599 - 0x0580], std::byte{0x02});
  EXPECT_EQ(bytes[0x059A - 0x0580], std::byte{0x03});
  EXPECT_EQ(bytes[0x059B - 0x0580], std::byte{0x0F});
  EXPECT_EQ(bytes[0x059C - 0x0580], std::byte{0xA5});
  EXPECT_EQ(bytes[0x059D - 0x0580], std::byte{0x8B});
  EXPECT_EQ(configuration.high_voltage(), 0x0F030201U);
  EXPECT_EQ(configuration.regulators(), 0x8BA5U);
}

TEST(Configuration, TakesAShorterCategoryWithZerosBehindIt) {
  const std::array<std::byte, 2> category{std::byte{4}, std::byte{5}};
  const Configuration configuration(category);
  EXPECT_EQ(configuration.signal(0), 4);
  EXPECT_EQ(configuration.signal(1), 5);
  for (std::size_t line = 2; line < kLines; ++line) {
    EXPECT_EQ(configuration.signal(line), 0);
  }
}

}  // namespace
}  // namespace stator::mfc
