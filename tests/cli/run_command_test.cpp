// What "stator run" says before it runs: warnings, refusals, and their order.

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "stator/link/can/can_link.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/serial/serial_link.hpp"
#include "stator/link/system/tcp_listener.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using tests::Outcome;
using tests::stator;
using tests::temporary;

/// Two drives with one node-ID, in a file that goes with the object.
class TwinRack {
 public:
  TwinRack() {
    std::ofstream(path_) << "[[bus]]\nports = [\"slcan-tcp:0\"]\n"
                            "[[bus.device]]\ntype = \"tmcc160\"\nname = \"lift\"\n"
                            "[[bus.device]]\ntype = \"tmcc160\"\nname = \"spindle\"\n";
  }
  ~TwinRack() { std::filesystem::remove(path_); }
  TwinRack(const TwinRack&) = delete;
  TwinRack& operator=(const TwinRack&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_ = temporary("twins.toml");
};

TEST(RunCommand, WarnsOfAddressesGivenTwiceAndRuns) {
  const TwinRack rack;
  const Outcome run = stator("run " + rack.path() + " --duration 10ms");
  EXPECT_EQ(run.status, 0) << run.output;
  const std::size_t warning =
      run.output.find("node-ID 1 is given to 2 devices of can0 (lift, spindle)");
  EXPECT_LT(warning, run.output.find("CAN bus can0")) << run.output;

  const Outcome check = stator("check " + rack.path());
  EXPECT_EQ(check.status, 0) << check.output;
  EXPECT_THAT(check.output, HasSubstr(rack.path() + ": warning: node-ID 1 is given to 2 devices"));
  EXPECT_THAT(stator("check --format json " + rack.path()).output,
              HasSubstr("\"warnings\": [\n    {\n      \"message\": \"node-ID 1 is given"));
}

TEST(RunCommand, WhatFailsAtTheStartIsNotAnnouncedBefore) {
  std::uint16_t port = 0;
  const auto listener = link::listen_at("127.0.0.1", port, "test");
  ASSERT_TRUE(listener) << listener.error().text;
  const Outcome outcome =
      stator("run --device tmcc160 --port slcan-tcp:0 --http 127.0.0.1:" + std::to_string(port));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("stator: the web server cannot listen"));
  EXPECT_THAT(outcome.output, Not(HasSubstr("CAN bus"))) << "nothing runs";
}

TEST(RunCommand, ItsOutputAndItsLogStandInTheirOrderInOneFile) {
  const std::string path = temporary("order.toml");
  std::ofstream(path) << "[[bus]]\nports = [\"slcan-tcp:0\"]\n[[bus.device]]\ntype = \"tmcc160\"\n"
                         "[[event]]\nat = \"1ms\"\naction = \"power-off\"\ndevice = \"tmcc160\"\n";
  const Outcome outcome = stator("run " + path + " --duration 300ms");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  const std::size_t running = outcome.output.find("Running;");
  const std::size_t event = outcome.output.find("power");
  const std::size_t end = outcome.output.find(" overruns");
  EXPECT_LT(running, event) << outcome.output;
  EXPECT_LT(event, end) << outcome.output;
  std::filesystem::remove(path);
}

TEST(RunCommand, APathThatAnotherRunServesIsRefused) {
  const std::string path = temporary("served");
  const auto serial = link::open_serial_link("pty:" + path);
  ASSERT_TRUE(serial) << serial.error().text;
  for (const char* options :
       {"--device tmcm-142 --serial pty:", "--device tmcc160 --port slcan:"}) {
    const Outcome outcome = stator("run " + (options + path) + " --duration 10ms");
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("another process serves \"" + path + "\"; end it"));
    EXPECT_TRUE(std::filesystem::is_symlink(path)) << "the run that has it keeps it";
  }
}

TEST(RunCommand, TakesARealTimePriorityWithinItsLimits) {
  EXPECT_EQ(stator("run --device tmcc160 --port slcan-tcp:0 --priority 0").status, 2);
  EXPECT_EQ(stator("run --device tmcc160 --port slcan-tcp:0 --priority 100").status, 2);
  const Outcome outcome =
      stator("run --device tmcc160 --port slcan-tcp:0 --priority 20 --duration 10ms");
  if (link::may_run_in_real_time(20)) {
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("Running;"));
  } else {
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.output, HasSubstr("stator: --priority: real-time priority 20 is not"));
  }
}

TEST(RunCommand, SaysWhereEventsStandInTheTimeOfTheFrames) {
  const std::string run = "run --device tmcc160 --port slcan-tcp:0 --duration 10ms";
  EXPECT_THAT(stator(run).output, HasSubstr("0 s of the events is "));
  EXPECT_THAT(stator(run + " --clock lockstep").output, Not(HasSubstr("0 s of the events")));
}

}  // namespace
}  // namespace stator
