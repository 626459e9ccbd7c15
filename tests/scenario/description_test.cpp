// What is told of the keys of scenario files.

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/event_section.hpp"
#include "stator/rack/file/rack_file_description.hpp"
#include "stator/scenario/scenario_file.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {
namespace {

using settings::KeyDescription;
using settings::TableDescription;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

class ScenarioDescription : public ::testing::Test {
 protected:
  [[nodiscard]] const TableDescription& step() const { return *root_.find("step")->table; }
  /// The keys that steps of a kind have besides those of every step.
  [[nodiscard]] const TableDescription& step(std::string_view kind) const {
    for (const settings::TableVariant& variant : step().variants) {
      if (variant.value == kind) {
        return *variant.table;
      }
    }
    ADD_FAILURE() << kind << " is not described";
    return step();
  }
  [[nodiscard]] const KeyDescription& key(std::string_view kind, const std::string& name) const {
    const KeyDescription* const found = step(kind).find(name);
    if (found == nullptr) {
      ADD_FAILURE() << kind << " has no " << name;
      return root_.keys.front();
    }
    return *found;
  }

  TableDescription root_ = describe_scenario_file(devices::products());
};

std::vector<std::string> names_of(const TableDescription& table) {
  std::vector<std::string> names;
  for (const KeyDescription& key : table.keys) {
    names.push_back(key.name);
  }
  return names;
}

TEST_F(ScenarioDescription, NamesTheKeysOfTheFile) {
  EXPECT_THAT(names_of(root_),
              ElementsAre("name", "summary", "product", "rack", "cycle", "limit", "plot", "step"));
  EXPECT_EQ(root_.find("limit")->default_value, "\"60s\"");
  EXPECT_EQ(root_.find("cycle")->default_value, "") << "it is the rack's";
  EXPECT_FALSE(root_.find("rack")->required) << "there may be a product";
  EXPECT_THAT(root_.find("product")->forms.front().choices, Contains("tmcm-3315"));
}

TEST_F(ScenarioDescription, OfARackIsThatOfARackFile) {
  const KeyDescription& rack = *root_.find("rack");
  EXPECT_EQ(rack.forms.size(), 2U) << "a text, or a table";
  EXPECT_EQ(rack.table->kind_of_file, rack::kRackFileKind);
  EXPECT_THAT(rack.table->keys, IsEmpty());
}

TEST_F(ScenarioDescription, NamesEveryKindOfStepAndEverythingThatCanHappenToARack) {
  EXPECT_EQ(step().selector, "do");
  EXPECT_THAT(names_of(step()), ElementsAre("note", "do"));
  std::vector<std::string> values;
  for (const settings::TableVariant& variant : step().variants) {
    values.push_back(variant.value);
  }
  std::vector<std::string> kinds;
  for (const StepKind& kind : step_kinds()) {
    kinds.emplace_back(kind.name);
  }
  EXPECT_THAT(values, IsSupersetOf(kinds));
  EXPECT_THAT(values, IsSupersetOf(rack::EventSectionReader::action_names()));
  EXPECT_EQ(values.size(), kinds.size() + rack::EventSectionReader::action_names().size());
}

TEST_F(ScenarioDescription, HasTheKeysOfEachStep) {
  EXPECT_THAT(names_of(step("move")),
              ElementsAre("device", "axis", "within", "target", "relative", "velocity",
                          "acceleration", "deceleration", "wait"));
  EXPECT_THAT(names_of(step("state")), ElementsAre("device", "segment", "state", "al_status"));
  EXPECT_THAT(names_of(step("nmt")), ElementsAre("device", "bus", "command"));
  EXPECT_THAT(names_of(step("expect-event")),
              ElementsAre("event", "device", "absent", "within", "for"));
  EXPECT_THAT(names_of(step("power-off")), ElementsAre("device"));
  EXPECT_THAT(names_of(*key("inject", "fault").table), Contains("kind"));
  EXPECT_EQ(key("inject", "fault").table->kind_of_file, "rack-file#fault");
}

TEST_F(ScenarioDescription, SaysWhatIsNeededAndWhatIsThereWithout) {
  EXPECT_TRUE(key("wait", "time").required);
  EXPECT_TRUE(key("write", "object").required);
  EXPECT_FALSE(key("write", "value").required) << "there may be bytes";
  EXPECT_FALSE(key("expect-signal", "equals").required) << "there may be another comparison";
  EXPECT_TRUE(key("expect-event", "event").required);
  EXPECT_FALSE(key("move", "device").required) << "a rack with one device needs no name";
  EXPECT_EQ(key("move", "within").default_value, "\"30s\"");
  EXPECT_EQ(key("enable", "within").default_value, "\"1s\"");
  EXPECT_EQ(key("state", "state").default_value, "\"operational\"");
  EXPECT_EQ(key("tmcl", "status").default_value, "100");
}

TEST_F(ScenarioDescription, OfAStateHasThoseOfBothNetworks) {
  const KeyDescription& state = key("expect-state", "state");
  ASSERT_EQ(state.forms.size(), 2U);
  EXPECT_THAT(state.forms[0].choices, Contains("bootstrap"));
  EXPECT_THAT(state.forms[1].choices, ElementsAre("operational", "pre-operational", "stopped"));
}

TEST_F(ScenarioDescription, SaysSomethingOfEveryKey) {
  for (const KeyDescription& key : root_.keys) {
    EXPECT_NE(key.summary, "") << key.name;
  }
  for (const settings::TableVariant& variant : step().variants) {
    for (const KeyDescription& key : variant.table->keys) {
      EXPECT_NE(key.summary, "") << variant.value << " " << key.name;
      EXPECT_THAT(key.summary, ::testing::Not(::testing::EndsWith("."))) << key.name;
    }
  }
}

// What decides whether --set changes a scenario or its rack is the same declaration.
TEST_F(ScenarioDescription, HasTheKeysThatChangesOfAScenarioBeginWith) {
  for (const KeyDescription& key : root_.keys) {
    const std::string change = key.name + "=5";
    const ScenarioRead read =
        parse_scenario("product = \"tmcm-3315\"\n[[step]]\ndo = \"scan\"\n", "a.toml",
                       devices::products(), std::vector<std::string>{change});
    if (key.name == "rack") {
      continue;  // is not looked at beside a product but unknown
    }
    ASSERT_FALSE(read.errors.empty()) << key.name;
    EXPECT_THAT(read.errors.front().text(), HasSubstr(" in the scenario")) << change;
  }
}

}  // namespace
}  // namespace stator::scenario
