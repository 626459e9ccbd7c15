// SDO block transfers of every length in both directions, with lost segments, wrong CRCs and
// requests out of order.
#include <gtest/gtest.h>

#include "sdo_client.hpp"
#include "stator/canopen/sdo/crc16.hpp"

namespace stator::canopen {
namespace {

std::string pattern(std::size_t size) {
  std::string text(size, ' ');
  std::ranges::generate(text, [n = 0U]() mutable { return static_cast<char>((++n * 37) & 0xFF); });
  return text;
}

std::uint16_t checksum_of(const std::string& text) {
  return crc16(std::as_bytes(std::span(text)));
}

/// Lengths around the borders of segments (7 bytes) and blocks (889 bytes).
constexpr std::array<std::size_t, 10> kLengths{0, 1, 6, 7, 8, 14, 888, 889, 890, 10'240};

TEST(SdoBlockUpload, CarriesEveryLengthWithAndWithoutCrc) {
  for (const bool crc : {false, true}) {
    NodeBench bench;
    bench.boot();
    SdoClient client(bench);
    for (const std::size_t length : kLengths) {
      const std::string text = pattern(length);
      bench.dictionary.find(0x1021, 0)->set_text(text);
      EXPECT_EQ(client.block_upload(0x1021, crc), text) << length << " bytes";
      EXPECT_EQ(client.checksum, crc ? checksum_of(text) : 0) << length << " bytes";
    }
  }
}

TEST(SdoBlockUpload, WorksWithEveryBlockSize) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  const std::string text = pattern(2000);
  bench.dictionary.find(0x1021, 0)->set_text(text);
  for (const unsigned block_size : {1U, 2U, 3U, 64U, 126U, 127U}) {
    EXPECT_EQ(client.block_upload(0x1021, true, {}, block_size), text);
  }
}

TEST(SdoBlockUpload, RepeatsWhatWasLost_WhereverInTheBlock) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  const std::string text = pattern(10'240);  // 1463 segments in blocks of 127
  bench.dictionary.find(0x1021, 0)->set_text(text);
  for (const std::size_t lost : {1U, 2U, 60U, 126U, 127U, 128U, 1462U, 1463U}) {
    EXPECT_EQ(client.block_upload(0x1021, true, {lost}), text) << "segment " << lost << " lost";
  }
  EXPECT_EQ(client.block_upload(0x1021, true, {1, 5, 128, 130, 700}), text);
}

TEST(SdoBlockUpload, EmptyTextWhoseOnlySegmentIsLost_IsRepeated) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  bench.dictionary.find(0x1021, 0)->set_text("");
  EXPECT_EQ(client.block_upload(0x1021, true, {1}), "");
}

TEST(SdoBlockUpload, Frames_AreThoseOfTheStandard) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0xA4, 0x08, 0x10, 0, 1, 0, 0, 0}), Texts{"585 [C6 08 10 00 0C 00 00 00]"});
  EXPECT_EQ(ask(bench, {0xA3, 0, 0, 0, 0, 0, 0, 0}), Texts{"585 [01 42 65 6E 63 68 20 6E]"});
  EXPECT_EQ(ask(bench, {0xA2, 1, 127, 0, 0, 0, 0, 0}), Texts{"585 [81 6F 64 65 20 31 00 00]"});
  const Texts end = ask(bench, {0xA2, 1, 127, 0, 0, 0, 0, 0});
  const unsigned crc = checksum_of("Bench node 1");
  EXPECT_EQ(end,
            Texts{to_text(can::data_frame(0x585, {0xC9, crc & 0xFF, crc >> 8, 0, 0, 0, 0, 0}))});
  EXPECT_EQ(ask(bench, {0xA1, 0, 0, 0, 0, 0, 0, 0}), Texts{});
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
}

TEST(SdoBlockUpload, BlockSizeOfTheNextBlock_MustBePossible) {
  NodeBench bench;
  bench.boot();
  for (const unsigned size : {0U, 128U}) {
    ask(bench, {0xA4, 0x08, 0x10, 0, 1, 0, 0, 0});
    ask(bench, {0xA3, 0, 0, 0, 0, 0, 0, 0});
    EXPECT_EQ(ask(bench, {0xA2, 1, size, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kInvalidBlockSize));
  }
}

TEST(SdoBlockUpload, AcknowledgeOfMoreThanWasSent_IsAnInvalidSequenceNumber) {
  NodeBench bench;
  bench.boot();
  for (const unsigned acknowledged : {3U, 127U, 128U, 255U}) {
    ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0});
    EXPECT_EQ(ask(bench, {0xA3, 0, 0, 0, 0, 0, 0, 0}).size(), 2U);
    EXPECT_EQ(ask(bench, {0xA2, acknowledged, 127, 0, 0, 0, 0, 0}),
              aborted(0x1008, 0, kInvalidSequence));
  }
}

TEST(SdoBlockTransfer, DeviceWithoutIt_RefusesItInBothDirections) {
  NodeConfiguration configuration = bench_configuration();
  configuration.sdo.block_transfer = false;
  NodeBench bench(configuration);
  bench.boot();
  EXPECT_EQ(ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0}), aborted(0x1008, 0, kUnknownCommand));
  EXPECT_EQ(ask(bench, {0xC6, 0x04, 0x20, 0, 9, 0, 0, 0}), aborted(0x2004, 0, kUnknownCommand));
  EXPECT_TRUE(bench.events.tells(
      "SDO block transfer of 2004h:00h refused: this device does not support it"));
}

TEST(SdoBlockTransfer, DeviceWithTheQuirk_RefusesItAndTakesSegments) {
  NodeConfiguration configuration = bench_configuration();
  configuration.quirks.no_block_transfer = true;
  NodeBench bench(configuration);
  bench.boot();
  EXPECT_EQ(ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0}), aborted(0x1008, 0, kUnknownCommand));
  EXPECT_EQ(ask(bench, {0xC6, 0x04, 0x20, 0, 9, 0, 0, 0}), aborted(0x2004, 0, kUnknownCommand));
  EXPECT_EQ(ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}), Texts{"585 [41 08 10 00 0C 00 00 00]"});
}

TEST(SdoBlockUpload, RequestOutOfOrder_IsRefused) {
  NodeBench bench;
  bench.boot();
  for (const unsigned request : {0xA1U, 0xA2U, 0xA3U}) {
    EXPECT_EQ(ask(bench, {request, 0, 127, 0, 0, 0, 0, 0}), aborted(0, 0, kUnknownCommand));
    ask(bench, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
    EXPECT_EQ(ask(bench, {request, 0, 127, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kUnknownCommand));
  }
  ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0xA2, 0, 127, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kUnknownCommand));
}

TEST(SdoBlockUpload, SilentClient_IsToldTheTimeOutAtEveryPoint) {
  NodeBench bench;
  bench.boot();
  const auto expect_time_out = [&] {
    bench.wait(1_s);
    EXPECT_EQ(to_text(bench.take()), aborted(0x1008, 0, kTimedOut));
  };
  ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0});
  expect_time_out();
  ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0});
  ask(bench, {0xA3, 0, 0, 0, 0, 0, 0, 0});
  expect_time_out();
  ask(bench, {0xA4, 0x08, 0x10, 0, 127, 0, 0, 0});
  ask(bench, {0xA3, 0, 0, 0, 0, 0, 0, 0});
  ask(bench, {0xA2, 2, 127, 0, 0, 0, 0, 0});
  expect_time_out();
}

TEST(SdoBlockUpload, FullTransmitBuffer_HoldsTheBlockBackWithoutLoss) {
  NodeBench bench;
  bench.boot();
  const std::string text = pattern(500);
  bench.dictionary.find(0x1021, 0)->set_text(text);
  ask(bench, {0xA0, 0x21, 0x10, 0, 127, 0, 0, 0});
  bench.transmitter.set_room(42);  // 32 stay free for other services
  bench.receive(kRequest, {0xA3, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(bench.take().size(), 10U);
  bench.transmitter.set_room(1000);
  bench.wait(1_ms);
  const std::vector<can::Frame> rest = bench.take();
  ASSERT_EQ(rest.size(), 62U);
  EXPECT_EQ(rest.front().data[0], std::byte{11});
  EXPECT_EQ(rest.back().data[0], std::byte{0x80 | 72});
}

TEST(SdoBlockUpload, AcknowledgeBeforeTheBlocksEnd_GoesOnBehindIt) {
  NodeBench bench;
  bench.boot();
  bench.dictionary.find(0x1021, 0)->set_text(pattern(500));
  ask(bench, {0xA0, 0x21, 0x10, 0, 127, 0, 0, 0});
  bench.transmitter.set_room(42);
  bench.receive(kRequest, {0xA3, 0, 0, 0, 0, 0, 0, 0});
  bench.take();
  bench.transmitter.set_room(1000);
  const std::string expected = pattern(500).substr(14, 7);
  bench.receive(kRequest, {0xA2, 2, 1, 0, 0, 0, 0, 0});
  const std::vector<can::Frame> next = bench.take();
  ASSERT_EQ(next.size(), 1U);
  EXPECT_EQ(next[0].data[0], std::byte{1});
  EXPECT_EQ(next[0].data[1], static_cast<std::byte>(expected[0]));
}

TEST(SdoBlockUpload, TextThatChangesItsLength_AbortsTheTransfer) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0xA4, 0x08, 0x10, 0, 1, 0, 0, 0});
  ask(bench, {0xA3, 0, 0, 0, 0, 0, 0, 0});
  bench.dictionary.find(0x1008, 0)->set_text("longer than it was");
  EXPECT_EQ(ask(bench, {0xA2, 1, 1, 0, 0, 0, 0, 0}), aborted(0x1008, 0, kDeviceState));
}

TEST(SdoBlockUpload, ProtocolSwitchThreshold_IsHonouredOnlyIfConfigured) {
  NodeBench plain;
  plain.boot();
  EXPECT_EQ(ask(plain, {0xA4, 0x00, 0x10, 0, 127, 20, 0, 0}),
            Texts{"585 [C6 00 10 00 04 00 00 00]"});
  NodeConfiguration configuration = bench_configuration();
  configuration.sdo.honour_protocol_switch_threshold = true;
  NodeBench bench(configuration);
  bench.boot();
  EXPECT_EQ(ask(bench, {0xA4, 0x00, 0x10, 0, 127, 20, 0, 0}),
            Texts{"585 [43 00 10 00 92 01 02 00]"});
  EXPECT_EQ(ask(bench, {0xA4, 0x08, 0x10, 0, 127, 12, 0, 0}),
            Texts{"585 [41 08 10 00 0C 00 00 00]"});
  EXPECT_EQ(ask(bench, {0xA4, 0x08, 0x10, 0, 127, 11, 0, 0}),
            Texts{"585 [C6 08 10 00 0C 00 00 00]"});
  EXPECT_EQ(ask(bench, {0xA4, 0x00, 0x10, 0, 127, 0, 0, 0}),
            Texts{"585 [C6 00 10 00 04 00 00 00]"});
}

TEST(SdoBlockDownload, CarriesEveryLengthWithAndWithoutCrcAndAnnouncedSize) {
  for (const bool crc : {false, true}) {
    for (const bool announce : {true, false}) {
      NodeBench bench;
      bench.boot();
      SdoClient client(bench);
      for (const std::size_t length : kLengths) {
        const std::string text = pattern(length);
        client.checksum = crc ? checksum_of(text) : 0;
        client.block_download(0x2004, text, crc, {}, announce);
        EXPECT_EQ(client.abort_code, 0U);
        EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), text) << length << " bytes";
      }
    }
  }
}

TEST(SdoBlockDownload, AsksAgainForWhatWasLost_WhereverInTheBlock) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  const std::string text = pattern(10'240);
  client.checksum = checksum_of(text);
  const std::vector<std::vector<std::size_t>> losses{
      {1}, {2}, {60}, {126}, {127}, {128}, {1462}, {1463}, {1, 5, 128, 130, 700}};
  for (const std::vector<std::size_t>& lost : losses) {
    bench.dictionary.find(0x2004, 0)->set_text("");
    client.block_download(0x2004, text, true, lost);
    EXPECT_EQ(client.abort_code, 0U);
    EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), text) << "segment " << lost[0] << " lost";
  }
}

TEST(SdoBlockDownload, BlockSize_IsTheConfiguredOne) {
  NodeConfiguration configuration = bench_configuration();
  configuration.sdo.block_size = 2;
  NodeBench bench(configuration);
  bench.boot();
  EXPECT_EQ(ask(bench, {0xC6, 0x04, 0x20, 0, 15, 0, 0, 0}), Texts{"585 [A4 04 20 00 02 00 00 00]"});
  EXPECT_EQ(ask(bench, {1, 'a', 'b', 'c', 'd', 'e', 'f', 'g'}), Texts{});
  EXPECT_EQ(ask(bench, {2, 'h', 'i', 'j', 'k', 'l', 'm', 'n'}),
            Texts{"585 [A2 02 02 00 00 00 00 00]"});
  EXPECT_EQ(ask(bench, {0x81, 'o', 0, 0, 0, 0, 0, 0}), Texts{"585 [A2 01 02 00 00 00 00 00]"});
  const unsigned crc = checksum_of("abcdefghijklmno");
  EXPECT_EQ(ask(bench, {0xD9, crc & 0xFF, crc >> 8, 0, 0, 0, 0, 0}),
            Texts{"585 [A1 00 00 00 00 00 00 00]"});
  EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), "abcdefghijklmno");
}

TEST(SdoBlockDownload, WrongCrc_AbortsAndWritesNothing) {
  NodeBench bench;
  bench.boot();
  SdoClient client(bench);
  client.checksum = static_cast<std::uint16_t>(checksum_of("some text") ^ 1U);
  client.block_download(0x2004, "some text", true);
  EXPECT_EQ(client.abort_code, kCrcError);
  EXPECT_EQ(bench.dictionary.find(0x2004, 0)->text(), "nobody");
  client.block_download(0x2004, "some text", false);
  EXPECT_EQ(client.abort_code, 0U);
}

TEST(SdoBlockDownload, ImpossibleSequenceNumber_Aborts) {
  NodeConfiguration configuration = bench_configuration();
  configuration.sdo.block_size = 4;
  NodeBench bench(configuration);
  bench.boot();
  for (const unsigned number : {0U, 5U, 0x85U}) {
    ask(bench, {0xC2, 0x04, 0x20, 0, 9, 0, 0, 0});
    EXPECT_EQ(ask(bench, {number, 0, 0, 0, 0, 0, 0, 0}), aborted(0x2004, 0, kInvalidSequence));
  }
}

TEST(SdoBlockDownload, RefusalOfData_WaitsForTheEndOfTheBlock) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0xC0, 0x01, 0x20, 0, 0, 0, 0, 0});  // two bytes long, not announced
  EXPECT_EQ(ask(bench, {1, 0, 0, 0, 0, 0, 0, 0}), Texts{});
  EXPECT_EQ(ask(bench, {2, 0, 0, 0, 0, 0, 0, 0}), Texts{});
  EXPECT_EQ(ask(bench, {0x83, 0, 0, 0, 0, 0, 0, 0}), aborted(0x2001, 0, kTooLong));
}

TEST(SdoBlockDownload, LengthOtherThanAnnounced_Aborts) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0xC2, 0x04, 0x20, 0, 9, 0, 0, 0});
  ask(bench, {1, 0, 0, 0, 0, 0, 0, 0});
  ask(bench, {0x82, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0xD1, 0, 0, 0, 0, 0, 0, 0}), aborted(0x2004, 0, kTooLong));
  ask(bench, {0xC2, 0x04, 0x20, 0, 9, 0, 0, 0});
  ask(bench, {0x81, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0xC1, 0, 0, 0, 0, 0, 0, 0}), aborted(0x2004, 0, kTooShort));
}

TEST(SdoBlockDownload, IsRefusedAtTheBeginWhereTheObjectDoesNotTakeIt) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0xC2, 0x00, 0x10, 0, 4, 0, 0, 0}), aborted(0x1000, 0, kReadOnly));
  EXPECT_EQ(ask(bench, {0xC2, 0x01, 0x20, 0, 4, 0, 0, 0}), aborted(0x2001, 0, kTooLong));
  EXPECT_EQ(ask(bench, {0xC2, 0x99, 0x20, 0, 4, 0, 0, 0}), aborted(0x2099, 0, kNoObject));
}

TEST(SdoBlockDownload, AbortByTheClientBetweenSegments_EndsTheTransfer) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0xC2, 0x04, 0x20, 0, 9, 0, 0, 0});
  ask(bench, {1, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(ask(bench, {0x80, 0x04, 0x20, 0, 0, 0, 4, 5}), Texts{});
  EXPECT_EQ(bench.node.next_deadline(), base::SimTime::never());
  EXPECT_EQ(ask(bench, {0x40, 0x00, 0x20, 0, 0, 0, 0, 0}).size(), 1U);
}

TEST(SdoBlockDownload, LostEndOfABlock_IsAcknowledgedAfterHalfTheTimeOut) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0xC2, 0x04, 0x20, 0, 21, 0, 0, 0});
  ask(bench, {1, 0, 0, 0, 0, 0, 0, 0});
  bench.wait(499_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{});
  bench.wait(1_ms);
  EXPECT_EQ(to_text(bench.take()), Texts{"585 [A2 01 7F 00 00 00 00 00]"});
  bench.wait(1_s);
  EXPECT_EQ(to_text(bench.take()), aborted(0x2004, 0, kTimedOut));
}

TEST(SdoBlockDownload, SilentClient_IsToldTheTimeOut) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0xC2, 0x04, 0x20, 0, 9, 0, 0, 0});
  bench.wait(1_s);
  EXPECT_EQ(to_text(bench.take()), aborted(0x2004, 0, kTimedOut));
  ask(bench, {0xC2, 0x04, 0x20, 0, 7, 0, 0, 0});
  ask(bench, {0x81, 0, 0, 0, 0, 0, 0, 0});
  bench.wait(1_s);
  EXPECT_EQ(to_text(bench.take()), aborted(0x2004, 0, kTimedOut));
}

}  // namespace
}  // namespace stator::canopen
