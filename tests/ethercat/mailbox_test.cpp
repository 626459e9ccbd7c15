// The mailbox protocol: counters, repeat requests, full mailboxes, and each error code
// (ETG.1000.4).
#include "stator/ethercat/stack/mailbox.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using testing::HasSubstr;

const std::string kReadDeviceType = "00 20 40 00 10 00 00 00 00 00";

class MailboxTest : public StackFixture {
 protected:
  MailboxTest() { go_pre_operational(); }

  Bytes request_of(std::string_view index_little_endian, unsigned counter) {
    return message(3, hex("00 20 40 " + std::string(index_little_endian) + " 00 00 00 00 00"),
                   counter);
  }
};

TEST_F(MailboxTest, Write_OfTheWorkedExample_IsAnsweredToTheByte) {
  const Bytes reply = exchange(hex("0A 00 00 00 00 13 00 20 23 05 20 00 03 00 00 00"));
  EXPECT_EQ(to_hex(reply), "0A 00 00 00 00 13 00 30 60 05 20 00 00 00 00 00");
}

TEST_F(MailboxTest, Replies_CountFromOneToSevenWithTheSlavesOwnCounter) {
  for (const unsigned expected : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 1U, 2U}) {
    const Bytes reply = exchange(message(3, hex(kReadDeviceType), 0));
    EXPECT_EQ(std::to_integer<unsigned>(reply[5]) >> 4, expected);
  }
}

TEST_F(MailboxTest, Reply_GoesToTheAddressOfTheRequest) {
  Bytes request = message(3, hex(kReadDeviceType), 1);
  request[2] = std::byte{0x01};
  request[3] = std::byte{0x10};
  const Bytes reply = exchange(request);
  EXPECT_EQ(to_hex(part(reply, 2, 2)), "01 10");
}

TEST_F(MailboxTest, RepeatedCounter_IsNotExecutedTwice) {
  const Bytes request = request_of("00 10", 3);
  EXPECT_FALSE(exchange(request).empty());
  EXPECT_TRUE(exchange(request).empty());
  EXPECT_EQ(stack.statistics().mailbox_duplicates, 1U);
  EXPECT_FALSE(exchange(request_of("00 10", 4)).empty());
  EXPECT_FALSE(exchange(request).empty());
}

TEST_F(MailboxTest, CounterZero_IsAlwaysAccepted) {
  EXPECT_FALSE(exchange(request_of("00 10", 0)).empty());
  EXPECT_FALSE(exchange(request_of("00 10", 0)).empty());
}

TEST_F(MailboxTest, CountersStartAfreshAfterInit) {
  EXPECT_FALSE(exchange(request_of("00 10", 3)).empty());
  request(0x01);
  go_pre_operational();
  const Bytes reply = exchange(request_of("00 10", 3));
  ASSERT_FALSE(reply.empty());
  EXPECT_EQ(std::to_integer<unsigned>(reply[5]) >> 4, 1U);
}

TEST_F(MailboxTest, NextRequestBeforeTheReplyWasRead_IsDeferredAndNotLost) {
  ASSERT_TRUE(controller.write_mailbox(request_of("00 10", 1)));
  process();
  ASSERT_TRUE(controller.write_mailbox(request_of("01 10", 2)));
  process();
  EXPECT_FALSE(controller.write_mailbox(request_of("08 10", 3)));
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "00 10");
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "01 10");
}

TEST_F(MailboxTest, RepeatedRequestWhileTheReplyWaits_IsTakenAwayAndTheReplyStays) {
  ASSERT_TRUE(controller.write_mailbox(request_of("00 10", 1)));
  process();
  ASSERT_TRUE(controller.write_mailbox(request_of("00 10", 1)));
  process();
  EXPECT_FALSE(controller.mailbox_full(0));
  EXPECT_EQ(stack.statistics().mailbox_duplicates, 1U);
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "00 10");
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

TEST_F(MailboxTest, NewRequestWhileTheReplyWaitsWithoutHostInterrupt_IsDeferredToo) {
  request(0x01);
  controller.set_sync_manager(0, 0x1000, 128, 0x06, true);
  controller.set_sync_manager(1, 0x1080, 128, 0x02, true);
  request(0x02);
  ASSERT_TRUE(controller.write_mailbox(request_of("00 10", 1)));
  process();
  ASSERT_TRUE(controller.write_mailbox(request_of("01 10", 2)));
  process();
  process();
  EXPECT_TRUE(controller.mailbox_full(0));
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "00 10");
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "01 10");
}

TEST_F(MailboxTest, RepeatRequest_BringsTheSameMessageAgain) {
  const Bytes first = exchange(request_of("00 10", 1));
  controller.toggle_repeat_request();
  process();
  EXPECT_TRUE(controller.repeat_acknowledged());
  EXPECT_EQ(to_hex(controller.read_mailbox()), to_hex(first));
  controller.toggle_repeat_request();
  process();
  EXPECT_EQ(to_hex(controller.read_mailbox()), to_hex(first));
  EXPECT_EQ(stack.statistics().mailbox_repeats, 2U);
}

TEST_F(MailboxTest, RepeatRequestWithANewerMessageInPlace_BringsTheOldOneThenTheNewer) {
  const Bytes first = exchange(request_of("00 10", 1));
  ASSERT_TRUE(controller.write_mailbox(request_of("01 10", 2)));
  process();
  controller.toggle_repeat_request();
  process();
  controller.toggle_repeat_request();  // asked again before it was read
  process();
  EXPECT_EQ(to_hex(controller.read_mailbox()), to_hex(first));
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 9, 2)), "01 10");
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

TEST_F(MailboxTest, RepeatRequestBeforeAnyMessage_IsOnlyAcknowledged) {
  controller.toggle_repeat_request();
  process();
  EXPECT_TRUE(controller.repeat_acknowledged());
  EXPECT_TRUE(controller.read_mailbox().empty());
}

TEST_F(MailboxTest, UnsupportedProtocol_IsAnsweredWithError2) {
  for (const unsigned type : {1U, 2U, 4U, 5U, 15U, 7U}) {
    const Bytes reply = exchange(message(type, hex("00 00 00 00"), 0));
    EXPECT_EQ(to_hex(part(reply, 0, 5)), "04 00 00 00 00");
    EXPECT_EQ(to_hex(part(reply, 6)), "01 00 02 00");
  }
  EXPECT_THAT(log.last("mailbox-error"), HasSubstr("not supported"));
}

TEST_F(MailboxTest, LengthBeyondTheMailbox_IsAnsweredWithError8) {
  Bytes request = message(3, hex(kReadDeviceType), 0);
  base::store_le(request, 0, std::uint16_t{123});
  EXPECT_EQ(to_hex(part(exchange(request), 6)), "01 00 08 00");
}

TEST_F(MailboxTest, TooShortMessages_AreAnsweredWithError6) {
  for (const char* payload : {"", "00", "00 20", "00 20 40 00 10 00 00", "00 80 01 00",
                              "00 80 01 00 00 00 01", "00 80 05 00 00 00 00 10 00"}) {
    const Bytes reply = exchange(message(3, hex(payload), 0));
    EXPECT_EQ(to_hex(part(reply, 6)), "01 00 06 00") << payload;
  }
}

TEST_F(MailboxTest, CoeServicesThatASlaveDoesNotServe_AreAnsweredWithError4OrError5) {
  for (const unsigned service : {1U, 3U, 4U, 5U, 6U, 7U}) {
    const Bytes payload = concat({le(static_cast<std::uint16_t>(service << 12)), Bytes(8)});
    EXPECT_EQ(to_hex(part(exchange(message(3, payload, 0)), 6)), "01 00 04 00");
  }
  for (const unsigned service : {0U, 9U, 15U}) {
    const Bytes payload = concat({le(static_cast<std::uint16_t>(service << 12)), Bytes(8)});
    EXPECT_EQ(to_hex(part(exchange(message(3, payload, 0)), 6)), "01 00 05 00");
  }
}

TEST_F(MailboxTest, ErrorMessageOfTheMaster_IsNotAnswered) {
  EXPECT_TRUE(exchange(message(0, hex("01 00 02 00"), 0)).empty());
}

TEST_F(MailboxTest, ReservedBitInTheHeader_IsAnsweredWithError1) {
  Bytes request = message(3, hex(kReadDeviceType), 1);
  request[5] |= std::byte{0x80};
  EXPECT_EQ(to_hex(part(exchange(request), 6)), "01 00 01 00");
}

TEST_F(MailboxTest, ChannelOtherThanZero_IsAnsweredWithError3) {
  for (const unsigned channel : {0x01U, 0x20U, 0x3FU}) {
    Bytes request = message(3, hex(kReadDeviceType), 0);
    request[4] = static_cast<std::byte>(channel);
    EXPECT_EQ(to_hex(part(exchange(request), 6)), "01 00 03 00") << channel;
  }
}

TEST_F(MailboxTest, EveryPriority_IsServed) {
  for (const unsigned priority : {1U, 2U, 3U}) {
    Bytes request = message(3, hex(kReadDeviceType), 0);
    request[4] = static_cast<std::byte>(priority << 6);
    EXPECT_EQ(to_hex(part(exchange(request), 6, 2)), "00 30") << priority;
  }
}

TEST_F(MailboxTest, ErrorReply_GoesToTheAddressOfTheRequest) {
  Bytes request = message(15, hex("00 00 00 00"), 0);
  base::store_le(request, 2, std::uint16_t{0x4321});
  EXPECT_EQ(to_hex(part(exchange(request), 0, 6)), "04 00 21 43 00 10");
}

TEST_F(MailboxTest, SeveralClientsBehindAGateway_EachGetsItsOwnReply) {
  for (const unsigned address : {0x8001U, 0x8002U, 0x0000U, 0x8001U}) {
    Bytes request = message(3, hex(kReadDeviceType), 0);
    base::store_le(request, 2, static_cast<std::uint16_t>(address));
    EXPECT_EQ(base::load_le<std::uint16_t>(exchange(request), 2), address);
  }
}

TEST_F(MailboxTest, EveryFragmentOfAnAnswer_GoesToTheAddressOfTheRequest) {
  request(0x01);
  configure_mailbox();
  controller.set_sync_manager(1, 0x1080, 40, 0x22, true);
  request(0x02);
  Bytes list = message(3, hex("00 80 01 00 00 00 01 00"), 1);  // list of all objects
  base::store_le(list, 2, std::uint16_t{0x8001});
  Bytes reply = exchange(list);
  int fragments = 0;
  for (; !reply.empty(); reply = controller.read_mailbox()) {
    EXPECT_EQ(to_hex(part(reply, 2, 2)), "01 80") << "fragment " << fragments;
    ++fragments;
    process();
  }
  EXPECT_GT(fragments, 1);
}

TEST_F(MailboxTest, EmergencyAfterAGatewaysRequest_GoesToTheMaster) {
  Bytes request = message(3, hex(kReadDeviceType), 1);
  base::store_le(request, 2, std::uint16_t{0x8001});
  exchange(request);
  stack.send_emergency(0x1000, 1, {}, now);
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 2, 2)), "00 00");
}

TEST_F(MailboxTest, RepeatedCounter_IsExplained) {
  exchange(request_of("00 10", 3));
  exchange(request_of("00 10", 3));
  EXPECT_THAT(log.last("mailbox-duplicate"), HasSubstr("counter 3 came twice"));
}

TEST_F(MailboxTest, RequestLongerThanItsMessage_IsServedFromTheLengthFieldAlone) {
  Bytes request = message(3, hex(kReadDeviceType), 1);
  request.resize(128, std::byte{0xEE});  // what an earlier message left in the mailbox
  EXPECT_EQ(to_hex(part(exchange(request), 6)), "00 30 43 00 10 00 92 01 FC FF");
}

TEST_F(MailboxTest, MailboxFilledToTheLastByte_IsServed) {
  const Bytes request = message(3, concat({hex(kReadDeviceType), Bytes(112)}), 1);
  ASSERT_EQ(request.size(), 128U);
  EXPECT_EQ(to_hex(part(exchange(request), 6, 2)), "00 30");
}

TEST_F(MailboxTest, InInit_RequestsStayUnanswered) {
  request(0x01);
  ASSERT_TRUE(controller.write_mailbox(request_of("00 10", 1)));
  process();
  EXPECT_TRUE(controller.read_mailbox().empty());
}

TEST_F(MailboxTest, UnreadReply_IsForgottenInInit) {
  ASSERT_TRUE(controller.write_mailbox(request_of("00 10", 1)));
  process();
  request(0x01);
  configure_mailbox();  // the controller empties a channel that is configured again
  request(0x02);
  EXPECT_TRUE(controller.read_mailbox().empty());
  EXPECT_FALSE(exchange(request_of("01 10", 1)).empty());
}

TEST_F(MailboxTest, ChannelsWithoutHostInterrupt_ArePolled) {
  request(0x01);
  controller.set_sync_manager(0, 0x1000, 128, 0x06, true);
  controller.set_sync_manager(1, 0x1080, 128, 0x02, true);
  request(0x02);
  EXPECT_FALSE(exchange(request_of("00 10", 1)).empty());
  EXPECT_FALSE(exchange(request_of("00 10", 2)).empty());
}

}  // namespace
}  // namespace stator::ethercat::test
