// What a bench does for the steps of scenarios, and how these end.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenario/run_scenario.hpp"
#include "source_paths.hpp"

namespace stator::scenario {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using tests::failure_of;
using tests::kDrive;
using tests::kModule;
using tests::run_text;

TEST(Bench, KeepsProcessDataGoingWhileItWaits) {
  EXPECT_EQ(failure_of(std::string(kModule) + R"(
[[step]]
do = "state"
[[step]]
do = "wait"
time = "500ms"
[[step]]
do = "expect-state"
state = "operational"
al_status = 0
[[step]]
do = "expect-lost-cycles"
equals = 0
)"),
            "passed");
}

TEST(Bench, KeepsASlaveWithoutObjectsGoing) {
  EXPECT_EQ(failure_of("rack = \"" STATOR_SOURCE_DIR "/racks/io-board.toml\""
                       R"(
[[step]]
do = "state"
[[step]]
do = "wait"
time = "500ms"
[[step]]
do = "expect-state"
state = "operational"
al_status = 0
)"),
            "passed");
}

TEST(Bench, TellsTheRefusalOfAState) {
  EXPECT_EQ(failure_of(std::string(kModule) + R"(
[[step]]
do = "state"
device = "tmcm-3315"
state = "safe-operational"
al_status = 0x0011
)"),
            "passed");
  EXPECT_THAT(failure_of(std::string(kModule) + R"(
[[step]]
do = "state"
device = "tmcm-3315"
state = "safe-operational"
al_status = 0x001E
)"),
              HasSubstr("expected a refusal with AL status code 001Eh"));
}

TEST(Bench, WritesAndReadsObjectsOverBothNetworks) {
  for (const char* rack : {kModule, kDrive}) {
    EXPECT_EQ(failure_of(std::string(rack) + R"(
[[step]]
do = "write"
object = "607A:00"
value = -5
[[step]]
do = "expect-object"
object = "607A:00"
equals = -5
[[step]]
do = "write"
object = "1000:00"
value = 5
abort = 0x06010002
[[step]]
do = "expect-object"
object = "5FFF:00"
abort = 0x06020000
[[step]]
do = "expect-object"
object = "6041:00"
mask = 0x4F
equals = 0x40
)"),
              "passed")
        << rack;
  }
}

TEST(Bench, WritesOnlyWhatFits) {
  EXPECT_THAT(failure_of(std::string(kModule) +
                         "[[step]]\ndo = \"write\"\nobject = \"6060:00\"\nvalue = 300\n"),
              StartsWith("300 does not fit"));
  EXPECT_THAT(failure_of(std::string(kModule) +
                         "[[step]]\ndo = \"write\"\nobject = \"6060:00\"\nvalue = 1.5\n"),
              StartsWith("1.5 is no whole number"));
}

TEST(Bench, MovesADriveOnEachNetwork) {
  EXPECT_EQ(failure_of(std::string(kModule) + R"(
[[step]]
do = "state"
[[step]]
do = "move"
axis = 2
target = 51200
velocity = 512000
acceleration = 5120000
[[step]]
do = "expect-signal"
signal = "tmcm-3315.axis2.shaft_position"
equals = 1
tolerance = 0.02
[[step]]
do = "disable"
axis = 2
[[step]]
do = "expect-power-state"
axis = 2
state = "switch-on-disabled"
)"),
            "passed");
  EXPECT_EQ(failure_of(std::string(kDrive) + R"(
[[step]]
do = "nmt"
command = "start"
[[step]]
do = "enable"
mode = "profile-velocity"
[[step]]
do = "write"
object = "60FF:00"
value = 500
[[step]]
do = "expect-signal"
signal = "tmcc160.axis0.shaft_speed"
above = 5
within = "3s"
)"),
            "passed");
}

TEST(Bench, FindsASlaveAgainAfterAScanOnly) {
  EXPECT_THAT(failure_of(std::string(kModule) + R"(
[[step]]
do = "scan"
[[step]]
do = "power-off"
device = "tmcm-3315"
[[step]]
do = "power-on"
device = "tmcm-3315"
[[step]]
do = "expect-state"
state = "init"
)"),
              HasSubstr("a step \"scan\" looks again"));
}

TEST(Bench, TellsThatThereIsNoReplyOfAModule) {
  const std::string line =
      "[rack]\n[[rack.device]]\ntype = \"tmcm-142\"\nname = \"feeder\"\n"
      "rs232 = \"pty:/tmp/x\"\n";
  EXPECT_EQ(failure_of(line + "[[step]]\ndo = \"tmcl\"\ncommand = \"GAP 1, 0\"\nequals = 8\n"),
            "expected status 100 (success) and a value that is 8; status 100 (success), value 0");
  EXPECT_THAT(failure_of(line + "[[step]]\ndo = \"power-off\"\ndevice = \"feeder\"\n"
                                "[[step]]\ndo = \"tmcl\"\ncommand = \"GAP 1, 0\"\n"),
              HasSubstr("no reply came over pty:/tmp/x within 0.2 s"));
  EXPECT_THAT(failure_of(line + "[[step]]\ndo = \"tmcl\"\ncommand = \"JUMP 1, 0\"\n"),
              HasSubstr("is no command"));
}

TEST(Bench, ReachesAModuleOverCanAsWell) {
  EXPECT_EQ(failure_of("product = \"tmcm-142\"\n[[step]]\ndo = \"tmcl\"\ncommand = \"SAP 4, 0, "
                       "700\"\n[[step]]\ndo = \"tmcl\"\ncommand = \"GAP 4, 0\"\nequals = 700\n"),
            "passed");
}

TEST(Runner, EndsAtTheFirstStepThatFails) {
  const ScenarioResult result = run_text(std::string(kModule) + R"(
[[step]]
do = "expect-signal"
signal = "tmcm-3315.axis0.torque"
above = 5
within = "10ms"
[[step]]
do = "wait"
time = "1s"
)");
  EXPECT_EQ(result.status, Status::failed);
  EXPECT_EQ(result.steps[0].status, Status::failed);
  EXPECT_EQ(result.steps[0].text,
            "expected tmcm-3315.axis0.torque is above 5 within 10 ms; it is 0 Nm at 0.010000 s");
  EXPECT_EQ(result.steps[1].status, Status::not_run);
  EXPECT_EQ(result.end, base::SimTime(10_ms));
}

TEST(Runner, FailsAScenarioThatTakesTooLong) {
  EXPECT_THAT(failure_of(std::string(kModule) +
                         "limit = \"50ms\"\n[[step]]\ndo = \"wait\"\ntime = \"1s\"\n"),
              HasSubstr("limit of 50 ms of simulated time is reached"));
}

TEST(Runner, TellsWhyARackCannotBeBuilt) {
  const ScenarioResult result =
      run_text("plot = [\"nosuch\"]\n" + std::string(kModule) + "[[step]]\ndo = \"scan\"\n");
  EXPECT_EQ(result.status, Status::error);
  EXPECT_THAT(result.error, HasSubstr("nosuch"));
}

}  // namespace
}  // namespace stator::scenario
