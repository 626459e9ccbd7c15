// A bus of a rack on a real port, as "stator run" runs it.

#include "stator/rack/run/bus_thread.hpp"

#include <array>
#include <chrono>
#include <fstream>
#include <span>
#include <string>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "rack/test_can_device.hpp"
#include "rack/text_log.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::rack {
namespace {

using stator::tests::rack_with_bus;
using ::testing::HasSubstr;

/// A program behind a TCP connection.
class Program {
 public:
  explicit Program(const std::string& port_name) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port =
        htons(static_cast<std::uint16_t>(std::stoul(port_name.substr(port_name.rfind(':') + 1))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }

  void send(const std::string& text) {
    EXPECT_EQ(::write(socket_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// What comes until it contains `end` or ten seconds have passed.
  std::string read_until(const std::string& end) {
    std::string text;
    while (text.find(end) == std::string::npos) {
      pollfd waiting{.fd = socket_.get(), .events = POLLIN, .revents = 0};
      std::array<char, 4096> buffer{};
      const ssize_t got =
          ::poll(&waiting, 1, 10'000) > 0 ? ::read(socket_.get(), buffer.data(), buffer.size()) : 0;
      if (got <= 0) {
        ADD_FAILURE() << "only \"" << text << "\" came";
        break;
      }
      text.append(buffer.data(), static_cast<std::size_t>(got));
    }
    return text;
  }

 private:
  link::FileDescriptor socket_;
};

/// A program with the LAWICEL protocol.
class SlcanProgram : public Program {
 public:
  explicit SlcanProgram(const std::string& port_name) : Program(port_name) { send("O\r"); }
};

class BusThreadTest : public ::testing::Test {
 protected:
  explicit BusThreadTest(RackConfiguration configuration = rack_with_bus(2))
      : configuration_(std::move(configuration)) {
    configuration_.buses[0].ports = {"slcan-tcp:0"};
  }
  void start() {
    rack_.emplace(configuration_, log_);
    runner_.emplace(*rack_, configuration_, logger_);
    runner_->start();
  }
  [[nodiscard]] std::string port() { return runner_->bus(0).port(0).name(); }

  RackConfiguration configuration_;
  EventLog log_;
  std::shared_ptr<Log> logger_ = tests::no_log();
  std::optional<Rack> rack_;
  std::optional<Runner> runner_;
};

TEST_F(BusThreadTest, AProgramIsAnswered) {
  for (const ClockKind clock : {ClockKind::real, ClockKind::lockstep}) {
    configuration_.clock = clock;
    runner_.reset();
    start();
    SlcanProgram program(port());
    program.send("t60224011\r");
    EXPECT_THAT(program.read_until("t58224011\r"), HasSubstr("t58224011\r"));
    runner_->stop();
    EXPECT_EQ(runner_->bus(0).statistics().frames_in, 1U);
  }
}

/// Seconds since 1970, now.
double time_of_day() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

TEST_F(BusThreadTest, TimeStampsAreTheMachinesTimeAndInLockstepSimulatedTime) {
  const tests::TemporaryDirectory directory;
  configuration_.buses[0].ports = {"socketcand:0"};
  configuration_.buses[0].log = directory.path() + "/can0.log";
  configuration_.buses[0].capture = directory.path() + "/can0.pcap";
  for (const ClockKind clock : {ClockKind::real, ClockKind::lockstep}) {
    configuration_.clock = clock;
    runner_.reset();
    start();
    Program program(port());
    program.send("< open can0 >< rawmode >< send 602 1 11 >");
    const std::string answer = program.read_until(" 11 >");
    runner_->stop();
    EXPECT_TRUE(rack_->outputs().finish().empty());
    const std::string mark = "< frame 582 ";
    const std::size_t at = answer.find(mark);
    ASSERT_NE(at, std::string::npos) << answer;
    const double on_port = std::stod(answer.substr(at + mark.size()));

    std::ifstream log(configuration_.buses[0].log);
    std::string line;
    ASSERT_TRUE(std::getline(log, line));
    const double in_log = std::stod(line.substr(1));

    constexpr std::size_t kPcapHeader = 24;
    std::ifstream capture(configuration_.buses[0].capture, std::ios::binary);
    std::array<char, kPcapHeader + 4> head{};
    ASSERT_TRUE(capture.read(head.data(), head.size()));
    const auto in_capture =
        base::load_le<std::uint32_t>(std::as_bytes(std::span(head)), kPcapHeader);

    // A minute is as good as a moment here: simulated time is half a century away.
    const double expected = clock == ClockKind::real ? time_of_day() : 30.0;
    for (const double time : {on_port, in_log, static_cast<double>(in_capture)}) {
      EXPECT_NEAR(time, expected, 60.0);
    }
    EXPECT_NEAR(on_port, in_log, 1.0);
  }
}

TEST_F(BusThreadTest, OnAPacedBusAnswersComeWhenTheirTimeHasCome) {
  configuration_ = rack_with_bus(2, 10'000);
  configuration_.buses[0].ports = {"slcan-tcp:0"};
  start();
  SlcanProgram program(port());
  program.send("t60281122334455667788\r");
  program.read_until("t58281122334455667788\r");
  runner_->stop();
  EXPECT_GT(runner_->now(), base::SimTime(base::SimDuration(20'000'000))) << "20 ms on the wire";
}

TEST_F(BusThreadTest, AnUnpacedBurstLosesNoFrame) {
  start();
  SlcanProgram program(port());
  SlcanProgram listener(port());
  constexpr unsigned kFrames = 20'000;
  std::string burst;
  for (unsigned i = 0; i < kFrames; ++i) {
    burst += "t6011" + std::string(1, "0123456789ABCDEF"[i % 16]) + "0\r";
  }
  std::thread sender([&] { program.send(burst + "t60213F\r"); });
  const std::string answers = program.read_until("t58213F\r");
  sender.join();
  EXPECT_EQ(std::ranges::count(answers, 't'), kFrames + 1) << "each frame begins with a t";
}

TEST_F(BusThreadTest, InLockstepTimeMovesWithFramesOnly) {
  configuration_.clock = ClockKind::lockstep;
  start();
  SlcanProgram program(port());
  program.send("t0800\rt0800\rt6021AA\r");
  program.read_until("t5821AA\r");
  runner_->stop();
  EXPECT_EQ(runner_->now(), base::SimTime(base::SimDuration(2'050'000)));
}

TEST_F(BusThreadTest, ErrorFramesReachProgramsInTheFormOfTheirPort) {
  configuration_.clock = ClockKind::lockstep;
  configuration_.buses[0].ports = {"slcan-tcp:0", "socketcand:0"};
  configuration_.events = {
      {base::SimDuration(0), FrameFaultEvent{0, {}, {.kind = can::FrameFaultKind::corrupt}}}};
  start();
  SlcanProgram flags(port());
  Program frames(runner_->bus(0).port(1).name());
  frames.send("< open can0 >< rawmode >< send 602 1 11 >");
  const std::string told = frames.read_until("11 >");
  EXPECT_THAT(told, HasSubstr("\n< error 088 0.000050 >\n< frame 582 "));
  flags.read_until("t582111\r");
  flags.send("F\r");
  EXPECT_THAT(flags.read_until("F80\r"), HasSubstr("F80\r"));
  runner_->stop();
  EXPECT_EQ(runner_->bus(0).statistics().frames_out, 3U) << "the request to one, the answer to two";
}

TEST_F(BusThreadTest, ABusWithoutPortsIsRefused) {
  configuration_.buses[0].ports.clear();
  EXPECT_THROW(start(), std::runtime_error);
}

}  // namespace
}  // namespace stator::rack
