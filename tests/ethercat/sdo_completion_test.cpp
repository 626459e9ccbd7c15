// Writes that are complete, and answered, some time after the dictionary took them.

#include <optional>

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using namespace base::literals;
using dictionary::Verdict;

/// Is as slow, and fails, as a test wants.
class Disk final : public dictionary::WriteCompletion {
 public:
  std::optional<Verdict> poll(const dictionary::Entry& entry, base::SimTime /*now*/) override {
    asked = entry.index();
    return verdict;
  }
  std::optional<Verdict> verdict;
  std::uint16_t asked = 0;
};

const Bytes kWrite = hex("2F 03 20 00 78 00 00 00");

class SdoCompletion : public StackFixture {
 protected:
  SdoCompletion() {
    go_pre_operational();
    stack.set_write_completion(&disk);
  }
  ~SdoCompletion() override { stack.set_write_completion(nullptr); }
  Disk disk;
};

TEST_F(SdoCompletion, WriteIsAnsweredWhenItIsComplete) {
  EXPECT_TRUE(sdo(kWrite).empty());
  EXPECT_EQ(value(0x2003), 0x78U);
  EXPECT_EQ(disk.asked, 0x2003);
  for (int i = 0; i < 10; ++i) {
    now += 1_ms;
    process();
    EXPECT_TRUE(controller.read_mailbox().empty());
  }
  disk.verdict = Verdict{};
  process();
  const Bytes answer = controller.read_mailbox();
  ASSERT_EQ(answer.size(), 16U);
  EXPECT_EQ(to_hex(part(answer, 6, 10)), "00 30 60 03 20 00 00 00 00 00");
  process();
  EXPECT_TRUE(controller.read_mailbox().empty()) << "once";
}

TEST_F(SdoCompletion, WriteThatFailsInTheEnd_IsAborted) {
  EXPECT_TRUE(sdo(kWrite).empty());
  disk.verdict = dictionary::refuse(dictionary::AbortCode::hardware_error,
                                    dictionary::rules::kReadOnly, {0x2003, 0, "x"});
  process();
  const Bytes answer = controller.read_mailbox();
  ASSERT_EQ(answer.size(), 16U);
  EXPECT_EQ(to_hex(part(answer, 6, 10)), "00 20 80 03 20 00 00 00 06 06")
      << "an abort is a request";
}

TEST_F(SdoCompletion, WriteThatIsCompleteAtOnce_IsAnsweredAtOnce) {
  disk.verdict = Verdict{};
  EXPECT_EQ(to_hex(sdo(kWrite)), "60 03 20 00 00 00 00 00");
  EXPECT_EQ(to_hex(sdo("40 03 20 00 00 00 00 00")), "4F 03 20 00 78 00 00 00");
}

TEST_F(SdoCompletion, NextRequestWaitsInItsMailbox) {
  EXPECT_TRUE(sdo(kWrite).empty());
  EXPECT_TRUE(sdo("40 00 10 00 00 00 00 00").empty());
  EXPECT_TRUE(controller.mailbox_full(0));
  disk.verdict = Verdict{};
  process();
  EXPECT_EQ(part(controller.read_mailbox(), 8, 1), hex("60"));
  process();
  EXPECT_EQ(part(controller.read_mailbox(), 8, 1), hex("43"));
}

TEST_F(SdoCompletion, EmergenciesGoOutMeanwhile) {
  EXPECT_TRUE(sdo(kWrite).empty());
  EXPECT_TRUE(stack.send_emergency(0x1000, 1, {}, now));
  process();
  EXPECT_EQ(part(controller.read_mailbox(), 6, 2), hex("00 10"));
  disk.verdict = Verdict{};
  process();
  EXPECT_EQ(part(controller.read_mailbox(), 8, 1), hex("60"));
}

TEST_F(SdoCompletion, LeavingTheMailboxStates_ForgetsTheAnswer) {
  EXPECT_TRUE(sdo(kWrite).empty());
  request(1);
  disk.verdict = Verdict{};
  request(2);
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
  EXPECT_EQ(part(sdo("40 00 10 00 00 00 00 00"), 0, 1), hex("43"));
}

}  // namespace
}  // namespace stator::ethercat::test
