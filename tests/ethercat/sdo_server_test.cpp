// SDO transfers of CoE: expedited, normal and segmented, refusals, mailboxes from the smallest on.
#include "stator/ethercat/stack/sdo_server.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using dictionary::AbortCode;
using testing::HasSubstr;

class SdoServerTest : public StackFixture {
 protected:
  explicit SdoServerTest(std::uint16_t mailbox_length = 128)
      : StackFixture(with_mailbox(mailbox_length)) {
    go_pre_operational();
  }
  static DeviceDescription with_mailbox(std::uint16_t length) {
    DeviceDescription description = test_description();
    description.receive_mailbox = {0x1000, length};
    description.transmit_mailbox = {static_cast<std::uint16_t>(0x1000 + length), length};
    return description;
  }
  void expect_abort(std::string_view request, AbortCode code) {
    const Bytes reply = sdo(request);
    EXPECT_EQ(to_hex(part(reply, 0, 4)), "80 " + to_hex(part(hex(request), 1, 3))) << request;
    EXPECT_EQ(abort_code(reply), static_cast<std::uint32_t>(code)) << request;
  }
  /// Reads a whole value by initiate and segments; empty if it was aborted.
  Bytes upload(std::uint16_t index, std::uint8_t subindex, bool complete = false) {
    const Bytes reply = sdo(concat(
        {{static_cast<std::byte>(complete ? 0x50 : 0x40)}, le(index), le(subindex), Bytes(4)}));
    const auto command = std::to_integer<unsigned>(reply[0]);
    if ((command & 0xE2) == 0x42) {
      return part(reply, 4, 4 - (command >> 2 & 3));
    }
    if ((command & 0xE3) != 0x41) {
      return {};
    }
    const std::size_t size = base::load_le<std::uint32_t>(reply, 4);
    Bytes value = part(reply, 8);
    for (unsigned toggle = 0; value.size() < size; toggle ^= 0x10) {
      const Bytes segment = sdo(concat({{static_cast<std::byte>(0x60 | toggle)}, Bytes(7)}));
      const auto head = std::to_integer<unsigned>(segment[0]);
      EXPECT_EQ(head & 0xF0, toggle);
      const std::size_t unused = head >> 1 & 7;
      const Bytes data = part(segment, 1, segment.size() - 1 - unused);
      value = concat({value, data});
      EXPECT_EQ(head & 1, value.size() == size ? 1U : 0U);
    }
    return value;
  }
  /// Writes `value` by normal or segmented download with `per_message` bytes at most per mailbox.
  Bytes download(std::uint16_t index, std::uint8_t subindex, const Bytes& value,
                 std::size_t per_message, bool complete = false) {
    const std::size_t first = std::min(value.size(), per_message);
    Bytes reply = sdo(concat({{static_cast<std::byte>(complete ? 0x31 : 0x21)},
                              le(index),
                              le(subindex),
                              le(static_cast<std::uint32_t>(value.size())),
                              part(value, 0, first)}));
    unsigned toggle = 0;
    for (std::size_t at = first; at < value.size() && abort_code(reply) == 0; toggle ^= 0x10) {
      const std::size_t size = std::min(value.size() - at, per_message + 7);
      const std::size_t unused = size < 7 ? 7 - size : 0;
      const unsigned last = at + size == value.size() ? 1 : 0;
      reply = sdo(concat({{static_cast<std::byte>(toggle | unused << 1 | last)},
                          part(value, at, size),
                          Bytes(unused)}));
      if (abort_code(reply) == 0) {
        EXPECT_EQ(std::to_integer<unsigned>(reply[0]), 0x20 | toggle);
      }
      at += size;
    }
    return reply;
  }
};

TEST_F(SdoServerTest, IdentityReads_AreAnsweredToTheByte) {
  const std::pair<const char*, const char*> vectors[] = {
      {"40 00 10 00 00 00 00 00", "43 00 10 00 92 01 FC FF"},
      {"40 01 10 00 00 00 00 00", "4F 01 10 00 00 00 00 00"},
      {"40 18 10 00 00 00 00 00", "4F 18 10 00 03 00 00 00"},
      {"40 18 10 01 00 00 00 00", "43 18 10 01 86 02 00 00"},
      {"40 18 10 02 00 00 00 00", "43 18 10 02 F3 0C 00 00"},
      {"40 00 16 00 00 00 00 00", "4F 00 16 00 09 00 00 00"},
      {"40 00 16 01 00 00 00 00", "43 00 16 01 10 00 40 60"},
      {"40 00 1A 02 00 00 00 00", "43 00 1A 02 20 00 64 60"},
      {"40 12 1C 01 00 00 00 00", "4B 12 1C 01 00 16 00 00"},
      {"40 00 20 00 00 00 00 00", "4F 00 20 00 08 00 00 00"},
      {"40 03 20 00 00 00 00 00", "4F 03 20 00 80 00 00 00"},
      {"40 08 10 00 00 00 00 00", "41 08 10 00 09 00 00 00 54 4D 43 4D 2D 33 33 31 35"},
  };
  for (const auto& [request, reply] : vectors) {
    EXPECT_EQ(to_hex(sdo(request)), reply);
  }
}

TEST_F(SdoServerTest, ExpeditedWrites_OfTheWorkedExamples_AreConfirmedAndStored) {
  EXPECT_EQ(to_hex(sdo("2F 03 20 00 55 00 00 00")), "60 03 20 00 00 00 00 00");
  EXPECT_EQ(value(0x2003), 0x55U);
  EXPECT_EQ(to_hex(sdo("23 7A 60 00 20 A1 07 00")), "60 7A 60 00 00 00 00 00");
  EXPECT_EQ(value(0x607A), 500000U);
  EXPECT_EQ(to_hex(sdo("2B 40 60 00 0F 00 00 00")), "60 40 60 00 00 00 00 00");
  EXPECT_EQ(value(0x6040), 15U);
}

TEST_F(SdoServerTest, ExpeditedWriteWithoutSize_TakesTheSizeOfTheObject) {
  EXPECT_EQ(to_hex(sdo("22 40 60 00 07 00 FF FF")), "60 40 60 00 00 00 00 00");
  EXPECT_EQ(value(0x6040), 7U);
}

TEST_F(SdoServerTest, NormalWrite_OfAShortValue_IsTaken) {
  EXPECT_EQ(to_hex(sdo("21 40 60 00 02 00 00 00 0F 00")), "60 40 60 00 00 00 00 00");
  EXPECT_EQ(value(0x6040), 15U);
}

TEST_F(SdoServerTest, EmptyText_IsUploadedWithSizeZero) {
  EXPECT_EQ(to_hex(sdo("40 12 20 00 00 00 00 00")), "41 12 20 00 00 00 00 00");
}

TEST_F(SdoServerTest, ThreeByteText_IsExpeditedWithOneUnusedByte) {
  EXPECT_EQ(to_hex(sdo("40 11 20 00 00 00 00 00")), "47 11 20 00 61 62 63 00");
}

TEST_F(SdoServerTest, Refusals_CarryTheirAbortCode) {
  expect_abort("40 FF 2F 00 00 00 00 00", AbortCode::object_does_not_exist);
  expect_abort("2F FF 2F 00 00 00 00 00", AbortCode::object_does_not_exist);
  expect_abort("40 18 10 04 00 00 00 00", AbortCode::subindex_does_not_exist);
  expect_abort("40 00 20 01 00 00 00 00", AbortCode::subindex_does_not_exist);
  expect_abort("40 20 20 05 00 00 00 00", AbortCode::subindex_does_not_exist);
  expect_abort("23 00 10 00 00 00 00 00", AbortCode::read_only);
  expect_abort("21 08 10 00 09 00 00 00 54 4D 43 4D 2D 33 33 31 35", AbortCode::read_only);
  expect_abort("40 10 20 00 00 00 00 00", AbortCode::write_only);
  expect_abort("2F 40 60 00 07 00 00 00", AbortCode::length_too_low);
  expect_abort("23 40 60 00 07 00 00 00", AbortCode::length_too_high);
  expect_abort("2F 00 20 00 09 00 00 00", AbortCode::value_too_high);
  expect_abort("23 05 20 00 01 00 00 00", AbortCode::value_too_low);
  expect_abort("2F 60 60 00 63 00 00 00", AbortCode::value_range_exceeded);
  EXPECT_EQ(stack.statistics().sdo_aborts, 13U);
}

TEST_F(SdoServerTest, RefusedWrite_RaisesASentence) {
  sdo("2F 00 20 00 09 00 00 00");
  EXPECT_THAT(log.last("od-too-high"), HasSubstr("9 is above the maximum 8"));
}

TEST_F(SdoServerTest, WriteBoundToPreOperational_IsRefusedInHigherStates) {
  EXPECT_EQ(abort_code(sdo("2B 14 20 00 01 00 00 00")), 0U);
  configure_process_data();
  request(0x04);
  expect_abort("2B 14 20 00 02 00 00 00", AbortCode::device_state);
  request(0x08);
  expect_abort("2B 14 20 00 02 00 00 00", AbortCode::device_state);
  EXPECT_EQ(value(0x2014), 1U);
}

TEST_F(SdoServerTest, BlockTransferAndUnknownSpecifiers_AreRefusedWith05040001h) {
  expect_abort("A0 00 10 00 00 00 00 00", AbortCode::command_specifier_unknown);
  expect_abort("C0 00 20 00 00 00 00 00", AbortCode::command_specifier_unknown);
  expect_abort("E0 00 10 00 00 00 00 00", AbortCode::command_specifier_unknown);
  expect_abort("20 00 20 00 01 00 00 00", AbortCode::command_specifier_unknown);
}

TEST_F(SdoServerTest, SegmentsWithoutATransfer_AreRefused) {
  const auto code = static_cast<std::uint32_t>(AbortCode::command_specifier_unknown);
  EXPECT_EQ(abort_code(sdo("60 00 00 00 00 00 00 00")), code);
  EXPECT_EQ(abort_code(sdo("01 00 00 00 00 00 00 00")), code);
}

TEST_F(SdoServerTest, AbortOfTheMaster_IsNotAnsweredAndEndsTheTransfer) {
  sdo("21 11 20 00 C8 00 00 00 41");
  EXPECT_TRUE(sdo("80 11 20 00 00 00 04 05").empty());
  EXPECT_EQ(abort_code(sdo("00 41 41 41 41 41 41 41")),
            static_cast<std::uint32_t>(AbortCode::command_specifier_unknown));
}

TEST_F(SdoServerTest, SameToggleTwice_EndsTheTransfer) {
  sdo("50 00 30 00 00 00 00 00");
  sdo("60 00 00 00 00 00 00 00");
  const Bytes reply = sdo("60 00 00 00 00 00 00 00");
  EXPECT_EQ(to_hex(reply), "80 00 30 00 00 00 03 05");
  EXPECT_EQ(abort_code(sdo("70 00 00 00 00 00 00 00")),
            static_cast<std::uint32_t>(AbortCode::command_specifier_unknown));
}

TEST_F(SdoServerTest, WrongToggleInDownload_EndsTheTransfer) {
  sdo("21 11 20 00 10 00 00 00 41");
  EXPECT_EQ(to_hex(sdo("10 41 41 41 41 41 41 41")), "80 11 20 00 00 00 03 05");
}

TEST_F(SdoServerTest, AbandonedSegmentedUpload_DoesNotDisturbWhatFollows) {
  const Bytes whole = upload(0x3000, 0, true);
  sdo("50 00 30 00 00 00 00 00");
  sdo("60 00 00 00 00 00 00 00");
  EXPECT_EQ(to_hex(sdo("40 00 10 00 00 00 00 00")), "43 00 10 00 92 01 FC FF");
  EXPECT_EQ(upload(0x3000, 0, true), whole);
  sdo("50 00 30 00 00 00 00 00");
  EXPECT_EQ(to_hex(sdo("2F 03 20 00 55 00 00 00")), "60 03 20 00 00 00 00 00");
}

TEST_F(SdoServerTest, LongDownloads_AreCheckedBeforeTheirSegmentsCome) {
  expect_abort("21 00 10 00 C8 00 00 00", AbortCode::read_only);
  expect_abort("21 03 20 00 C8 00 00 00", AbortCode::length_too_high);
  expect_abort("21 13 20 00 07 00 00 00", AbortCode::length_too_low);
  expect_abort("21 11 20 00 FF FF FF FF", AbortCode::length_too_high);
  expect_abort("21 FF 2F 00 C8 00 00 00", AbortCode::object_does_not_exist);
  expect_abort("31 00 20 00 C8 00 00 00", AbortCode::unsupported_access);
}

TEST_F(SdoServerTest, SegmentsBeyondTheAnnouncedSize_AreRefused) {
  sdo("21 11 20 00 09 00 00 00 41 42 43");
  EXPECT_EQ(abort_code(sdo("01 44 45 46 47 48 49 4A")),
            static_cast<std::uint32_t>(AbortCode::length_too_high));
  EXPECT_EQ(dictionary.find(0x2011, 0)->text(), "abc");
}

TEST_F(SdoServerTest, LastSegmentTooEarly_IsRefused) {
  sdo("21 11 20 00 20 00 00 00 41 42 43");
  EXPECT_EQ(abort_code(sdo("01 44 45 46 47 48 49 4A")),
            static_cast<std::uint32_t>(AbortCode::length_too_low));
  EXPECT_EQ(dictionary.find(0x2011, 0)->text(), "abc");
}

/// The same transfers through mailboxes from the smallest possible to a large one.
class MailboxLengths : public SdoServerTest, public testing::WithParamInterface<int> {
 protected:
  MailboxLengths() : SdoServerTest(static_cast<std::uint16_t>(GetParam())) {}
};

TEST_P(MailboxLengths, TextsOfEveryLength_AreWrittenAndReadBack) {
  const std::size_t room = static_cast<std::size_t>(GetParam()) - 16;
  for (std::size_t length = 1; length <= 300; length += length < 40 ? 1 : 37) {
    Bytes text(length);
    for (std::size_t i = 0; i < length; ++i) {
      text[i] = static_cast<std::byte>('A' + i % 26);
    }
    const Bytes reply = download(0x2011, 0, text, room);
    ASSERT_EQ(abort_code(reply), 0U) << length;
    ASSERT_EQ(dictionary.find(0x2011, 0)->text().size(), length);
    EXPECT_EQ(upload(0x2011, 0), text) << length;
  }
}

TEST_P(MailboxLengths, SixtyFourBitValue_IsReadAndWritten) {
  EXPECT_EQ(to_hex(upload(0x2013, 0)), "88 77 66 55 44 33 22 11");
  const std::size_t room = static_cast<std::size_t>(GetParam()) - 16;
  EXPECT_EQ(abort_code(download(0x2013, 0, hex("01 02 03 04 05 06 07 08"), room)), 0U);
  EXPECT_EQ(value(0x2013), 0x0807060504030201U);
}

TEST_P(MailboxLengths, CompleteArray_IsReadAndWritten) {
  Bytes array = upload(0x3000, 0, true);
  ASSERT_EQ(array.size(), 2U + 200 * 4);
  EXPECT_EQ(to_hex(part(array, 0, 6)), "C8 00 01 01 01 01");
  EXPECT_EQ(to_hex(part(array, 798)), "C8 C8 C8 C8");
  std::reverse(array.begin() + 2, array.end());
  const std::size_t room = static_cast<std::size_t>(GetParam()) - 16;
  EXPECT_EQ(abort_code(download(0x3000, 0, array, room, true)), 0U);
  EXPECT_EQ(value(0x3000, 1), 0xC8C8C8C8U);
  EXPECT_EQ(upload(0x3000, 0, true), array);
}

INSTANTIATE_TEST_SUITE_P(SdoServer, MailboxLengths,
                         testing::Values(16, 17, 24, 34, 128, 256, 1024));

}  // namespace
}  // namespace stator::ethercat::test
