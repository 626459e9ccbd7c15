// Reads and writes of objects with the abort code of each refusal: length, range, state, power.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "small_drive.hpp"

namespace stator::dictionary {
namespace {

void expect_refused(const Verdict& verdict, AbortCode code, std::string_view words) {
  ASSERT_FALSE(verdict.has_value());
  EXPECT_EQ(verdict.error().code, code) << to_text(verdict.error().code);
  EXPECT_EQ(sentence(verdict.error()), words);
}

TEST(DictionaryLookUp, FindsObjectsAndEntriesByTheirNumbers) {
  const auto dictionary = make_small_drive();
  ASSERT_NE(dictionary->find(0x1018), nullptr);
  EXPECT_EQ(dictionary->find(0x1018)->name.str(), "Identity");
  EXPECT_EQ(dictionary->find(0x1018)->max_subindex(), 2);
  ASSERT_NE(dictionary->find(0x1018, 2), nullptr);
  EXPECT_EQ(dictionary->find(0x1018, 2)->value(), 3315U);
  EXPECT_EQ(dictionary->find(0x1018, 1), nullptr);
  EXPECT_EQ(dictionary->find(0x0FFF), nullptr);
  EXPECT_EQ(dictionary->find(0xFFFF, 0), nullptr);
}

TEST(DictionaryLookUp, RequireGivesTheEntryOrTheRefusal) {
  const auto dictionary = make_small_drive();
  const auto found = dictionary->require(0x607A, 0);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ((*found)->index(), 0x607A);

  const auto no_object = dictionary->require(0x607B, 0);
  ASSERT_FALSE(no_object.has_value());
  EXPECT_EQ(no_object.error().code, AbortCode::object_does_not_exist);
  EXPECT_EQ(sentence(no_object.error()),
            "object 607Bh refused: the dictionary has no such object; read the object list to see "
            "what the device offers");

  const auto no_subindex = dictionary->require(0x1018, 1);
  ASSERT_FALSE(no_subindex.has_value());
  EXPECT_EQ(no_subindex.error().code, AbortCode::subindex_does_not_exist);
  EXPECT_EQ(sentence(no_subindex.error()),
            "object 1018h:01h refused: the highest subindex of this object is 2");
}

TEST(DictionaryRead, GivesExactlyTheBytesOfTheType) {
  const auto dictionary = make_small_drive();
  std::array<std::byte, 6> out{};
  out.fill(std::byte{0xEE});
  Entry& target = *dictionary->find(0x607A, 0);
  ASSERT_TRUE(dictionary->read(target, out).has_value());
  const std::array expected{std::byte{0xF9}, std::byte{0xFF}, std::byte{0xFF},
                            std::byte{0xFF}, std::byte{0xEE}, std::byte{0xEE}};
  EXPECT_EQ(out, expected);
}

TEST(DictionaryRead, GivesATextWithoutATerminator) {
  const auto dictionary = make_small_drive();
  Entry& name = *dictionary->find(0x1008, 0);
  ASSERT_TRUE(dictionary->prepare_read(name).has_value());
  ASSERT_EQ(name.size(), 9U);
  EXPECT_EQ(name.bits(), 72U);
  std::array<char, 9> out{};
  ASSERT_TRUE(dictionary->read(name, std::as_writable_bytes(std::span(out))).has_value());
  EXPECT_EQ(std::string_view(out.data(), out.size()), "TMCM-3315");
}

TEST(DictionaryWrite, SaysBeforeTheDataCameWhatItWouldRefuse) {
  const auto dictionary = make_small_drive();
  const AccessContext operational{.network_state = NetworkState::operational};
  expect_refused(dictionary->prepare_write(*dictionary->find(0x1000, 0), {}, {}),
                 AbortCode::read_only,
                 "write to 1000h:00h \"Device type\" refused: the object is read-only");
  EXPECT_EQ(dictionary->prepare_write(*dictionary->find(0x2003, 0), {}, operational).error().code,
            AbortCode::device_state);
  Entry& target = *dictionary->find(0x607A, 0);
  EXPECT_EQ(dictionary->prepare_write(target, 5, {}).error().code, AbortCode::length_too_high);
  EXPECT_EQ(dictionary->prepare_write(target, 3, {}).error().code, AbortCode::length_too_low);
  EXPECT_TRUE(dictionary->prepare_write(target, {}, {}).has_value());
  EXPECT_TRUE(dictionary->prepare_write(*dictionary->find(0x2001, 0), 500, {}).has_value());
  EXPECT_EQ(target.signed_value(), -7);
}

TEST(DictionaryRead, LetsADomainBeReadInPartsWithoutACopy) {
  const auto dictionary = make_small_drive();
  Entry& eds = *dictionary->find(0x1021, 0);
  ASSERT_TRUE(dictionary->find(0x1021)->single());
  eds.set_text("[FileInfo]\n");
  ASSERT_EQ(eds.size(), 11U);
  const std::span<const std::byte> bytes = eds.bytes();
  ASSERT_EQ(bytes.size(), 11U);
  EXPECT_EQ(static_cast<const void*>(bytes.data()), eds.text().data());
  EXPECT_EQ(bytes[1], std::byte{'F'});
}

TEST(DictionaryRead, OfAWriteOnlyObjectIsRefused) {
  const auto dictionary = make_small_drive();
  std::array<std::byte, 4> out{};
  expect_refused(dictionary->read(*dictionary->find(0x2002, 0), out), AbortCode::write_only,
                 "read of 2002h:00h \"Key\" refused: the object is write-only");
}

TEST(DictionaryWrite, StoresWhatTheMasterSends) {
  const auto dictionary = make_small_drive();
  ASSERT_TRUE(write(*dictionary, 0x607A, std::int32_t{-1000}).has_value());
  EXPECT_EQ(dictionary->find(0x607A, 0)->signed_value(), -1000);
  ASSERT_TRUE(write(*dictionary, 0x2002, std::uint32_t{0xFFFFFFFF}).has_value());
  EXPECT_EQ(dictionary->find(0x2002, 0)->value(), 0xFFFFFFFFU);
  ASSERT_TRUE(write(*dictionary, 0x2005, std::uint64_t{0xFFFFFFFFFFFFFFFF}).has_value());
  EXPECT_EQ(dictionary->find(0x2005, 0)->value(), 0xFFFFFFFFFFFFFFFFU);
}

TEST(DictionaryWrite, ExtendsTheSignOfSignedTypesOnly) {
  const auto dictionary = make_small_drive();
  ASSERT_TRUE(write(*dictionary, 0x6060, std::uint8_t{0xFF}).has_value());
  EXPECT_EQ(dictionary->find(0x6060, 0)->signed_value(), -1);
  ASSERT_TRUE(write(*dictionary, 0x6040, std::uint16_t{0xFFFF}).has_value());
  EXPECT_EQ(dictionary->find(0x6040, 0)->signed_value(), 0xFFFF);
}

TEST(DictionaryWrite, StoresTextsOfAnyLength) {
  const auto dictionary = make_small_drive();
  Entry& owner = *dictionary->find(0x2001, 0);
  const std::string text(100, 'x');
  ASSERT_TRUE(dictionary->write(owner, std::as_bytes(std::span(text)), {}).has_value());
  EXPECT_EQ(owner.text(), text);
  ASSERT_TRUE(dictionary->write(owner, {}, {}).has_value());
  EXPECT_EQ(owner.size(), 0U);
}

TEST(DictionaryWrite, OfReadOnlyAndConstantObjectsIsRefused) {
  const auto dictionary = make_small_drive();
  expect_refused(write(*dictionary, 0x1000, std::uint32_t{1}), AbortCode::read_only,
                 "write to 1000h:00h \"Device type\" refused: the object is read-only");
  expect_refused(
      write(*dictionary, 0x1008, std::uint32_t{1}), AbortCode::read_only,
      "write to 1008h:00h \"Manufacturer device name\" refused: the object is read-only");
}

TEST(DictionaryWrite, WithAnotherLengthThanTheTypeIsRefused) {
  const auto dictionary = make_small_drive();
  expect_refused(write(*dictionary, 0x6040, std::uint32_t{6}), AbortCode::length_too_high,
                 "write to 6040h:00h \"Controlword\" refused: 4 bytes came, the data type has 2");
  expect_refused(write(*dictionary, 0x6040, std::uint8_t{6}), AbortCode::length_too_low,
                 "write to 6040h:00h \"Controlword\" refused: 1 bytes came, the data type has 2");
  EXPECT_EQ(dictionary->find(0x6040, 0)->value(), 0U);
}

TEST(DictionaryWrite, LongerThanAnyNumberIsRefusedAsWell) {
  const auto dictionary = make_small_drive();
  const std::array<std::byte, 500> data{};
  expect_refused(dictionary->write(*dictionary->find(0x6040, 0), data, {}),
                 AbortCode::length_too_high,
                 "write to 6040h:00h \"Controlword\" refused: 500 bytes came, the data type has 2");
}

TEST(DictionaryWrite, OutsideTheRangeIsRefusedWithTheSignOfTheType) {
  const auto dictionary = make_small_drive();
  expect_refused(write(*dictionary, 0x607A, std::int32_t{1001}), AbortCode::value_too_high,
                 "write to 607Ah:00h \"Target position\" refused: 1001 is above the maximum 1000");
  expect_refused(
      write(*dictionary, 0x607A, std::int32_t{-1001}), AbortCode::value_too_low,
      "write to 607Ah:00h \"Target position\" refused: -1001 is below the minimum -1000");
  expect_refused(write(*dictionary, 0x2000, std::uint8_t{0xFF}), AbortCode::value_too_high,
                 "write to 2000h:00h \"Microstep resolution\" refused: 255 is above the maximum 8");
  expect_refused(write(*dictionary, 0x2000, std::uint8_t{0}), AbortCode::value_too_low,
                 "write to 2000h:00h \"Microstep resolution\" refused: 0 is below the minimum 1");
  EXPECT_EQ(dictionary->find(0x607A, 0)->signed_value(), -7);
}

TEST(DictionaryWrite, OfABooleanTakesZeroAndOneOnly) {
  const auto dictionary = make_small_drive();
  ASSERT_TRUE(write(*dictionary, 0x2004, std::uint8_t{1}).has_value());
  expect_refused(write(*dictionary, 0x2004, std::uint8_t{2}), AbortCode::value_too_high,
                 "write to 2004h:00h \"Enabled\" refused: 2 is above the maximum 1");
  EXPECT_EQ(dictionary->find(0x2004, 0)->value(), 1U);
}

TEST(DictionaryWrite, OfAValueTheDeviceDoesNotSupportIsRefused) {
  const auto dictionary = make_small_drive();
  for (const int mode : {-1, 1, 8}) {
    EXPECT_TRUE(write(*dictionary, 0x6060, static_cast<std::int8_t>(mode)).has_value()) << mode;
  }
  for (const auto& [mode, words] : {std::pair(3, "3"), std::pair(9, "9"), std::pair(-2, "-2")}) {
    expect_refused(write(*dictionary, 0x6060, static_cast<std::int8_t>(mode)),
                   AbortCode::value_range_exceeded,
                   "write to 6060h:00h \"Modes of operation\" refused: " + std::string(words) +
                       " is none of the values the device supports: -1, 1, 8");
  }
  EXPECT_EQ(dictionary->find(0x6060, 0)->signed_value(), 8);
}

TEST(DictionaryWrite, InAStateThatForbidsItIsRefused) {
  const auto dictionary = make_small_drive();
  EXPECT_TRUE(
      write(*dictionary, 0x2003, std::uint16_t{2000}, NetworkState::pre_operational).has_value());
  expect_refused(write(*dictionary, 0x2003, std::uint16_t{3000}, NetworkState::operational),
                 AbortCode::device_state,
                 "write to 2003h:00h \"Cycle time\" refused in Operational: it can be written in "
                 "Pre-Operational only; change the state first");
  EXPECT_EQ(dictionary->find(0x2003, 0)->value(), 2000U);
}

class PowerDrive {
 public:
  [[nodiscard]] base::StaticText state_of(std::uint8_t /*axis*/) const { return state; }
  base::StaticText state;
};

TEST(DictionaryWrite, WhileThePowerDriveIsOnIsRefusedWhereItMustBeOff) {
  const auto dictionary = make_small_drive();
  PowerDrive drive;
  dictionary->set_drive_state_query(
      Dictionary::DriveStateQuery::bind<&PowerDrive::state_of>(drive));
  EXPECT_TRUE(write(*dictionary, 0x2000, std::uint8_t{4}).has_value());
  drive.state = "Operation enabled";
  expect_refused(write(*dictionary, 0x2000, std::uint8_t{5}), AbortCode::device_state,
                 "write to 2000h:00h \"Microstep resolution\" refused: the power drive is in "
                 "Operation enabled, must be in Switch on disabled; write controlword 0 first");
  EXPECT_TRUE(write(*dictionary, 0x607A, std::int32_t{5}).has_value());
  EXPECT_EQ(dictionary->find(0x2000, 0)->value(), 4U);
}

}  // namespace
}  // namespace stator::dictionary
