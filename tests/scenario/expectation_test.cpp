// What expectations see, and what they say when they do not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenario/run_scenario.hpp"

namespace stator::scenario {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using tests::failure_of;
using tests::kDrive;
using tests::kModule;

std::string module(const std::string& steps) {
  return failure_of(std::string(kModule) + steps);
}
std::string drive(const std::string& steps) {
  return failure_of(std::string(kDrive) + steps);
}

TEST(ExpectSignal, GuessesWhatWasMeant) {
  EXPECT_THAT(module("[[step]]\ndo = \"expect-signal\"\nsignal = \"tmcm-3315.axis0.shaft_sped\"\n"
                     "equals = 0\n"),
              HasSubstr("did you mean \"tmcm-3315.axis0.shaft_speed\"?"));
}

TEST(ExpectSignal, MustHoldForItsTime) {
  EXPECT_THAT(module(R"([[step]]
do = "set"
device = "tmcm-3315"
input = "axis0.load_torque"
value = 0.5
[[step]]
do = "expect-signal"
signal = "tmcm-3315.axis0.load_torque"
equals = 0.5
for = "50ms"
[[step]]
do = "inject"
fault = { kind = "load-step", device = "tmcm-3315", torque = 0.2, wait = "20ms" }
[[step]]
do = "expect-signal"
signal = "tmcm-3315.axis0.load_torque"
equals = 0.5
for = "50ms"
)"),
              AllOf(HasSubstr("is 0.5 for 50 ms"), HasSubstr("it is 0.2 Nm")));
}

TEST(ExpectState, TellsStateAndCode) {
  EXPECT_THAT(module("[[step]]\ndo = \"expect-state\"\nstate = \"operational\"\n"),
              HasSubstr("it is in Init with AL status code 0000h"));
  EXPECT_EQ(drive("[[step]]\ndo = \"expect-state\"\nstate = \"pre-operational\"\nwithin = \"2s\"\n"
                  "[[step]]\ndo = \"nmt\"\ncommand = \"stop\"\n"
                  "[[step]]\ndo = \"expect-state\"\nstate = \"stopped\"\n"),
            "passed");
}

TEST(ExpectPowerState, TellsTheStatusword) {
  EXPECT_THAT(module("[[step]]\ndo = \"expect-power-state\"\nstate = \"fault\"\n"),
              HasSubstr("it is in Switch on disabled, statusword"));
}

TEST(ExpectRegister, CountsWhatThePortSees) {
  EXPECT_EQ(module(R"([[step]]
do = "state"
[[step]]
do = "expect-register"
address = 0x0300
equals = 0
[[step]]
do = "inject"
fault = { kind = "ethercat-corrupt", device = "tmcm-3315", count = 3 }
[[step]]
do = "wait"
time = "20ms"
[[step]]
do = "expect-register"
address = 0x0300
equals = 3
)"),
            "passed");
}

TEST(ExpectFrame, LooksAtWhatCameSinceTheLastDeed) {
  EXPECT_EQ(drive(R"([[step]]
do = "nmt"
command = "reset-node"
[[step]]
do = "expect-frame"
identifier = 0x701
data = "00"
within = "2s"
[[step]]
do = "expect-frame"
identifier = 0x701
data = "00"
[[step]]
do = "wait"
time = "10ms"
[[step]]
do = "expect-frame"
identifier = 0x701
data = "00"
absent = true
)"),
            "passed");
  EXPECT_THAT(drive("[[step]]\ndo = \"expect-frame\"\nidentifier = 0x123\nwithin = \"5ms\"\n"),
              HasSubstr("expected a frame 123h within 5 ms; none with that identifier came"));
}

TEST(SendStep, PutsAFrameOnTheBus) {
  EXPECT_EQ(drive(R"([[step]]
do = "expect-state"
state = "pre-operational"
within = "2s"
[[step]]
do = "send"
identifier = 0x601
data = "40 00 10 00 00 00 00 00"
[[step]]
do = "expect-frame"
identifier = 0x581
data = "43 00 10 00 92 01 FC FF"
)"),
            "passed");
}

TEST(ExpectEvent, FindsWhatTheRackTells) {
  EXPECT_EQ(module("[[step]]\ndo = \"power-off\"\ndevice = \"tmcm-3315\"\n"
                   "[[step]]\ndo = \"expect-event\"\nevent = \"power-off\"\n"
                   "[[step]]\ndo = \"expect-event\"\nevent = \"power-on\"\nabsent = true\n"),
            "passed");
  EXPECT_THAT(module("[[step]]\ndo = \"expect-event\"\nevent = \"power-off\"\n"),
              StartsWith("expected an event power-off; it was not told"));
}

TEST(ExpectFault, TellsItsState) {
  EXPECT_EQ(module(R"([[step]]
do = "inject"
fault = { kind = "motor-stall", name = "jam", device = "tmcm-3315" }
[[step]]
do = "expect-fault"
fault = "jam"
state = "active"
[[step]]
do = "clear"
fault = "jam"
[[step]]
do = "expect-fault"
fault = "jam"
state = "done"
)"),
            "passed");
  EXPECT_THAT(module("[[step]]\ndo = \"clear\"\nfault = \"nobody\"\n"),
              HasSubstr("no fault named \"nobody\""));
}

TEST(ExpectObject, ComparesTextsAndMaskedBits) {
  EXPECT_EQ(
      module("[[step]]\ndo = \"expect-object\"\nobject = \"1008:00\"\ntext = \"TMCM-3315\"\n"),
      "passed");
  EXPECT_THAT(
      module("[[step]]\ndo = \"expect-object\"\nobject = \"1008:00\"\ntext = \"TMCM-3316\"\n"),
      HasSubstr("it is \"TMCM-3315\""));
  EXPECT_THAT(module("[[step]]\ndo = \"expect-object\"\nobject = \"1008:00\"\nequals = 5\n"),
              HasSubstr("which is no number"));
}

}  // namespace
}  // namespace stator::scenario
