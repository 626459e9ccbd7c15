// stator from: a rack file of files, what became of them, and what it refuses.
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/temporary_directory.hpp"
#include "cli/stator_program.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::Outcome;
using tests::stator;

class FromCommand : public testing::Test {
 protected:
  [[nodiscard]] std::string made(const std::string& name) const {
    return directory_.path() + "/" + name;
  }
  [[nodiscard]] static std::string example(const std::string& name) {
    return std::string(STATOR_SOURCE_DIR) + "/examples/device_files/" + name;
  }
  tests::TemporaryDirectory directory_;
};

TEST_F(FromCommand, WritesARackThatRunsAndSaysWhatItAssumed) {
  const Outcome outcome = stator("from " + example("servo_drive.xml") + " " +
                                 example("can_drive.eds") + " -o " + made("rack.toml"));
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("assumed:"));
  EXPECT_THAT(outcome.output, HasSubstr("[drive-default]"));
  const Outcome check = stator("check " + made("rack.toml"));
  EXPECT_EQ(check.status, 0) << check.output;
  const Outcome moved = stator("move --rack " + made("rack.toml") +
                               " --units-per-revolution 10000 --velocity 200000 --acceleration "
                               "2000000 --revolutions 2");
  EXPECT_EQ(moved.status, 0) << moved.output;
}

TEST_F(FromCommand, DrivesWithCyclicModesOnlyMoveByAStreamOfTargets) {
  std::string text = tests::content(example("servo_drive.xml"));
  const std::string modes = "<DefaultData>A5010000</DefaultData>";
  ASSERT_NE(text.find(modes), std::string::npos) << "6502h";
  text.replace(text.find(modes), modes.size(), "<DefaultData>80010000</DefaultData>");
  std::ofstream(made("cyclic.xml")) << text;
  ASSERT_EQ(stator("from " + made("cyclic.xml") + " -o " + made("rack.toml")).status, 0);
  const Outcome moved = stator("move --rack " + made("rack.toml") +
                               " --units-per-revolution 10000 --velocity 200000 --acceleration "
                               "2000000 --revolutions -3 --settle 500ms");
  EXPECT_EQ(moved.status, 0) << moved.output;
  EXPECT_THAT(moved.output, HasSubstr("0 -> -30000"));
  EXPECT_THAT(moved.output, testing::ContainsRegex("at -(30000|29999|30001), [01] from"));
}

TEST_F(FromCommand, SaysTheSameAsJson) {
  const Outcome outcome =
      stator("from " + example("terminals.xml") + " --device DI-4 --format json");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const auto said = nlohmann::json::parse(outcome.output);
  EXPECT_THAT(said["rack"].get<std::string>(), HasSubstr("#DI-4"));
  EXPECT_EQ(said["files"][0]["name"], "di-4");
}

TEST_F(FromCommand, RefusesWhatIsNoFileOfADeviceAndWhatHasSeveral) {
  const Outcome other = stator("from " + std::string(STATOR_SOURCE_DIR) + "/LICENSE");
  EXPECT_NE(other.status, 0);
  EXPECT_THAT(other.output, HasSubstr("no file of a device"));
  const Outcome several = stator("from " + example("terminals.xml"));
  EXPECT_NE(several.status, 0);
  EXPECT_THAT(several.output, HasSubstr("DO-2"));
}

TEST_F(FromCommand, KeepsAFileThatIsThere) {
  const std::string rack = made("rack.toml");
  ASSERT_EQ(stator("from " + example("servo_drive.xml") + " -o " + rack).status, 0);
  EXPECT_NE(stator("from " + example("servo_drive.xml") + " -o " + rack).status, 0);
  EXPECT_EQ(stator("from " + example("servo_drive.xml") + " --force -o " + rack).status, 0);
}

}  // namespace
}  // namespace stator
