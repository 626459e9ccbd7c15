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

TEST(ExpectObject, TellsBitsUnderAMaskInHexadecimal) {
  EXPECT_THAT(module("[[step]]\ndo = \"state\"\n"
                     "[[step]]\ndo = \"expect-object\"\nobject = \"6041:00\"\nmask = 0x006F\n"
                     "equals = 0x0027\n"),
              StartsWith("expected tmcm-3315 6041h:00 with mask 6Fh is 27h; it is 0070h, with the "
                         "mask 60h at "));
}

/// A TMCC160 with its supply below the limit, which it tells with FF00h.
constexpr const char* kSag = R"([[step]]
do = "nmt"
command = "start"
[[step]]
do = "enable"
mode = "profile-velocity"
[[step]]
do = "inject"
fault = { kind = "supply-sag", name = "sag", device = "tmcc160", volts = 18 }
)";

TEST(ExpectEmergency, FindsThatOfANodeOnCan) {
  EXPECT_EQ(drive(std::string(kSag) + R"([[step]]
do = "expect-emergency"
code = 0xFF00
within = "500ms"
[[step]]
do = "expect-emergency"
code = 0x8611
absent = true
[[step]]
do = "clear"
[[step]]
do = "expect-emergency"
code = 0xFF00
absent = true
)"),
            "passed")
      << "what came before the last deed does not count";
  EXPECT_THAT(drive(std::string(kSag) + R"([[step]]
do = "expect-emergency"
code = 0x8611
error_register = 0x21
within = "500ms"
)"),
              AllOf(StartsWith("expected an emergency 8611h with error register 21h of tmcc160 "
                               "within 500 ms; FF00h with error register "),
                    HasSubstr(" came at ")));
}

TEST(ExpectEmergency, FetchesThoseOfASlaveFromItsMailbox) {
  // The axis stands at 0, outside of its software limits then.
  const std::string limit = R"([[step]]
do = "state"
[[step]]
do = "write"
object = "607D:01"
value = 1000
)";
  EXPECT_EQ(module(limit + R"([[step]]
do = "expect-emergency"
code = 0xFF01
error_register = 0x81
data = "02 00"
within = "20ms"
[[step]]
do = "expect-emergency"
code = 0xFF01
[[step]]
do = "wait"
time = "10ms"
[[step]]
do = "expect-emergency"
absent = true
)"),
            "passed")
      << "one that was fetched is there for every expectation until the next deed";
  EXPECT_THAT(module(limit + R"([[step]]
do = "expect-emergency"
code = 0xFF01
data = "01"
within = "20ms"
)"),
              StartsWith("expected an emergency FF01h with 01 of tmcm-3315 within 20 ms; FF01h "
                         "with error register 81h and 02 00 00 00 00 came"));
  EXPECT_THAT(module("[[step]]\ndo = \"expect-emergency\"\n"),
              StartsWith("expected an emergency of tmcm-3315; none came"));
}

TEST(ExpectEmergency, IsRefusedForWhatSendsNone) {
  EXPECT_THAT(failure_of("product = \"tmcm-142\"\n[[step]]\ndo = \"expect-emergency\"\n"),
              HasSubstr("tmcm-142 sends none, it is no CANopen node"));
}

TEST(ExpectEvent, OfANameThatNoEventHasIsRefusedWithTheNearest) {
  EXPECT_THAT(tests::errors_of(std::string(kModule) +
                               "[[step]]\ndo = \"expect-event\"\nevent = \"power-of\"\n"),
              HasSubstr("there is no event \"power-of\" (did you mean \"power-off\"?); \"stator "
                        "test --events\" lists all"));
  EXPECT_EQ(
      tests::errors_of(std::string(kModule) +
                       "[[step]]\ndo = \"expect-event\"\nevent = \"tmcm-3315-new-firmware\"\n"),
      "");
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
