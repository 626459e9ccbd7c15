// Registers and fields of the I/O block against the document's overview and tables.
#include "stator/mfc/registers/register_map.hpp"

#include <set>

#include <gmock/gmock.h>

#include "mfc/csv_file.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/mfc/registers/register_description.hpp"

namespace stator::mfc {
namespace {

using testing::document_table;

std::uint64_t mask_of(const RegisterField& field) {
  const unsigned width = field.bit_hi - field.bit_lo + 1U;
  const std::uint64_t ones = width == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
  return ones << field.bit_lo;
}

TEST(RegisterMap, HasTheRegistersOfTheDocumentsOverview) {
  const auto table = document_table("mfc_register_overview.csv");
  ASSERT_EQ(table.size(), kRegisters.size());
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Register& entry = kRegisters[i];
    const auto& row = table[i];
    EXPECT_EQ(entry.number, std::stoul(row.at("number")));
    EXPECT_EQ(entry.spi_address(), std::stoul(row.at("mfc_spi_address"), nullptr, 16));
    EXPECT_EQ(entry.name, row.at("name"));
    const std::string direction = entry.direction == Direction::write  ? "W"
                                  : entry.direction == Direction::read ? "R"
                                                                       : "-";
    EXPECT_EQ(direction, row.at("write_read")) << entry.name;
    EXPECT_EQ(entry.size, std::stoul(row.at("size_bytes"))) << entry.name;
    EXPECT_EQ(entry.mapped_size(), std::stoul(row.at("mapped_bytes"))) << entry.name;
    EXPECT_EQ("L" + std::to_string(entry.line), row.at("source_line")) << entry.name;
    const std::string block = !entry.mappable()                     ? ""
                              : entry.direction == Direction::write ? "0"
                                                                    : "1";
    EXPECT_EQ(block, row.at("memory_block")) << entry.name;
  }
}

TEST(RegisterMap, PrintsTheFieldsOfTheDocumentsTables) {
  const auto table = document_table("mfc_registers.csv");
  const auto rows = describe_fields();
  ASSERT_EQ(rows.size(), 240U);
  ASSERT_EQ(table.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto cells = rows[i].columns();
    for (std::size_t column = 0; column < cells.size(); ++column) {
      const std::string name(kFieldColumns[column]);
      const std::string& expected = table[i].at(name);
      if (name == "reset" && expected.empty()) {
        // The document is silent: 0 (A-78), and nothing for fields without meaning.
        EXPECT_THAT(std::string(cells[column]), ::testing::AnyOf("", "0"));
        continue;
      }
      EXPECT_EQ(cells[column], expected) << rows[i].name << "." << rows[i].field << " " << name;
    }
  }
}

TEST(RegisterMap, FieldsFillTheirRegistersWithoutOverlap) {
  std::array<std::uint64_t, kRegisterCount> covered{};
  for (const auto group : register_field_groups()) {
    for (const RegisterField& field : group) {
      const Register& entry = kRegisters[field.number];
      EXPECT_LT(field.bit_hi, entry.width_bits()) << entry.name << "." << field.name;
      EXPECT_EQ(covered[field.number] & mask_of(field), 0U) << entry.name << "." << field.name;
      covered[field.number] |= mask_of(field);
    }
  }
  for (const Register& entry : kRegisters) {
    const unsigned width = entry.width_bits();
    const std::uint64_t all = width == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
    EXPECT_EQ(covered[entry.number], all) << entry.name;
  }
}

TEST(RegisterMap, OnlyTheEncoderConstantHasAResetValueOtherThanZero) {
  for (const Register& entry : kRegisters) {
    EXPECT_EQ(reset_value(entry.number), entry.number == register_number::kEncConst ? 65536U : 0U)
        << entry.name;
  }
}

TEST(RegisterMap, FindsRegistersByNameAndDirection) {
  EXPECT_EQ(find_register("X_ENC", Direction::write)->number, 2);
  EXPECT_EQ(find_register("X_ENC", Direction::read)->number, 3);
  EXPECT_EQ(find_register("GPO", Direction::read), nullptr);
  EXPECT_EQ(find_register("reserved", Direction::none), nullptr);
}

TEST(RegisterMap, TriggersHaveTheDocumentsCodes) {
  const auto table = document_table("mfc_trigger_sources.csv");
  ASSERT_EQ(table.size(), kTriggerCount);
  std::set<std::string_view> names(kTriggerNames.begin(), kTriggerNames.end());
  EXPECT_EQ(names.size(), kTriggerCount);
  EXPECT_EQ(table[5].at("name"), "ECAT_SOF");
  EXPECT_EQ(kTriggerNames[5], "start-of-frame");
  for (std::size_t code = 0; code < kTriggerCount; ++code) {
    EXPECT_EQ(std::stoul(table[code].at("code")), code);
    EXPECT_EQ(table[code].at("name") == "always", transparent(static_cast<Trigger>(code)));
  }
}

}  // namespace
}  // namespace stator::mfc
