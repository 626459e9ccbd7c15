// TMCL over CAN: frames of seven and eight bytes, identifiers, replies and events.
#include "stator/tmcl/sessions/can_session.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tmcl/firmware_fixture.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using enum Command;
using tests::bytes_of;

class CanSessionTest : public tests::FirmwareFixture {
 protected:
  std::optional<CanReply> send(const std::vector<std::byte>& data, std::uint32_t identifier = 1) {
    return session_.take(identifier, data, now_);
  }
  static std::vector<std::byte> data_of(const std::optional<CanReply>& reply) {
    EXPECT_TRUE(reply.has_value());
    return reply ? std::vector<std::byte>(reply->payload().begin(), reply->payload().end())
                 : std::vector<std::byte>();
  }

  CanSession session_{firmware_};
};

// L486, L549.
TEST_F(CanSessionTest, SevenBytesCarryACommandAndItsReply) {
  module_.position = 711;
  const auto reply = send(bytes_of({6, 1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(data_of(reply), bytes_of({1, 0x64, 6, 0, 0, 2, 0xC7}));
  EXPECT_EQ(reply->identifier, 2);
}

TEST_F(CanSessionTest, EightBytesAreAnsweredWithEight) {
  module_.position = 711;
  EXPECT_EQ(data_of(send(bytes_of({6, 1, 0, 0, 0, 0, 0, 0xEE}))),
            bytes_of({1, 0x64, 6, 0, 0, 2, 0xC7, 0x36}))
      << "the eighth is the sum of the serial reply";
}

// L5197-L5199.
TEST_F(CanSessionTest, TheVersionTextNeedsEightBytes) {
  EXPECT_EQ(data_of(send(bytes_of({136, 0, 0, 0, 0, 0, 0}))),
            bytes_of({'1', '4', '2', 'V', '4', '.', '4'}));
  EXPECT_EQ(data_of(send(bytes_of({136, 0, 0, 0, 0, 0, 0, 0}))),
            bytes_of({'1', '4', '2', 'V', '4', '.', '4', '5'}));
}

TEST_F(CanSessionTest, FramesOfOtherLengthsAreNoCommands) {
  for (const std::size_t length : {0U, 1U, 6U}) {
    EXPECT_FALSE(send(std::vector<std::byte>(length, std::byte{3})));
  }
  EXPECT_TRUE(module_.velocities.empty());
}

TEST_F(CanSessionTest, TwoIdentifiersReachTheModule) {
  set_global(71, 0x123);
  set_global(70, 0x7FF);
  EXPECT_FALSE(send(bytes_of({3, 0, 0, 0, 0, 0, 0}), 1));
  EXPECT_FALSE(send(bytes_of({3, 0, 0, 0, 0, 0, 0}), 0)) << "0: there is no second one";
  EXPECT_EQ(send(bytes_of({3, 0, 0, 0, 0, 0, 0}), 0x123)->identifier, 0x7FF);
  set_global(83, 0x321);
  EXPECT_EQ(send(bytes_of({3, 0, 0, 0, 0, 0, 0}), 0x321)->identifier, 0x7FF);
  EXPECT_TRUE(send(bytes_of({3, 0, 0, 0, 0, 0, 0}), 0x123));
}

TEST_F(CanSessionTest, ANewIdentifierHoldsAfterTheReply) {
  EXPECT_EQ(send(bytes_of({9, 70, 0, 0, 0, 0, 9}))->identifier, 2);
  EXPECT_EQ(send(bytes_of({9, 71, 0, 0, 0, 0, 7}))->identifier, 9);
  EXPECT_FALSE(send(bytes_of({10, 71, 0, 0, 0, 0, 0}), 1));
  EXPECT_TRUE(send(bytes_of({10, 71, 0, 0, 0, 0, 0}), 7));
}

TEST_F(CanSessionTest, TheTelegramPauseDoesNotCount) {
  set_global(75, 255);
  EXPECT_TRUE(send(bytes_of({3, 0, 0, 0, 0, 0, 0})));
}

TEST_F(CanSessionTest, CommandsWithoutAReplyHaveNone) {
  EXPECT_FALSE(send(bytes_of({242, 0x81, 0x92, 0xA3, 0xB4, 0xC5, 0xD6})));
  EXPECT_FALSE(send(bytes_of({242, 0x81, 0x92, 0xA3, 0xB4, 0xC5, 0xD6, 0})));
  EXPECT_FALSE(send(bytes_of({205, 0, 0, 0, 0, 0, 0})));
  EXPECT_FALSE(send(bytes_of({137, 0, 0, 0, 0, 0x04, 0xD2})));
  EXPECT_EQ(module_.factory_resets, 1);
}

TEST_F(CanSessionTest, ThereIsNoTextOnCan) {
  EXPECT_EQ(data_of(send(bytes_of({139, 0, 0, 0, 0, 0, 0}))), bytes_of({1, 6, 139, 0, 0, 0, 0}));
}

TEST_F(CanSessionTest, ACellOfTheMemoryIsItsSevenBytes) {
  load({tests::instruction(wait, 1, 0, 500)});
  EXPECT_EQ(data_of(send(bytes_of({134, 0, 0, 0, 0, 0, 0}))), bytes_of({27, 1, 0, 0, 0, 1, 0xF4}));
}

TEST_F(CanSessionTest, TheReachedTargetIsToldOnce) {
  module_.reached = false;
  EXPECT_EQ(data_of(send(bytes_of({138, 0, 0, 0, 0, 0, 1, 0}))),
            bytes_of({1, 0x64, 138, 0, 0, 0, 1, 0xF2}));
  EXPECT_FALSE(session_.take_event());
  module_.reached = true;
  const auto event = session_.take_event();
  EXPECT_EQ(data_of(event), bytes_of({1, 0x80, 138, 0, 0, 0, 1, 0x0E}));
  EXPECT_EQ(event->identifier, 2);
  EXPECT_FALSE(session_.take_event());
}

}  // namespace
}  // namespace stator::tmcl
