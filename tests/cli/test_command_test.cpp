#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using tests::content;
using tests::Outcome;
using tests::stator;
using tests::temporary;

/// Scenarios in a folder of their own.
class TestCommand : public ::testing::Test {
 protected:
  TestCommand() {
    std::filesystem::create_directories(folder_);
    write("good.toml",
          "name = \"it waits\"\nproduct = \"tmcm-3315\"\n[[step]]\ndo = \"wait\"\n"
          "time = \"10ms\"\n");
    write("bad.toml",
          "name = \"it turns\"\nproduct = \"tmcm-3315\"\n[[step]]\ndo = \"expect-signal\"\n"
          "signal = \"tmcm-3315.axis0.shaft_speed\"\nabove = 1\n");
  }
  ~TestCommand() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ + "/" + name) << text;
  }
  [[nodiscard]] std::string in_folder(const std::string& name) const {
    return folder_ + "/" + name;
  }

  std::string folder_ = temporary("scenarios");
};

TEST_F(TestCommand, RunsAllOfAFolderAndFailsIfOneDoes) {
  const Outcome outcome = stator("test " + folder_);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("passed  it waits (0.010 s simulated"), HasSubstr("failed  it turns"),
                    HasSubstr("bad.toml:3: expect-signal"), HasSubstr("1 of 2 scenarios passed")));
  EXPECT_EQ(stator("test " + in_folder("good.toml")).status, 0);
}

TEST_F(TestCommand, ChoosesByName) {
  const Outcome list = stator("test --list " + folder_);
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.output, AllOf(HasSubstr("it turns  "), HasSubstr("it waits  ")));
  const Outcome some = stator("test --verbose --filter '*waits' " + folder_);
  EXPECT_EQ(some.status, 0) << some.output;
  EXPECT_THAT(some.output, AllOf(HasSubstr("wait:3: 10 ms"), Not(HasSubstr("it turns"))));
  const Outcome none = stator("test --filter nothing " + folder_);
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.output, HasSubstr("no scenario is named like \"nothing\""));
}

TEST_F(TestCommand, WritesReports) {
  const Outcome outcome = stator("test " + folder_ + " --junit " + in_folder("r.xml") + " --html " +
                                 in_folder("r.html"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(content(in_folder("r.xml")), HasSubstr("<testsuite name=\"it turns\""));
  EXPECT_THAT(content(in_folder("r.html")), HasSubstr("1 of 2 passed"));
}

TEST_F(TestCommand, GoesOnBehindAFileThatCannotBeRead) {
  write("broken.toml", "product = \"tmcm-3315\"\n[[step]]\ndo = \"wiat\"\n");
  const Outcome outcome = stator("test " + folder_);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("broken.toml:3:"), HasSubstr("did you mean \"wait\""),
                                    HasSubstr("1 of 3 scenarios passed")));
}

TEST_F(TestCommand, SaysWhatItNeeds) {
  EXPECT_THAT(stator("test").output, HasSubstr("name a scenario file or a folder"));
  std::filesystem::create_directories(in_folder("empty"));
  EXPECT_THAT(stator("test " + in_folder("empty")).output,
              HasSubstr("no scenario is in this folder"));
  EXPECT_THAT(stator("test --steps").output,
              AllOf(HasSubstr("expect-signal"), HasSubstr("inject")));
}

TEST(TestCommandKeys, AreListedForCompletion) {
  const Outcome outcome = stator("test --keys");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("limit\tduration, \"1ms\" to \"86400s\"\t`\"60s\"`\tSimulated time "
                              "after which the scenario has failed\n"),
                    HasSubstr("step[].target\tinteger, -2147483648 to 2147483647\tneeded\tTarget "
                              "position in the drive's units\n"),
                    HasSubstr("step[].fault.kind\t"), HasSubstr("rack\ttext or table\t")));
}

TEST(TestCommandKeys, AreAskedForWithoutFiles) {
  EXPECT_NE(stator("test --schema " STATOR_SOURCE_DIR "/scenarios").status, 0);
}

TEST(TestCommandKeys, TheirSchemaIsTheFileInTheDocumentation) {
  tests::expect_documented("test --schema", "scenario.schema.json");
}

TEST(TestCommandKeys, TheirReferenceIsThePageInTheDocumentation) {
  tests::expect_documented("test --reference", "scenario-keys.md");
}

}  // namespace
}  // namespace stator
