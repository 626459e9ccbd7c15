// Numbers, names, types and operands of TMCL's commands against the manual.
#include "stator/tmcl/command_set.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"

namespace stator::tmcl {
namespace {

std::vector<tests::CsvRow> documented_commands() {
  std::ifstream file(STATOR_TEST_DATA "/tmcm-142/commands.csv");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::vector<tests::CsvRow> rows = tests::parse_csv(text);
  EXPECT_GT(rows.size(), 1U);
  rows.erase(rows.begin());
  return rows;
}

std::uint8_t number_in(const std::string& text) {
  unsigned number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return static_cast<std::uint8_t>(number);
}

TEST(CommandSet, EveryDocumentedCommandHasItsNumberNameAndTypes) {
  std::set<std::uint8_t> seen;
  for (const tests::CsvRow& row : documented_commands()) {
    SCOPED_TRACE(row[0] + " " + row[1]);
    const std::uint8_t number = number_in(row[0]);
    seen.insert(number);
    const CommandDeclaration* declared = classic_command_set().find(number);
    ASSERT_NE(declared, nullptr);
    const std::string word = row[1].substr(0, row[1].find(' '));
    const bool has_mnemonic =
        std::ranges::none_of(word, [](unsigned char c) { return std::islower(c) != 0; });
    ASSERT_EQ(declared->mnemonic.view(), has_mnemonic ? word : "");
    if (!has_mnemonic) {
      EXPECT_TRUE(declared->use.direct);
      EXPECT_FALSE(declared->use.program);
      continue;
    }
    EXPECT_EQ(classic_command_set().find(declared->mnemonic), declared);
    if (row[1].size() > word.size() && !declared->symbols.empty()) {
      const std::string symbol = row[1].substr(word.size() + 1);
      const auto found = std::ranges::find(declared->symbols, symbol, &Symbol::name);
      ASSERT_NE(found, declared->symbols.end());
      EXPECT_EQ(found->value, number_in(row[2]));
    }
  }
  for (const CommandDeclaration& declared : classic_command_set().all()) {
    EXPECT_TRUE(seen.contains(static_cast<std::uint8_t>(declared.command)))
        << std::string_view(declared.name);
  }
}

TEST(CommandSet, LinesOfTextMayHoldWhatTheDocumentLists) {
  std::ifstream file(STATOR_TEST_DATA "/tmcm-142/ascii_commands.csv");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::set<std::string> documented;
  for (const tests::CsvRow& row : tests::parse_csv(text)) {
    if (!row[1].empty() && std::isdigit(static_cast<unsigned char>(row[1].front())) != 0) {
      documented.insert(row[0]);
    }
  }
  std::set<std::string> declared;
  for (const CommandDeclaration& each : classic_command_set().all()) {
    if (each.use.ascii) {
      declared.insert(std::string(each.mnemonic));
    }
  }
  EXPECT_EQ(declared, documented);
}

TEST(CommandSet, WhatIsNotDeclaredIsNotFound) {
  for (const int number : {0, 16, 17, 18, 25, 26, 29, 37, 38, 40, 63, 72, 127, 140, 255}) {
    EXPECT_EQ(classic_command_set().find(static_cast<std::uint8_t>(number)), nullptr) << number;
  }
  EXPECT_EQ(classic_command_set().find("SAC"), nullptr);
  EXPECT_EQ(classic_command_set().find(""), nullptr) << "the name of those without one";
  EXPECT_EQ(classic_command_set().find("mvp"), classic_command_set().find("MVP"));
}

TEST(CommandSet, OperandsStandBeforeTheUnusedOnesAndNameAFieldOnce) {
  for (const CommandDeclaration& each : classic_command_set().all()) {
    std::set<Field> fields;
    for (std::size_t i = 0; i < each.operands.size(); ++i) {
      if (i >= each.operand_count()) {
        EXPECT_EQ(each.operands[i].field, Field::none) << std::string_view(each.name);
      } else {
        EXPECT_TRUE(fields.insert(each.operands[i].field).second) << std::string_view(each.name);
      }
    }
    const bool named = std::ranges::any_of(
        each.operands, [](const Operand& o) { return o.meaning == Meaning::symbol; });
    EXPECT_EQ(named, !each.symbols.empty()) << std::string_view(each.name);
  }
}

}  // namespace
}  // namespace stator::tmcl
