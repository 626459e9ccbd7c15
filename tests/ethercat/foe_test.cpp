#include "stator/ethercat/stack/foe.hpp"

#include <map>

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

/// Files in memory, with a capacity and a commit that takes as many calls as the test wants.
class MemoryFiles final : public FileStore {
 public:
  FoeError open_for_reading(std::string_view name) override {
    const auto found = files.find(std::string(name));
    reading = found == files.end() ? Bytes() : found->second;
    return found == files.end() ? FoeError::not_found : FoeError::none;
  }
  std::size_t size() const override { return reading.size(); }
  FoeError read(std::size_t offset, std::span<std::byte> out) override {
    if (fail_reading) {
      return FoeError::program_error;
    }
    std::ranges::copy(part(reading, offset, out.size()), out.begin());
    return FoeError::none;
  }
  FoeError open_for_writing(std::string_view name) override {
    writing_name = name;
    staging.clear();
    return name == "fixed" ? FoeError::access_denied : FoeError::none;
  }
  FoeError append(std::span<const std::byte> data) override {
    if (staging.size() + data.size() > capacity) {
      return FoeError::disk_full;
    }
    staging.insert(staging.end(), data.begin(), data.end());
    return FoeError::none;
  }
  Commit commit() override {
    ++commits;
    if (commits <= slow_commits) {
      return {.in_progress = true};
    }
    if (commit_error == FoeError::none) {
      files[writing_name] = staging;
    }
    return {.error = commit_error};
  }
  void abort() override { ++aborts; }

  std::map<std::string, Bytes> files;
  Bytes reading;
  Bytes staging;
  std::string writing_name;
  std::size_t capacity = 100'000;
  bool fail_reading = false;
  int slow_commits = 0;
  FoeError commit_error = FoeError::none;
  int commits = 0;
  int aborts = 0;
};

/// Bytes 0, 1, 2 ... of a file.
Bytes counting(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<std::byte>(i * 7 + i / 256);
  }
  return bytes;
}

/// What has to exist before the stack that uses it.
struct Files {
  MemoryFiles& store() { return files; }

  MemoryFiles files;
};

class FoeTest : private Files, public StackFixture {
 protected:
  static constexpr std::size_t kPacket = 128 - 12;

  explicit FoeTest(const FoeOptions& options = {}, std::uint16_t transmit_mailbox = 128)
      : StackFixture(with_foe(transmit_mailbox), {.files = &Files::store(), .foe = options}) {}

  using Files::store;

  static DeviceDescription with_foe(std::uint16_t transmit_mailbox) {
    DeviceDescription description = test_description();
    description.foe = true;
    description.transmit_mailbox.length = transmit_mailbox;
    description.bootstrap_receive_mailbox = description.receive_mailbox;
    description.bootstrap_transmit_mailbox = description.transmit_mailbox;
    return description;
  }
  void go_bootstrap() {
    configure_mailbox();
    request(0x03);
    ASSERT_EQ(controller.al_status(), 0x03U);
  }

  /// Sends a FoE message and returns the answer without the mailbox header.
  Bytes foe(unsigned operation, std::uint32_t number, const Bytes& rest = {}) {
    counter_ = counter_ % 7 + 1;
    const Bytes header{static_cast<std::byte>(operation), std::byte{0}};
    const Bytes reply = exchange(message(4, concat({header, le(number), rest}), counter_));
    if (reply.empty()) {
      return reply;
    }
    EXPECT_EQ(std::to_integer<unsigned>(reply[5]) & 0x0F, 4U) << to_hex(reply);
    return part(reply, 6);
  }
  static Bytes text(std::string_view words) {
    const auto bytes = std::as_bytes(std::span(words));
    return {bytes.begin(), bytes.end()};
  }
  Bytes ask_to_read(std::string_view name, std::uint32_t password = 0) {
    return foe(1, password, text(name));
  }
  Bytes ask_to_write(std::string_view name, std::uint32_t password = 0) {
    return foe(2, password, text(name));
  }
  Bytes data(std::uint32_t packet, const Bytes& bytes) { return foe(3, packet, bytes); }

  static std::string acknowledge(std::uint32_t packet) {
    return to_hex(concat({hex("04 00"), le(packet)}));
  }
  static FoeError error_of(const Bytes& reply) {
    return reply.size() >= 6 && reply[0] == std::byte{5}
               ? static_cast<FoeError>(base::load_le<std::uint32_t>(reply, 2))
               : FoeError::none;
  }
  static bool is_busy(const Bytes& reply) { return !reply.empty() && reply[0] == std::byte{6}; }

  /// Sends a whole file; the last answer.
  Bytes download(std::string_view name, const Bytes& file) {
    Bytes reply = ask_to_write(name);
    std::uint32_t packet = 0;
    std::size_t offset = 0;
    std::size_t sent = kPacket;
    while (sent == kPacket && to_hex(reply) == acknowledge(packet)) {
      const Bytes bytes = part(file, offset, kPacket);
      sent = bytes.size();
      offset += sent;
      reply = data(++packet, bytes);
    }
    return reply;
  }
  /// Reads a whole file whose packets hold `full` bytes.
  Bytes upload(std::string_view name, std::size_t full = kPacket) {
    Bytes file;
    Bytes reply = ask_to_read(name);
    for (std::uint32_t packet = 1;; ++packet) {
      EXPECT_EQ(to_hex(part(reply, 0, 6)), to_hex(concat({hex("03 00"), le(packet)})));
      const Bytes bytes = part(reply, 6);
      file.insert(file.end(), bytes.begin(), bytes.end());
      reply = foe(4, packet);
      if (bytes.size() < full) {
        EXPECT_TRUE(reply.empty()) << "something follows the last packet: " << to_hex(reply);
        return file;
      }
    }
  }
};

TEST_F(FoeTest, Download_IsAnsweredToTheByte) {
  go_pre_operational();
  EXPECT_EQ(to_hex(ask_to_write("a.bin")), "04 00 00 00 00 00");
  EXPECT_EQ(to_hex(data(1, hex("01 02 03"))), "04 00 01 00 00 00");
  EXPECT_EQ(to_hex(store().files.at("a.bin")), "01 02 03");
}

TEST_F(FoeTest, Upload_IsAnsweredToTheByte) {
  go_pre_operational();
  store().files["a.bin"] = hex("01 02 03");
  EXPECT_EQ(to_hex(ask_to_read("a.bin")), "03 00 01 00 00 00 01 02 03");
  EXPECT_TRUE(foe(4, 1).empty());
}

TEST_F(FoeTest, FilesOfEveryLengthAroundThePacketSize_AreWrittenAndReadBack) {
  go_pre_operational();
  for (const std::size_t size : {std::size_t{1}, kPacket - 1, kPacket, kPacket + 1, 2 * kPacket,
                                 5 * kPacket - 1, 5 * kPacket, std::size_t{70'000}}) {
    const Bytes file = counting(size);
    const Bytes last = download("image", file);
    EXPECT_EQ(to_hex(last), acknowledge(static_cast<std::uint32_t>(size / kPacket + 1))) << size;
    EXPECT_EQ(store().files["image"], file) << size;
    EXPECT_EQ(upload("image"), file) << size;
  }
}

TEST_F(FoeTest, MultipleOfThePacketSize_EndsWithAnEmptyPacketInBothDirections) {
  go_pre_operational();
  ask_to_write("image");
  EXPECT_EQ(to_hex(data(1, counting(kPacket))), acknowledge(1));
  EXPECT_EQ(store().commits, 0) << "a full packet is not the last";
  EXPECT_EQ(to_hex(data(2, {})), acknowledge(2));
  EXPECT_EQ(store().commits, 1);
  EXPECT_EQ(ask_to_read("image").size(), 6 + kPacket);
  EXPECT_EQ(to_hex(foe(4, 1)), "03 00 02 00 00 00");
  EXPECT_TRUE(foe(4, 2).empty());
}

TEST_F(FoeTest, EmptyFile_IsRefusedAsIllegalAndTheOldOneStays) {
  go_pre_operational();
  download("image", hex("AA"));
  ask_to_write("image");
  EXPECT_EQ(error_of(data(1, {})), FoeError::illegal);
  EXPECT_EQ(to_hex(store().files["image"]), "AA");
  EXPECT_EQ(log.last("foe-abandoned"), "") << "it was refused, not given up";
}

TEST_F(FoeTest, FileName_IsNotTerminatedByAZeroButMayBe) {
  go_pre_operational();
  ask_to_write("image.bin");
  EXPECT_EQ(store().writing_name, "image.bin");
  foe(2, 0, concat({text("other"), Bytes(3)}));
  EXPECT_EQ(store().writing_name, "other");
  ask_to_write("");
  EXPECT_EQ(store().writing_name, "");
}

TEST_F(FoeTest, MissingFile_IsNotFound) {
  go_pre_operational();
  const Bytes reply = ask_to_read("nothing");
  EXPECT_EQ(to_hex(part(reply, 0, 6)), "05 00 01 80 00 00");
  EXPECT_EQ(part(reply, 6), text("not found"));
  EXPECT_THAT(log.last("foe-refused"), HasSubstr("8001h (not found)"));
}

TEST_F(FoeTest, FileThatMayNotBeWritten_IsRefusedWithTheStoresError) {
  go_pre_operational();
  EXPECT_EQ(error_of(ask_to_write("fixed")), FoeError::access_denied);
  EXPECT_EQ(error_of(data(1, hex("01"))), FoeError::not_defined);
}

TEST_F(FoeTest, FileThatDoesNotFit_EndsTheTransferWithDiskFull) {
  go_pre_operational();
  store().capacity = 150;
  download("image", hex("AA"));
  ask_to_write("image");
  EXPECT_EQ(to_hex(data(1, counting(kPacket))), acknowledge(1));
  EXPECT_EQ(error_of(data(2, counting(kPacket))), FoeError::disk_full);
  EXPECT_EQ(error_of(data(3, counting(3))), FoeError::not_defined);
  EXPECT_EQ(to_hex(store().files["image"]), "AA");
}

TEST_F(FoeTest, RepeatedPacket_IsAcknowledgedAgainAndNotStoredTwice) {
  go_pre_operational();
  ask_to_write("image");
  const Bytes file = counting(2 * kPacket + 5);
  for (const std::uint32_t packet : {1U, 1U, 2U, 2U, 2U, 3U, 3U}) {
    EXPECT_EQ(to_hex(data(packet, part(file, (packet - 1) * kPacket, kPacket))),
              acknowledge(packet));
  }
  EXPECT_EQ(store().files["image"], file);
  EXPECT_EQ(store().commits, 1);
}

TEST_F(FoeTest, WrongPacketNumber_EndsTheDownloadAndLeavesTheOldFile) {
  go_pre_operational();
  download("image", hex("AA"));
  for (const std::uint32_t wrong : {0U, 3U, 0xFFFFFFFFU}) {
    ask_to_write("image");
    EXPECT_EQ(to_hex(data(1, counting(kPacket))), acknowledge(1));
    EXPECT_EQ(error_of(data(wrong, hex("01"))), FoeError::packet_number_wrong) << wrong;
    EXPECT_EQ(error_of(data(2, hex("01"))), FoeError::not_defined);
    EXPECT_EQ(to_hex(store().files["image"]), "AA");
  }
}

TEST_F(FoeTest, FirstPacketZero_IsWrong) {
  go_pre_operational();
  ask_to_write("image");
  EXPECT_EQ(error_of(data(0, hex("01"))), FoeError::packet_number_wrong);
}

TEST_F(FoeTest, WrongAcknowledge_EndsTheUpload) {
  go_pre_operational();
  store().files["image"] = counting(3 * kPacket);
  ask_to_read("image");
  EXPECT_EQ(error_of(foe(4, 2)), FoeError::packet_number_wrong);
  EXPECT_EQ(error_of(foe(4, 1)), FoeError::not_defined);
}

TEST_F(FoeTest, RepeatedAcknowledgeOrBusy_BringsTheLastPacketAgain) {
  go_pre_operational();
  store().files["image"] = counting(3 * kPacket);
  ask_to_read("image");
  const Bytes second = foe(4, 1);
  EXPECT_EQ(to_hex(part(second, 0, 6)), "03 00 02 00 00 00");
  EXPECT_EQ(foe(4, 1), second);
  EXPECT_EQ(foe(6, 0), second);
  EXPECT_EQ(to_hex(part(foe(4, 2), 0, 6)), "03 00 03 00 00 00");
}

TEST_F(FoeTest, FileThatChangesWhileItIsRead_EndsTheUploadWithProgramError) {
  go_pre_operational();
  store().files["image"] = counting(3 * kPacket);
  ask_to_read("image");
  store().fail_reading = true;
  EXPECT_EQ(error_of(foe(4, 1)), FoeError::program_error);
}

TEST_F(FoeTest, NewRequest_TakesThePlaceOfAnAbandonedTransfer) {
  go_pre_operational();
  download("image", hex("AA"));
  ask_to_write("image");
  data(1, counting(kPacket));
  EXPECT_EQ(upload("image"), hex("AA"));
  EXPECT_THAT(log.last("foe-abandoned"), HasSubstr("after 116 bytes"));
  store().files["long"] = counting(1000);
  ask_to_read("long");
  EXPECT_EQ(to_hex(download("image", hex("BB"))), acknowledge(1));
  EXPECT_EQ(to_hex(store().files["image"]), "BB");
}

TEST_F(FoeTest, ErrorOfTheMaster_EndsTheTransferWithoutAnAnswer) {
  go_pre_operational();
  ask_to_write("image");
  EXPECT_TRUE(foe(5, 0x8000).empty());
  EXPECT_EQ(store().aborts, 1);
  EXPECT_EQ(error_of(data(1, hex("01"))), FoeError::not_defined);
}

TEST_F(FoeTest, MailboxStop_ForgetsTheTransfer) {
  go_pre_operational();
  ask_to_write("image");
  data(1, counting(kPacket));
  request(0x01);
  EXPECT_EQ(store().aborts, 1);
  EXPECT_THAT(log.last("foe-abandoned"), HasSubstr("after 116 bytes"));
  go_pre_operational();
  EXPECT_EQ(error_of(data(2, hex("01"))), FoeError::not_defined);
  EXPECT_TRUE(store().files.empty());
}

TEST_F(FoeTest, DataWithoutARequest_AreRefused) {
  go_pre_operational();
  EXPECT_EQ(error_of(data(1, hex("01"))), FoeError::not_defined);
  EXPECT_EQ(error_of(foe(4, 0)), FoeError::not_defined);
  EXPECT_EQ(error_of(foe(6, 0)), FoeError::not_defined);
}

TEST_F(FoeTest, DataDuringAnUpload_AreIllegal) {
  go_pre_operational();
  store().files["image"] = counting(300);
  ask_to_read("image");
  EXPECT_EQ(error_of(data(1, hex("01"))), FoeError::illegal);
}

TEST_F(FoeTest, ShortMessages_AreMailboxError6AndUnknownOperationsError5) {
  go_pre_operational();
  for (const char* payload : {"", "02", "02 00 00 00 00", "03 00 01 00 00"}) {
    EXPECT_EQ(to_hex(part(exchange(message(4, hex(payload), 0)), 6)), "01 00 06 00") << payload;
  }
  for (const unsigned operation : {0U, 7U, 255U}) {
    const Bytes payload = concat({{static_cast<std::byte>(operation)}, Bytes(7)});
    EXPECT_EQ(to_hex(part(exchange(message(4, payload, 0)), 6)), "01 00 05 00") << operation;
  }
}

TEST_F(FoeTest, ErrorTexts_AreThoseOfTheStandard) {
  EXPECT_EQ(to_text(FoeError::not_defined), "not defined");
  EXPECT_EQ(to_text(FoeError::disk_full), "disk full");
  EXPECT_EQ(to_text(FoeError::illegal), "illegal");
  EXPECT_EQ(to_text(FoeError::already_exists), "already exists");
  EXPECT_EQ(to_text(FoeError::bootstrap_only), "bootstrap only");
  EXPECT_EQ(to_text(FoeError::checksum_wrong), "checksum wrong");
  EXPECT_EQ(to_text(FoeError::firmware_does_not_fit), "firmware does not fit for hardware");
  for (std::uint32_t code = 0x8000; code <= 0x800D; ++code) {
    EXPECT_NE(to_text(static_cast<FoeError>(code)), "unknown error") << std::hex << code;
  }
  EXPECT_EQ(to_text(static_cast<FoeError>(0x800E)), "unknown error");
}

TEST_F(FoeTest, ReceivedFile_IsLoggedWithItsChecksum) {
  go_pre_operational();
  download("image", text("123456789"));
  EXPECT_THAT(log.last("foe-received"), HasSubstr("9 bytes received by FoE, CRC-32 CBF43926h"));
}

TEST_F(FoeTest, CommitThatTakesItsTime_IsBusyUntilItIsDone) {
  go_pre_operational();
  store().slow_commits = 3;
  ask_to_write("image");
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(is_busy(data(1, hex("01 02"))));
    EXPECT_TRUE(store().files.empty());
  }
  EXPECT_EQ(to_hex(data(1, hex("01 02"))), acknowledge(1));
  EXPECT_EQ(to_hex(store().files["image"]), "01 02");
}

TEST_F(FoeTest, FailedCommit_IsToldInsteadOfTheLastAcknowledge) {
  go_pre_operational();
  store().commit_error = FoeError::disk_full;
  EXPECT_EQ(error_of(download("image", hex("01 02"))), FoeError::disk_full);
  EXPECT_EQ(error_of(data(1, hex("01 02"))), FoeError::not_defined);
}

TEST_F(FoeTest, PacketBehindTheLastWhileCommitting_IsAWrongNumber) {
  go_pre_operational();
  store().slow_commits = 100;
  ask_to_write("image");
  data(1, hex("01 02"));
  EXPECT_EQ(error_of(data(2, hex("03"))), FoeError::packet_number_wrong);
}

TEST_F(FoeTest, BesideCoe_BothProtocolsAreServed) {
  go_pre_operational();
  ask_to_write("image");
  EXPECT_EQ(to_hex(sdo("40 00 10 00 00 00 00 00")), "43 00 10 00 92 01 FC FF");
  EXPECT_EQ(to_hex(data(1, hex("01"))), acknowledge(1));
}

TEST_F(FoeTest, Announced_WithoutAFileStore_IsAMistakeInTheDevice) {
  EXPECT_THROW(SlaveStack(controller, dictionary, description, application, {}, {}),
               std::logic_error);
}

class FoeWithPassword : public FoeTest {
 protected:
  FoeWithPassword() : FoeTest({.password = 0x12345678}) {}
};

TEST_F(FoeWithPassword, OtherPasswords_HaveNoRights) {
  go_pre_operational();
  store().files["image"] = hex("AA");
  EXPECT_EQ(error_of(ask_to_read("image", 0)), FoeError::no_rights);
  EXPECT_EQ(error_of(ask_to_write("image", 0x12345679)), FoeError::no_rights);
  EXPECT_EQ(to_hex(ask_to_read("image", 0x12345678)), "03 00 01 00 00 00 AA");
}

class FoeInBootstrap : public FoeTest {
 protected:
  FoeInBootstrap() : FoeTest({.bootstrap_only = true}) {}
};

TEST_F(FoeInBootstrap, OutsideBootstrap_RequestsAreRefusedWith8008h) {
  go_pre_operational();
  EXPECT_EQ(to_hex(part(ask_to_write("image"), 0, 6)), "05 00 08 80 00 00");
  EXPECT_EQ(error_of(ask_to_read("image")), FoeError::bootstrap_only);
  EXPECT_THAT(log.last("foe-refused"), HasSubstr("to Bootstrap"));
}

TEST_F(FoeInBootstrap, InBootstrap_FoeWorksAndCoeDoesNot) {
  go_bootstrap();
  EXPECT_EQ(to_hex(download("image", counting(1000))), acknowledge(9));
  EXPECT_EQ(upload("image"), counting(1000));
  EXPECT_EQ(to_hex(part(exchange(message(3, hex("00 20 40 00 10 00 00 00 00 00"))), 6)),
            "01 00 02 00");
}

class FoeWithErasing : public FoeTest {
 protected:
  FoeWithErasing() : FoeTest({.erase_time = base::SimDuration(200'000'000)}) {}
};

TEST_F(FoeWithErasing, DataAreAnsweredBusyUntilTheFlashIsErased) {
  go_pre_operational();
  EXPECT_EQ(to_hex(ask_to_write("image")), acknowledge(0)) << "a request is never answered busy";
  EXPECT_EQ(to_hex(part(data(1, hex("01")), 0, 6)), "06 00 00 00 64 00");
  now += base::SimDuration(50'000'000);
  EXPECT_EQ(to_hex(part(data(1, hex("01")), 0, 6)), "06 00 19 00 64 00");
  now += base::SimDuration(149'999'999);
  EXPECT_EQ(to_hex(part(data(1, hex("01")), 0, 6)), "06 00 63 00 64 00");
  now += base::SimDuration(1);
  EXPECT_EQ(to_hex(data(1, hex("01"))), acknowledge(1));
  EXPECT_EQ(to_hex(store().files["image"]), "01");
}

TEST_F(FoeWithErasing, ReadingDoesNotErase) {
  go_pre_operational();
  store().files["image"] = hex("AA");
  EXPECT_EQ(upload("image"), hex("AA"));
}

class FoeWithLongReplies : public FoeTest {
 protected:
  FoeWithLongReplies() : FoeTest({}, 256) {}
};

TEST_F(FoeWithLongReplies, UploadPacketsAreNoLongerThanWhatMastersTakeForFull) {
  go_pre_operational();
  store().files["image"] = counting(1000);
  EXPECT_EQ(ask_to_read("image").size(), 6 + kPacket);
  EXPECT_EQ(upload("image"), counting(1000));
}

class FoeWithShortReplies : public FoeTest {
 protected:
  FoeWithShortReplies() : FoeTest({}, 40) {}
};

TEST_F(FoeWithShortReplies, UploadPacketsFillTheSendMailbox) {
  go_pre_operational();
  store().files["image"] = counting(1000);
  EXPECT_EQ(upload("image", 40 - 12), counting(1000));
  EXPECT_EQ(part(ask_to_read("a name that is not there"), 6), text("not found"));
}

class FoeWithTinyReplies : public FoeTest {
 protected:
  FoeWithTinyReplies() : FoeTest({}, 16) {}
};

TEST_F(FoeWithTinyReplies, ErrorTextsAreCutToTheMailbox) {
  go_pre_operational();
  EXPECT_EQ(part(ask_to_read("x"), 6), text("not "));
}

}  // namespace
}  // namespace stator::ethercat::test
