// The scenarios in scenarios pass, and always in the same simulated time.

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/scenario/runner.hpp"
#include "stator/scenario/scenario_file.hpp"

namespace stator::scenario {
namespace {

std::vector<std::string> shipped() {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(STATOR_SOURCE_DIR "/scenarios")) {
    paths.push_back(entry.path().string());
  }
  std::ranges::sort(paths);
  return paths;
}

class ShippedScenario : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedScenario, PassesAlikeEachTime) {
  const ScenarioRead read = read_scenario_file(GetParam(), devices::products());
  for (const settings::Problem& error : read.errors) {
    ADD_FAILURE() << error.what();
  }
  EXPECT_FALSE(read.scenario.summary.empty());
  const ScenarioResult first = run(read.scenario);
  EXPECT_EQ(first.status, Status::passed)
      << first.error << (first.failed_step() != nullptr ? first.failed_step()->text : "");
  const ScenarioResult second = run(read.scenario);
  EXPECT_EQ(second.end, first.end);
  ASSERT_EQ(second.steps.size(), first.steps.size());
  for (std::size_t i = 0; i < first.steps.size(); ++i) {
    EXPECT_EQ(second.steps[i].text, first.steps[i].text);
    EXPECT_EQ(second.steps[i].end, first.steps[i].end);
  }
  ASSERT_EQ(second.plots.size(), first.plots.size());
  for (std::size_t i = 0; i < first.plots.size(); ++i) {
    EXPECT_EQ(second.plots[i].values, first.plots[i].values);
  }
}

INSTANTIATE_TEST_SUITE_P(Racks, ShippedScenario, ::testing::ValuesIn(shipped()),
                         [](const auto& each) {
                           std::string name = std::filesystem::path(each.param).stem().string();
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace stator::scenario
