// How a scenario file is read, and its errors with their places.
#include "stator/scenario/scenario_file.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenario/run_scenario.hpp"
#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using tests::errors_of;
using tests::kModule;

TEST(ScenarioFile, KeepsWhatItSays) {
  const ScenarioRead read = parse_scenario(R"(name = "It waits"
summary = "Nothing else."
product = "tmcm-3315"
limit = "5s"
cycle = "2ms"
plot = ["*.axis0.shaft_position"]

[[step]]
do = "wait"
time = "1500ms"

[[step]]
note = "again"
do = "wait"
time = "20ms"
)",
                                           "test.toml", devices::products());
  ASSERT_TRUE(read.errors.empty()) << read.errors.front().what();
  const Scenario& scenario = read.scenario;
  EXPECT_EQ(scenario.name, "It waits");
  EXPECT_EQ(scenario.summary, "Nothing else.");
  EXPECT_EQ(scenario.limit, base::SimDuration(5'000'000'000));
  EXPECT_EQ(scenario.rack.cycle, base::SimDuration(2'000'000));
  ASSERT_EQ(scenario.steps.size(), 2U);
  EXPECT_EQ(scenario.steps[0].line, 8U);
  EXPECT_EQ(scenario.steps[0].kind, "wait");
  EXPECT_EQ(scenario.steps[0].title, "1.5 s");
  EXPECT_EQ(scenario.steps[1].title, "again");
}

TEST(ScenarioFile, IsNamedLikeItsFileWithoutAName) {
  const ScenarioRead read = parse_scenario("product = \"tmcm-3315\"\n[[step]]\ndo = \"scan\"\n",
                                           "folder/lost-frame.toml", devices::products());
  EXPECT_EQ(read.scenario.name, "lost-frame");
}

TEST(ScenarioFile, TakesTheKeysOfARackAsATable) {
  const ScenarioRead read = parse_scenario(R"([rack]
[[rack.segment]]
[[rack.segment.device]]
type = "tmcm-3315"
name = "own"
[[step]]
do = "scan"
)",
                                           "test.toml", devices::products());
  ASSERT_TRUE(read.errors.empty()) << read.errors.front().what();
  EXPECT_EQ(read.scenario.rack.segments.front().devices.front().name, "own");
}

TEST(ScenarioFile, TellsAllErrorsWithTheirPlaces) {
  const std::string errors = errors_of(std::string(kModule) + R"(colour = "red"
[[step]]
do = "wiat"
[[step]]
do = "wait"
[[step]]
do = "wait"
time = "5 parsecs"
[[step]]
do = "write"
object = "6040:xx"
value = 1
[[step]]
do = "expect-signal"
signal = "tmcm-3315.axis0.torque"
[[step]]
do = "move"
device = "tmcm-3316"
target = 5
[[step]]
do = "scan"
speed = 5
)");
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:2:"), HasSubstr("colour")));
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:4:"), HasSubstr("did you mean \"wait\"")));
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:5:"), HasSubstr("\"time\" is missing")));
  EXPECT_THAT(errors, HasSubstr("test.toml:9:"));
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:12:"), HasSubstr("\"6040:xx\" is no object")));
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:14:"), HasSubstr("what is expected")));
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:19:"), HasSubstr("did you mean \"tmcm-3315\"")));
  EXPECT_THAT(errors, AllOf(HasSubstr("test.toml:23:"), HasSubstr("speed")));
}

TEST(ScenarioFile, NeedsARackAndSteps) {
  EXPECT_THAT(errors_of("[[step]]\ndo = \"scan\"\n"), HasSubstr("a scenario needs a rack file"));
  EXPECT_THAT(errors_of(kModule), HasSubstr("at least one [[step]]"));
  EXPECT_THAT(errors_of("rack = \"nosuch.toml\"\n[[step]]\ndo = \"scan\"\n"),
              HasSubstr("nosuch.toml: cannot read the rack file"));
  EXPECT_THAT(errors_of("product = "), HasSubstr("test.toml:1:"));
}

TEST(ScenarioFile, TellsThatAFileIsMissing) {
  const ScenarioRead read = read_scenario_file("nosuch.toml", devices::products());
  ASSERT_EQ(read.errors.size(), 1U);
  EXPECT_THAT(read.errors.front().what(), HasSubstr("cannot read the scenario file"));
}

TEST(ScenarioFile, WhatHappensToARackIsAStep) {
  for (const std::string& action : rack::EventSectionReader::action_names()) {
    const std::string errors = errors_of(std::string(kModule) + "[[step]]\ndo = \"" + action +
                                         "\"\ndevice = \"nobody\"\n");
    EXPECT_THAT(errors, ::testing::Not(HasSubstr("\"do\""))) << action;
  }
}

TEST(StepKinds, AreNamedOnceAndSaid) {
  std::set<std::string_view> names;
  for (const StepKind& kind : step_kinds()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_FALSE(kind.summary.empty());
    EXPECT_EQ(kind.looks, kind.name.starts_with("expect-")) << kind.name;
    EXPECT_EQ(std::ranges::count(rack::EventSectionReader::action_names(), kind.name), 0);
  }
}

TEST(StepKinds, StandInTheDocumentation) {
  std::ifstream file(STATOR_SOURCE_DIR "/docs/how-to/scenarios.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const StepKind& kind : step_kinds()) {
    EXPECT_THAT(text.str(), HasSubstr("`" + std::string(kind.name) + "`"));
  }
}

TEST(ScenarioFile, TakesChangesOfItsStepsAndOfItsRack) {
  const std::string text =
      "name = \"a\"\nlimit = \"1s\"\n[[step]]\ndo = \"wait\"\ntime = "
      "\"10ms\"\n[rack]\n[[rack.segment]]\n"
      "[[rack.segment.device]]\ntype = \"tmcm-3315\"\nname = \"x\"\n";
  const auto read = [&](const std::vector<std::string>& changes) {
    return parse_scenario(text, "a.toml", devices::products(), changes);
  };
  const ScenarioRead changed = read({"step[0].note=short", "limit=2s", "x.axis[0].motor=nosuch"});
  EXPECT_EQ(changed.scenario.limit, base::SimDuration(2'000'000'000));
  ASSERT_EQ(changed.errors.size(), 1U);
  EXPECT_THAT(changed.errors.front().text(),
              testing::HasSubstr("--set x.axis[0].motor=nosuch: \"motor\" is \"nosuch\""));
  const ScenarioRead step = read({"step[0].note=short", "clock=lockstep"});
  ASSERT_EQ(step.scenario.steps.size(), 1U);
  EXPECT_EQ(step.scenario.steps[0].title, "short");
  EXPECT_EQ(step.scenario.rack.clock, rack::ClockKind::lockstep);
}

}  // namespace
}  // namespace stator::scenario
