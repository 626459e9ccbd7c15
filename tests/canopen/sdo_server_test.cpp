// Expedited and segmented SDO transfers, and the abort code of each way in which they can fail.
#include <gtest/gtest.h>

#include "sdo_client.hpp"

namespace stator::canopen {
namespace {

TEST(SdoServer, ExpeditedUpload_CarriesOneToFourBytesAndTheirNumber) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [4F 00 20 00 08 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x40, 0x01, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [4B 01 20 00 00 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x40, 0x02, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [43 02 20 00 F9 FF FF FF]"});
  bench.dictionary.find(0x2004, 0)->set_text("Ada");
  EXPECT_EQ(ask(bench, {0x40, 0x04, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [47 04 20 00 41 64 61 00]"});
}

TEST(SdoServer, ExpeditedDownload_WritesWithAndWithoutAnnouncedSize) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x2B, 0x01, 0x20, 0, 0x34, 0x12, 0, 0}),
            Texts{"585 [60 01 20 00 00 00 00 00]"});
  EXPECT_EQ(bench.value(0x2001), 0x1234U);
  EXPECT_EQ(ask(bench, {0x22, 0x01, 0x20, 0, 0x78, 0x56, 0, 0}),
            Texts{"585 [60 01 20 00 00 00 00 00]"});
  EXPECT_EQ(bench.value(0x2001), 0x5678U);
  EXPECT_EQ(ask(bench, {0x22, 0x04, 0x20, 0, 'l', 'o', 'v', 'e'}),
            Texts{"585 [60 04 20 00 00 00 00 00]"});
  EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), "love");
}

TEST(SdoServer, Answers_InTheMomentOfTheRequest) {
  NodeBench bench;
  bench.boot();
  bench.receive(kRequest, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  ASSERT_EQ(bench.transmitter.times.size(), 1U);
  EXPECT_EQ(bench.transmitter.times[0], bench.now);
}

TEST(SdoServer, SegmentedUpload_SendsATextSevenBytesAtATime) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}), Texts{"585 [41 08 10 00 0C 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), Texts{"585 [00 42 65 6E 63 68 20 6E]"});
  EXPECT_EQ(ask(bench, {0x70, 0, 0, 0, 0, 0, 0, 0}), Texts{"585 [15 6F 64 65 20 31 00 00]"});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
}

TEST(SdoServer, SegmentedUpload_OfNothingIsOneEmptySegment) {
  NodeBench bench;
  bench.boot();
  bench.dictionary.find(0x2004, 0)->set_text("");
  EXPECT_EQ(ask(bench, {0x40, 0x04, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [41 04 20 00 00 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), Texts{"585 [0F 00 00 00 00 00 00 00]"});
}

TEST(SdoServer, SegmentedUpload_CarriesValuesOfEveryLength) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  for (const std::size_t size : {5U, 6U, 7U, 8U, 13U, 14U, 15U, 889U, 100'000U}) {
    std::string text(size, ' ');
    std::ranges::generate(text, [n = 0U]() mutable { return static_cast<char>('!' + ++n % 90); });
    bench.dictionary.find(0x1021, 0)->set_text(text);
    EXPECT_EQ(client.upload(0x1021), text) << size << " bytes";
  }
}

TEST(SdoServer, SegmentedTransfer_CarriesA64BitNumberBothWays) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  client.download(0x2003, 0, "\x08\x07\x06\x05\x04\x03\x02\x01");
  EXPECT_EQ(client.abort_code, 0U);
  EXPECT_EQ(bench.value(0x2003), 0x0102030405060708U);
  EXPECT_EQ(client.upload(0x2003), "\x08\x07\x06\x05\x04\x03\x02\x01");
}

TEST(SdoServer, SegmentedDownload_WritesTextsWithAndWithoutAnnouncedSize) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  for (const bool announce : {true, false}) {
    for (const std::size_t size : {0U, 1U, 4U, 6U, 7U, 8U, 14U, 16384U}) {
      const std::string text(size, announce ? 'a' : 'b');
      client.download(0x2004, 0, text, announce);
      EXPECT_EQ(client.abort_code, 0U);
      EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), text);
    }
  }
}

TEST(SdoServer, ToggleTwiceTheSame_AbortsAndForgetsTheTransfer) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kToggleBit));
  EXPECT_EQ(ask(bench, {0x70, 0, 0, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
  EXPECT_TRUE(bench.events.tells("SDO segment of 1008h:00h refused: toggle bit 0 came, 1 was due"));

  ask(bench, {0x21, 0x04, 0x20, 0, 9, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x10, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), aborted(0x2004, 0, kToggleBit));
  EXPECT_EQ(ask(bench, {0x00, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), aborted(0, 0, kUnknownCommand));
  EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), "nobody");
}

TEST(SdoServer, SegmentOfTheOtherDirection_IsRefused) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x00, 0, 0, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kUnknownCommand));
  ask(bench, {0x21, 0x04, 0x20, 0, 9, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0x2004, 0, kUnknownCommand));
}

TEST(SdoServer, LengthThatDoesNotFit_IsRefusedBeforeTheDataCome) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x21, 0x01, 0x20, 0, 3, 0, 0, 0}), aborted(0x2001, 0, kTooLong));
  EXPECT_EQ(ask(bench, {0x21, 0x01, 0x20, 0, 1, 0, 0, 0}), aborted(0x2001, 0, kTooShort));
  EXPECT_EQ(ask(bench, {0x21, 0x00, 0x10, 0, 4, 0, 0, 0}), aborted(0x1000, 0, kReadOnly));
  EXPECT_EQ(ask(bench, {0x21, 0x04, 0x20, 0, 0x01, 0x40, 0, 0}), aborted(0x2004, 0, kOutOfMemory));
  EXPECT_EQ(ask(bench, {0x21, 0x99, 0x20, 0, 1, 0, 0, 0}), aborted(0x2099, 0, kNoObject));
}

TEST(SdoServer, SegmentsThatBreakTheAnnouncedLength_AbortTheTransfer) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x21, 0x04, 0x20, 0, 8, 0, 0, 0});
  ask(bench, {0x00, '1', '2', '3', '4', '5', '6', '7'});
  EXPECT_EQ(ask(bench, {0x1B, '8', '9', 0, 0, 0, 0, 0}), aborted(0x2004, 0, kTooLong));

  ask(bench, {0x21, 0x04, 0x20, 0, 8, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x01, '1', '2', '3', '4', '5', '6', '7'}), aborted(0x2004, 0, kTooShort));
  EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), "nobody");
  EXPECT_TRUE(bench.events.tells(
      "SDO download to 2004h:00h refused: it ended after 7 bytes, 8 were announced"));
}

TEST(SdoServer, SegmentsWithoutAnnouncedLength_AreHeldAgainstTheType) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x20, 0x01, 0x20, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x00, 1, 2, 3, 4, 5, 6, 7}), aborted(0x2001, 0, kTooLong));
  ask(bench, {0x20, 0x01, 0x20, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x0D, 1, 0, 0, 0, 0, 0, 0}), aborted(0x2001, 0, kTooShort));
  ask(bench, {0x20, 0x01, 0x20, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x0F, 0, 0, 0, 0, 0, 0, 0}), aborted(0x2001, 0, kTooShort));
}

TEST(SdoServer, TextLongerThanTheServersRoom_IsRefusedWithoutAnnouncementToo) {
  NodeConfiguration configuration = bench_configuration();
  configuration.sdo.longest_download = 10;
  NodeBench bench(configuration);
  bench.boot();
  ask(bench, {0x20, 0x04, 0x20, 0, 0, 0, 0, 0});
  ask(bench, {0x00, 1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(ask(bench, {0x10, 1, 2, 3, 4, 5, 6, 7}), aborted(0x2004, 0, kOutOfMemory));
}

TEST(SdoServer, AbortByTheClient_EndsAnyTransferWithoutAnAnswer) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x80, 0, 0, 0, 0, 0, 0x04, 0x05}), Texts{});
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x80, 0, 0, 0, 0, 0, 0x04, 0x05}), Texts{});
  EXPECT_TRUE(bench.events.tells("1008h:00h ended by the client with abort code 05040000h"));
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
}

TEST(SdoServer, SilentClient_IsToldTheTimeOutOnce) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  bench.wait(999_ms);
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}).size(), 1U);
  bench.wait(999_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), aborted(0x1008, 0, kTimedOut));
  bench.wait(5_s);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_TRUE(
      bench.events.tells("SDO transfer of 1008h:00h ended: the client sent nothing for 1000"));
}

TEST(SdoServer, TimeOut_IsConfigurable) {
  NodeConfiguration configuration = bench_configuration();
  configuration.sdo.timeout = 50_ms;
  NodeBench bench(configuration);
  bench.boot();
  ask(bench, {0x21, 0x04, 0x20, 0, 8, 0, 0, 0});
  bench.wait(50_ms);
  EXPECT_EQ(to_text(bench.take()), aborted(0x2004, 0, kTimedOut));
}

TEST(SdoServer, NewRequest_SupersedesAnAbandonedTransfer) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [4F 00 20 00 08 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
}

TEST(SdoServer, FrameWithoutEightBytes_IsIgnoredCountedAndExplained) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x40, 0x00, 0x10, 0}), Texts{});
  EXPECT_EQ(ask(bench, {}), Texts{});
  bench.receive(can::remote_frame(kRequest, 8));
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_EQ(bench.node.sdo_server().statistics().malformed, 2U);
  EXPECT_TRUE(bench.events.tells("SDO ignored: the frame has 4 data bytes, must have 8"));
}

TEST(SdoServer, TextThatChangesItsLengthWhileItIsRead_AbortsTheUpload) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  bench.dictionary.find(0x1008, 0)->set_text("short");
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kDeviceState));
}

TEST(SdoServer, Stop_ForgetsTheTransfer) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  bench.nmt(2);
  bench.wait(2_s);
  bench.nmt(1);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
}

TEST(SdoServer, ResetCommunication_ForgetsTheTransferAndServesOn) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  bench.nmt(130);
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"705 [00]"});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
  EXPECT_EQ(ask(bench, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0}), Texts{"585 [4F 00 20 00 08 00 00 00]"});
}

TEST(SdoServer, ObjectOfPreOperational_IsRefusedInOperational) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x2B, 0x07, 0x20, 0, 1, 0, 0, 0}), Texts{"585 [60 07 20 00 00 00 00 00]"});
  bench.nmt(1);
  EXPECT_EQ(ask(bench, {0x2B, 0x07, 0x20, 0, 2, 0, 0, 0}), aborted(0x2007, 0, kDeviceState));
  EXPECT_EQ(bench.value(0x2007), 1U);
}

TEST(SdoServer, RefusalOfTheDictionary_ExplainsItself) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x2F, 0x00, 0x20, 0, 9, 0, 0, 0});
  EXPECT_TRUE(
      bench.events.tells("write to 2000h:00h \"Resolution\" refused: 9 is above the maximum 8"));
  EXPECT_EQ(bench.node.sdo_server().statistics().aborts, 1U);
}

/// Carries out a write when the test says so.
class Disk final : public dictionary::WriteCompletion {
 public:
  [[nodiscard]] std::optional<dictionary::Verdict> poll(const dictionary::Entry& entry,
                                                        base::SimTime) override {
    ++polls;
    return entry.index() == 0x2000 ? verdict : dictionary::Verdict{};
  }
  std::optional<dictionary::Verdict> verdict;
  int polls = 0;
};

TEST(SdoServer, WriteUnderWay_IsAnsweredWhenItIsComplete) {
  NodeBench bench;
  Disk disk;
  bench.node.set_write_completion(&disk);
  bench.boot();
  EXPECT_EQ(ask(bench, {0x2F, 0x00, 0x20, 0, 4, 0, 0, 0}), Texts{});
  bench.wait(3_s);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  EXPECT_GE(disk.polls, 3000);
  disk.verdict = dictionary::Verdict{};
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"585 [60 00 20 00 00 00 00 00]"});
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
  EXPECT_EQ(ask(bench, {0x2B, 0x01, 0x20, 0, 1, 0, 0, 0}).size(), 1U);
}

TEST(SdoServer, WriteThatFailsLater_IsAnsweredWithItsRefusal) {
  constexpr base::EventRule kFull{"full", base::Severity::refusal, "the memory is full"};
  NodeBench bench;
  Disk disk;
  bench.node.set_write_completion(&disk);
  bench.boot();
  ask(bench, {0x2F, 0x00, 0x20, 0, 4, 0, 0, 0});
  disk.verdict = dictionary::refuse(dictionary::AbortCode::hardware_error, kFull, {});
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), aborted(0x2000, 0, kHardwareError));
  EXPECT_TRUE(bench.events.tells("the memory is full"));
}

TEST(SdoServer, SegmentedWriteUnderWay_IsAnsweredLikeASegment) {
  NodeBench bench;
  Disk disk;
  bench.node.set_write_completion(&disk);
  bench.boot();
  ask(bench, {0x21, 0x00, 0x20, 0, 1, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x0D, 3, 0, 0, 0, 0, 0, 0}), Texts{});
  disk.verdict = dictionary::Verdict{};
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"585 [20 00 00 00 00 00 00 00]"});
}

TEST(SdoServer, ClientThatAbortsAWriteUnderWay_IsNotAnswered) {
  NodeBench bench;
  Disk disk;
  bench.node.set_write_completion(&disk);
  bench.boot();
  ask(bench, {0x2F, 0x00, 0x20, 0, 4, 0, 0, 0});
  ask(bench, {0x80, 0x00, 0x20, 0, 0, 0, 4, 5});
  disk.verdict = dictionary::Verdict{};
  bench.wait(1_s);
  EXPECT_EQ(to_text(bench.take()), Texts{});
}

TEST(SdoServer, ParameterObject_ShowsTheIdentifiersOfTheFirstServer) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(bench.value(0x1200, 1), 0x605U);
  EXPECT_EQ(bench.value(0x1200, 2), 0x585U);
}

TEST(SdoServer, FurtherServer_IsSilentUntilBothItsIdentifiersAreValid) {
  NodeBench bench;
  bench.boot();
  const auto ask_second = [&] {
    bench.receive(0x6A0, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0});
    return to_text(bench.take());
  };
  EXPECT_EQ(ask_second(), Texts{});
  ask(bench, {0x23, 0x01, 0x12, 1, 0xA0, 0x06, 0, 0});
  EXPECT_EQ(ask_second(), Texts{});
  ask(bench, {0x23, 0x01, 0x12, 2, 0xA1, 0x06, 0, 0});
  EXPECT_EQ(ask_second(), Texts{"6A1 [4F 00 20 00 08 00 00 00]"});
  ask(bench, {0x23, 0x01, 0x12, 1, 0xA0, 0x06, 0, 0x80});
  EXPECT_EQ(ask_second(), Texts{});
}

TEST(SdoServer, TwoServers_HaveTheirTransfersApart) {
  NodeBench bench;
  bench.boot();
  bench.set(0x1201, 1, 0x6A0);
  bench.set(0x1201, 2, 0x6A1);
  bench.node.communication_objects_changed();
  ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  bench.receive(0x6A0, {0x21, 0x04, 0x20, 0, 3, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{"6A1 [60 04 20 00 00 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x60, 0, 0, 0, 0, 0, 0, 0}), Texts{"585 [00 42 65 6E 63 68 20 6E]"});
  bench.receive(0x6A0, {0x09, 'A', 'd', 'a', 0, 0, 0, 0});
  EXPECT_EQ(to_text(bench.take()), Texts{"6A1 [20 00 00 00 00 00 00 00]"});
  EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), "Ada");
}

}  // namespace
}  // namespace stator::canopen
