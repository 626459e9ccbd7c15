// The TMCM-3315's dictionary against its document row by row, and which values its objects refuse.
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcm_3315/objects.hpp"
#include "stator/dictionary/description.hpp"

namespace stator::devices::tmcm_3315 {
namespace {

using dictionary::AbortCode;
using dictionary::Dictionary;
using dictionary::Entry;
using dictionary::NetworkState;

std::vector<tests::CsvRow> documented_objects() {
  std::ifstream file(STATOR_TEST_DATA "/tmcm-3315/objects.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return tests::parse_csv(text);
}

class Tmcm3315Objects : public testing::Test {
 protected:
  Tmcm3315Objects() { add_objects(dictionary_); }

  /// Writes `value` in Pre-Operational; the abort code, or no_error for success.
  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::int64_t value,
                  NetworkState state = NetworkState::pre_operational) {
    Entry* entry = dictionary_.find(index, subindex);
    EXPECT_NE(entry, nullptr) << std::hex << index;
    std::array<std::byte, 8> data{};
    for (std::size_t i = 0; i < data.size(); ++i) {
      data[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
    const dictionary::Verdict verdict =
        dictionary_.write(*entry, std::span(data).first(entry->size()), {state});
    return verdict ? kNoError : verdict.error().code;
  }

  static constexpr AbortCode kNoError{};
  Dictionary dictionary_;
};

TEST_F(Tmcm3315Objects, EveryRowEqualsTheDocumentInEveryColumn) {
  const std::vector<tests::CsvRow> rows = documented_objects();
  ASSERT_EQ(rows.size(), 435U) << "header and 434 rows";
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

TEST_F(Tmcm3315Objects, AxesAreReachedByTheDocumentsIndexOffsets) {
  EXPECT_EQ(dictionary_.find(0x6840)->name.str(), "Axis 1: Controlword");
  EXPECT_EQ(dictionary_.find(0x7040)->name.str(), "Axis 2: Controlword");
  EXPECT_EQ(dictionary_.find(0x2200)->name.str(), "Axis 1: Microstep resolution");
  EXPECT_EQ(dictionary_.find(0x2400)->name.str(), "Axis 2: Microstep resolution");
  EXPECT_EQ(dictionary_.find(0x7040)->axis, 2);
}

TEST_F(Tmcm3315Objects, ModuleObjectsExistOnce) {
  EXPECT_NE(dictionary_.find(0x2702), nullptr);
  EXPECT_EQ(dictionary_.find(0x2902), nullptr);
  EXPECT_EQ(dictionary_.find(0x2B03), nullptr);
  EXPECT_EQ(dictionary_.find(0x1010), nullptr) << "no parameter storage is documented";
}

TEST_F(Tmcm3315Objects, ArraysAndRecordsCarryTheDocumentsSectionTitles) {
  EXPECT_EQ(dictionary_.find(0x1018)->name.str(), "Identity object");
  EXPECT_EQ(dictionary_.find(0x2002)->name.str(), "Axis 0: Brake delay times");
  EXPECT_EQ(dictionary_.find(0x707D)->name.str(), "Axis 2: Software position limit");
}

TEST_F(Tmcm3315Objects, ValuesTheDocumentLeavesOpenStartAsDecided) {
  EXPECT_EQ(dictionary_.find(0x202A, 0)->value(), 255U);
  EXPECT_EQ(dictionary_.find(0x2236, 0)->value(), 255U);
  EXPECT_EQ(dictionary_.find(0x2030, 0)->value(), 0U);
  EXPECT_EQ(dictionary_.find(0x204E, 0)->value(), 0U);
}

TEST_F(Tmcm3315Objects, ValuesOutsideAnEnumerationAreRefused) {
  struct Case {
    std::uint16_t index;
    std::int64_t good;
    std::int64_t bad;
  };
  constexpr std::array kCases{
      Case{0x208C, 0, 1},  Case{0x208C, 181, 182}, Case{0x2097, 15, 1},  Case{0x605A, 5, 3},
      Case{0x605B, 0, 1},  Case{0x605C, 1, 0},     Case{0x605D, 1, 2},   Case{0x605E, 2, 0},
      Case{0x6060, 10, 2}, Case{0x6060, 0, 11},    Case{0x6060, 6, -1},  Case{0x606A, -1, -2},
      Case{0x6086, 1, 2},  Case{0x6098, 35, 36},   Case{0x6898, 19, 20}, Case{0x7060, 9, 7},
  };
  for (const Case& c : kCases) {
    EXPECT_EQ(write(c.index, 0, c.good), kNoError) << std::hex << c.index << ' ' << c.good;
    EXPECT_EQ(write(c.index, 0, c.bad), AbortCode::value_range_exceeded)
        << std::hex << c.index << ' ' << c.bad;
  }
}

TEST_F(Tmcm3315Objects, ValuesOutsideARangeAreRefused) {
  EXPECT_EQ(write(0x2005, 0, 64), AbortCode::value_too_high);
  EXPECT_EQ(write(0x2095, 0, -4), AbortCode::value_too_low);
  EXPECT_EQ(write(0x2010, 0, 268435456), AbortCode::value_too_high);
  EXPECT_EQ(write(0x60C2, 2, 4), AbortCode::value_too_high);
  EXPECT_EQ(write(0x2002, 0, 2), AbortCode::read_only);
  EXPECT_EQ(write(0x6041, 0, 0), AbortCode::read_only);
}

TEST_F(Tmcm3315Objects, MappingAndAssignmentAreWritableInPreOperationalOnly) {
  for (const std::uint16_t index : std::to_array<std::uint16_t>({0x1600, 0x1A00, 0x1C12, 0x1C13})) {
    EXPECT_EQ(write(index, 0, 0), kNoError);
    EXPECT_EQ(write(index, 0, 0, NetworkState::safe_operational), AbortCode::device_state);
    EXPECT_EQ(write(index, 1, 0, NetworkState::operational), AbortCode::device_state);
  }
  EXPECT_EQ(write(0x1600, 0, 10), AbortCode::value_too_high);
}

TEST_F(Tmcm3315Objects, SyncManagerTypesTakeOnlyTheValuesTheyHave) {
  EXPECT_EQ(write(0x1C00, 0, 4), kNoError);
  EXPECT_EQ(write(0x1C00, 3, 3), kNoError);
  EXPECT_EQ(write(0x1C00, 3, 4), AbortCode::value_range_exceeded);
}

}  // namespace
}  // namespace stator::devices::tmcm_3315
