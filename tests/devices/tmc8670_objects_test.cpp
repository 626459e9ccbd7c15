// Objects of a TMC8670 against the recommended table, and the fields of the FOC block to which they
// lead.
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/devices/tmc8670/objects.hpp"
#include "stator/devices/tmc8670/register_objects.hpp"
#include "stator/dictionary/description.hpp"

namespace stator::devices::tmc8670 {
namespace {

using control::foc::field;
using dictionary::AbortCode;
using dictionary::Dictionary;
using dictionary::Entry;

std::vector<tests::CsvRow> recommended_objects() {
  std::ifstream file(STATOR_TEST_DATA "/tmc8670/objects_recommended.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return tests::parse_csv(text);
}

/// Columns in which an object differs from the recommendation on purpose (F-70, F-71): subindex 0
/// of mappings and assignments is written, and the error settings are a record throughout; no
/// master is thrown out of Operational unasked (F-77); option codes are those obeyed (F-88).
bool differs_on_purpose(const std::string& index, const std::string& subindex, std::size_t column) {
  constexpr std::size_t kObjectType = 3;
  constexpr std::size_t kAccess = 5;
  constexpr std::size_t kDefault = 7;
  constexpr std::size_t kMinimum = 8;
  constexpr std::size_t kMaximum = 9;
  constexpr std::size_t kNote = 12;
  const bool configuration =
      index == "1600" || index == "1A00" || index == "1C12" || index == "1C13";
  const bool option_code = index >= "605A" && index <= "605E";
  return (option_code && (column == kMinimum || column == kMaximum)) ||
         (configuration && subindex == "00" && (column == kAccess || column == kMaximum)) ||
         (index == "10F1" && subindex == "00" && column == kObjectType) ||
         (index == "10F1" && subindex == "02" && (column == kDefault || column == kNote));
}

class Tmc8670Objects : public testing::Test {
 protected:
  Tmc8670Objects() { add_objects(dictionary_); }

  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
    Entry* entry = dictionary_.find(index, subindex);
    EXPECT_NE(entry, nullptr) << std::hex << index;
    std::array<std::byte, 8> data{};
    for (std::size_t i = 0; i < data.size(); ++i) {
      data[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
    const auto verdict = dictionary_.write(*entry, std::span(data).first(entry->size()), {});
    return verdict ? AbortCode{} : verdict.error().code;
  }
  std::int64_t read(std::uint16_t index, std::uint8_t subindex) {
    Entry* entry = dictionary_.find(index, subindex);
    EXPECT_TRUE(dictionary_.prepare_read(*entry));
    return entry->signed_value();
  }

  Dictionary dictionary_;
};

TEST_F(Tmc8670Objects, EveryRecommendedRowIsThereInEveryColumn) {
  const std::vector<tests::CsvRow> rows = recommended_objects();
  ASSERT_EQ(rows.size(), 192U) << "header and 191 rows";
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const std::string& index = rows[row][0];
    const std::string& subindex = rows[row][1];
    const Entry* entry =
        dictionary_.find(static_cast<std::uint16_t>(std::stoul(index, nullptr, 16)),
                         static_cast<std::uint8_t>(std::stoul(subindex, nullptr, 16)));
    ASSERT_NE(entry, nullptr) << index << ':' << subindex;
    const dictionary::EntryDescription description = dictionary::describe(*entry);
    const auto columns = description.columns();
    for (std::size_t column = 0; column < columns.size(); ++column) {
      if (!differs_on_purpose(index, subindex, column)) {
        EXPECT_EQ(columns[column], rows[row][column])
            << index << ':' << subindex << " column " << rows[0][column];
      }
    }
  }
}

// F-88: the codes of CiA 402 that are obeyed, no reserved ones, no manufacturer's.
TEST_F(Tmc8670Objects, OptionCodesAreThoseThatAreObeyed) {
  struct Row {
    std::uint16_t index;
    std::vector<std::int64_t> codes;
  };
  for (const Row& row : {Row{0x605A, {0, 1, 2, 5, 6}}, Row{0x605B, {0, 1}}, Row{0x605C, {0, 1}},
                         Row{0x605D, {1, 2, 3, 4}}, Row{0x605E, {0, 1, 2}}}) {
    for (const std::int64_t code : {-32768, -1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 32767}) {
      const std::int64_t before = read(row.index, 0);
      const bool legal = std::ranges::find(row.codes, code) != row.codes.end();
      EXPECT_EQ(write(row.index, 0, code), legal ? AbortCode{} : AbortCode::value_range_exceeded)
          << std::hex << row.index << std::dec << ' ' << code;
      EXPECT_EQ(read(row.index, 0), legal ? code : before);
    }
  }
}

TEST_F(Tmc8670Objects, EveryObjectSaysThatTheDocumentHasNone) {
  for (const Entry& entry : dictionary_.entries()) {
    EXPECT_EQ(entry.declaration().source, "not in document") << std::hex << entry.index();
    EXPECT_FALSE(entry.declaration().note.empty()) << std::hex << entry.index();
  }
}

TEST_F(Tmc8670Objects, EveryPdoMapsObjectsThatExistInItsDirection) {
  int mapped = 0;
  for (const dictionary::Object& object : dictionary_.objects()) {
    const bool receive = object.index >= 0x1600 && object.index < 0x1800;
    if (!receive && (object.index < 0x1A00 || object.index >= 0x1C00)) {
      continue;
    }
    const std::uint64_t count = object.entries.front().value();
    for (const Entry& entry : object.entries.subspan(1)) {
      if (entry.subindex() > count) {
        EXPECT_EQ(entry.value(), 0U);
        continue;
      }
      ++mapped;
      const Entry* target = dictionary_.find(static_cast<std::uint16_t>(entry.value() >> 16U),
                                             static_cast<std::uint8_t>(entry.value() >> 8U));
      ASSERT_NE(target, nullptr) << std::hex << entry.value();
      EXPECT_EQ(target->bits(), entry.value() & 0xFFU) << std::hex << entry.value();
      EXPECT_EQ(target->declaration().mapping,
                receive ? dictionary::PdoMapping::receive : dictionary::PdoMapping::transmit)
          << std::hex << entry.value();
    }
  }
  EXPECT_EQ(mapped, 5 + 3 + 3 + 3 + 8 + 14 + 6 + 6 + 5 + 5 + 6 + 16);
}

TEST_F(Tmc8670Objects, ValuesOutsideAnEnumerationAreRefused) {
  struct Case {
    std::uint16_t index;
    std::uint8_t subindex;
    std::int64_t good;
    std::int64_t bad;
  };
  constexpr std::array kCases{Case{0x6060, 0, 10, 7}, Case{0x6060, 0, 4, 2}, Case{0x2000, 1, 1, 4},
                              Case{0x2001, 5, 0, 2},  Case{0x1C32, 1, 2, 3}, Case{0x2030, 8, 0, 2}};
  for (const Case& c : kCases) {
    EXPECT_EQ(write(c.index, c.subindex, c.good), AbortCode{}) << std::hex << c.index;
    EXPECT_EQ(write(c.index, c.subindex, c.bad), AbortCode::value_range_exceeded)
        << std::hex << c.index;
  }
}

class Tmc8670Registers : public Tmc8670Objects {
 protected:
  Tmc8670Registers() { registers_.write_all(); }
  control::foc::FocBlock block_;
  RegisterObjects registers_{dictionary_, block_};
};

TEST_F(Tmc8670Registers, ObjectsAreWrittenToTheirFields) {
  EXPECT_EQ(write(0x2000, 2, 7), AbortCode{});
  EXPECT_EQ(block_.get(field("N_POLE_PAIRS")), 7);
  EXPECT_EQ(block_.get(field("MOTOR_TYPE")), 3) << "the neighbour in its register stays";
  EXPECT_EQ(write(0x2000, 3, -128), AbortCode{});
  EXPECT_EQ(block_.get(field("ADC_I0_SCALE")), -128);
  EXPECT_EQ(block_.get(field("ADC_I1_SCALE")), -128);
  EXPECT_EQ(write(0x2001, 4, 3), AbortCode{});
  EXPECT_EQ(block_.read(0x17), 3U);
  EXPECT_EQ(write(0x2030, 9, 4), AbortCode{});
  EXPECT_EQ(block_.get(field("MODE_PID_SMPL")), 4);
  EXPECT_EQ(read(0x2030, 10), 4) << "one field for both (F-74)";
}

TEST_F(Tmc8670Registers, DefaultsOfTheObjectsReachTheChip) {
  EXPECT_EQ(block_.read(0x18), 3999U);
  EXPECT_EQ(block_.read(0x19), 0x1414U);
  EXPECT_EQ(block_.read(0x26), 65536U);
  EXPECT_EQ(block_.read(0x5C), 0x7FFFFFFFU) << "no limit of the rate";
  EXPECT_EQ(block_.read(0x5D), 23169U);
  EXPECT_EQ(block_.read(0x75), 0xFFFFFFFFU) << "no brake chopper";
  EXPECT_EQ(block_.read(0x34), 0x2AAA0000U);
  EXPECT_EQ(block_.read(0x36), 0xD555AAAAU);
  EXPECT_EQ(block_.get(field("AENC_0_OFFSET")), -32768);
}

TEST_F(Tmc8670Registers, AnObjectShowsWhatAUartHasWritten) {
  EXPECT_TRUE(block_.write(0x58, 0x01230045));
  EXPECT_EQ(read(0x2030, 5), 0x0123);
  EXPECT_EQ(read(0x2030, 6), 0x0045);
}

TEST_F(Tmc8670Registers, EveryRegisterIsReachedByAddressAndValue) {
  EXPECT_EQ(write(0x2FF0, 1, 0x01), AbortCode{});
  EXPECT_EQ(write(0x2FF0, 2, 0), AbortCode{});
  EXPECT_EQ(write(0x2FF0, 1, 0x00), AbortCode{});
  EXPECT_EQ(read(0x2FF0, 2), 0x38363730);
  EXPECT_EQ(write(0x2FF0, 1, 128), AbortCode::value_too_high);
}

TEST_F(Tmc8670Registers, AValueThatTheFieldCannotHoldIsRefused) {
  EXPECT_EQ(write(0x2010, 1, 1 << 24), AbortCode::value_too_high);
  EXPECT_EQ(write(0x2012, 4, 4096), AbortCode::value_too_high);
  EXPECT_EQ(write(0x2012, 4, 4095), AbortCode{});
  EXPECT_EQ(write(0x2001, 4, 4), AbortCode::value_too_high);
}

}  // namespace
}  // namespace stator::devices::tmc8670
