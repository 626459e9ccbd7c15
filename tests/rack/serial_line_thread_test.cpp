// Serial lines of TMCL modules over pseudo-terminal and TCP, in real time and in lockstep.
#include "stator/rack/run/serial_line_thread.hpp"

#include <filesystem>
#include <sstream>
#include <vector>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "base/wait_for.hpp"
#include "rack/test_serial_device.hpp"
#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::rack {
namespace {

using Bytes = std::vector<std::byte>;
using Settings = tests::TestSerialDevice::Settings;

constexpr std::uint8_t kGetGlobal = 10;
constexpr std::uint8_t kOwnAddress = 66;

Bytes question(std::uint8_t address) {
  const tmcl::Telegram telegram =
      tmcl::encode(tmcl::Request{.address = address, .command = kGetGlobal, .type = kOwnAddress});
  return {telegram.begin(), telegram.end()};
}

Bytes answer(std::uint8_t address) {
  const tmcl::Telegram telegram =
      tmcl::encode(tmcl::Reply{.module_address = address, .command = kGetGlobal, .value = address});
  return {telegram.begin(), telegram.end()};
}

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

class SerialLineThreadTest : public testing::Test {
 protected:
  [[nodiscard]] std::string port() const { return directory_.path() + "/usb"; }
  [[nodiscard]] link::FileDescriptor program() const {
    link::FileDescriptor descriptor(::open(port().c_str(), O_RDWR | O_NOCTTY));
    EXPECT_TRUE(descriptor.is_open());
    return descriptor;
  }
  static void program_sends(const link::FileDescriptor& program, std::span<const std::byte> bytes) {
    EXPECT_EQ(::write(program.get(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
  }
  static Bytes program_reads(const link::FileDescriptor& program, std::size_t length) {
    Bytes bytes;
    while (bytes.size() < length) {
      pollfd waiting{.fd = program.get(), .events = POLLIN, .revents = 0};
      std::array<std::byte, 64> buffer{};
      const ssize_t got =
          ::poll(&waiting, 1, 10'000) > 0 ? ::read(program.get(), buffer.data(), buffer.size()) : 0;
      if (got <= 0) {
        ADD_FAILURE() << "only " << bytes.size() << " bytes came";
        break;
      }
      bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + got);
    }
    return bytes;
  }

  void start(const std::vector<Settings>& devices) {
    configuration_.buses = tests::rack_with_line(line_, devices).buses;
    runner_.reset();
    rack_ = std::make_unique<Rack>(configuration_, log_);
    runner_ = std::make_unique<Runner>(*rack_, configuration_, logger_);
    runner_->start();
  }
  [[nodiscard]] tests::TestSerialDevice& device(std::size_t index) {
    return dynamic_cast<tests::TestSerialDevice&>(*rack_->bus(0).devices()[index].device);
  }

  tests::TemporaryDirectory directory_;
  std::string line_ = "pty:" + port();
  RackConfiguration configuration_;
  EventLog log_;
  std::ostringstream text_;
  std::shared_ptr<Log> logger_ = tests::log_to(text_);
  std::unique_ptr<Rack> rack_;
  std::unique_ptr<Runner> runner_;
};

TEST_F(SerialLineThreadTest, ARunningModuleAnswersAtItsPort) {
  RackConfiguration configuration = parse_rack_file(R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "lift"
usb = "pty:)" + port() + R"("
)",
                                                    "test.toml", devices::products());
  std::uint16_t free_port = 0;
  {
    const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
    ASSERT_TRUE(probe) << probe.error().text;
    free_port = (*probe)->local_port();
  }
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_port};
  rack_ = std::make_unique<Rack>(configuration, log_);
  runner_ = std::make_unique<Runner>(*rack_, configuration, logger_);
  EXPECT_EQ(runner_->line(0).link().name(), port());
  runner_->start();
  for (int round = 0; round < 2; ++round) {
    const link::FileDescriptor client = program();
    program_sends(client, tmcl::encode(tmcl::Request{.command = 6, .type = 140, .motor = 2}));
    const Bytes answer = program_reads(client, tmcl::kTelegramLength);
    EXPECT_EQ(answer, (Bytes{std::byte{2}, std::byte{1}, std::byte{100}, std::byte{6}, std::byte{0},
                             std::byte{0}, std::byte{0}, std::byte{8}, std::byte{117}}));
  }
  runner_.reset();
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(port())));
}

TEST_F(SerialLineThreadTest, ModulesOnALineAreReachedByAddressAndAnswerAtOnce) {
  start({Settings{.address = 1}, Settings{.address = 2}});
  const link::FileDescriptor client = program();
  for (const std::uint8_t address : std::initializer_list<std::uint8_t>{1, 2, 2, 1}) {
    program_sends(client, question(address));
    EXPECT_EQ(program_reads(client, tmcl::kTelegramLength), answer(address));
  }
  runner_->stop();
  const SerialLineThreadStatistics statistics = runner_->line(0).statistics();
  EXPECT_EQ(statistics.line.bytes_in, 36U);
  EXPECT_EQ(statistics.link.bytes_sent, 36U);
  EXPECT_EQ(statistics.line.bytes_lost, 0U);
}

TEST_F(SerialLineThreadTest, AProgramMayCloseThePortAndOpenItAgain) {
  start({Settings{}});
  for (int i = 0; i < 3; ++i) {
    const link::FileDescriptor client = program();
    program_sends(client, question(1));
    EXPECT_EQ(program_reads(client, tmcl::kTelegramLength), answer(1));
  }
}

TEST_F(SerialLineThreadTest, AReplyThatIsHeldBackComesWithoutFurtherTraffic) {
  for (const ClockKind clock : {ClockKind::real, ClockKind::lockstep}) {
    configuration_.clock = clock;
    start({Settings{.pause = 15}});
    const link::FileDescriptor client = program();
    program_sends(client, question(1));
    EXPECT_EQ(program_reads(client, tmcl::kTelegramLength), answer(1));
    EXPECT_GE(runner_->now(), base::SimTime(base::SimDuration(15'000'000)));
    runner_.reset();
  }
}

TEST_F(SerialLineThreadTest, ADeviceThatLooksInItsPeriodAnswersWithoutABusOrASegment) {
  start({Settings{.at_once = false}});
  const link::FileDescriptor client = program();
  program_sends(client, question(1));
  EXPECT_EQ(program_reads(client, tmcl::kTelegramLength), answer(1));
}

TEST_F(SerialLineThreadTest, ALineIsServedOverTcpToo) {
  line_ = "tcp:0";
  start({Settings{}});
  const std::string& name = runner_->line(0).link().name();
  EXPECT_THAT(name, testing::StartsWith("127.0.0.1:"));
  for (int i = 0; i < 2; ++i) {
    const link::FileDescriptor client(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoul(name.substr(10))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
    program_sends(client, question(1));
    EXPECT_EQ(program_reads(client, tmcl::kTelegramLength), answer(1));
  }
}

TEST_F(SerialLineThreadTest, InLockstepEachTelegramMovesTimeByOneStepHoweverItComes) {
  configuration_.clock = ClockKind::lockstep;
  for (const std::size_t piece : {1U, 4U, 9U, 14U, 27U}) {
    start({Settings{}});
    const link::FileDescriptor client = program();
    const Bytes all = question(1) + question(2) + question(1);
    for (std::size_t i = 0; i < all.size(); i += piece) {
      program_sends(client, std::span(all).subspan(i, std::min(piece, all.size() - i)));
    }
    EXPECT_EQ(program_reads(client, 18), answer(1) + answer(1));
    runner_->stop();
    EXPECT_EQ(runner_->now(), base::SimTime(base::SimDuration(150'000))) << piece;
    EXPECT_EQ(device(0).served.back(), base::SimTime(base::SimDuration(100'000))) << piece;
    runner_.reset();
  }
}

TEST_F(SerialLineThreadTest, InLockstepAPacedLineMovesTimeUntilTheReplyHasPassed) {
  configuration_.clock = ClockKind::lockstep;
  SerialLineConfiguration line;
  line.link = line_;
  line.pacing = true;
  configuration_.lines = {line};
  start({Settings{.baud_rate = 115'200}});
  const link::FileDescriptor client = program();
  program_sends(client, question(1));
  EXPECT_EQ(program_reads(client, tmcl::kTelegramLength), answer(1));
  runner_->stop();
  constexpr base::SimDuration kByteTime{86'806};
  EXPECT_EQ(device(0).served.back(), base::SimTime(kByteTime * 9));
  EXPECT_EQ(runner_->now(), base::SimTime(kByteTime * 18));
}

TEST_F(SerialLineThreadTest, InLockstepADeviceThatLooksInItsPeriodMovesNoTime) {
  configuration_.clock = ClockKind::lockstep;
  start({Settings{.at_once = false}});
  const link::FileDescriptor client = program();
  program_sends(client, question(1));
  EXPECT_TRUE(tests::wait_for(
      [this] { return runner_->line(0).statistics().line.bytes_in >= tmcl::kTelegramLength; }));
  EXPECT_EQ(runner_->now(), base::SimTime());
}

TEST_F(SerialLineThreadTest, LostBytesAreToldOnce) {
  configuration_.clock = ClockKind::lockstep;
  start({Settings{.at_once = false}});
  const link::FileDescriptor client = program();
  for (int i = 0; i < 10; ++i) {
    program_sends(client, Bytes(500));  // a pty takes them as the line's thread reads them
  }
  EXPECT_TRUE(
      tests::wait_for([this] { return runner_->line(0).statistics().line.bytes_in >= 5000; }));
  runner_->stop();
  EXPECT_EQ(runner_->line(0).statistics().line.bytes_lost, 5000 - SerialLine::kQueuedBytes);
  const std::string told = text_.str();
  const std::size_t first = told.find("bytes were lost");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(told.find("bytes were lost", first + 1), std::string::npos);
}

}  // namespace
}  // namespace stator::rack
