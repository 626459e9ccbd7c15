// Serial lines of a rack without any link: bytes and time come from the test.

#include "stator/rack/networks/serial_line.hpp"

#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/own_device.hpp"
#include "rack/test_serial_device.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using base::SimDuration;
using base::SimTime;
using testing::ElementsAre;
using testing::IsEmpty;
using tests::TestSerialDevice;
using Bytes = std::vector<std::byte>;
using Settings = TestSerialDevice::Settings;

constexpr std::uint8_t kGetGlobal = 10;
constexpr std::uint8_t kOwnAddress = 66;
constexpr SimTime kStart{2_ms};
/// 10 bits at 9600 bit/s, to the nearest nanosecond.
constexpr SimDuration kByteTime{1'041'667};

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

class SerialLineTest : public testing::Test {
 protected:
  void build(const std::vector<Settings>& devices, bool pacing = false) {
    RackConfiguration configuration = tests::rack_with_line("pty:field", devices);
    SerialLineConfiguration line;
    line.link = "pty:field";
    line.pacing = pacing;
    configuration.lines.push_back(line);
    build(configuration);
  }
  void build(const RackConfiguration& configuration) {
    rack_ = std::make_unique<Rack>(configuration, log_);
    rack_->connect_line(0, SerialLine::Output::bind<&SerialLineTest::hear>(*this));
  }
  [[nodiscard]] const SerialLine& line() const { return rack_->line(0); }
  [[nodiscard]] TestSerialDevice& device(std::size_t index) {
    return tests::own<TestSerialDevice>(rack_->device({0, index, NetworkKind::bus}));
  }
  void put(const Bytes& bytes, SimTime now) {
    rack_->advance(now);
    rack_->put(0, bytes, now);
  }
  [[nodiscard]] Bytes heard() { return std::exchange(heard_, {}); }

 private:
  void hear(std::span<const std::byte> bytes) {
    heard_.insert(heard_.end(), bytes.begin(), bytes.end());
  }

  EventLog log_;
  Bytes heard_;
  std::unique_ptr<Rack> rack_;

 protected:
  Rack& rack() { return *rack_; }
};

TEST_F(SerialLineTest, AModuleAnswersAtTheMomentAtWhichItsTelegramIsComplete) {
  build({Settings{}});
  put(question(1), kStart);
  EXPECT_EQ(heard(), answer(1));
  EXPECT_THAT(device(0).served, ElementsAre(kStart));
  EXPECT_EQ(line().statistics().bytes_in, 9U);
  EXPECT_EQ(line().statistics().bytes_out, 9U);
}

TEST_F(SerialLineTest, ModulesOnOneLineAnswerByAddress) {
  build({Settings{.address = 1}, Settings{.address = 2}, Settings{.address = 7}});
  EXPECT_EQ(rack().line_count(), 1U);
  EXPECT_EQ(line().members(), 3U);
  put(question(7) + question(2), kStart);
  EXPECT_EQ(heard(), answer(7) + answer(2));
  put(question(3), kStart + 1_ms);
  EXPECT_THAT(heard(), IsEmpty()) << "nobody has this address";
}

TEST_F(SerialLineTest, AReplyIsNoCommandToAnotherModule) {
  build({Settings{.address = 1}, Settings{.address = 2}});
  put(question(1), kStart);
  EXPECT_EQ(heard(), answer(1)) << "the reply begins with 2, the host's address";
  put(question(2), kStart);
  EXPECT_EQ(heard(), answer(2)) << "module 2 is in step";
}

TEST_F(SerialLineTest, NoiseIsForgottenAfterAGap) {
  build({Settings{}});
  put({std::byte{0xFF}, std::byte{0}, std::byte{1}}, kStart);
  put(question(1), kStart + 6_ms);
  EXPECT_EQ(heard(), answer(1));
}

TEST_F(SerialLineTest, ATelegramMayComeInParts) {
  build({Settings{}});
  const Bytes whole = question(1);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_THAT(heard(), IsEmpty());
    put({whole[i]}, kStart + 4_ms * static_cast<std::int64_t>(i));
  }
  EXPECT_EQ(heard(), answer(1));
}

TEST_F(SerialLineTest, AWrongChecksumIsAnsweredByTheModuleWhoseAddressItCarries) {
  build({Settings{.address = 1}, Settings{.address = 2}});
  Bytes wrong = question(1);
  wrong.back() ^= std::byte{1};
  put(wrong, kStart);
  const Bytes reply = heard();
  ASSERT_EQ(reply.size(), 9U);
  EXPECT_EQ(reply[1], std::byte{1}) << "module";
  EXPECT_EQ(reply[2], std::byte{1}) << "status: wrong checksum";
}

TEST_F(SerialLineTest, AReplyThatIsHeldBackIsSentWhenItsTimeHasCome) {
  build({Settings{.pause = 15}});
  put(question(1), kStart);
  EXPECT_EQ(rack().next_line_deadline(0), kStart + 15_ms);
  rack().advance(kStart + 15_ms - SimDuration(1));
  EXPECT_THAT(heard(), IsEmpty());
  rack().advance(kStart + 15_ms);
  EXPECT_EQ(heard(), answer(1));
}

TEST_F(SerialLineTest, PacedBytesComeAndGoWithTheEndOfTheirStopBit) {
  build({Settings{.baud_rate = 9600}}, true);
  EXPECT_EQ(line().speed(), 9600U);
  put(question(1), kStart);
  const SimTime complete = kStart + kByteTime * 9;
  Bytes so_far;
  for (std::int64_t i = 1; i <= 9; ++i) {
    rack().advance(complete + kByteTime * i - SimDuration(1));
    so_far = so_far + heard();
    EXPECT_EQ(so_far.size(), static_cast<std::size_t>(i - 1));
    rack().advance(complete + kByteTime * i);
    so_far = so_far + heard();
    EXPECT_EQ(so_far.size(), static_cast<std::size_t>(i));
  }
  EXPECT_EQ(so_far, answer(1));
  std::vector<SimTime> arrivals;
  for (std::int64_t i = 1; i <= 9; ++i) {
    arrivals.push_back(kStart + kByteTime * i);
  }
  EXPECT_EQ(device(0).served, arrivals);
}

TEST_F(SerialLineTest, PacingDoesNotDependOnTheStepsInWhichTimePasses) {
  const auto served = [this](SimDuration step) {
    build({Settings{.baud_rate = 115'200, .pause = 3}}, true);
    put(question(1) + question(1), kStart);
    for (SimTime now = kStart; now < kStart + 20_ms; now += step) {
      rack().advance(now);
    }
    rack().advance(kStart + 20_ms);
    EXPECT_EQ(heard(), answer(1) + answer(1)) << step.nanoseconds();
    return device(0).served;
  };
  const std::vector<SimTime> once = served(20_ms);
  EXPECT_EQ(served(SimDuration(7'001)), once);
  EXPECT_EQ(served(1_ms), once);
}

TEST_F(SerialLineTest, APacedReplyBeginsAfterTheTelegramPause) {
  build({Settings{.baud_rate = 9600, .pause = 15}}, true);
  put(question(1), kStart);
  const SimTime end = kStart + kByteTime * 18 + 15_ms;
  rack().advance(end - SimDuration(1));
  EXPECT_EQ(heard().size(), 8U);
  rack().advance(end);
  EXPECT_EQ(heard().size(), 1U);
}

TEST_F(SerialLineTest, BothDirectionsOfAPacedLinePassAtOnce) {
  build({Settings{.baud_rate = 9600}}, true);
  put(question(1) + question(1), kStart);
  rack().advance(kStart + kByteTime * 27);
  EXPECT_EQ(heard(), answer(1) + answer(1)) << "the first reply while the second request comes";
}

TEST_F(SerialLineTest, AnInterfaceWithoutBaudRateIsNotPaced) {
  build({Settings{}}, true);
  EXPECT_EQ(line().speed(), std::nullopt);
  put(question(1), kStart);
  EXPECT_EQ(heard(), answer(1));
}

TEST_F(SerialLineTest, ADeviceAtAnotherBaudRateNeitherHearsNorIsHeard) {
  build({Settings{.address = 1, .baud_rate = 9600}, Settings{.address = 2, .baud_rate = 19'200}},
        true);
  put(question(2), kStart);
  rack().advance(kStart + 100_ms);
  EXPECT_THAT(heard(), IsEmpty());
  EXPECT_EQ(line().statistics().bytes_lost, 9U);
  put(question(1), kStart + 100_ms);
  rack().advance(kStart + 200_ms);
  EXPECT_EQ(heard(), answer(1));
}

TEST_F(SerialLineTest, WhatFindsNoRoomIsLostAndCounted) {
  build({Settings{.at_once = false}});
  put(Bytes(5000), kStart);
  EXPECT_TRUE(line().waits());
  EXPECT_EQ(line().statistics().bytes_lost, 5000 - SerialLine::kQueuedBytes);
  rack().advance(kStart + 1_ms);
  EXPECT_FALSE(line().waits());
}

TEST_F(SerialLineTest, APacedLineSaysHowMuchItTakes) {
  build({Settings{.baud_rate = 9600}}, true);
  EXPECT_EQ(line().room(), SerialLine::kQueuedBytes);
  put(Bytes(4000), kStart);
  EXPECT_EQ(line().room(), SerialLine::kQueuedBytes - 4000);
  put(Bytes(1000), kStart);
  EXPECT_EQ(line().room(), 0U);
  EXPECT_EQ(line().statistics().bytes_lost, 5000 - SerialLine::kQueuedBytes);
}

TEST_F(SerialLineTest, ADeviceThatLooksInItsPeriodAnswersThen) {
  build({Settings{.at_once = false}});
  put(question(1), kStart + SimDuration(1));
  EXPECT_THAT(heard(), IsEmpty());
  rack().advance(kStart + 1_ms);
  EXPECT_EQ(heard(), answer(1));
}

TEST_F(SerialLineTest, WithoutSupplyNothingIsHeard) {
  build({Settings{}});
  const DeviceAddress address{0, 0, NetworkKind::bus};
  rack().apply(PowerEvent{address, false}, kStart);
  put(question(1), kStart);
  EXPECT_THAT(heard(), IsEmpty());
  rack().apply(PowerEvent{address, true}, kStart + 1_ms);
  put(question(1), kStart + 2_ms);
  EXPECT_EQ(heard(), answer(1)) << "once: what came without supply is gone";
}

TEST_F(SerialLineTest, TheInterfacesOfOneDeviceMayBeOnDifferentLines) {
  RackConfiguration configuration = tests::rack_with_line("pty:field", {Settings{.pause = 15}});
  configuration.buses[0].devices[0].serial.push_back({"usb", "pty:desk"});
  build(configuration);
  ASSERT_EQ(rack().line_count(), 2U);
  put(question(1), kStart);
  rack().put(1, question(1), kStart);
  EXPECT_EQ(rack().line(1).statistics().bytes_out, 9U) << "no pause on USB";
  EXPECT_EQ(rack().line(0).statistics().bytes_out, 0U);
  rack().advance(kStart + 15_ms);
  EXPECT_EQ(rack().line(0).statistics().bytes_out, 9U);
}

TEST_F(SerialLineTest, AnInterfaceThatADeviceHasNotIsRefused) {
  RackConfiguration configuration = tests::rack_with_line("pty:field", {Settings{}});
  configuration.buses[0].devices[0].serial[0].interface = "rs232";
  EXPECT_THROW(build(configuration), std::runtime_error);
}

TEST_F(SerialLineTest, ABusWithoutWireHasNoSignals) {
  build({Settings{}});
  EXPECT_THAT(rack().signals(), IsEmpty());
}

}  // namespace
}  // namespace stator::rack
