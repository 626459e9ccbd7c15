// Cases of the CiA conformance test, group 2: SDO. Numbers are those of the test tool.

#include <gtest/gtest.h>

#include "canopen/conformance_device.hpp"

namespace stator::canopen::test {
namespace {

using Message = ConformanceDevice::Message;

constexpr std::uint8_t kId = kNodeId;

/// A request and the one answer to it.
struct Exchange {
  const char* number;
  const char* about;
  Message request;
  Message answer;
};

Message aborted(std::uint16_t index, std::uint8_t subindex, std::uint32_t code) {
  return {0x80,
          static_cast<std::uint8_t>(index & 0xFFU),
          static_cast<std::uint8_t>(index >> 8U),
          subindex,
          static_cast<std::uint8_t>(code & 0xFFU),
          static_cast<std::uint8_t>(code >> 8U & 0xFFU),
          static_cast<std::uint8_t>(code >> 16U & 0xFFU),
          static_cast<std::uint8_t>(code >> 24U)};
}

const Exchange kExchanges[] = {
    {"2.01", "expedited read", {0x40, 0x00, 0x10}, {0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00}},
    {"2.03", "write read-only", {0x23, 0x00, 0x10}, aborted(0x1000, 0, 0x06010002)},
    {"2.04", "read write-only", {0x40, 0x22, 0x20}, aborted(0x2022, 0, 0x06010001)},
    {"2.05", "no such sub-index", {0x40, 0x00, 0x10, 1}, aborted(0x1000, 1, 0x06090011)},
    {"2.06", "no such object", {0x40, 0x04, 0x10}, aborted(0x1004, 0, 0x06020000)},
    {"2.07", "unknown command", {0xE0, 0x00, 0x10}, aborted(0x1000, 0, 0x05040001)},
    {"2.08a", "too long for a byte", {0x23, 0x0D, 0x10}, aborted(0x100D, 0, 0x06070012)},
    {"2.08b", "too long for a word", {0x23, 0x0C, 0x10}, aborted(0x100C, 0, 0x06070012)},
    {"2.09a", "too short for a word", {0x2F, 0x0C, 0x10}, aborted(0x100C, 0, 0x06070013)},
    {"2.09b", "too short for a long", {0x2F, 0x05, 0x10}, aborted(0x1005, 0, 0x06070013)},
    {"2.10", "above the maximum", {0x2B, 0x21, 0x20, 0, 31}, aborted(0x2021, 0, 0x06090031)},
    {"2.11", "below the minimum", {0x2B, 0x21, 0x20, 0, 9}, aborted(0x2021, 0, 0x06090032)},
    {"2.12a", "COB-ID to server", {0x40, 0x00, 0x12, 1}, {0x43, 0, 0x12, 1, 0x00 + kId, 0x06}},
    {"2.12b", "COB-ID to client", {0x40, 0x00, 0x12, 2}, {0x43, 0, 0x12, 2, 0x80 + kId, 0x05}},
    {"2.28", "second server", {0x40, 0x01, 0x12}, aborted(0x1201, 0, 0x06020000)},
    {"2.30", "SDO client", {0x40, 0x80, 0x12}, aborted(0x1280, 0, 0x06020000)},
};

TEST(ConformanceCase, Case2_SingleRequests_HaveThePreciseAnswer) {
  ConformanceDevice device;
  for (const Exchange& exchange : kExchanges) {
    EXPECT_EQ(device.exchange(exchange.request), exchange.answer)
        << exchange.number << ": " << exchange.about;
  }
}

TEST(ConformanceCase, Case2_29_ResetCommunication_LeavesTheServerWhereItWas) {
  ConformanceDevice device;
  device.nmt(NmtCommand::reset_communication);
  device.wait(base::SimDuration(100'000'000));
  for (const Exchange& exchange : kExchanges) {
    EXPECT_EQ(device.exchange(exchange.request), exchange.answer)
        << exchange.number << ": " << exchange.about;
  }
}

/// What the device refuses although its object can be written.
std::uint32_t expected_of_write_back(std::uint16_t index, std::uint8_t subindex) {
  if (index == 0x1010 || index == 0x1011) {
    return 0x08000020;  // no signature
  }
  const bool mapping = (index & 0xFE00) == 0x1600 || (index & 0xFE00) == 0x1A00;
  const bool invalid = (index & 0x1FF) == 4;  // the fifth PDOs do not exist
  static_cast<void>(subindex);
  return mapping && !invalid ? 0x06010000 : 0;
}

TEST(ConformanceCase, Case2_02_EveryCommunicationObject_TakesTheValueItHas) {
  ConformanceDevice device;
  for (const dictionary::Entry& entry : device.dictionary.entries()) {
    if (entry.index() >= 0x2000 || !entry.writable()) {
      continue;
    }
    const std::uint32_t value = device.upload_number(entry.index(), entry.subindex());
    EXPECT_EQ(device.download(entry.index(), entry.subindex(), value),
              expected_of_write_back(entry.index(), entry.subindex()))
        << std::hex << entry.index() << ":" << int{entry.subindex()};
    EXPECT_EQ(device.upload_number(entry.index(), entry.subindex()), value);
  }
}

TEST(ConformanceCase, Case2_13_ShortValueForASegmentedClient_ComesExpedited) {
  ConformanceDevice device;
  EXPECT_EQ(device.upload(0x1000, 0).bytes, (std::string{'\x92', '\x01', '\x02', '\x00'}));
}

TEST(ConformanceCase, Case2_14_15_TwoBytes_CanBeWrittenSegmented) {
  ConformanceDevice device;
  EXPECT_EQ(device.download_segmented(0x100C, 0, std::string_view("\x34\x12", 2)), 0U);
  EXPECT_EQ(device.upload_number(0x100C, 0), 0x1234U);
  EXPECT_EQ(device.download_segmented(0x1017, 0, std::string_view("\xE8\x03", 2)), 0U);
  EXPECT_EQ(device.upload_number(0x1017, 0), 1000U);
}

TEST(ConformanceCase, Case2_16_18_Text_IsReadAndWrittenSegmented) {
  ConformanceDevice device;
  EXPECT_EQ(device.upload(0x1008, 0).bytes, "Full-featured test device");
  EXPECT_EQ(device.download_segmented(0x2023, 0, "fourteen bytes"), 0U);
  EXPECT_EQ(device.upload(0x2023, 0).bytes, "fourteen bytes");
}

TEST(ConformanceCase, Case2_17_WrongToggle_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(device.exchange({0x40, 0x08, 0x10, 0})[0], 0x41);
  EXPECT_EQ(device.exchange({0x60})[0] & 0xF1, 0x00);
  EXPECT_EQ(ConformanceDevice::abort_of(device.exchange({0x60})), 0x05030000U);
  EXPECT_EQ(device.exchange({0x21, 0x23, 0x20, 0, 20})[0], 0x60);
  EXPECT_EQ(ConformanceDevice::abort_of(device.exchange({0x10, 'a', 'b', 'c', 'd', 'e', 'f', 'g'})),
            0x05030000U);
}

TEST(ConformanceCase, Case2_19_22_Block_IsReadWithAndWithoutCrc) {
  ConformanceDevice device;
  for (const bool with_crc : {false, true}) {
    EXPECT_EQ(device.upload_block(0x1000, 0, with_crc).bytes,
              (std::string{'\x92', '\x01', '\x02', '\x00'}));
    EXPECT_EQ(device.upload_block(0x1008, 0, with_crc).bytes, "Full-featured test device");
  }
}

TEST(ConformanceCase, Case2_23_25_Block_IsWrittenWithAndWithoutCrc) {
  ConformanceDevice device;
  const std::string text(2000, 'x');
  for (const bool with_crc : {false, true}) {
    EXPECT_EQ(device.download_block(0x100C, 0, std::string_view("\x34\x12", 2), with_crc), 0U);
    EXPECT_EQ(device.upload_number(0x100C, 0), 0x1234U);
    EXPECT_EQ(device.download_block(0x2023, 0, text, with_crc), 0U);
    EXPECT_EQ(device.upload(0x2023, 0).bytes, text);
  }
}

TEST(ConformanceCase, Case2_26_BlockSizeAbove127_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(ConformanceDevice::abort_of(device.exchange({0xA4, 0x08, 0x10, 0, 128, 0, 0, 0})),
            0x05040002U);
}

TEST(ConformanceCase, Case2_27_AcknowledgedSequenceAboveTheLast_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(device.exchange({0xA0, 0x08, 0x10, 0, 127, 0, 0, 0})[0] & 0xE0, 0xC0);
  device.exchange({0xA3});
  device.wait(base::SimDuration(10'000'000));
  device.take_sent();
  EXPECT_EQ(ConformanceDevice::abort_of(device.exchange({0xA2, 128, 127})), 0x05040003U);
}

}  // namespace
}  // namespace stator::canopen::test
