// stator faults, inject, clear, status.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/stator_program.hpp"
#include "stator/cli/client/fault_keys.hpp"
#include "stator/cli/failure.hpp"

namespace stator::cli {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

TEST(FaultWords, BecomeWhatTheTableOfKindsSays) {
  EXPECT_EQ(fault_of_words("mailbox-abort",
                           {"device=7", "code=0x06020000", "object=6060", "when.sdo=1018:01",
                            "when.count=2", "for=1s", "probability=0.5"}),
            (json{{"kind", "mailbox-abort"},
                  {"device", "7"},
                  {"code", 0x06020000},
                  {"object", "6060"},
                  {"when", {{"sdo", "1018:01"}, {"count", 2}}},
                  {"for", "1s"},
                  {"probability", 0.5}}));
  EXPECT_EQ(fault_of_words("ethercat-drop", {"count=many"})["count"], "many")
      << "the rack says what is wrong with it";
}

TEST(FaultWords, MistakesAreExplained) {
  try {
    (void)fault_of_words("mailbox-stal", {});
    FAIL() << "accepted";
  } catch (const Failure& failure) {
    EXPECT_THAT(failure.what(), HasSubstr("did you mean \"mailbox-stall\"?"));
  }
  EXPECT_THROW((void)fault_of_words("ethercat-drop", {"count"}), Failure);
}

TEST(FaultCommands, ListKindsAndKeys) {
  const tests::Outcome all = tests::stator("faults");
  EXPECT_EQ(all.status, 0);
  EXPECT_THAT(all.output, HasSubstr("clock-drift"));
  const tests::Outcome one = tests::stator("faults mailbox-stall");
  EXPECT_EQ(one.status, 0);
  EXPECT_THAT(one.output, HasSubstr("when.cycles"));
  EXPECT_THAT(tests::stator("faults mailbox-stal").output, HasSubstr("did you mean"));
}

TEST(FaultCommands, TellWhenNoRackIsServed) {
  for (const char* command : {"inject ethercat-drop --device x", "clear --all", "status"}) {
    const tests::Outcome outcome =
        tests::stator(std::string(command) + " --http 127.0.0.1:1");  // a port nobody has
    EXPECT_EQ(outcome.status, 1) << command;
    EXPECT_THAT(outcome.output, HasSubstr("no web server at 127.0.0.1:1")) << command;
    EXPECT_THAT(outcome.output, HasSubstr("stator run RACK --http")) << command;
  }
  EXPECT_THAT(tests::stator("status --http ftp://there").output, HasSubstr("is no address"));
  EXPECT_THAT(tests::stator("clear").output, HasSubstr("say which faults to clear"));
}

}  // namespace
}  // namespace stator::cli
