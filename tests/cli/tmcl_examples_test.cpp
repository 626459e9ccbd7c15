// Traces of the TMCL programs in examples/, and the moves of the test program in the TMCM-142's
// manual (chapter 5.2).
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "sanitized.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::content;
using tests::Outcome;
using tests::stator;
using tests::temporary;

const std::string kExamples = STATOR_SOURCE_DIR "/examples/tmcl";
/// Fifty minutes of simulated time, eight of a processor's below sanitizers.
constexpr const char* kLongRun = "--for 3000s";

/// Runs an example as `options` say and compares its trace with the one that is kept.
void expect_trace(const std::string& name, const std::string& options) {
  const std::string trace = temporary(name + ".csv");
  std::string command = "tmcl run ";
  command.append(kExamples).append("/").append(name).append(".tmc ");
  command.append(options).append(" --trace ").append(trace);
  const Outcome outcome = stator(command);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  std::string kept = kExamples;
  kept.append("/expected/").append(name).append(".csv");
  EXPECT_EQ(content(trace), content(kept))
      << name << "; if this is meant: examples/tmcl/expected/renew";
  std::filesystem::remove(trace);
}

TEST(TmclExamples, EachHasTheTraceThatIsExpectedOfIt) {
  std::ifstream runs(kExamples + "/expected/runs.txt");
  std::set<std::string> names;
  std::string line;
  while (std::getline(runs, line)) {
    if (line.empty() || line.front() == '#') {
      continue;
    }
    std::istringstream words(line);
    std::string name;
    std::string options;
    words >> name;
    std::getline(words, options);
    names.insert(name);
    if (!tests::kSanitized || options.find(kLongRun) == std::string::npos) {
      expect_trace(name, options);
    }
  }
  for (const auto& file : std::filesystem::directory_iterator(kExamples)) {
    if (file.path().extension() == ".tmc") {
      EXPECT_TRUE(names.contains(file.path().stem().string()))
          << file.path() << " is not in expected/runs.txt";
    }
  }
}

/// Value of a column of the line of a trace that begins so.
double column(const std::string& trace, const std::string& beginning_of_command, int place) {
  std::istringstream lines(trace);
  std::string line;
  while (std::getline(lines, line)) {
    if (line.find(beginning_of_command) == std::string::npos) {
      continue;
    }
    // Behind the command, which may contain commas.
    std::istringstream cells(line.substr(line.find(beginning_of_command)));
    std::string cell;
    std::getline(cells, cell, '"');
    for (int i = 0; i <= place; ++i) {
      std::getline(cells, cell, ',');
    }
    return std::stod(cell);
  }
  ADD_FAILURE() << "no line with " << beginning_of_command;
  return 0.0;
}

// TMCM-142 TMCL Firmware Manual, chapter 5.2 (L357-L371): left with 500000, 5 s, stop, right with
// 250000, 5 s, stop, then to 10000000 and to -1000000.
TEST(TmclExamples, TheDocumentsTestProgramMakesTheDocumentedMoves) {
  constexpr int kPosition = 5;
  constexpr int kVelocity = 6;
  constexpr double kUnit = 2.0 * 16e6 / 2147483648.0;  // microsteps/s (L5878-L5882)
  const std::string trace = content(kExamples + "/expected/test_program.csv");
  std::istringstream lines(trace);
  std::string line;
  double left = 0.0;
  double right = 0.0;
  while (std::getline(lines, line)) {
    const std::size_t last = line.rfind(',');
    if (line.find(",WAIT TICKS") != std::string::npos ||
        line.find("\"WAIT TICKS") != std::string::npos) {
      (left == 0.0 ? left : right) = std::stod(line.substr(last + 1));
    }
  }
  EXPECT_NEAR(left, -500000 * kUnit, 0.01);
  EXPECT_NEAR(right, 250000 * kUnit, 0.01);
  EXPECT_EQ(column(trace, "MVP ABS, 0, -1000000", kPosition), 10000000.0);
  EXPECT_EQ(column(trace, "MVP ABS, 0, -1000000", kVelocity), 0.0);
  EXPECT_THAT(trace, HasSubstr(",JA Loop,0,0,,100,-1000000,"));
}

}  // namespace
}  // namespace stator
