// When the mailbox wants to be called, what it writes to its sync managers, and how its quirks slow
// it down.

#include <algorithm>
#include <optional>
#include <vector>

#include "ethercat/stack_fixture.hpp"
#include "stator/ethercat/stack/mailbox.hpp"

namespace stator::ethercat::test {
namespace {

using namespace base::literals;

const std::string kReadDeviceType = "00 20 40 00 10 00 00 00 00 00";

/// Notes to which addresses the host writes.
class WatchedController final : public ProcessDataInterface {
 public:
  void read(std::uint16_t address, std::span<std::byte> out) override { inner.read(address, out); }
  void write(std::uint16_t address, std::span<const std::byte> data) override {
    written.push_back(address);
    inner.write(address, data);
  }
  [[nodiscard]] std::uint32_t al_event_request() const override { return inner.al_event_request(); }

  FakeController inner;
  std::vector<std::uint16_t> written;
};

/// A protocol that answers with what it got, and has a message of its own when told so.
class Echo final : public MailboxProtocol {
 public:
  [[nodiscard]] MailboxType type() const override { return MailboxType::voe; }
  [[nodiscard]] bool available_in(AlState /*state*/) const override { return true; }
  void reset() override {}
  MailboxReply handle(std::span<const std::byte> request, std::span<std::byte> reply,
                      base::SimTime /*now*/) override {
    std::ranges::copy(request, reply.begin());
    return {.length = request.size()};
  }
  [[nodiscard]] bool has_message() const override { return own_length.has_value(); }
  std::size_t next_message(std::span<std::byte> /*message*/, base::SimTime /*now*/) override {
    const std::size_t length = own_length.value_or(0);
    own_length.reset();
    return length;
  }

  std::optional<std::size_t> own_length;
};

class MailboxFlow : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kHostControl = 0x080F;
  static constexpr std::uint32_t kReceived = al_event::sync_manager(0);
  static constexpr std::uint32_t kRead = al_event::sync_manager(1);

  MailboxFlow() {
    mailbox.add(echo);
    controller.inner.set_sync_manager(0, 0x1000, 64, 0x26, true);
    controller.inner.set_sync_manager(1, 0x1080, 64, 0x22, true);
    mailbox.start(read_sync_managers(controller), AlState::pre_operational);
  }
  void process() { mailbox.process(controller.al_event_request(), base::SimTime()); }
  bool wrote_host_control() const {
    return std::ranges::find(controller.written, kHostControl) != controller.written.end();
  }

  WatchedController controller;
  SlaveStackStatistics statistics;
  Mailbox mailbox{controller, 64, 64, {}, statistics};
  Echo echo;
};

TEST_F(MailboxFlow, WantsToBeCalledForARequestAndForAReplyThatWasRead) {
  EXPECT_FALSE(mailbox.needs_attention(0));
  EXPECT_TRUE(mailbox.needs_attention(kReceived));
  ASSERT_TRUE(controller.inner.write_mailbox(hex("02 00 00 00 00 1F AA BB")));
  process();
  EXPECT_FALSE(mailbox.needs_attention(0)) << "the master has not read the reply";
  EXPECT_TRUE(mailbox.needs_attention(kRead));
  EXPECT_EQ(to_hex(controller.inner.read_mailbox()), "02 00 00 00 00 1F AA BB");
}

TEST_F(MailboxFlow, LeavesAnEmptyChannelSwitchedOnWhenItStarts) {
  EXPECT_FALSE(wrote_host_control());
}

TEST_F(MailboxFlow, TakesAMessageBackThatAnEarlierRunLeft) {
  echo.own_length = 2;
  process();
  ASSERT_TRUE(controller.inner.mailbox_full(1));
  mailbox.start(read_sync_managers(controller), AlState::pre_operational);
  EXPECT_TRUE(wrote_host_control());
  EXPECT_FALSE(controller.inner.mailbox_full(1));
}

TEST_F(MailboxFlow, SendsNothingForAMessageThatItsProtocolGaveUp) {
  echo.own_length = 0;
  process();
  EXPECT_FALSE(controller.inner.mailbox_full(1));
  EXPECT_EQ(statistics.mailbox_sent, 0U);
  echo.own_length = 2;
  process();
  EXPECT_TRUE(controller.inner.mailbox_full(1));
  EXPECT_EQ(statistics.mailbox_sent, 1U);
}

TEST_F(MailboxFlow, CountsItsErrorReplies) {
  ASSERT_TRUE(controller.inner.write_mailbox(hex("02 00 00 00 00 13 AA BB")));  // no CoE here
  process();
  EXPECT_EQ(statistics.mailbox_errors, 1U);
  EXPECT_EQ(to_hex(controller.inner.read_mailbox()), "04 00 00 00 00 10 01 00 02 00");
}

class MailboxRepetition : public StackFixture {
 protected:
  MailboxRepetition() { go_pre_operational(); }
};

// ETG.1000.4 §5.6: the master asks again until it has the message; those behind it are not lost.
TEST_F(MailboxRepetition, AskedForAgainAfterItWasRead_LosesNothingBehindIt) {
  const Bytes first = exchange(message(3, hex(kReadDeviceType), 1));
  ASSERT_TRUE(controller.write_mailbox(message(3, hex("00 20 40 01 10 00 00 00 00 00"), 2)));
  process();
  controller.toggle_repeat_request();
  process();
  EXPECT_EQ(to_hex(controller.read_mailbox()), to_hex(first));
  controller.toggle_repeat_request();
  process();
  EXPECT_EQ(to_hex(controller.read_mailbox()), to_hex(first));
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "01 10");
}

TEST_F(MailboxRepetition, ARequestBehindAnEmergency_IsLookedAtAndItsInterruptAcknowledged) {
  stack.send_emergency(0x1000, 1, {}, now);
  process();
  ASSERT_TRUE(controller.mailbox_full(1));
  ASSERT_TRUE(controller.write_mailbox(message(3, hex(kReadDeviceType), 1)));
  process();
  EXPECT_EQ(controller.al_event_request() & al_event::sync_manager(0), 0U);
  EXPECT_TRUE(controller.mailbox_full(0)) << "the request waits";
  controller.read_mailbox();
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "00 10");
}

class MailboxOfASlowDevice : public StackFixture {
 protected:
  static SlaveStackOptions slow() {
    SlaveStackOptions options;
    options.quirks.slow_sdo = 2_ms;
    return options;
  }
  MailboxOfASlowDevice() : StackFixture(test_description(), slow()) { go_pre_operational(); }
};

TEST_F(MailboxOfASlowDevice, SdoAnswersComeWhenTheTimeIsOver) {
  EXPECT_TRUE(exchange(message(3, hex(kReadDeviceType), 1)).empty());
  now += 2_ms - base::SimDuration(1);
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
  now += base::SimDuration(1);
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 6)), "00 30 43 00 10 00 92 01 FC FF");
}

TEST_F(MailboxOfASlowDevice, SdoInformationComesAtOnce) {
  const Bytes reply = exchange(message(3, hex("00 80 01 00 00 00 00 00"), 1));
  EXPECT_EQ(to_hex(part(reply, 6, 3)), "00 80 02");
}

TEST_F(MailboxOfASlowDevice, AnAbortOfTheMasterHasNoAnswerLaterEither) {
  EXPECT_TRUE(exchange(message(3, hex("00 20 80 00 10 00 00 00 04 05"), 1)).empty());
  now += 10_ms;
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

class MailboxThatDoesNotCount : public StackFixture {
 protected:
  static SlaveStackOptions uncounted() {
    SlaveStackOptions options;
    options.quirks.mailbox_counter_zero = true;
    return options;
  }
  MailboxThatDoesNotCount() : StackFixture(test_description(), uncounted()) {
    go_pre_operational();
  }
};

TEST_F(MailboxThatDoesNotCount, SendsTheCounterZeroInEveryReply) {
  for (const unsigned counter : {1U, 2U, 3U}) {
    const Bytes reply = exchange(message(3, hex(kReadDeviceType), counter));
    ASSERT_FALSE(reply.empty());
    EXPECT_EQ(std::to_integer<unsigned>(reply[5]) >> 4, 0U);
  }
}

}  // namespace
}  // namespace stator::ethercat::test
