// What lists something lists it as JSON as well, with the same rows.
#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::Outcome;
using tests::stator;

nlohmann::json list_of(const std::string& arguments) {
  const Outcome outcome = stator(arguments + " --format json");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return nlohmann::json::parse(outcome.output);
}

/// Each name of the list stands in the text of the same command.
void expect_names_in_text(const std::string& arguments, const nlohmann::json& list,
                          const char* key) {
  const Outcome text = stator(arguments);
  EXPECT_EQ(text.status, 0);
  EXPECT_FALSE(list.empty());
  for (const nlohmann::json& each : list) {
    EXPECT_THAT(text.output, HasSubstr(each.at(key).get<std::string>())) << arguments;
  }
}

TEST(JsonLists, OfProducts) {
  expect_names_in_text("devices", list_of("devices"), "type");
}

TEST(JsonLists, OfKindsOfFaults) {
  expect_names_in_text("faults", list_of("faults").at("kinds"), "name");
  const nlohmann::json one = list_of("faults motor-stall").at("kinds");
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].at("name"), "motor-stall");
  expect_names_in_text("faults motor-stall", one[0].at("target"), "name");
}

TEST(JsonLists, OfSlaves) {
  const nlohmann::json slaves = list_of("scan --device tmcm-3315");
  ASSERT_EQ(slaves.size(), 1U);
  EXPECT_EQ(slaves[0].at("name"), "TMCM-3315");
  EXPECT_EQ(slaves[0].at("coe"), true);
  EXPECT_EQ(slaves[0].at("ports").size(), 4U);
}

TEST(JsonLists, OfTheMemoryMapOfAnIoBlock) {
  const std::string command = "mfc config " STATOR_SOURCE_DIR "/examples/mfc/io-board.toml";
  const nlohmann::json map = list_of(command);
  expect_names_in_text(command, map.at("registers"), "register");
  expect_names_in_text(command, map.at("registers"), "address");
  ASSERT_TRUE(map.at("pins").contains("MFCIO03"));
  EXPECT_THAT(stator(command).output,
              HasSubstr("MFCIO03   " + map.at("pins").at("MFCIO03").get<std::string>() + "\n"));
}

TEST(JsonLists, OfScenariosStepsAndEvents) {
  const std::string scenarios = "test --list " STATOR_SOURCE_DIR "/scenarios";
  expect_names_in_text(scenarios, list_of(scenarios), "name");
  expect_names_in_text("test --steps", list_of("test --steps"), "name");
  const nlohmann::json events = list_of("test --events");
  EXPECT_TRUE(std::ranges::is_sorted(events));
  EXPECT_THAT(stator("test --events").output, HasSubstr("\npower-off\n"));
}

}  // namespace
}  // namespace stator
