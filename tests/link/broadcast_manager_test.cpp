// Cyclic transmission and content filters as Linux' CAN broadcast manager has them, and CAN
// filters.
#include "stator/link/can/broadcast_manager.hpp"

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/link/can/can_exec_link.hpp"
#include "stator/link/can/socketcan_frame.hpp"

namespace stator::link {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class BroadcastManagerTest : public testing::Test {
 protected:
  bool execute(const BroadcastHead& head, const std::vector<can::Frame>& frames = {}) {
    std::string message(reinterpret_cast<const char*>(&head), sizeof head);
    for (const can::Frame& each : frames) {
      const can_frame frame = to_socketcan(each);
      message.append(reinterpret_cast<const char*>(&frame), sizeof frame);
    }
    return manager_.execute(std::as_bytes(std::span(message)), now_, sent_, told_);
  }
  void wait(std::chrono::milliseconds time) {
    now_ += time;
    manager_.advance(now_, sent_, told_);
  }
  void hear(const can::Frame& frame) { manager_.on_frame(frame, now_, told_); }
  /// The opcodes of what the program was told since the last time.
  std::vector<std::uint32_t> told() {
    std::vector<std::uint32_t> opcodes;
    for (const std::string& each : told_) {
      BroadcastHead head;
      std::memcpy(&head, each.data(), sizeof head);
      opcodes.push_back(head.opcode);
    }
    told_.clear();
    return opcodes;
  }

  BroadcastManager manager_;
  MachineTime now_{1h};
  BroadcastManager::Frames sent_;
  BroadcastManager::Messages told_;
};

constexpr bcm_timeval k10ms{.tv_sec = 0, .tv_usec = 10'000};

TEST_F(BroadcastManagerTest, SendsAtOnceAndThenInTheInterval) {
  ASSERT_TRUE(execute({.opcode = TX_SETUP,
                       .flags = SETTIMER | STARTTIMER,
                       .ival2 = k10ms,
                       .can_id = 0x80,
                       .nframes = 1},
                      {can::data_frame(0x80, {1})}));
  EXPECT_EQ(sent_.size(), 1U);
  EXPECT_EQ(manager_.deadline(), now_ + 10ms);
  wait(9ms);
  EXPECT_EQ(sent_.size(), 1U);
  wait(1ms);
  EXPECT_EQ(sent_.size(), 2U);
  ASSERT_TRUE(
      execute({.opcode = TX_SETUP, .can_id = 0x80, .nframes = 1}, {can::data_frame(0x80, {2})}));
  EXPECT_EQ(sent_.size(), 2U) << "a change waits for its turn";
  wait(10ms);
  EXPECT_EQ(sent_.back(), can::data_frame(0x80, {2}));
  ASSERT_TRUE(execute({.opcode = TX_DELETE, .can_id = 0x80}));
  EXPECT_FALSE(manager_.deadline());
  EXPECT_FALSE(execute({.opcode = TX_DELETE, .can_id = 0x80})) << "there is none any more";
}

TEST_F(BroadcastManagerTest, ACountedTransmissionEndsAndTellsSo) {
  execute({.opcode = TX_SETUP,
           .flags = SETTIMER | STARTTIMER | TX_COUNTEVT,
           .count = 3,
           .ival1 = k10ms,
           .can_id = 5,
           .nframes = 1},
          {can::data_frame(5, {})});
  for (int i = 0; i < 10; ++i) {
    wait(10ms);
  }
  EXPECT_EQ(sent_.size(), 3U);
  EXPECT_THAT(told(), ElementsAre(TX_EXPIRED));
}

TEST_F(BroadcastManagerTest, SeveralFramesTakeTurns) {
  execute({.opcode = TX_SETUP,
           .flags = SETTIMER | STARTTIMER,
           .ival2 = k10ms,
           .can_id = 1,
           .nframes = 2},
          {can::data_frame(1, {}), can::data_frame(2, {})});
  wait(10ms);
  wait(10ms);
  EXPECT_THAT(sent_,
              ElementsAre(can::data_frame(1, {}), can::data_frame(2, {}), can::data_frame(1, {})));
}

TEST_F(BroadcastManagerTest, TellsOfChangesInTheBitsAskedFor) {
  execute({.opcode = RX_SETUP, .can_id = 0x181, .nframes = 1}, {can::data_frame(0x181, {0xF0})});
  hear(can::data_frame(0x182, {0x10}));
  EXPECT_THAT(told(), IsEmpty());
  hear(can::data_frame(0x181, {0x10}));
  EXPECT_THAT(told(), ElementsAre(RX_CHANGED));
  hear(can::data_frame(0x181, {0x1F}));
  EXPECT_THAT(told(), IsEmpty()) << "only masked bits changed";
  hear(can::data_frame(0x181, {0x2F}));
  EXPECT_THAT(told(), ElementsAre(RX_CHANGED));
}

TEST_F(BroadcastManagerTest, TellsWhenAFrameStaysAwayAndComesBack) {
  execute({.opcode = RX_SETUP,
           .flags = RX_FILTER_ID | SETTIMER | STARTTIMER | RX_ANNOUNCE_RESUME,
           .ival1 = k10ms,
           .can_id = 0x181});
  wait(10ms);
  EXPECT_THAT(told(), ElementsAre(RX_TIMEOUT));
  wait(10ms);
  EXPECT_THAT(told(), IsEmpty()) << "told once";
  hear(can::data_frame(0x181, {}));
  EXPECT_THAT(told(), ElementsAre(RX_CHANGED));
}

TEST_F(BroadcastManagerTest, RefusesWhatIsNoCommand) {
  EXPECT_FALSE(manager_.execute({}, now_, sent_, told_));
  EXPECT_FALSE(execute({.opcode = 99}));
  EXPECT_FALSE(execute({.opcode = TX_SETUP, .can_id = 1, .nframes = 2}, {can::data_frame(1, {})}));
  EXPECT_FALSE(execute({.opcode = TX_READ, .can_id = 1}));
}

TEST(CanFilter, LetsPassOrKeepsOut) {
  const can_frame frame = to_socketcan(can::data_frame(0x181, {}));
  EXPECT_TRUE(passes({.can_id = 0x181, .can_mask = 0x7FF}, frame));
  EXPECT_TRUE(passes({.can_id = 0, .can_mask = 0}, frame));
  EXPECT_FALSE(passes({.can_id = 0x182, .can_mask = 0x7FF}, frame));
  EXPECT_FALSE(passes({.can_id = 0x181 | CAN_INV_FILTER, .can_mask = 0x7FF}, frame));
  EXPECT_TRUE(passes({.can_id = 0x182 | CAN_INV_FILTER, .can_mask = 0x7FF}, frame));
  EXPECT_FALSE(passes({.can_id = 0x181 | CAN_EFF_FLAG, .can_mask = CAN_EFF_FLAG | 0x7FF}, frame));
  EXPECT_FALSE(passes({.can_id = 0x181 | CAN_RTR_FLAG, .can_mask = CAN_RTR_FLAG | 0x7FF}, frame));
}

}  // namespace
}  // namespace stator::link
