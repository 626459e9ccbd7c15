#include "rack/serial_bridge.hpp"

#include <chrono>
#include <filesystem>
#include <sstream>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "link/file_descriptor.hpp"
#include "link/udp_ethernet_link.hpp"
#include "rack/event_log.hpp"
#include "rack/rack_file.hpp"
#include "rack/runner.hpp"
#include "tmcl/telegram.hpp"

namespace stator::rack {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Bytes bytes_of(std::size_t length, unsigned seed = 0) {
  Bytes bytes(length);
  for (std::size_t i = 0; i < length; ++i) {
    bytes[i] = static_cast<std::byte>(i * 7 + seed);
  }
  return bytes;
}

class SerialBridgeTest : public testing::Test {
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

  tests::TemporaryDirectory directory_;
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> logger_ = std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
};

TEST_F(SerialBridgeTest, BytesPassBothWaysInTheirOrder) {
  auto line = link::open_serial_link("pty:" + port());
  ASSERT_TRUE(line) << line.error().text;
  SerialBridge bridge(std::move(*line), "lift", logger_);
  const link::FileDescriptor client = program();
  program_sends(client, bytes_of(1000));
  Bytes taken;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (taken.size() < 1000 && std::chrono::steady_clock::now() < deadline) {
    Bytes buffer(37);
    const std::size_t length = bridge.take(buffer);
    taken.insert(taken.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(length));
    std::this_thread::yield();
  }
  EXPECT_EQ(taken, bytes_of(1000));
  bridge.send(bytes_of(500, 3));
  EXPECT_EQ(program_reads(client, 500), bytes_of(500, 3));
}

TEST_F(SerialBridgeTest, WhatDoesNotFitIntoTheQueueIsDropped) {
  auto line = link::open_serial_link("pty:" + port());
  ASSERT_TRUE(line) << line.error().text;
  SerialBridge bridge(std::move(*line), "lift", logger_);
  const link::FileDescriptor client = program();
  for (int i = 0; i < 9; ++i) {
    program_sends(client, bytes_of(500));  // a pty takes them as the bridge's thread reads them
  }
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (bridge.bytes_dropped() < 4500 - SerialBridge::kQueuedBytes &&
         std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_EQ(bridge.bytes_dropped(), 4500 - SerialBridge::kQueuedBytes);
  Bytes buffer(5000);
  EXPECT_EQ(bridge.take(buffer), SerialBridge::kQueuedBytes);
  EXPECT_EQ(bridge.take(buffer), 0U);
}

TEST_F(SerialBridgeTest, ARunningModuleAnswersAtItsPort) {
  RackConfiguration configuration = parse_rack_file(R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "lift"
usb = "pty:)" + port() + R"("
)",
                                                    "test.toml");
  std::uint16_t free_port = 0;
  {
    const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
    ASSERT_TRUE(probe) << probe.error().text;
    free_port = (*probe)->local_port();
  }
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_port};
  EventLog log;
  Rack rack(configuration, log);
  Runner runner(rack, configuration, logger_);
  EXPECT_THAT(text_.str(), HasSubstr("lift: its USB interface is the serial port " + port()));
  runner.start();
  for (int round = 0; round < 2; ++round) {
    const link::FileDescriptor client = program();
    program_sends(client, tmcl::encode(tmcl::Request{.command = 6, .type = 140, .motor = 2}));
    const Bytes answer = program_reads(client, tmcl::kTelegramLength);
    EXPECT_EQ(answer, (Bytes{std::byte{2}, std::byte{1}, std::byte{100}, std::byte{6}, std::byte{0},
                             std::byte{0}, std::byte{0}, std::byte{8}, std::byte{117}}));
  }
  runner.stop();
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(port())));
}

TEST_F(SerialBridgeTest, MistakesOfTheUsbKeyAreExplained) {
  const auto refusal_of = [](const std::string& usb) -> std::string {
    try {
      static_cast<void>(parse_rack_file(
          "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nusb = \"" + usb + "\"\n",
          "test.toml"));
    } catch (const RackFileError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(refusal_of("/dev/ttyUSB0"), HasSubstr("write \"pty:PATH\""));
  EXPECT_THAT(refusal_of("pty:"), HasSubstr("write \"pty:PATH\""));
}

}  // namespace
}  // namespace stator::rack
