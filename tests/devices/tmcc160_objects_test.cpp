// The TMCC160's dictionary against its document row by row, and which values its objects refuse.
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcc160/objects.hpp"
#include "stator/dictionary/description.hpp"

namespace stator::devices::tmcc160 {
namespace {

using dictionary::AbortCode;
using dictionary::Dictionary;
using dictionary::Entry;

std::vector<tests::CsvRow> table(const std::string& name) {
  std::ifstream file(STATOR_TEST_DATA "/tmcc160/" + name);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return tests::parse_csv(text);
}

constexpr std::size_t kDefaultColumn = 7;
constexpr std::size_t kNotesColumn = 12;

/// The table of the document with what the device does instead (effective_values.csv). A default
/// that differs from the print is said in the notes, unless they say so already.
std::vector<tests::CsvRow> effective_objects() {
  std::vector<tests::CsvRow> rows = table("objects.csv");
  for (const tests::CsvRow& value : table("effective_values.csv")) {
    if (value[2] != "default") {
      continue;  // other columns of objects.csv are as the device has them
    }
    for (tests::CsvRow& row : rows) {
      const std::string wanted = value[4].substr(0, value[4].find(' '));
      if (row[0] != value[0] || row[1] != value[1] || row[kDefaultColumn] == wanted) {
        continue;
      }
      std::string& notes = row[kNotesColumn];
      row[kDefaultColumn] = wanted;
      if (notes.find("rinted default") == std::string::npos) {
        notes += " Printed default: " + value[3] + ".";
      }
    }
  }
  return rows;
}

class Tmcc160Objects : public testing::Test {
 protected:
  Tmcc160Objects() { add_objects(dictionary_); }

  /// Writes `value` as an SDO does; the abort code, or kNoError for success.
  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
    Entry* entry = dictionary_.find(index, subindex);
    EXPECT_NE(entry, nullptr) << std::hex << index;
    std::array<std::byte, 8> data{};
    for (std::size_t i = 0; i < data.size(); ++i) {
      data[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
    const dictionary::Verdict verdict =
        dictionary_.write(*entry, std::span(data).first(entry->size()), {});
    return verdict ? kNoError : verdict.error().code;
  }

  static constexpr AbortCode kNoError{};
  Dictionary dictionary_;
};

TEST_F(Tmcc160Objects, EveryRowEqualsTheDocumentAsDecidedInEveryColumn) {
  const std::vector<tests::CsvRow> rows = effective_objects();
  ASSERT_EQ(rows.size(), 218U) << "header and 217 rows";
  const auto& names = dictionary::kDescriptionColumns;
  EXPECT_EQ(rows.front(), tests::CsvRow(names.begin(), names.end()));
  ASSERT_EQ(dictionary_.entries().size(), rows.size() - 1);
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const dictionary::EntryDescription description =
        dictionary::describe(dictionary_.entries()[row - 1]);
    const auto columns = description.columns();
    ASSERT_EQ(rows[row].size(), columns.size()) << "row " << row;
    for (std::size_t column = 0; column < columns.size(); ++column) {
      EXPECT_EQ(columns[column], rows[row][column])
          << rows[row][0] << ':' << rows[row][1] << " column " << names[column];
    }
  }
}

TEST_F(Tmcc160Objects, ValuesThatAreNotListedAreRefusedWith06090030) {
  std::size_t checked = 0;
  for (const tests::CsvRow& row : table("effective_values.csv")) {
    if (row[2] != "allowed values") {
      continue;
    }
    const auto index = static_cast<std::uint16_t>(std::stoul(row[0], nullptr, 16));
    std::map<std::int64_t, bool> allowed;
    std::istringstream list(row[4]);
    for (std::string value; std::getline(list, value, ';');) {
      allowed[std::stoll(value)] = true;
    }
    for (std::int64_t value = -128; value <= 127; ++value) {
      const bool is_signed = dictionary::is_signed(dictionary_.find(index, 0)->type());
      if (is_signed || value >= 0) {
        EXPECT_EQ(write(index, 0, value),
                  allowed[value] ? kNoError : AbortCode::value_range_exceeded)
            << row[0] << ' ' << value;
      }
    }
    ++checked;
  }
  EXPECT_EQ(checked, 4U);
}

TEST_F(Tmcc160Objects, BitRatesReactionsAndTransmissionTypesTakeTheListedValuesOnly) {
  struct Case {
    std::uint16_t index;
    std::uint8_t subindex;
    std::int64_t good;
    std::int64_t bad;
  };
  constexpr std::array kCases{
      Case{0x2704, 0, 20, 21},     Case{0x2704, 0, 800, 1001},  Case{0x1029, 1, 1, 2},
      Case{0x1029, 2, 0, 255},     Case{0x1400, 2, 0xFE, 0x01}, Case{0x1403, 2, 0x00, 0xFD},
      Case{0x1800, 2, 0x01, 0x02}, Case{0x1803, 2, 0xFF, 0xFC}, Case{0x2095, 5, 0, 1},
  };
  for (const Case& c : kCases) {
    EXPECT_EQ(write(c.index, c.subindex, c.good), kNoError) << std::hex << c.index << ' ' << c.good;
    EXPECT_EQ(write(c.index, c.subindex, c.bad), AbortCode::value_range_exceeded)
        << std::hex << c.index << ' ' << c.bad;
  }
}

TEST_F(Tmcc160Objects, ValuesOutsideTheirRangeAreRefused) {
  std::size_t checked = 0;
  for (const Entry& entry : dictionary_.entries()) {
    const dictionary::EntryDeclaration& declaration = entry.declaration();
    if (!entry.writable() || !declaration.range || !declaration.legal_values.empty()) {
      continue;
    }
    const std::int64_t low = declaration.range->minimum.as_signed();
    const std::int64_t high = declaration.range->maximum.as_signed();
    const std::int64_t span = std::int64_t{1} << dictionary::bit_length(entry.type());
    const std::int64_t lowest = dictionary::is_signed(entry.type()) ? -span / 2 : 0;
    if (low > lowest) {
      EXPECT_EQ(write(entry.index(), entry.subindex(), low - 1), AbortCode::value_too_low);
      ++checked;
    }
    if (high < lowest + span - 1) {
      EXPECT_EQ(write(entry.index(), entry.subindex(), high + 1), AbortCode::value_too_high);
      ++checked;
    }
    EXPECT_EQ(write(entry.index(), entry.subindex(), low), kNoError);
    EXPECT_EQ(write(entry.index(), entry.subindex(), high), kNoError);
  }
  EXPECT_EQ(checked, 55U);
}

TEST_F(Tmcc160Objects, IdentifiersOfServicesCountFromTheNodeId) {
  dictionary_.set_node_id(5);
  EXPECT_EQ(dictionary_.find(0x1014, 0)->default_bits(), 0x85U);
  EXPECT_EQ(dictionary_.find(0x1014, 0)->value(), 0x80U) << "until the next reset";
  dictionary_.reset_values();
  EXPECT_EQ(dictionary_.find(0x1014, 0)->value(), 0x85U);
  EXPECT_EQ(dictionary_.find(0x1403, 1)->value(), 0x40000505U);
  EXPECT_EQ(dictionary_.find(0x1802, 1)->value(), 0x40000385U);
  EXPECT_EQ(dictionary_.find(0x1005, 0)->value(), 0x80U);
}

TEST_F(Tmcc160Objects, OnlyAxisZeroExists) {
  EXPECT_EQ(dictionary_.find(0x6840), nullptr);
  EXPECT_EQ(dictionary_.find(0x2205), nullptr);
  EXPECT_EQ(dictionary_.find(0x1003), nullptr) << "no error history is documented";
  EXPECT_EQ(dictionary_.find(0x1010)->find(3), nullptr);
  EXPECT_EQ(dictionary_.find(0x2025)->find(1), nullptr);
}

TEST_F(Tmcc160Objects, ArraysAndRecordsCarryTheDocumentsSectionTitles) {
  EXPECT_EQ(dictionary_.find(0x1018)->name.str(), "Identity object");
  EXPECT_EQ(dictionary_.find(0x2030)->name.str(), "Torque mode settings");
  EXPECT_EQ(dictionary_.find(0x1A03)->name.str(), "TPDO 4 mapping parameter");
}

}  // namespace
}  // namespace stator::devices::tmcc160
