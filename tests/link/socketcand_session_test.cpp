// The socketcand protocol: handshake, raw mode, broadcast manager, errors, beacon.
#include "stator/link/can/socketcand_session.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/link/can/socketcand_beacon.hpp"

namespace stator::link {
namespace {

using namespace base::literals;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

constexpr base::SimTime kTime(1'000'023'424_us);

class SocketcandSessionTest : public testing::Test {
 protected:
  std::string say(std::string_view text) {
    std::string answer;
    while (!text.empty()) {
      const auto taken = session_.take(text, now_, answer);
      if (taken.consumed == 0) {
        ADD_FAILURE() << "incomplete: " << text;
        break;
      }
      text.remove_prefix(taken.consumed);
      if (taken.frame) {
        frames_.push_back(*taken.frame);
      }
    }
    return answer;
  }
  std::string hear(const can::Frame& frame, base::SimTime time = kTime) {
    std::string text;
    session_.put(frame, time, text);
    return text;
  }
  std::string wait(std::chrono::milliseconds time) {
    now_ += time;
    std::string text;
    while (const auto frame = session_.advance(now_, text)) {
      frames_.push_back(*frame);
    }
    return text;
  }
  void open_raw() {
    say("< open can0 >< rawmode >");
    wait(50ms);
  }

  SocketcandSession session_;
  MachineTime now_;
  std::vector<can::Frame> frames_;
};

TEST_F(SocketcandSessionTest, HandshakeLeadsToRawMode) {
  std::string greeting;
  session_.greet(greeting);
  EXPECT_EQ(greeting, "< hi >");
  EXPECT_EQ(say("< open can0 >"), "< ok >");
  EXPECT_EQ(say("< rawmode >"), "< ok >");
}

TEST_F(SocketcandSessionTest, FramesOfARawConnectionAreWrittenBehindASeparator) {
  open_raw();
  EXPECT_EQ(hear(can::data_frame(0x12, {0xA1, 2})), "\n< frame 012 1000.023424 A102 >");
  EXPECT_EQ(hear(can::data_frame(0x12, {})), "\n< frame 012 1000.023424  >")
      << "no data leave two blanks";
  can::Frame extended = can::data_frame(0x12, {});
  extended.extended = true;
  EXPECT_EQ(hear(extended), "\n< frame 00000012 1000.023424  >");
  EXPECT_EQ(hear(can::remote_frame(0x12)), "") << "the protocol has none";
}

TEST_F(SocketcandSessionTest, FramesAreTakenHoweverTheirNumbersArePadded) {
  open_raw();
  EXPECT_EQ(say("< send 12 2 a1 2 >< send 123 0  >< send 1ABCDEF0 1 FF >< send 00000012 0 >"), "");
  ASSERT_EQ(frames_.size(), 4U);
  EXPECT_EQ(frames_[0], can::data_frame(0x12, {0xA1, 2}));
  EXPECT_EQ(frames_[1], can::data_frame(0x123, {}));
  EXPECT_EQ(frames_[2].identifier, 0x1ABCDEF0U);
  EXPECT_TRUE(frames_[2].extended);
  EXPECT_TRUE(frames_[3].extended) << "eight digits";
}

TEST_F(SocketcandSessionTest, ALengthWithoutDataIsARemoteFrame) {
  open_raw();
  say("< send 181 8 >");
  EXPECT_EQ(frames_.at(0), can::remote_frame(0x181, 8));
}

TEST_F(SocketcandSessionTest, FramesWaitUntilTheAnswerToRawmodeHasArrivedAlone) {
  say("< open can0 >< rawmode >");
  EXPECT_EQ(hear(can::data_frame(1, {})), "");
  EXPECT_EQ(wait(49ms), "");
  EXPECT_THAT(wait(1ms), StartsWith("\n< frame 001"));
  EXPECT_THAT(hear(can::data_frame(2, {})), StartsWith("\n< frame 002"));
}

TEST_F(SocketcandSessionTest, TheClientsNextMessageReleasesThemToo) {
  say("< open can0 >< rawmode >");
  EXPECT_EQ(hear(can::data_frame(1, {})), "");
  EXPECT_THAT(say("< send 2 0 >"), StartsWith("\n< frame 001"));
}

TEST_F(SocketcandSessionTest, ErrorFramesOfTheBusAreTold) {
  open_raw();
  std::string text;
  EXPECT_TRUE(session_.put_error(bus_error_frame(), kTime, text));
  EXPECT_EQ(text, "\n< error 088 1000.023424 >");
}

TEST_F(SocketcandSessionTest, WrongMessagesAreAnsweredWithAnErrorAndCounted) {
  EXPECT_THAT(say("< rawmode >"), HasSubstr("< error no bus is open"));
  open_raw();
  for (const char* message :
       {"< send 123 9 >", "< send 123 2 1 >", "< send 123 2 1 2 3 >", "< send 123 1 100 >",
        "< send 20000000 0 >", "< send xyz 0 >", "< send >", "< nonsense >", "< >", "< open a >"}) {
    EXPECT_THAT(say(message), StartsWith("< error ")) << message;
  }
  EXPECT_TRUE(frames_.empty());
  EXPECT_EQ(session_.malformed(), 11U);
}

TEST_F(SocketcandSessionTest, MessagesMayComeInPiecesAndNoiseIsPassedOver) {
  std::string answer;
  EXPECT_EQ(session_.take("< ope", now_, answer).consumed, 0U);
  EXPECT_EQ(session_.take("\r\n", now_, answer).consumed, 2U);
  EXPECT_EQ(session_.take("<" + std::string(300, 'x'), now_, answer).consumed, 301U);
  EXPECT_EQ(say("  \n< open can0 >"), "< ok >");
}

TEST_F(SocketcandSessionTest, EchoAnswersInEveryMode) {
  EXPECT_EQ(say("< echo >"), "< echo >");
  open_raw();
  EXPECT_EQ(say("< echo >"), "< echo >");
}

TEST_F(SocketcandSessionTest, StatisticsComeInTheIntervalAskedFor) {
  open_raw();
  hear(can::data_frame(1, {1, 2, 3}));
  say("< send 2 1 ff >< controlmode >< statistics 100 >");
  EXPECT_EQ(wait(99ms), "");
  EXPECT_EQ(wait(1ms), "< stat 3 1 1 1 >");
  EXPECT_EQ(wait(100ms), "< stat 3 1 1 1 >");
  say("< statistics 0 >");
  EXPECT_EQ(wait(1s), "");
}

TEST_F(SocketcandSessionTest, TheBroadcastManagerSendsCyclically) {
  say("< open can0 >< add 0 20000 80 1 5 >");
  wait(0ms);
  wait(20ms);
  say("< update 80 1 6 >");
  wait(20ms);
  say("< delete 80 >");
  wait(1s);
  EXPECT_THAT(frames_, testing::ElementsAre(can::data_frame(0x80, {5}), can::data_frame(0x80, {5}),
                                            can::data_frame(0x80, {6})));
}

TEST_F(SocketcandSessionTest, TheBroadcastManagerTellsOnlyWhatIsSubscribed) {
  say("< open can0 >< subscribe 0 500000 181 >");
  EXPECT_EQ(hear(can::data_frame(0x182, {})), "");
  EXPECT_EQ(hear(can::data_frame(0x181, {0xA, 0xB})), "\n< frame 181 1000.023424 0A 0B >");
  EXPECT_EQ(hear(can::data_frame(0x181, {}), kTime + 499_ms), "") << "too soon";
  EXPECT_NE(hear(can::data_frame(0x181, {}), kTime + 500_ms), "");
  say("< unsubscribe 181 >");
  EXPECT_EQ(hear(can::data_frame(0x181, {}), kTime + 1_s + 500_ms), "");
}

TEST_F(SocketcandSessionTest, WhatIsNotServedIsSaidSo) {
  EXPECT_THAT(say("< open can0 >< filter 0 0 181 1 ff >"), HasSubstr("not served"));
}

TEST(SocketcandBeacon, NamesServerAndBus) {
  EXPECT_EQ(socketcand_beacon("bench", "10.0.0.7", 29536),
            "<CANBeacon name=\"bench\" type=\"socketcand\" description=\"Stator\">"
            "<URL>can://10.0.0.7:29536</URL><Bus name=\"can0\"/></CANBeacon>");
}

}  // namespace
}  // namespace stator::link
