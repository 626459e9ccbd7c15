// The protocol of the socket for firmware, message by message, on a TMC8461 without sockets.

#include "stator/rack/run/chip_session.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"

namespace stator::rack {
namespace {

using base::SimDuration;
using base::SimTime;
using link::chip_protocol::Refusal;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

using Bytes = std::vector<std::byte>;

class Session : public ::testing::Test {
 protected:
  struct Message {
    std::uint8_t kind;
    std::uint8_t tag;
    Bytes body;
  };

  Session()
      : session(chip, "chip",
                {.reply = [this](const link::ChipMessage& m) { replies.push_back(copy(m)); },
                 .event =
                     [this](const link::ChipMessage& m) {
                       if (reads) {
                         events.push_back(copy(m));
                       }
                       return reads;
                     },
                 .refuse =
                     [this](std::uint8_t number, Refusal refusal, std::string_view text) {
                       refusals.push_back(refusal);
                       refused_tag = number;
                       sentence = text;
                     },
                 .greeted = [this] { ++greetings; },
                 .power = [this](bool on) { chip.set_power(on, now); }}) {
    session.begin();
  }

  static Message copy(const link::ChipMessage& message) {
    return {message.kind, message.tag, Bytes(message.body.begin(), message.body.end())};
  }
  void send(std::uint8_t kind, std::initializer_list<unsigned> values) {
    Bytes body;
    for (const unsigned value : values) {
      body.push_back(static_cast<std::byte>(value));
    }
    session.take({.kind = kind, .tag = ++tag, .body = body}, now);
  }
  void greet() { send(1, {'S', 'T', 'C', 'H', 1}); }
  std::vector<unsigned> answer() {
    std::vector<unsigned> result;
    for (std::size_t i = 12; i < replies.back().body.size(); ++i) {
      result.push_back(std::to_integer<unsigned>(replies.back().body[i]));
    }
    return result;
  }

  devices::Tmc8461 chip{devices::Tmc8461Configuration{}};
  SimTime now;
  std::vector<Message> replies;
  std::vector<Message> events;
  std::vector<Refusal> refusals;
  std::string sentence;
  std::uint8_t refused_tag = 0;
  std::uint8_t tag = 0;
  int greetings = 0;
  bool reads = true;
  ChipSession session;
};

TEST_F(Session, GreetingIsAnsweredWithWhatTheChipHas) {
  now = SimTime() + SimDuration(0x1234);
  greet();
  ASSERT_THAT(replies, SizeIs(1));
  EXPECT_EQ(replies[0].kind, 0x81U);
  EXPECT_EQ(replies[0].tag, 1U);
  EXPECT_EQ(base::load_le<std::uint16_t>(replies[0].body.data()), chip.levels());
  EXPECT_EQ(base::load_le<std::uint64_t>(replies[0].body.data() + 4), 0x1234U);
  EXPECT_THAT(answer(), ElementsAre(1, 3, 0x00, 0x10, 0xFF, 0x7F, 'c', 'h', 'i', 'p'));
  EXPECT_EQ(greetings, 1);
}

TEST_F(Session, NothingPassesBeforeTheGreeting) {
  send(3, {});
  EXPECT_THAT(refusals, ElementsAre(Refusal::no_hello));
  send(1, {'S', 'T', 'C'});
  send(1, {'H', 'T', 'T', 'P', 1});
  EXPECT_THAT(refusals, ElementsAre(Refusal::no_hello, Refusal::no_hello, Refusal::no_hello));
  send(1, {'S', 'T', 'C', 'H', 2});
  EXPECT_EQ(refusals.back(), Refusal::version);
  EXPECT_EQ(greetings, 0);
  EXPECT_THAT(replies, IsEmpty());
}

TEST_F(Session, TransferIsADatagramWithChipSelectAroundIt) {
  greet();
  send(2, {0, 0, 0, 0, 0x00, 0x02, 0x00, 0xFF});
  EXPECT_EQ(replies.back().kind, 0x82U);
  EXPECT_THAT(answer(), ElementsAre(0, 0, 0xD0, 0x61));
  send(2, {1, 0, 0, 0, 0x00, 0x04, 0x21, 0x01});
  send(2, {1, 0, 0, 0, 0x00, 0x02, 0x00, 0xFF});
  EXPECT_THAT(answer(), ElementsAre(0, 0, 0x21, 0x01));
}

TEST_F(Session, TransferMayComeInPieces) {
  greet();
  send(2, {0, 1, 0, 0, 0x00});
  send(2, {0, 1, 0, 0, 0x02, 0x00});
  EXPECT_THAT(answer(), ElementsAre(0, 0xD0));
  send(2, {0, 0, 0, 0, 0xFF});
  EXPECT_THAT(answer(), ElementsAre(0x61));
}

TEST_F(Session, PauseAndSurplusClocksReachThePort) {
  greet();
  send(2, {0, 2, 100, 0, 0x00, 0x02, 0xFF});  // 100 ns
  send(2, {0, 0, 0, 0, 0x18, 0x6B, 0xFF, 0, 0xFF});
  EXPECT_THAT(answer(), ElementsAre(0, 0, 0, 1, 0x48)) << "busy violation of a read";
  send(2, {0, 0x30, 0, 0, 0x80, 0x04, 0x55});
  send(2, {0, 0, 0, 0, 0x18, 0x6B, 0xFF, 0, 0xFF});
  EXPECT_THAT(answer(), ElementsAre(0, 0, 0, 2, 0x83)) << "three clocks too many in a write";
}

TEST_F(Session, WatchedLinesTellOfTheirChanges) {
  greet();
  send(4, {0x08, 0x00});  // RESET_OUT
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    send(2, {0, 0, 0, 0, 0x02, 0x0C, key});  // 0041h
  }
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(events[0].kind, 0xC0U);
  EXPECT_EQ(events[0].tag, 0U);
  ASSERT_THAT(events[0].body, SizeIs(16));
  EXPECT_EQ(base::load_le<std::uint16_t>(events[0].body.data() + 2), 0x0008U);
  EXPECT_EQ(base::load_le<std::uint16_t>(events[0].body.data() + 4), 0x0008U);
  send(4, {0, 0});
  EXPECT_EQ(chip.next_line_change(), SimTime::never());
}

TEST_F(Session, LostEventsAreCountedInTheNextOne) {
  greet();
  send(4, {0x00, 0x40});  // power
  reads = false;
  send(6, {0});
  send(6, {1});
  reads = true;
  send(6, {0});
  ASSERT_THAT(events, SizeIs(1));
  EXPECT_EQ(base::load_le<std::uint16_t>(events[0].body.data() + 6), 2U);
}

TEST_F(Session, PinsResetAndLatch) {
  greet();
  send(5, {3, 0});
  EXPECT_EQ(chip.levels(), product::host_line(product::HostLine::power));
  send(5, {3, 1});
  EXPECT_NE(chip.levels() & product::host_line(product::HostLine::eeprom_loaded), 0U);
}

TEST_F(Session, WhatDoesNotFitIsRefusedAndTheConnectionGoesOn) {
  greet();
  send(2, {0, 0, 0});
  send(4, {1});
  send(5, {1});
  send(6, {});
  EXPECT_THAT(refusals, ElementsAre(Refusal::malformed, Refusal::malformed, Refusal::malformed,
                                    Refusal::malformed));
  refusals.clear();
  send(2, {2, 0, 0, 0, 0});
  send(5, {4, 0});
  EXPECT_THAT(refusals, ElementsAre(Refusal::unknown_target, Refusal::unknown_target));
  send(9, {});
  EXPECT_EQ(refusals.back(), Refusal::unknown_request);
  EXPECT_EQ(refused_tag, tag);
  send(3, {});
  EXPECT_EQ(replies.back().kind, 0x83U);
}

TEST_F(Session, LeavingEndsChipSelectAndWatching) {
  greet();
  send(4, {0xFF, 0x7F});
  send(2, {0, 1, 0, 0, 0x80, 0x04});
  session.leave();
  EXPECT_EQ(chip.next_line_change(), SimTime::never());
  Bytes in(1);
  chip.transfer(product::HostSpi::pdi, Bytes{std::byte{0x55}}, in, {});
  std::array<std::byte, 1> value{};
  chip.controller().peek(0x1000, value);
  EXPECT_EQ(value[0], std::byte{0}) << "nobody is selected";
}

}  // namespace
}  // namespace stator::rack
