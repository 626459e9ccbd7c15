// stator conformance: rows of docs/conformance as text and JSON, by device and status.
#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"
#include "stator/cli/cells.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using tests::content;
using tests::Outcome;
using tests::stator;

std::vector<std::vector<std::string>> table(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream stream(text);
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    rows.push_back(cli::csv_fields(line));
  }
  return rows;
}

TEST(CsvFields, QuotesCommasAndEmptyFieldsAreRead) {
  EXPECT_EQ(cli::csv_fields(R"(a,,"b,c","say ""no""",)"),
            (std::vector<std::string>{"a", "", "b,c", "say \"no\"", ""}));
}

TEST(ConformanceCommand, GivesEveryRowOfTheFilesOfEveryDevice) {
  for (const auto& entry :
       std::filesystem::directory_iterator(STATOR_SOURCE_DIR "/docs/conformance")) {
    if (entry.path().extension() != ".csv") {
      continue;
    }
    const std::string device = entry.path().stem();
    const Outcome outcome = stator("conformance " + device + " --format csv");
    EXPECT_EQ(outcome.status, 0);
    const auto printed = table(outcome.output);
    const auto requirements = table(content(STATOR_TEST_DATA "/" + device + "/requirements.csv"));
    auto outcomes = table(content(entry.path()));
    ASSERT_EQ(printed.size(), requirements.size()) << device;
    ASSERT_EQ(printed.size(), outcomes.size()) << device;
    for (std::size_t i = 0; i < printed.size(); ++i) {
      const auto& requirement = requirements[i];
      const auto found =
          std::ranges::find(outcomes, requirement[0], [](const auto& row) { return row[0]; });
      ASSERT_NE(found, outcomes.end()) << requirement[0];
      EXPECT_EQ(printed[i], (std::vector<std::string>{requirement[0], requirement[1], (*found)[1],
                                                      requirement[2], requirement[3], (*found)[2],
                                                      (*found)[3]}));
    }
  }
}

TEST(ConformanceCommand, WithoutADeviceCountsForAll) {
  const Outcome outcome = stator("conformance --format csv");
  EXPECT_EQ(outcome.status, 0);
  const auto rows = table(outcome.output);
  ASSERT_EQ(rows.size(), 5U);
  for (const auto& row : rows) {
    const auto outcomes = table(content(STATOR_SOURCE_DIR "/docs/conformance/" + row[0] + ".csv"));
    const auto count = [&outcomes](const std::string& status) {
      return std::to_string(
          std::ranges::count(outcomes, status, [](const auto& each) { return each[1]; }));
    };
    EXPECT_EQ(row,
              (std::vector<std::string>{row[0], std::to_string(outcomes.size()), count("done"),
                                        count("simplified"), count("left-out"), count("open")}));
  }
  EXPECT_THAT(stator("conformance").output, HasSubstr("LEFT OUT  OPEN"));
  EXPECT_THAT(stator("conformance").output, HasSubstr("open is still to come"));
  EXPECT_THAT(stator("conformance --format json").output, HasSubstr("\"left-out\": "));
}

TEST(ConformanceCommand, ShowsOneStatusOnly) {
  const Outcome outcome = stator("conformance tmcm-3315 --status simplified");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, HasSubstr(" open; for good: "));
  EXPECT_THAT(outcome.output, HasSubstr("  simplified  "));
  EXPECT_THAT(outcome.output, Not(HasSubstr("  done        ")));
  EXPECT_EQ(stator("conformance --status done").status, 1);
  EXPECT_EQ(stator("conformance tmcm-3315 --status perfect").status, 2);
}

TEST(ConformanceCommand, JsonNamesTheTests) {
  const Outcome outcome = stator("conformance tmcm-3315 --format json --status done");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output,
              HasSubstr("\"Tmcm3315Objects.AxesAreReachedByTheDocumentsIndexOffsets\""));
}

TEST(ConformanceCommand, AnUnknownProductIsNamedWithTheLikelyOne) {
  const Outcome outcome = stator("conformance tmcm-3351");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("did you mean \"tmcm-3315\"?"));
}

}  // namespace
}  // namespace stator
