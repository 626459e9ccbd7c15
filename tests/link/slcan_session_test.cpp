// The LAWICEL protocol (slcan): commands, answers, status flags, time stamps, acceptance filters.
#include "stator/link/can/slcan_session.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::link {
namespace {

using namespace base::literals;

class SlcanSessionTest : public testing::Test {
 protected:
  /// What is answered to `text`; frames go to frames_.
  std::string say(std::string_view text) { return say(session_, text); }
  std::string say(SlcanSession& session, std::string_view text) {
    std::string answer;
    while (!text.empty()) {
      const auto taken = session.take(text, MachineTime(), answer);
      if (taken.consumed == 0) {
        ADD_FAILURE() << "incomplete: " << text;
        break;
      }
      text.remove_prefix(taken.consumed);
      restarts_ += taken.restart ? 1 : 0;
      if (taken.frame) {
        frames_.push_back(*taken.frame);
      }
    }
    return answer;
  }
  std::string hear(const can::Frame& frame, base::SimTime time = {}) {
    std::string text;
    session_.put(frame, time, text);
    return text;
  }

  std::vector<unsigned> bit_rates_;
  std::vector<can::Frame> frames_;
  int restarts_ = 0;
  SlcanSession session_{false, [this](unsigned bit_rate) { bit_rates_.push_back(bit_rate); }};
};

can::Frame extended(can::Frame frame) {
  frame.extended = true;
  return frame;
}

TEST_F(SlcanSessionTest, FramesOfAllKindsAreTakenWithoutAnAnswer) {
  EXPECT_EQ(say("O\r"), "\r");
  EXPECT_EQ(say("t1232A1b2\rT1ABCDEF01ff\rr7010\rR000000018\r"), "");
  ASSERT_EQ(frames_.size(), 4U);
  EXPECT_EQ(frames_[0], can::data_frame(0x123, {0xA1, 0xB2}));
  EXPECT_EQ(frames_[1], extended(can::data_frame(0x1ABCDEF0, {0xFF})));
  EXPECT_EQ(frames_[2], can::remote_frame(0x701));
  EXPECT_EQ(frames_[3], extended(can::remote_frame(1, 8)));
}

TEST_F(SlcanSessionTest, FramesOfAllKindsAreWritten) {
  say("O\r");
  EXPECT_EQ(hear(can::data_frame(0x7F, {0xA1, 0xB2})), "t07F2A1B2\r");
  EXPECT_EQ(hear(extended(can::data_frame(0x1ABCDEF0, {}))), "T1ABCDEF00\r");
  EXPECT_EQ(hear(can::remote_frame(0x701, 1)), "r7011\r");
  EXPECT_EQ(hear(extended(can::remote_frame(1))), "R000000010\r");
}

TEST_F(SlcanSessionTest, AClosedChannelCarriesNothing) {
  EXPECT_EQ(hear(can::data_frame(1, {})), "");
  EXPECT_EQ(say("t0010\r"), "\a");
  say("O\rC\r");
  EXPECT_EQ(hear(can::data_frame(1, {})), "");
  EXPECT_TRUE(frames_.empty());
}

TEST_F(SlcanSessionTest, ListenOnlyHearsButDoesNotSend) {
  EXPECT_EQ(say("L\r"), "\r");
  EXPECT_EQ(hear(can::data_frame(1, {})), "t0010\r");
  EXPECT_EQ(say("t0010\r"), "\a");
}

TEST_F(SlcanSessionTest, VersionAndSerialNumberHaveSixBytes) {
  EXPECT_EQ(say("V\r"), "V1013\r");
  EXPECT_EQ(say("N\r").size(), 6U);
}

TEST_F(SlcanSessionTest, BitRateIsTold) {
  EXPECT_EQ(say("S6\rS9\rS0\r"), "\r\r\r");
  EXPECT_THAT(bit_rates_, testing::ElementsAre(500'000, 83'300, 10'000));
  EXPECT_EQ(say("s031C\r"), "\r");
  EXPECT_EQ(say("O\rS6\r"), "\r\a") << "an open channel keeps its bit rate";
}

TEST_F(SlcanSessionTest, WrongLinesAreAnsweredWithBelAndCounted) {
  say("O\r");
  for (const char* line :
       {"t1239\r", "t12\r", "t1232A1\r", "t1232A1B2C3\r", "t80000\r", "tXYZ0\r", "T200000000\r",
        "d1230\r", "b1230\r", "Y2\r", "Q0\r", "X0\r", "Z2\r", "V1\r", "r12301\r"}) {
    EXPECT_EQ(say(line), "\a") << line;
  }
  EXPECT_TRUE(frames_.empty());
  EXPECT_EQ(session_.malformed(), 15U);
}

TEST_F(SlcanSessionTest, EmptyLinesAndLineFeedsAreIgnored) {
  EXPECT_EQ(say("\r\r\n\r\nO\r"), "\r");
  EXPECT_EQ(session_.malformed(), 0U);
}

TEST_F(SlcanSessionTest, ALineWithoutEndIsGivenUp) {
  std::string answer;
  EXPECT_EQ(session_.take("t1232A1", MachineTime(), answer).consumed, 0U);
  EXPECT_EQ(session_.take(std::string(65, 'x'), MachineTime(), answer).consumed, 65U);
  EXPECT_EQ(answer, "\a");
}

TEST_F(SlcanSessionTest, TimeStampsAreMillisecondsOfTheMinute) {
  EXPECT_EQ(say("Z1\rO\r"), "\r\r");
  EXPECT_EQ(hear(can::data_frame(1, {}), base::SimTime(59'999_ms)), "t0010EA5F\r");
  EXPECT_EQ(hear(can::data_frame(1, {}), base::SimTime(60'001_ms)), "t00100001\r");
}

TEST_F(SlcanSessionTest, StatusFlagsTellErrorsOnce) {
  EXPECT_EQ(say("F\r"), "\a") << "only an open channel has flags";
  say("O\r");
  std::string nothing;
  EXPECT_FALSE(session_.put_error(bus_error_frame(), {}, nothing));
  session_.note_lost_frame();
  EXPECT_EQ(nothing, "");
  EXPECT_EQ(say("F\r"), "F88\r");
  EXPECT_EQ(say("F\r"), "F00\r");
}

TEST_F(SlcanSessionTest, AcknowledgementsComeWhenWanted) {
  SlcanSession session(true);
  EXPECT_EQ(say(session, "O\rt0010\rT000000010\r"), "\rz\rZ\r");
}

TEST_F(SlcanSessionTest, AcceptanceFilterLetsPassWhatTheRegistersSay) {
  // Filter 1: exactly 181h, any data; filter 2: 281h, remote or not.
  EXPECT_EQ(say("M30205020\rm001F001F\rO\r"), "\r\r\r");
  EXPECT_EQ(hear(can::data_frame(0x181, {0x55})), "t181155\r");
  EXPECT_EQ(hear(can::remote_frame(0x281)), "r2810\r");
  EXPECT_EQ(hear(can::data_frame(0x182, {})), "");
  // Of an extended frame the upper 16 bits of the identifier count.
  EXPECT_EQ(hear(extended(can::data_frame(0x3020U << 13 | 7, {}))), "T060400070\r");
  EXPECT_EQ(hear(extended(can::data_frame(0x10000000, {}))), "");
}

TEST_F(SlcanSessionTest, OpeningAndClosingDiscardWhatWaits) {
  say("O\r");
  EXPECT_EQ(restarts_, 1);
  say("C\r");
  EXPECT_EQ(restarts_, 2);
}

}  // namespace
}  // namespace stator::link
