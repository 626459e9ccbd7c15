// The texts by which an entry of a dictionary is described in tables.
#include "stator/dictionary/description.hpp"

#include <gtest/gtest.h>

#include "small_drive.hpp"

namespace stator::dictionary {
namespace {

EntryDescription describe(std::uint16_t index) {
  return dictionary::describe(*make_small_drive()->find(index, 0));
}

TEST(EntryDescription, NamesEveryPropertyOfAnEntry) {
  const EntryDescription target = describe(0x607A);
  EXPECT_EQ(target.index, "607A");
  EXPECT_EQ(target.subindex, "00");
  EXPECT_EQ(target.name, "Target position");
  EXPECT_EQ(target.object_type, "VAR");
  EXPECT_EQ(target.data_type, "INTEGER32");
  EXPECT_EQ(target.access, "rw");
  EXPECT_EQ(target.pdo_mapping, "no");
  EXPECT_EQ(target.default_value, "-7");
  EXPECT_EQ(target.minimum, "-1000");
  EXPECT_EQ(target.maximum, "1000");
}

TEST(EntryDescription, TellsADomainFromAVariable) {
  EXPECT_EQ(describe(0x1021).object_type, "DOMAIN");
  EXPECT_EQ(describe(0x1021).data_type, "DOMAIN");
}

TEST(EntryDescription, ShowsADefaultAsItsDocumentDoes) {
  EXPECT_EQ(describe(0x1000).default_value, "0xFFFC0192");
  EXPECT_EQ(describe(0x1008).default_value, "TMCM-3315");
  EXPECT_EQ(describe(0x2003).default_value, "1000");
}

TEST(EntryDescription, LeavesOutWhatTheDocumentDoesNotGive) {
  constexpr auto kDeclarations =
      std::to_array<EntryDeclaration>({{.index = 0x2000, .default_value = undocumented(5)}});
  Dictionary dictionary;
  dictionary.add(kDeclarations);
  dictionary.finish();
  const Entry& entry = *dictionary.find(0x2000, 0);
  EXPECT_EQ(dictionary::describe(entry).default_value, "");
  EXPECT_EQ(dictionary::describe(entry).minimum, "");
  EXPECT_EQ(entry.value(), 5U);
}

TEST(EntryDescription, SaysWhereAPlacedEntryWasDeclared) {
  Dictionary dictionary;
  dictionary.add(kSmallDrive, {.axis = 1, .index_offset = 0x800, .name_prefix = "Axis 1: "});
  dictionary.finish();
  const EntryDescription target = dictionary::describe(*dictionary.find(0x687A, 0));
  EXPECT_EQ(target.index, "687A");
  EXPECT_EQ(target.name, "Axis 1: Target position");
  EXPECT_EQ(target.notes, "Motor 0 index 607Ah + 800h.");
}

TEST(EntryDescription, HasAsManyColumnsAsTheirNames) {
  const EntryDescription target = describe(0x607A);
  EXPECT_EQ(target.columns().size(), kDescriptionColumns.size());
  EXPECT_EQ(target.columns()[2], "Target position");
  EXPECT_EQ(kDescriptionColumns[2], "name");
}

}  // namespace
}  // namespace stator::dictionary
