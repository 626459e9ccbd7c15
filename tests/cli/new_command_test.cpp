// stator new: writes rack files that stator check accepts, of options and of a person's answers.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using tests::Outcome;
using tests::stator;
using tests::temporary;

TEST(NewCommand, WritesARackFileOfEveryProductThatIsAccepted) {
  for (const char* type : {"tmcm-3315", "tmc8670", "tmcc160", "tmcm-142", "tmc8461", "junction"}) {
    const std::string file = temporary(std::string("new-") + type + ".toml");
    std::filesystem::remove(file);
    const Outcome written = stator("new " + file + " --device " + type);
    EXPECT_EQ(written.status, 0) << written.output;
    const Outcome check = stator("check " + file);
    EXPECT_EQ(check.status, 0) << check.output << tests::content(file);
    EXPECT_THAT(check.output, HasSubstr(type));
  }
}

TEST(NewCommand, TakesSeveralDevicesMotorsAndNetworks) {
  const std::string file = temporary("new-rack.toml");
  std::filesystem::remove(file);
  const Outcome written =
      stator("new " + file +
             " --device tmcm-3315 --device tmcc160 --device tmcc160 --device tmcm-142 --name gantry"
             " --motor QSH5718-79-30-163 --link udp:127.0.0.1 --port slcan:/tmp/new-can"
             " --serial rs232=pty:/tmp/new-serial");
  EXPECT_EQ(written.status, 0) << written.output;
  const std::string text = tests::content(file);
  EXPECT_THAT(text, AllOf(HasSubstr("link = \"udp:127.0.0.1\"\n"), HasSubstr("name = \"gantry\"\n"),
                          HasSubstr("motor = \"QSH5718-79-30-163\"\n"),
                          HasSubstr("ports = [\"slcan:/tmp/new-can\"]\n"),
                          HasSubstr("rs232 = \"pty:/tmp/new-serial\"\n"),
                          HasSubstr("name = \"tmcc160-2\"\n"), HasSubstr("node_id = 2\n")))
      << text;
  EXPECT_THAT(text, HasSubstr("# load.inertia = ")) << "keys that were not chosen are comments";
  const Outcome again = stator("new " + file + " --device tmcm-3315");
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.output, HasSubstr("exists; write another file, or this one with --force"));
  EXPECT_EQ(stator("new " + file + " --device tmcm-3315 --force").status, 0);
  EXPECT_THAT(tests::content(file), Not(HasSubstr("tmcc160")));
}

TEST(NewCommand, RefusesWhatDoesNotExistWithTheNearest) {
  const Outcome device = stator("new --device tmcm-3351");
  EXPECT_EQ(device.status, 1);
  EXPECT_THAT(device.output, HasSubstr("did you mean \"tmcm-3315\"?"));
  const Outcome motor = stator("new --device tmcm-3315 --motor QSH5718-55-30-99");
  EXPECT_EQ(motor.status, 1);
  EXPECT_THAT(motor.output, HasSubstr("did you mean \"QSH5718-55-30-098\"?"));
  const Outcome none = stator("new");
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.output, HasSubstr("say which devices the rack has, e.g. --device tmcm-3315"));
}

TEST(NewCommand, CommentsOfKeysAreRightWithoutTheirSign) {
  const std::string file = temporary("new-comments.toml");
  ASSERT_EQ(stator("new --device tmcm-3315 > " + file).status, 0);
  // Of the first axis only: what stands before concerns links and files that need not be there.
  const std::string text = tests::content(file);
  const std::size_t begin = text.find("[[segment.device.axis]] # 0");
  ASSERT_NE(begin, std::string::npos) << text;
  std::string uncommented = text.substr(0, begin);
  for (std::size_t at = begin; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    std::string line = text.substr(at, end - at);
    // End stops are two keys that must fit together.
    if (line.starts_with("# load.") && line.find("end_stop") == std::string::npos) {
      line.erase(0, 2);
    }
    uncommented += line + "\n";
    at = end + 1;
  }
  std::ofstream(file) << uncommented;
  EXPECT_THAT(uncommented, HasSubstr("\nload.inertia = "));
  const Outcome check = stator("check " + file);
  EXPECT_EQ(check.status, 0) << check.output;
}

}  // namespace
}  // namespace stator
