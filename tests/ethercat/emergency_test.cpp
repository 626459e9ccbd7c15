// Emergencies of CoE to the byte, their order behind replies, and a full queue.
#include "stator/ethercat/stack/emergency.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

class EmergencyTest : public StackFixture {
 protected:
  bool send(std::uint16_t code, std::uint8_t error_register, std::array<std::uint8_t, 5> bytes) {
    return stack.send_emergency(code, error_register, bytes, now);
  }
};

TEST_F(EmergencyTest, FollowingErrorOfMotor2_IsSentToTheByte) {
  go_pre_operational();
  EXPECT_TRUE(send(0x8611, 0x21, {0, 2, 0, 0, 0}));
  process();
  EXPECT_EQ(to_hex(controller.read_mailbox()), "0A 00 00 00 00 13 00 10 11 86 21 00 02 00 00 00");
}

TEST_F(EmergencyTest, WorkedExamples_AreEncodedToTheByte) {
  go_pre_operational();
  struct Example {
    std::uint16_t code;
    std::uint8_t error_register;
    std::array<std::uint8_t, 5> bytes;
    const char* expected;
  };
  for (const Example& example : {Example{0x0000, 0x00, {0, 0}, "00 00 00 00 00 00 00 00"},
                                 Example{0x1000, 0x01, {2, 1}, "00 10 01 02 01 00 00 00"},
                                 Example{0x2312, 0x03, {0, 2}, "12 23 03 00 02 00 00 00"},
                                 Example{0x5441, 0x81, {0, 255}, "41 54 81 00 FF 00 00 00"},
                                 Example{0x6320, 0x21, {0, 255}, "20 63 21 00 FF 00 00 00"},
                                 Example{0xFF00, 0x05, {0, 0}, "00 FF 05 00 00 00 00 00"},
                                 Example{0xFF01, 0x81, {3, 1}, "01 FF 81 03 01 00 00 00"}}) {
    ASSERT_TRUE(send(example.code, example.error_register, example.bytes));
    process();
    EXPECT_EQ(to_hex(part(controller.read_mailbox(), 8)), example.expected);
    process();
  }
}

TEST_F(EmergencyTest, ReplyComesFirst_ThenTheEmergenciesInOrder) {
  go_pre_operational();
  send(0x1000, 1, {1});
  send(0x1000, 1, {2});
  const Bytes reply = exchange(message(3, hex("00 20 40 00 10 00 00 00 00 00"), 1));
  EXPECT_EQ(to_hex(part(reply, 6, 2)), "00 30");
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 6, 6)), "00 10 00 10 01 01");
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 6, 6)), "00 10 00 10 01 02");
}

TEST_F(EmergencyTest, FullQueue_DropsTheNewest) {
  go_pre_operational();
  for (std::uint8_t i = 0; i < EmergencyQueue::kCapacity; ++i) {
    EXPECT_TRUE(send(0x1000, 1, {i}));
  }
  EXPECT_FALSE(send(0x1000, 1, {99}));
  EXPECT_EQ(stack.statistics().emergencies_dropped, 1U);
  for (unsigned i = 0; i < EmergencyQueue::kCapacity; ++i) {
    process();
    EXPECT_EQ(std::to_integer<unsigned>(part(controller.read_mailbox(), 11, 1).at(0)), i);
  }
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

TEST_F(EmergencyTest, WithoutARunningMailbox_NothingIsQueued) {
  EXPECT_FALSE(send(0x1000, 1, {}));
  go_pre_operational();
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

TEST_F(EmergencyTest, SwitchedOff_NothingIsSent) {
  go_pre_operational();
  send(0x1000, 1, {});
  stack.set_emergencies(false);
  EXPECT_FALSE(send(0x1000, 1, {}));
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

}  // namespace
}  // namespace stator::ethercat::test
