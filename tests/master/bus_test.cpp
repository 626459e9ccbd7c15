// The master's frames: several datagrams in one, retries, and answers that are lost, late, doubled
// or foreign.
#include "stator/master/bus.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/scripted_port.hpp"

namespace stator::master {
namespace {

using ethercat::Command;
using test::ScriptedPort;
using Frame = ScriptedPort::Frame;
using Frames = std::vector<Frame>;

constexpr Station kStation{.position = 4, .address = 0x1005};

/// What one slave sends back: the data filled with `value`, working counter as given.
Frame answered(Frame frame, std::uint8_t value, std::uint16_t working_counter = 1) {
  ethercat::DatagramCursor cursor(frame);
  while (auto datagram = cursor.next()) {
    std::ranges::fill(datagram->bytes(), std::byte{value});
    datagram->working_counter = working_counter;
    datagram->store();
  }
  return frame;
}

struct Bench {
  explicit Bench(ScriptedPort::Answer answer) : port(std::move(answer)), bus(port, options) {}

  Result<std::uint8_t> read() { return bus.read_number<std::uint8_t>(kStation, 0x0130); }

  MasterOptions options;
  ScriptedPort port;
  Bus bus;
};

TEST(Bus, AFrameCarriesSeveralDatagramsAndBringsBackTheirDataAndCounters) {
  Bench bench([](const Frame& frame) { return Frames{answered(frame, 0x5A, 2)}; });
  std::array<std::byte, 3> first{std::byte{1}};
  std::array<std::byte, 2> second{std::byte{2}};
  std::array<Datagram, 2> datagrams{
      {{.command = Command::brd, .address = 0, .data = first},
       {.command = Command::lrw, .address = 0x10000, .data = second}}};
  ASSERT_TRUE(bench.bus.exchange(datagrams, 0));
  EXPECT_EQ(first[2], std::byte{0x5A});
  EXPECT_EQ(second[1], std::byte{0x5A});
  EXPECT_EQ(datagrams[0].working_counter, 2);
  EXPECT_EQ(datagrams[1].working_counter, 2);
  EXPECT_EQ(bench.port.sent.size(), 1U);
  EXPECT_EQ(bench.port.sent[0].size(), 60U) << "padded to the shortest Ethernet frame";
}

TEST(Bus, ALostFrameIsSentAgainAndTheLastAttemptsAnswerCounts) {
  int frames = 0;
  Bench bench(
      [&](const Frame& frame) { return ++frames < 3 ? Frames() : Frames{answered(frame, 7)}; });
  const auto value = bench.read();
  ASSERT_TRUE(value);
  EXPECT_EQ(*value, 7);
  EXPECT_EQ(frames, 3);
}

TEST(Bus, SilenceEndsAfterTheRetriesWithATimeout) {
  Bench bench([](const Frame&) { return Frames(); });
  bench.options.patience = base::SimDuration();
  const auto value = bench.read();
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::timeout);
  EXPECT_EQ(bench.port.sent.size(), 4U);
  EXPECT_EQ(bench.port.now().since_power_on(), bench.options.frame_timeout * 4);
}

TEST(Bus, SilenceIsStoodForAsLongAsAWatchdogOfADriveStandsIt) {
  int silent = 9;
  Bench bench(
      [&](const Frame& frame) { return silent-- > 0 ? Frames() : Frames{answered(frame, 7)}; });
  const auto value = bench.read();
  ASSERT_TRUE(value) << value.error().text;
  EXPECT_EQ(*value, 7);
  EXPECT_EQ(bench.port.now().since_power_on(), bench.options.frame_timeout * 9);
  silent = 1000;
  const auto never = bench.read();
  ASSERT_FALSE(never);
  EXPECT_EQ(never.error().code, ErrorCode::timeout);
  EXPECT_EQ(bench.port.sent.size(), 20U);
  EXPECT_THAT(never.error().text, testing::HasSubstr("no frame came back for 100 ms, sent 10"));
  EXPECT_THAT(never.error().text, testing::HasSubstr("the link is down"));
}

TEST(Bus, AnswersThatComeTooLateAreCountedAndSayWhoseFaultItIs) {
  Frame late;
  Bench bench([&](const Frame& frame) {
    Frames back;
    if (!late.empty()) {
      back.push_back(late);
      back.push_back(late);  // a duplicate of it is no second answer
    }
    late = answered(frame, 1);
    return back;
  });
  const auto value = bench.read();
  ASSERT_FALSE(value);
  EXPECT_EQ(bench.bus.late_answers(), 9U);
  EXPECT_THAT(value.error().text, testing::HasSubstr("but 9 came too late"));
  EXPECT_THAT(value.error().text, testing::HasSubstr("too busy"));
}

TEST(Bus, AnAnswerToAnEarlierFrameIsNotTakenForTheOneAwaited) {
  Frame late;
  Bench bench([&](const Frame& frame) {
    if (late.empty()) {
      late = answered(frame, 1);
      return Frames();
    }
    return Frames{late, answered(frame, 2)};
  });
  const auto value = bench.read();
  ASSERT_TRUE(value);
  EXPECT_EQ(*value, 2);
}

TEST(Bus, ADoubledAnswerDoesNotDisturbTheNextExchange) {
  std::uint8_t count = 0;
  Bench bench([&](const Frame& frame) {
    ++count;
    return Frames{answered(frame, count), answered(frame, count)};
  });
  EXPECT_EQ(*bench.read(), 1);
  EXPECT_EQ(*bench.read(), 2);
  EXPECT_EQ(*bench.read(), 3);
  EXPECT_EQ(count, 3);
}

TEST(Bus, DamagedAndForeignFramesAreNoAnswers) {
  const std::vector<std::function<void(Frame&)>> kDamages{
      [](Frame& frame) { frame.resize(10); },
      [](Frame& frame) { frame.resize(20); },
      [](Frame& frame) { frame[12] = std::byte{0x08}; },   // EtherType IPv4
      [](Frame& frame) { frame[15] = std::byte{0x50}; },   // EtherCAT header type 5
      [](Frame& frame) { frame[16] = std::byte{7}; },      // other command
      [](Frame& frame) { frame[17] ^= std::byte{0x80}; },  // other index
      [](Frame& frame) { frame[22] = std::byte{200}; },    // length past the end
      [](Frame& frame) { frame[22] = std::byte{2}; }};     // other length
  for (std::size_t i = 0; i < kDamages.size(); ++i) {
    Bench bench([&](const Frame& frame) {
      Frame damaged = answered(frame, 1);
      kDamages[i](damaged);
      return Frames{damaged};
    });
    const auto value = bench.read();
    ASSERT_FALSE(value) << "damage " << i;
    EXPECT_EQ(value.error().code, ErrorCode::timeout) << "damage " << i;
  }
}

TEST(Bus, AnEndlessFloodOfForeignFramesDoesNotHoldTheMaster) {
  Bench bench([](const Frame&) { return Frames(1000, Frame(64)); });
  const auto value = bench.read();
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::timeout);
}

TEST(Bus, NobodyAnsweringARegisterAccessNamesSlaveAndRegister) {
  Bench bench([](const Frame& frame) { return Frames{answered(frame, 0, 0)}; });
  const auto value = bench.read();
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::working_counter);
  EXPECT_THAT(
      value.error().text,
      testing::AllOf(testing::HasSubstr("0130h"), testing::HasSubstr("slave 4 (station 1005h)"),
                     testing::HasSubstr("working counter 0 instead of 1")));
}

TEST(Bus, DatagramsThatDoNotFitOneFrameAreRefusedBeforeSending) {
  Bench bench([](const Frame&) { return Frames(); });
  std::vector<std::byte> data(ethercat::kMaximumDatagramData + 1);
  const auto counter = bench.bus.execute(Command::lrw, 0, data);
  ASSERT_FALSE(counter);
  EXPECT_EQ(counter.error().code, ErrorCode::argument);
  EXPECT_TRUE(bench.port.sent.empty());
}

}  // namespace
}  // namespace stator::master
