// stator describe for TMCL modules against the tables of the TMCM-142's manual, column by column.
#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "devices/csv.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::content;
using tests::CsvRow;
using tests::Outcome;
using tests::stator;

std::vector<CsvRow> documented(const std::string& table) {
  std::string path = STATOR_TEST_DATA "/tmcm-142/";
  path += table;
  return tests::parse_csv(content(path));
}

std::vector<CsvRow> described(const std::string& options) {
  std::string command = "describe tmcm-142 --format csv ";
  command += options;
  const Outcome outcome = stator(command);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return tests::parse_csv(outcome.output);
}

/// Compares the columns named, by rows of the same number of the document.
void expect_same(const std::vector<CsvRow>& rows, const std::vector<CsvRow>& document,
                 const std::set<std::string_view>& columns) {
  ASSERT_EQ(rows.size(), document.size());
  ASSERT_EQ(rows[0], document[0]) << "the columns";
  for (std::size_t i = 1; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), document[0].size()) << "row " << i;
    for (std::size_t column = 0; column < document[0].size(); ++column) {
      if (columns.contains(document[0][column])) {
        EXPECT_EQ(rows[i][column], document[i][column])
            << document[0][column] << " of " << rows[i][1];
      }
    }
  }
}

/// A range, default or unit that the document prints in a way of its own, or leaves open, is ours
/// as decided; those it prints plainly are the same.
void expect_same_where_plain(const std::vector<CsvRow>& rows, const std::vector<CsvRow>& document,
                             const std::string& name, const std::string& plain_characters,
                             const std::set<std::string_view>& decided = {}) {
  const auto column = static_cast<std::size_t>(
      std::find(document[0].begin(), document[0].end(), name) - document[0].begin());
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const std::string& printed = document[i][column];
    std::string key = rows[i][0];
    key.append(1, '/').append(rows[i][1]);
    if (!printed.empty() && printed.find_first_not_of(plain_characters) == std::string::npos &&
        !decided.contains(key)) {
      EXPECT_EQ(rows[i][column], printed) << name << " of " << key;
    }
  }
}

constexpr const char* kNumberCharacters = "-0123456789.";

TEST(TmclDescribe, AxisParametersAreThoseOfTheDocumentColumnByColumn) {
  const auto rows = described("--parameters axis");
  const auto document = documented("axis_parameters.csv");
  expect_same(rows, document, {"number", "name", "unit", "stored", "source_line", "notes"});
  expect_same_where_plain(rows, document, "range", kNumberCharacters);
  expect_same_where_plain(rows, document, "default", kNumberCharacters);
  // Writing 34 clears it, which is no writing in the document's list (A33).
  expect_same_where_plain(rows, document, "access", "RWE", {"34/PID i sum"});
}

TEST(TmclDescribe, GlobalParametersAreThoseOfTheDocumentColumnByColumn) {
  const auto rows = described("--parameters global");
  const auto document = documented("global_parameters.csv");
  // The unit of the telegram pause time is not printed; milliseconds are decided (A9).
  expect_same(rows, document,
              {"bank", "number", "name", "access", "stored", "source_line", "notes"});
  expect_same_where_plain(rows, document, "unit", "abcdefghijklmnopqrstuvwxyz1 ", {"0/75"});
  expect_same_where_plain(rows, document, "range", kNumberCharacters);
  expect_same_where_plain(rows, document, "default", kNumberCharacters);
}

TEST(TmclDescribe, CommandsAreThoseOfTheDocument) {
  const auto rows = described("--commands");
  const auto document = documented("commands.csv");
  expect_same(rows, document, {"number", "mnemonic", "source_line"});
  expect_same_where_plain(rows, document, "type", kNumberCharacters);
}

TEST(TmclDescribe, WithoutAChoiceAllTablesComeInEveryFormat) {
  const std::string csv = stator("describe tmcm-142 --format csv").output;
  EXPECT_THAT(csv, HasSubstr("number,name,access,range,default,unit,stored,source_line,notes\n"));
  EXPECT_THAT(csv, HasSubstr("\n\nbank,number,name,"));
  EXPECT_THAT(csv, HasSubstr("\n\nnumber,mnemonic,type,"));
  EXPECT_THAT(stator("describe tmcm-142 --format json").output,
              HasSubstr("\"global_parameters\": ["));
  EXPECT_THAT(stator("describe tmcm-142 --format markdown").output, HasSubstr("## Commands\n\n| "));
  EXPECT_THAT(stator("describe tmcm-142").output, HasSubstr("MVP ABS"));
}

TEST(TmclDescribe, DevicesWithoutTmclProgramsHaveNoSuchTables) {
  const Outcome outcome = stator("describe tmcm-3315 --commands");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("runs no programs in TMCL"));
}

}  // namespace
}  // namespace stator
