#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "small_drive.hpp"

namespace stator::dictionary {
namespace {

/// What finish() objects to; empty if it does not.
std::string refusal_of(const std::vector<EntryDeclaration>& declarations) {
  Dictionary dictionary;
  dictionary.add(declarations);
  try {
    dictionary.finish();
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "";
}

TEST(DictionaryConstruction, ObjectsAndEntriesAreSortedWhateverTheOrderOfDeclaration) {
  const std::vector<EntryDeclaration> declarations{
      {.index = 0x6000, .subindex = 1}, {.index = 0x2000}, {.index = 0x6000, .subindex = 0}};
  Dictionary dictionary;
  dictionary.add(declarations);
  dictionary.finish();
  ASSERT_EQ(dictionary.objects().size(), 2U);
  EXPECT_EQ(dictionary.objects()[0].index, 0x2000);
  EXPECT_EQ(dictionary.objects()[1].index, 0x6000);
  ASSERT_EQ(dictionary.objects()[1].entries.size(), 2U);
  EXPECT_EQ(dictionary.objects()[1].entries[0].subindex(), 0);
  EXPECT_EQ(dictionary.objects()[1].entries[1].subindex(), 1);
}

TEST(DictionaryConstruction, AnEntryDeclaredTwiceIsRejectedByName) {
  EXPECT_EQ(refusal_of({{.index = 0x2000}, {.index = 0x2001}, {.index = 0x2000}}),
            "dictionary entry 2000h:00: declared twice");
}

TEST(DictionaryConstruction, AnObjectWithoutSubindexZeroIsRejected) {
  EXPECT_EQ(refusal_of({{.index = 0x1A0F, .subindex = 0x1B}}),
            "dictionary entry 1A0Fh:1B: subindex 0 is missing");
}

TEST(DictionaryConstruction, ADefaultThatIsNoValueOfItsTypeIsRejected) {
  EXPECT_EQ(refusal_of({{.index = 0x2000, .type = DataType::unsigned8, .default_value = 256}}),
            "dictionary entry 2000h:00: default is no value of its type UNSIGNED8");
  EXPECT_NE(refusal_of({{.index = 0x2000, .type = DataType::unsigned32, .default_value = -1}}), "");
  EXPECT_NE(refusal_of({{.index = 0x2000, .type = DataType::integer8, .default_value = 128}}), "");
  EXPECT_EQ(refusal_of({{.index = 0x2000, .type = DataType::integer8, .default_value = -128}}), "");
}

TEST(DictionaryConstruction, ABoundThatIsNoValueOfItsTypeIsRejected) {
  EXPECT_EQ(refusal_of({{.index = 0x2000, .type = DataType::integer16, .range = Range{0, 32768}}}),
            "dictionary entry 2000h:00: maximum is no value of its type INTEGER16");
  EXPECT_EQ(refusal_of({{.index = 0x2000, .type = DataType::unsigned16, .range = Range{-1, 5}}}),
            "dictionary entry 2000h:00: minimum is no value of its type UNSIGNED16");
}

TEST(DictionaryConstruction, AnEmptyRangeIsRejectedWithTheSignOfTheType) {
  EXPECT_EQ(refusal_of({{.index = 0x2000, .type = DataType::integer16, .range = Range{1, -1}}}),
            "dictionary entry 2000h:00: maximum is below minimum");
  EXPECT_EQ(refusal_of({{.index = 0x2000, .type = DataType::integer16, .range = Range{-1, 1}}}),
            "");
}

TEST(DictionaryConstruction, ADefaultOutsideAPrintedRangeIsTheDocumentsBusiness) {
  EXPECT_EQ(refusal_of({{.index = 0x2000,
                         .type = DataType::unsigned8,
                         .default_value = 9,
                         .range = Range{1, 8}}}),
            "");
}

TEST(DictionaryConstruction, NothingIsAddedAfterFinish) {
  const auto dictionary = make_small_drive();
  EXPECT_THROW(dictionary->add(kSmallDrive, {.index_offset = 0x100}), std::logic_error);
}

TEST(DictionaryPlacement, PutsTheSameDeclarationsAtEachAxis) {
  constexpr auto kAxis = std::to_array<EntryDeclaration>({
      {.index = 0x607A, .name = "Target position", .type = DataType::integer32},
      {.index = 0x607D,
       .name = "Number of entries",
       .object_code = ObjectCode::array,
       .type = DataType::unsigned8,
       .default_value = 1,
       .object_name = "Software limits"},
      {.index = 0x607D,
       .subindex = 1,
       .name = "Minimum",
       .object_code = ObjectCode::array,
       .type = DataType::integer32},
  });
  Dictionary dictionary;
  dictionary.add(kAxis, {.axis = 0, .name_prefix = "Axis 0: "});
  dictionary.add(kAxis, {.axis = 2, .index_offset = 0x1000, .name_prefix = "Axis 2: "});
  dictionary.finish();

  const Entry* first = dictionary.find(0x607A, 0);
  const Entry* third = dictionary.find(0x707A, 0);
  ASSERT_NE(first, nullptr);
  ASSERT_NE(third, nullptr);
  EXPECT_EQ(first->axis(), 0);
  EXPECT_EQ(first->name(), "Axis 0: Target position");
  EXPECT_EQ(third->axis(), 2);
  EXPECT_EQ(third->index(), 0x707A);
  EXPECT_EQ(third->name(), "Axis 2: Target position");

  const Object* limits = dictionary.find(0x707D);
  ASSERT_NE(limits, nullptr);
  EXPECT_EQ(limits->name.str(), "Axis 2: Software limits");
  EXPECT_EQ(limits->axis, 2);
  EXPECT_EQ(limits->code, ObjectCode::array);
  EXPECT_EQ(limits->max_subindex(), 1);
}

TEST(DictionaryPlacement, AxesKeepTheirValuesApart) {
  constexpr auto kAxis =
      std::to_array<EntryDeclaration>({{.index = 0x607A, .type = DataType::integer32}});
  Dictionary dictionary;
  dictionary.add(kAxis);
  dictionary.add(kAxis, {.axis = 1, .index_offset = 0x800});
  dictionary.finish();
  dictionary.variable<std::int32_t>(0x687A).set(5);
  EXPECT_EQ(dictionary.variable<std::int32_t>(0x607A).get(), 0);
  EXPECT_EQ(dictionary.variable<std::int32_t>(0x687A).get(), 5);
}

TEST(DictionaryObjects, EntriesOfAnObjectAreThoseItShows) {
  const auto dictionary = make_small_drive();
  for (const Object& object : dictionary->objects()) {
    const std::span<Entry> entries = dictionary->entries_of(object);
    EXPECT_EQ(entries.data(), object.entries.data());
    EXPECT_EQ(entries.size(), object.entries.size());
  }
}

TEST(DictionaryReset, BringsBackNumbersAndTextsWithoutHooks) {
  const auto dictionary = make_small_drive();
  dictionary->find(0x607A, 0)->set_value(99);
  dictionary->find(0x2001, 0)->set_text("somebody");
  dictionary->reset_values();
  EXPECT_EQ(dictionary->find(0x607A, 0)->signed_value(), -7);
  EXPECT_EQ(dictionary->find(0x2001, 0)->text(), "nobody");
}

TEST(DictionaryReset, BringsDefaultsThatCountFromTheNodeIdWithTheNodeIdOfThen) {
  const std::vector<EntryDeclaration> declarations{
      {.index = 0x1005, .default_value = 0x80},
      {.index = 0x1014, .default_value = 0x80, .node_id_relative = true}};
  Dictionary dictionary;
  dictionary.add(declarations);
  dictionary.finish();
  EXPECT_EQ(dictionary.find(0x1014, 0)->value(), 0x80U) << "no node-ID yet";
  for (const std::uint8_t node_id : {std::uint8_t{5}, std::uint8_t{0x7F}}) {
    const std::uint64_t before = dictionary.find(0x1014, 0)->value();
    dictionary.set_node_id(node_id);
    EXPECT_EQ(dictionary.find(0x1014, 0)->value(), before) << "the value waits for the reset";
    dictionary.reset_values();
    EXPECT_EQ(dictionary.find(0x1014, 0)->value(), 0x80U + node_id);
    EXPECT_EQ(dictionary.find(0x1005, 0)->value(), 0x80U);
  }
}

TEST(DictionaryVariable, SeesAndChangesTheValueOfItsEntry) {
  const auto dictionary = make_small_drive();
  auto target = dictionary->variable<std::int32_t>(0x607A);
  EXPECT_EQ(target.get(), -7);
  target.set(-500);
  EXPECT_EQ(dictionary->find(0x607A, 0)->signed_value(), -500);
  ASSERT_TRUE(write(*dictionary, 0x607A, std::int32_t{250}).has_value());
  EXPECT_EQ(target.get(), 250);
}

TEST(DictionaryVariable, OfAConstDictionaryOnlyReads) {
  const auto dictionary = make_small_drive();
  const auto seen = std::as_const(*dictionary).variable<std::int32_t>(0x607A);
  static_assert(std::is_same_v<decltype(seen), const Variable<const std::int32_t>>);
  const Variable<const std::int32_t> same = dictionary->variable<std::int32_t>(0x607A);
  dictionary->find(0x607A, 0)->set_value(5);
  EXPECT_EQ(seen.get(), 5);
  EXPECT_EQ(same.get(), 5);
}

TEST(DictionaryVariable, OfTheWrongTypeIsRejected) {
  const auto dictionary = make_small_drive();
  EXPECT_THROW((void)std::as_const(*dictionary).variable<std::uint32_t>(0x607A), std::logic_error);
  EXPECT_THROW((void)dictionary->variable<std::uint32_t>(0x607A), std::logic_error);
  EXPECT_THROW((void)dictionary->variable<std::int16_t>(0x607A), std::logic_error);
  EXPECT_THROW((void)dictionary->variable<std::int32_t>(0x7777), std::logic_error);
}

}  // namespace
}  // namespace stator::dictionary
