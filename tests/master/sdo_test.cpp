// The master's SDO transfers and SDO information, with lost frames, aborts and emergencies in
// between.
#include <algorithm>
#include <array>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/simulated_segment.hpp"
#include "stator/dictionary/abort_code.hpp"
#include "stator/master/master.hpp"

namespace stator::master {
namespace {

using dictionary::AbortCode;
using test::SimulatedSegment;

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

/// Slaves that send their aborts as responses, as many did before they were tried with SOEM.
class AbortsAsResponses final : public FramePort {
 public:
  explicit AbortsAsResponses(FramePort& port) : port_(port) {}

  Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                               base::SimDuration timeout) override {
    auto length = port_.exchange(frame, reply, timeout);
    const std::span<std::byte> came = reply.first(length ? *length : 0);
    // CoE in the mailbox header, then the CoE header and the command byte of the abort.
    const std::array abort{std::byte{0x00}, std::byte{0x20}, std::byte{0x80}};
    // Clang 14 cannot take std::ranges::search from this standard library.
    const auto found = std::search(came.begin(), came.end(), abort.begin(), abort.end());
    if (found != came.end()) {
      *std::next(found) = std::byte{0x30};
      ++changed;
    }
    return length;
  }
  void wait(base::SimDuration duration) override { port_.wait(duration); }
  [[nodiscard]] base::SimTime now() override { return port_.now(); }

  int changed = 0;

 private:
  FramePort& port_;
};

class SdoTest : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(master.scan());
    ASSERT_TRUE(master.start_mailbox(0));
  }

  static MasterOptions patient() {
    MasterOptions options;
    options.frame_retries = 10;
    options.frame_timeout = base::SimDuration(1'000'000);
    return options;
  }

  SimulatedSegment segment;
  Master master{segment, patient()};
};

TEST_F(SdoTest, NumbersAreReadAndWritten) {
  EXPECT_EQ(*master.upload_number<std::uint32_t>(0, {0x1000, 0}), 0x00020192U);
  EXPECT_EQ(*master.upload_number<std::uint32_t>(0, {0x1018, 2}), 4711U);
  ASSERT_TRUE(master.download_number<std::uint16_t>(0, {0x2000, 0}, 0xBEEF));
  EXPECT_EQ(*master.upload_number<std::uint16_t>(0, {0x2000, 0}), 0xBEEF);
}

TEST_F(SdoTest, ANumberOfEightBytesTravelsInANormalTransfer) {
  ASSERT_TRUE(master.download_number<std::uint64_t>(0, {0x2002, 0}, 0x1122334455667788));
  EXPECT_EQ(*master.upload_number<std::uint64_t>(0, {0x2002, 0}), 0x1122334455667788U);
}

TEST_F(SdoTest, TextsOfEveryLengthSurviveDownAndUpload) {
  for (const std::size_t length :
       {1U, 4U, 5U, 7U, 111U, 112U, 113U, 118U, 119U, 224U, 225U, 226U, 231U, 232U, 233U, 250U}) {
    std::string text;
    for (std::size_t i = 0; i < length; ++i) {
      text += static_cast<char>('a' + i % 26);
    }
    const auto written = master.download(0, {0x2001, 0}, bytes_of(text));
    ASSERT_TRUE(written) << length << " bytes: " << written.error().text;
    const auto read = master.upload(0, {0x2001, 0});
    ASSERT_TRUE(read) << length << " bytes: " << read.error().text;
    ASSERT_EQ(text_of(*read), text);
  }
}

TEST_F(SdoTest, ACompleteRecordIsReadInOneTransfer) {
  const auto record = master.upload(0, {0x1018, 0, true});
  ASSERT_TRUE(record) << record.error().text;
  ASSERT_EQ(record->size(), 18U) << "subindex 0 takes 16 bits";
  EXPECT_EQ(base::load_le<std::uint32_t>(*record, 6), 4711U);
}

TEST_F(SdoTest, AnAbortNamesObjectSlaveCodeAndMeaning) {
  const auto missing = master.upload(0, {0x5FFF, 0});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::sdo_aborted);
  EXPECT_EQ(missing.error().detail, 0x06020000U);
  EXPECT_EQ(missing.error().text,
            "SDO read of 5FFFh:00 from slave 0 (station 1001h) aborted: 06020000h the object does "
            "not exist in the object dictionary");

  const auto read_only = master.download_number<std::uint32_t>(0, {0x1000, 0}, 1);
  ASSERT_FALSE(read_only);
  EXPECT_EQ(read_only.error().detail, static_cast<std::uint32_t>(AbortCode::read_only));
  EXPECT_THAT(read_only.error().text, testing::HasSubstr("SDO write of 1000h:00 to slave 0"));

  const auto wrong_length = master.download_number<std::uint8_t>(0, {0x2000, 0}, 1);
  ASSERT_FALSE(wrong_length);
  EXPECT_EQ(wrong_length.error().code, ErrorCode::sdo_aborted);
}

TEST_F(SdoTest, AnAbortThatComesAsAResponseIsOneToo) {
  AbortsAsResponses port(segment);
  Master other(port, patient());
  ASSERT_TRUE(other.scan());
  ASSERT_TRUE(other.start_mailbox(0));
  const auto missing = other.upload(0, {0x5FFF, 0});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().detail, 0x06020000U);
  const auto read_only = other.download_number<std::uint32_t>(0, {0x1000, 0}, 1);
  ASSERT_FALSE(read_only);
  EXPECT_EQ(read_only.error().detail, static_cast<std::uint32_t>(AbortCode::read_only));
  EXPECT_EQ(port.changed, 2);
}

TEST_F(SdoTest, ANumberOfAnotherLengthThanExpectedIsAnError) {
  const auto value = master.upload_number<std::uint16_t>(0, {0x1000, 0});
  ASSERT_FALSE(value);
  EXPECT_EQ(value.error().code, ErrorCode::protocol);
  EXPECT_THAT(value.error().text, testing::HasSubstr("4 bytes, 2 were expected"));
}

TEST_F(SdoTest, LostRequestsAndAnswersAreRepeatedWithoutChangingTheOutcome) {
  segment.loss_per_mille = 200;
  for (std::uint16_t value = 1; value <= 100; ++value) {
    const auto written = master.download_number<std::uint16_t>(0, {0x2000, 0}, value);
    ASSERT_TRUE(written) << value << ": " << written.error().text;
    const auto read = master.upload_number<std::uint16_t>(0, {0x2000, 0});
    ASSERT_TRUE(read) << value << ": " << read.error().text;
    ASSERT_EQ(*read, value);
  }
}

TEST_F(SdoTest, ASegmentedTransferSurvivesLossInAllItsFrames) {
  const std::string text(500, 'x');
  segment.loss_per_mille = 150;
  segment.double_answers = true;
  for (int round = 0; round < 10; ++round) {
    const auto written = master.download(0, {0x2001, 0}, bytes_of(text));
    ASSERT_TRUE(written) << written.error().text;
    const auto read = master.upload(0, {0x2001, 0});
    ASSERT_TRUE(read) << read.error().text;
    ASSERT_EQ(text_of(*read), text);
  }
}

TEST_F(SdoTest, EmergenciesArePutAsideWhileAnAnswerIsAwaited) {
  ASSERT_TRUE(segment.slave(0).stack.send_emergency(0x7305, 0x20, {1, 2, 3, 4, 5}, segment.now()));
  ASSERT_TRUE(segment.slave(0).stack.send_emergency(0x3220, 0x04, {}, segment.now()));
  EXPECT_EQ(*master.upload_number<std::uint32_t>(0, {0x1000, 0}), 0x00020192U);

  segment.wait(base::SimDuration(5'000'000));
  const auto emergencies = master.take_emergencies(0);
  ASSERT_TRUE(emergencies);
  ASSERT_EQ(emergencies->size(), 2U);
  EXPECT_EQ((*emergencies)[0].error_code, 0x7305);
  EXPECT_EQ((*emergencies)[0].error_register, 0x20);
  EXPECT_EQ((*emergencies)[0].data[4], std::byte{5});
  EXPECT_EQ((*emergencies)[1].error_code, 0x3220);
  EXPECT_TRUE(master.take_emergencies(0)->empty());
}

TEST_F(SdoTest, WithoutMailboxTheErrorSaysThatTheSlaveDoesNotAnswer) {
  ASSERT_TRUE(master.request_state(0, ethercat::AlState::init));
  const auto read = master.upload(0, {0x1000, 0});
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().text, testing::HasSubstr("slave 0"));
  ASSERT_TRUE(master.start_mailbox(0));
  const auto again = master.upload(0, {0x1000, 0});
  EXPECT_TRUE(again) << again.error().text;
}

TEST_F(SdoTest, TheDictionaryDescribesItself) {
  const auto list = master.object_list(0);
  ASSERT_TRUE(list) << list.error().text;
  EXPECT_EQ(list->size(), segment.slave(0).dictionary.objects().size());
  for (const std::uint16_t index : *list) {
    const dictionary::Object* const object = segment.slave(0).dictionary.find(index);
    ASSERT_NE(object, nullptr) << std::hex << index;
    const auto description = master.object_description(0, index);
    ASSERT_TRUE(description) << description.error().text;
    EXPECT_EQ(description->name, object->name.str());
    EXPECT_EQ(description->maximum_subindex, object->max_subindex());
    EXPECT_EQ(description->object_code, static_cast<std::uint8_t>(object->code));
    for (const dictionary::Entry& entry : object->entries) {
      const auto described = master.entry_description(0, index, entry.subindex());
      ASSERT_TRUE(described) << described.error().text;
      EXPECT_EQ(described->name, entry.name());
      EXPECT_EQ(described->data_type, static_cast<std::uint16_t>(entry.type()));
      EXPECT_EQ(described->bit_length, entry.bits());
    }
  }
}

TEST_F(SdoTest, ListsOfMappableObjectsAreShorterThanTheWholeList) {
  const auto receive = master.object_list(0, ObjectListType::mappable_in_receive_pdo);
  ASSERT_TRUE(receive) << receive.error().text;
  EXPECT_THAT(*receive, testing::ElementsAre(0x6040, 0x607A, 0x6840, 0x687A));
}

TEST_F(SdoTest, ADescriptionOfAMissingObjectIsRefusedWithItsAbortCode) {
  const auto description = master.object_description(0, 0x5FFF);
  ASSERT_FALSE(description);
  EXPECT_EQ(description.error().code, ErrorCode::sdo_aborted);
  EXPECT_EQ(description.error().detail, 0x06020000U);
  EXPECT_THAT(description.error().text, testing::HasSubstr("5FFFh"));
}

}  // namespace
}  // namespace stator::master
