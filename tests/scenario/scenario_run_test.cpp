// Scenarios step by step, on a bench that is there already.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenario/run_scenario.hpp"
#include "stator/bench/bench.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_steps.hpp"

namespace stator::scenario {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;

constexpr const char* kSteps = R"(
rack = "nowhere.toml"
product = "tmcc160"
[[step]]
do = "state"
[[step]]
do = "wait"
time = "500ms"
[[step]]
do = "expect-state"
state = "operational"
)";

rack::RackConfiguration module() {
  return rack::load_single_device("tmcm-3315", devices::products(), {});
}

ScenarioRead read(const rack::RackConfiguration& configuration, rack::Changes changes = {}) {
  return read_scenario_tree(rack::parse_rack_tree(kSteps, "test.toml"), "test.toml", configuration,
                            changes);
}

ScenarioResult run_on(bench::Bench& bench, const Scenario& scenario) {
  ScenarioRun run(scenario, bench);
  while (run.step()) {
  }
  return run.result();
}

TEST(ScenarioRun, BeginsAtThePresentMomentOfItsBench) {
  bench::Bench bench(module());
  bench.pass(250_ms);
  const ScenarioRead steps = read(bench.configuration());
  ASSERT_TRUE(steps.errors.empty()) << steps.errors.front().text();
  const ScenarioResult result = run_on(bench, steps.scenario);
  EXPECT_EQ(result.status, Status::passed);
  EXPECT_EQ(result.begin, base::SimTime() + 250_ms);
  EXPECT_EQ(result.end, bench.now());
  EXPECT_EQ(result.steps.front().begin, result.begin);
}

TEST(ScenarioRun, GoesStepByStep) {
  bench::Bench bench(module());
  const Scenario scenario = read(bench.configuration()).scenario;
  ScenarioRun run(scenario, bench);
  EXPECT_TRUE(run.step());
  EXPECT_EQ(run.result().steps[0].status, Status::passed);
  EXPECT_EQ(run.result().steps[1].status, Status::not_run);
  EXPECT_TRUE(run.step());
  EXPECT_TRUE(run.step());
  EXPECT_FALSE(run.step());
  EXPECT_EQ(run.result().steps[2].status, Status::passed);
}

TEST(ScenarioRun, FailsBeyondItsLimitOnABenchWithAnother) {
  bench::Bench bench(module());
  const std::vector<std::string> changes{"limit=400ms"};
  const ScenarioResult result = run_on(bench, read(bench.configuration(), changes).scenario);
  ASSERT_NE(result.failed_step(), nullptr);
  EXPECT_EQ(result.failed_step()->kind, "wait");
  EXPECT_THAT(result.failed_step()->text, HasSubstr("the scenario's limit of 400 ms"));
}

TEST(ScenarioRun, FailsAtTheLimitOfItsBench) {
  bench::Bench bench(module(), 300_ms);
  const ScenarioResult result = run_on(bench, read(bench.configuration()).scenario);
  ASSERT_NE(result.failed_step(), nullptr);
  EXPECT_THAT(result.failed_step()->text, HasSubstr("the rack's limit of 300 ms"));
}

TEST(ScenarioRun, TakesNoChangesOfARackThatIsThere) {
  const std::vector<std::string> changes{"step[1].time=1ms", "tmcm-3315.axis[0].supply_voltage=24"};
  const ScenarioRead steps = read(module(), changes);
  ASSERT_EQ(steps.errors.size(), 1U);
  EXPECT_THAT(steps.errors.front().text(),
              HasSubstr("--set tmcm-3315.axis[0].supply_voltage=24: the rack is there already"));
}

TEST(ScenarioRun, ComesToWhatAScenarioWithTheSameRackDoes) {
  bench::Bench bench(module());
  const ScenarioResult on_bench = run_on(bench, read(bench.configuration()).scenario);
  const std::string own = std::string(kSteps).substr(std::string(kSteps).find("[[step]]"));
  const ScenarioResult alone = tests::run_text(std::string(tests::kModule) + own);
  EXPECT_EQ(on_bench.end, alone.end);
}

}  // namespace
}  // namespace stator::scenario
