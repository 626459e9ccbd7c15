// SDO information services of CoE: lists, object and entry descriptions, fragments (ETG.1000.6).
#include "stator/ethercat/stack/sdo_information.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

class SdoInformationTest : public StackFixture {
 protected:
  explicit SdoInformationTest(std::uint16_t mailbox_length = 128)
      : StackFixture(with_mailbox(mailbox_length)) {
    go_pre_operational();
  }
  static DeviceDescription with_mailbox(std::uint16_t length) {
    DeviceDescription description = test_description();
    description.receive_mailbox = {0x1000, length};
    description.transmit_mailbox = {static_cast<std::uint16_t>(0x1000 + length), length};
    return description;
  }
  /// Indices of a list; the answer's opcode and list type are checked.
  std::vector<std::uint16_t> list(std::uint16_t type) {
    const Bytes answer = information(1, le(type));
    EXPECT_EQ(to_hex(part(answer, 0, 3)), to_hex(concat({hex("02"), le(type)})));
    std::vector<std::uint16_t> indices;
    for (std::size_t at = 3; at + 1 < answer.size(); at += 2) {
      indices.push_back(base::load_le<std::uint16_t>(answer, at));
    }
    return indices;
  }
  std::string object(std::string_view index) { return to_hex(information(3, hex(index))); }
  Bytes entry(std::string_view index_subindex_info) {
    return information(5, hex(index_subindex_info));
  }
  static std::string text(const Bytes& answer, std::size_t from) {
    std::string name;
    for (const std::byte byte : part(answer, from)) {
      name += static_cast<char>(byte);
    }
    return name;
  }
};

TEST_F(SdoInformationTest, ListOfAllObjects_IsTheDictionary) {
  std::vector<std::uint16_t> expected;
  for (const dictionary::Object& object : dictionary.objects()) {
    expected.push_back(object.index);
  }
  EXPECT_EQ(list(1), expected);
}

TEST_F(SdoInformationTest, MappableLists_HoldWhatCanStandInAPdo) {
  EXPECT_THAT(list(2), ElementsAre(0x2015, 0x6040, 0x6060, 0x607A, 0x60FF, 0x6840, 0x687A, 0x68FF,
                                   0x7040, 0x707A, 0x70FF));
  EXPECT_THAT(list(3), ElementsAre(0x6041, 0x6061, 0x6064, 0x606C, 0x6841, 0x6864, 0x686C, 0x7041,
                                   0x7064, 0x706C));
  EXPECT_THAT(list(4), SizeIs(0));
  EXPECT_THAT(list(5), SizeIs(0));
}

TEST_F(SdoInformationTest, ListOfLengths_CountsTheOthers) {
  EXPECT_THAT(list(0), ElementsAre(dictionary.objects().size(), 11, 10, 0, 0));
}

TEST_F(SdoInformationTest, UnknownListAndUnknownRequest_AreRefused) {
  EXPECT_EQ(to_hex(information(1, hex("06 00"))), "07 00 00 01 06");
  EXPECT_EQ(to_hex(information(9, hex("00 00 00 00"))), "07 01 00 04 05");
}

TEST_F(SdoInformationTest, ObjectDescription_HasTypeCodeAndNameOfTheWhole) {
  EXPECT_EQ(object("00 10"), "04 00 10 07 00 00 07 " +
                                 to_hex(std::as_bytes(std::span(std::string_view("Device type")))));
  EXPECT_EQ(object("18 10"), "04 18 10 23 00 03 09 " +
                                 to_hex(std::as_bytes(std::span(std::string_view("Identity")))));
  EXPECT_EQ(object("00 30"),
            "04 00 30 07 00 C8 08 " + to_hex(std::as_bytes(std::span(std::string_view("Table")))));
  EXPECT_EQ(object("00 16"), "04 00 16 21 00 09 09 " +
                                 to_hex(std::as_bytes(std::span(std::string_view("RxPDO 1")))));
  EXPECT_EQ(object("FF 2F"), "07 00 00 02 06");
}

TEST_F(SdoInformationTest, EntryDescription_HasTypeLengthAccessAndName) {
  const Bytes answer = entry("40 60 00 07");
  EXPECT_EQ(to_hex(part(answer, 0, 11)), "06 40 60 00 07 06 00 10 00 7F 00");
  EXPECT_EQ(text(answer, 11), "Controlword");
}

TEST_F(SdoInformationTest, AccessFlags_TellStatesAndMapping) {
  EXPECT_EQ(to_hex(part(entry("41 60 00 00"), 9, 2)), "87 00");  // ro, transmit
  EXPECT_EQ(to_hex(part(entry("10 20 00 00"), 9, 2)), "38 00");  // wo
  EXPECT_EQ(to_hex(part(entry("14 20 00 00"), 9, 2)), "0F 00");  // written in Pre-Operational only
  EXPECT_EQ(to_hex(part(entry("03 20 00 00"), 9, 2)), "3F 00");  // rw
}

TEST_F(SdoInformationTest, ValueInfo_BringsWhatWasAskedAndDeclared) {
  const Bytes all = entry("05 20 00 7F");
  EXPECT_EQ(to_hex(part(all, 0, 11)), "06 05 20 00 7F 07 00 20 00 3F 00");
  EXPECT_EQ(to_hex(part(all, 11, 14)), "03 FD 03 00 00 00 02 00 00 00 3F 00 00 00");
  EXPECT_EQ(text(all, 25), "Limit switches");

  const Bytes without_range = entry("15 20 00 7F");
  EXPECT_EQ(to_hex(part(without_range, 0, 12)), "06 15 20 00 17 01 00 01 00 7F 00 00");
  EXPECT_EQ(text(without_range, 12), "Switch");

  const Bytes of_text = entry("08 10 00 7F");
  EXPECT_EQ(to_hex(part(of_text, 0, 11)), "06 08 10 00 07 09 00 48 00 07 00");
  EXPECT_EQ(text(of_text, 11), "Manufacturer device name");
}

TEST_F(SdoInformationTest, MissingEntries_AreRefused) {
  EXPECT_EQ(to_hex(entry("18 10 04 00")), "07 11 00 09 06");
  EXPECT_EQ(to_hex(entry("FF 2F 00 00")), "07 00 00 02 06");
}

TEST_F(SdoInformationTest, NewRequest_SupersedesFragmentsNobodyFetched) {
  request(0x01);
  controller.set_sync_manager(0, 0x1000, 128, 0x26, true);
  controller.set_sync_manager(1, 0x1080, 24, 0x22, true);
  request(0x02);
  const Bytes first = exchange(message(3, hex("00 80 01 00 00 00 01 00"), 1));
  ASSERT_NE(base::load_le<std::uint16_t>(first, 10), 0U);
  ASSERT_TRUE(controller.write_mailbox(message(3, hex("00 80 05 00 00 00 00 10 00 00"), 2)));
  process();
  EXPECT_EQ(to_hex(part(controller.read_mailbox(), 8, 1)), "86");
}

class SdoInformationFragments : public SdoInformationTest, public testing::WithParamInterface<int> {
 protected:
  SdoInformationFragments() : SdoInformationTest(static_cast<std::uint16_t>(GetParam())) {}
};

TEST_P(SdoInformationFragments, ListIsWholeAndFragmentsCountDown) {
  EXPECT_EQ(list(1).size(), dictionary.objects().size());
  for (std::size_t i = 0; i < fragments_left.size(); ++i) {
    EXPECT_EQ(fragments_left[i], fragments_left.size() - 1 - i);
  }
  EXPECT_EQ(text(entry("00 10 00 00"), 11), "Device type");
}

INSTANTIATE_TEST_SUITE_P(SdoInformation, SdoInformationFragments,
                         testing::Values(18, 24, 34, 64, 128, 512));

}  // namespace
}  // namespace stator::ethercat::test
