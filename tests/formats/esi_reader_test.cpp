// What is read of ESI files as they are in real life. Each file of tests/data/esi_files has one
// construct, which its name tells.
#include "stator/formats/esi/esi_reader.hpp"

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "formats/esi_file.hpp"

namespace stator::formats {
namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::ImportKind;
using dictionary::ObjectCode;
using dictionary::PdoMapping;
using ethercat::ImportedPdo;
using Read = tests::ReadEsi;
using tests::esi_refusal;

TEST(EsiEncoding, NamesAreReadInEveryEncoding) {
  for (const auto& [file, name] :
       {std::pair{"utf_8_with_mark", "Größe 3"}, std::pair{"no_declaration", "Größe 3"},
        std::pair{"latin_1_misspelt", "Größe 3"}, std::pair{"windows_1252", "Größe 3 – 5 €"},
        std::pair{"iso_8859_15", "Größe 3 €"}, std::pair{"latin_1_unnamed", "Größe 3"},
        std::pair{"utf_8_named_latin_1", "Größe 3"}, std::pair{"utf_16", "Größe 3"},
        std::pair{"utf_16_without_mark", "Größe 3"}, std::pair{"no_line_feeds", "Größe 3"},
        std::pair{"zeros_behind_end", "Größe 3"},
        std::pair{"document_type_without_entities", "Größe 3"}}) {
    const Read read(file);
    EXPECT_EQ(read->description.name, name) << file;
    EXPECT_EQ(read->description.product_code, 0x1234U) << file;
  }
}

TEST(EsiEncoding, WhatContradictsItsNameIsToldAsRepaired) {
  EXPECT_EQ(Read("latin_1_unnamed").notes("encoding", ImportKind::repaired), 1);
  EXPECT_EQ(Read("utf_8_named_latin_1").notes("encoding", ImportKind::repaired), 1);
  EXPECT_EQ(Read("latin_1_misspelt").notes("encoding", ImportKind::repaired), 0);
}

TEST(EsiRefusal, EntitiesAreRefusedWithTheirLine) {
  const dictionary::ImportError error = esi_refusal("entity_declared");
  EXPECT_EQ(error.rule, "xml-entity");
  EXPECT_EQ(error.line, 4U);
}

TEST(EsiRefusal, OtherFormatsAreRefusedByName) {
  EXPECT_NE(esi_refusal("powerlink_profile").text.find("POWERLINK"), std::string::npos);
  EXPECT_NE(esi_refusal("network_information").text.find("ENI"), std::string::npos);
  EXPECT_EQ(esi_refusal("network_information").rule, "other-format");
  EXPECT_EQ(esi_refusal("modules_only").rule, "no-device");
  const dictionary::ImportError cut = esi_refusal("cut_off");
  EXPECT_EQ(cut.rule, "not-xml");
  EXPECT_GT(cut.line, 10U);
}

TEST(EsiRefusal, WhatIsNoTextOrNestedWithoutEndIsRefused) {
  dictionary::ImportReport report;
  EXPECT_EQ(read_esi("", {}, report).error().rule, "not-xml");
  EXPECT_EQ(read_esi("[FileInfo]", {}, report).error().rule, "not-xml");
  EXPECT_EQ(read_esi(std::string("<a>\0</a>", 8), {}, report).error().rule, "not-xml");
  std::string deep;
  for (int i = 0; i < 100'000; ++i) {
    deep += "<a>";
  }
  for (int i = 0; i < 100'000; ++i) {
    deep += "</a>";
  }
  EXPECT_EQ(read_esi(deep, {}, report).error().rule, "too-deep");
  std::string wide = "<EtherCATInfo>";
  for (int i = 0; i < 100'000; ++i) {
    wide += "<a/>";
  }
  EXPECT_EQ(read_esi(wide + "</EtherCATInfo>", {}, report).error().rule, "too-deep");
}

TEST(EsiIdentity, TheEnglishNameIsTaken) {
  const Read read("names_in_several_languages");
  EXPECT_EQ(read->description.name, "Drive <7> kW");
  EXPECT_EQ(Read("brackets_as_characters")->description.name, "Large drive");
  EXPECT_EQ(read->description.order_code, "T-7");
  EXPECT_EQ(read->description.group, "Examples");
  EXPECT_EQ(read->description.vendor_name, "Example Makers");
  EXPECT_EQ(read->description.vendor_id, 0xABCU);
  EXPECT_EQ(read->description.product_code, 0x12345678U);
  EXPECT_EQ(read->description.revision, 7U);
  EXPECT_EQ(read->description.ebus_current, -90);
  EXPECT_EQ(read->description.port_physics, (std::array<char, 4>{'Y', 'K', ' ', ' '}));
}

TEST(EsiIdentity, WhatIsTooLongOrMissingIsTold) {
  const Read read("identity_longer_than_32_bits");
  EXPECT_EQ(read->description.product_code, 0x34910000U);
  EXPECT_EQ(read.notes("identity", ImportKind::repaired), 1);
  EXPECT_EQ(read.notes("identity", ImportKind::assumed), 1);
}

TEST(EsiIdentity, OfSeveralProfilesTheDrivesCounts) {
  const Read read("several_profiles");
  EXPECT_EQ(read->profile, 402);
  EXPECT_NE(read.find(0x6040, 0), nullptr);
  EXPECT_NE(read.find(0x6840, 0), nullptr);
}

TEST(EsiIdentity, ATerminalHasNeitherMailboxNorDictionary) {
  const Read read("terminal_without_dictionary");
  EXPECT_TRUE(read->objects.rows().empty());
  EXPECT_EQ(read.notes("no-dictionary", ImportKind::assumed), 1);
  EXPECT_FALSE(read->description.coe);
  EXPECT_EQ(read->description.receive_mailbox.length, 0);
  EXPECT_EQ(read->description.output_offset, 0x0F00);
  ASSERT_EQ(read->receive_pdos.size(), 1U);
  EXPECT_TRUE(read->receive_pdos[0].fixed);
  EXPECT_TRUE(read->receive_pdos[0].mandatory);
  EXPECT_EQ(read->receive_pdos[0].sync_manager, 0);
  EXPECT_EQ(read->receive_pdos[0].entries[0].type, DataType::boolean);
}

TEST(EsiValues, NumbersAreReadInEverySpelling) {
  const Read read("numbers");
  EXPECT_EQ(read.value(0x2000), 12);
  EXPECT_EQ(read.value(0x2001), 0x1F);
  EXPECT_TRUE(read.row(0x2001).default_value.number.hexadecimal);
  EXPECT_EQ(read.value(0x2002), 0x2E);
  EXPECT_EQ(read.value(0x2003), -3);
  EXPECT_EQ(read.value(0x2004), -1);
  EXPECT_EQ(read.value(0x2005), 300 - 256);
  EXPECT_EQ(read.notes("default-value", ImportKind::repaired), 1);
  EXPECT_EQ(read.value(0x2006), 1);
  EXPECT_EQ(read.value(0x2007), 0x3FC00000);
  EXPECT_FALSE(read.row(0x2008).default_value.documented);
  EXPECT_EQ(read.notes("default-value", ImportKind::left_out), 1);
  EXPECT_EQ(read.notes("object-index", ImportKind::left_out), 1);
}

TEST(EsiValues, DefaultDataAreBytesFromTheLowest) {
  const Read read("default_data");
  EXPECT_EQ(read.value(0x2000), 0x12345678);
  EXPECT_EQ(read.value(0x2001), -2);
  EXPECT_EQ(read.row(0x2002).default_value.text, "ABC");
  EXPECT_EQ(read.row(0x2003).default_value.text, "\1\2\3\4");
  EXPECT_EQ(read.row(0x2003).type, DataType::octet_string);
  EXPECT_EQ(read.row(0x2004).default_value.text, std::string_view("\0\0\0\0", 4));
  EXPECT_EQ(read.value(0x2005), 1);
  EXPECT_EQ(read.value(0x2006), 0x1234);
  EXPECT_EQ(read.notes("default-value", ImportKind::repaired), 2) << read.all_notes();
  EXPECT_EQ(read.row(0x2007).default_value.text, "Hello");
  EXPECT_EQ(read.row(0x2007).type, DataType::visible_string);
  EXPECT_FALSE(read.row(0x2008).default_value.documented);
  EXPECT_EQ(read.value(0x2009), 0x3FC00000);
  EXPECT_EQ(read.row(0x200A).default_value.text, "");
  EXPECT_EQ(read.row(0x200B).default_value.text, std::string_view("A\0B\0", 4));
  EXPECT_EQ(read.value(0x200C), 0x12345678);
}

TEST(EsiValues, LimitsMakeARangeUnlessTheyAreEqual) {
  const Read read("limits");
  EXPECT_EQ(read.row(0x2000).range->minimum.as_signed(), -10);
  EXPECT_EQ(read.row(0x2000).range->maximum.as_signed(), 10);
  EXPECT_EQ(read.row(0x2001).range->maximum.bits, 16U);
  EXPECT_EQ(read.row(0x2002).range->minimum.as_signed(), -128);
  EXPECT_FALSE(read.row(0x2003).range);
}

TEST(EsiObjects, FlagsOfASubindexCountBeforeThoseOfTheObject) {
  const Read read("flags");
  EXPECT_EQ(read.row(0x2000).access, Access::read_only);
  EXPECT_EQ(read.row(0x2000).mapping, PdoMapping::transmit);
  EXPECT_EQ(read.row(0x2001).access, Access::write_only);
  EXPECT_EQ(read.row(0x2001).mapping, PdoMapping::receive);
  EXPECT_EQ(read.row(0x2002).access, Access::read_write);
  EXPECT_EQ(read.row(0x2002).mapping, PdoMapping::both);
  EXPECT_EQ(read.row(0x2002).write_states, 3);
  EXPECT_EQ(read.row(0x2003).write_states, dictionary::kPreOperationalOnly);
  EXPECT_EQ(read.notes("read-restrictions", ImportKind::left_out), 1);
  EXPECT_EQ(read.row(0x2004, 1).access, Access::read_only);
  EXPECT_EQ(read.row(0x2004, 1).mapping, PdoMapping::transmit);
  EXPECT_EQ(read.row(0x2004, 2).access, Access::read_write);
  EXPECT_EQ(read.row(0x2004, 2).mapping, PdoMapping::receive);
  EXPECT_EQ(read.row(0x2005).access, Access::read_write);
  EXPECT_EQ(read.notes("access", ImportKind::assumed), 1);
}

TEST(EsiObjects, TypesAreFoundByNameAliasAndLength) {
  const Read read("data_types");
  EXPECT_EQ(read.row(0x2000).type, DataType::integer8);
  EXPECT_EQ(read.value(0x2000), -1);
  EXPECT_EQ(read.row(0x2000).note, "0 = off, 1 = on, -1 = backwards");
  EXPECT_EQ(read.row(0x2001).type, DataType::bit3);
  EXPECT_EQ(read.row(0x2002).type, DataType::integer8);
  EXPECT_EQ(read.row(0x2002).note, read.row(0x2000).note);
  EXPECT_EQ(read.row(0x2003).type, DataType::unsigned16);
  EXPECT_EQ(read.row(0x2004).type, DataType::visible_string);
  EXPECT_EQ(read.row(0x2005).type, DataType::octet_string);
  EXPECT_EQ(read.row(0x2005).object_code, ObjectCode::variable);
  EXPECT_EQ(read.row(0x2005).default_value.text.size(), 6U);
  EXPECT_EQ(read.row(0x2006).type, DataType::bit5);
  EXPECT_EQ(read.row(0x2007).type, DataType::unsigned24);
  EXPECT_EQ(read.row(0x2008).type, DataType::unsigned16);
  EXPECT_EQ(read.row(0x2009).default_value.text.size(), 4U);
  EXPECT_EQ(read.row(0x200A).type, DataType::unsigned16);  // by its length
  EXPECT_EQ(read.row(0x200B).type, DataType::time_of_day);
}

TEST(EsiObjects, UnknownTypesAreTakenByLength) {
  const Read read("unknown_types");
  EXPECT_EQ(read.row(0x2000).type, DataType::unsigned16);
  EXPECT_EQ(read.row(0x2001).type, DataType::octet_string);
  EXPECT_EQ(read.row(0x2001).default_value.text.size(), 100U);
  EXPECT_EQ(read.row(0x2002).type, DataType::unsigned32);
  EXPECT_EQ(read.row(0x2003).type, DataType::unsigned8);
  EXPECT_EQ(read.notes("type-unknown", ImportKind::assumed), 4);
  EXPECT_GT(read.line("type-unknown"), 30U);
}

TEST(EsiObjects, RecordsHaveACountNamesAndGaps) {
  const Read read("records");
  EXPECT_EQ(read.subindices(0x1018), (std::vector<int>{0, 1, 2, 4}));
  EXPECT_EQ(read.row(0x1018).object_name, "Identity");
  EXPECT_EQ(read.row(0x1018).object_code, ObjectCode::record);
  EXPECT_EQ(read.row(0x1018).type, DataType::unsigned8);
  EXPECT_EQ(read.value(0x1018), 4);
  EXPECT_EQ(read.row(0x1018, 1).name, "Vendor");
  EXPECT_EQ(read.value(0x1018, 1), 0xABC);
  EXPECT_EQ(read.subindices(0x2000), (std::vector<int>{0, 1}));
  EXPECT_EQ(read.value(0x2000), 1);
  EXPECT_EQ(read.row(0x2000).access, Access::read_only);
}

TEST(EsiObjects, ArraysAreAsLongAsTheirTypeSays) {
  const Read read("arrays");
  EXPECT_EQ(read.subindices(0x1C12), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(read.row(0x1C12).object_code, ObjectCode::array);
  EXPECT_EQ(read.value(0x1C12), 1);  // assigned now, not at most
  EXPECT_EQ(read.row(0x1C12).access, Access::read_write);
  EXPECT_EQ(read.value(0x1C12, 1), 0x1600);
  EXPECT_EQ(read.row(0x1C12, 1).name, "SubIndex 001");
  EXPECT_EQ(read.row(0x1C12, 4).type, DataType::unsigned16);
  EXPECT_EQ(read.subindices(0x2000), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(read.value(0x2000), 3);
  EXPECT_EQ(read.subindices(0x2001), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(read.row(0x2001).object_code, ObjectCode::record);
}

TEST(EsiObjects, ValuesOfSomeSubindicesAreFoundByName) {
  const Read read("values_of_some_subindices");
  EXPECT_FALSE(read.row(0x2000, 1).default_value.documented);
  EXPECT_EQ(read.value(0x2000, 2), 2);
  EXPECT_EQ(read.value(0x2000), 3);
  EXPECT_EQ(read.value(0x2001, 1), 1);
  EXPECT_EQ(read.value(0x2001, 3), 3);
  EXPECT_EQ(read.notes("value-without-subindex", ImportKind::left_out), 1);
}

TEST(EsiObjects, TheValueOfAWholeObjectIsDivided) {
  const Read read("value_of_whole_object");
  EXPECT_EQ(read.value(0x2000, 1), 0x1234);
  EXPECT_EQ(read.value(0x2000, 2), -2);
}

TEST(EsiObjects, TheFirstOfTwoCounts) {
  const Read read("objects_and_types_twice");
  EXPECT_EQ(read.row(0x2000).name, "First");
  EXPECT_EQ(read.row(0x2000).type, DataType::unsigned16);
  EXPECT_EQ(read.row(0x2001, 1).name, "First");
  for (const char* rule : {"object-twice", "type-twice", "subindex-twice"}) {
    EXPECT_EQ(read.notes(rule, ImportKind::repaired), 1) << rule;
  }
}

TEST(EsiObjects, WrongCountsAreRepaired) {
  const Read read("wrong_counts");
  EXPECT_EQ(read.value(0x2000), 1);
  EXPECT_EQ(read.value(0x2001), 1);
  EXPECT_EQ(read.notes("highest-subindex", ImportKind::repaired), 2);
  const Read longer("more_than_255_subindices");
  EXPECT_EQ(longer.subindices(0x2000).size(), 256U);
  EXPECT_EQ(longer.value(0x2000), 255);
  EXPECT_EQ(longer.notes("too-many-subindices", ImportKind::left_out), 1);
}

TEST(EsiObjects, OlderFilesHaveThemInTheMailbox) {
  const Read read("objects_in_mailbox");
  EXPECT_EQ(read.value(0x2000), 10);
  EXPECT_FALSE(read->description.sdo_information);
}

TEST(EsiPdos, TheDefaultIsTheOneWithASyncManager) {
  const Read read("default_pdo_is_not_first");
  ASSERT_EQ(read->receive_pdos.size(), 3U);
  EXPECT_FALSE(read->receive_pdos[0].sync_manager);
  EXPECT_EQ(read->receive_pdos[1].sync_manager, 2);
  EXPECT_TRUE(read->receive_pdos[1].mandatory);
  EXPECT_EQ(read->receive_pdos[1].excluded, (std::vector<std::uint16_t>{0x1600}));
  EXPECT_EQ(read->receive_pdos[1].entries[1].index, 0x607A);
  EXPECT_EQ(read->receive_pdos[1].entries[1].type, DataType::integer32);
  EXPECT_TRUE(read->receive_pdos[2].entries.empty());
  ASSERT_EQ(read->transmit_pdos.size(), 1U);
  EXPECT_EQ(read->transmit_pdos[0].entries[0].name, "Statusword");
}

TEST(EsiPdos, OfThoseThatExcludeOneAnotherTheFirstIsAssigned) {
  const Read read("pdos_that_exclude_one_another");
  EXPECT_EQ(read->receive_pdos[0].sync_manager, 2);
  EXPECT_FALSE(read->receive_pdos[1].sync_manager);
  EXPECT_EQ(read->receive_pdos[2].sync_manager, 2);  // what excludes it is not assigned
  EXPECT_EQ(read.notes("pdo-excluded", ImportKind::repaired), 1);
}

TEST(EsiPdos, GapsHaveAnyLengthAndMayBeOnTypes) {
  const Read read("gaps");
  std::vector<std::pair<int, int>> entries;
  for (const ImportedPdo::Entry& entry : read->transmit_pdos[0].entries) {
    entries.emplace_back(entry.index, entry.bits);
  }
  EXPECT_EQ(entries, (std::vector<std::pair<int, int>>{
                         {0x6000, 1}, {0, 1}, {0, 0}, {0, 6}, {0, 8}, {0x6000, 8}}));
  EXPECT_EQ(read.notes("type-mapped", ImportKind::repaired), 1);
}

TEST(EsiPdos, DevicesWithoutMailboxHaveDataAtTypeNumbers) {
  const Read read("data_at_type_numbers");
  ASSERT_EQ(read->receive_pdos[0].entries.size(), 2U);
  EXPECT_EQ(read->receive_pdos[0].entries[1].index, 5);
  EXPECT_EQ(read->receive_pdos[0].entries[1].subindex, 2);
  EXPECT_EQ(read->receive_pdos[0].entries[1].name, "Byte 1");
  EXPECT_EQ(read->transmit_pdos[0].entries[0].index, 6);
  ASSERT_EQ(read->sync_managers.size(), 2U);  // whose names and control bytes tell nothing
  EXPECT_EQ(read->sync_managers[0].type, 3);
  EXPECT_EQ(read->sync_managers[1].type, 4);
}

TEST(EsiPdos, WhatMapsItselfIsRepaired) {
  const Read read("pdo_maps_itself");
  ASSERT_EQ(read->transmit_pdos[0].entries.size(), 1U);
  EXPECT_EQ(read->transmit_pdos[0].entries[0].subindex, 2);
  EXPECT_EQ(read.notes("pdo-maps-itself", ImportKind::repaired), 1);
}

TEST(EsiPdos, BitsCountBeforeTypes) {
  const Read read("entries_of_other_lengths");
  const std::vector<ImportedPdo::Entry>& entries = read->transmit_pdos[0].entries;
  ASSERT_EQ(entries.size(), 5U);
  EXPECT_EQ(entries[0].bits, 8);
  EXPECT_FALSE(entries[0].type);
  EXPECT_EQ(entries[1].bits, 16);
  EXPECT_EQ(entries[1].type, DataType::unsigned16);
  EXPECT_EQ(entries[2].bits, 400);
  EXPECT_EQ(entries[2].type, DataType::octet_string);
  EXPECT_EQ(entries[3].type, DataType::bit3);
  EXPECT_FALSE(entries[4].type);
  EXPECT_EQ(read.notes("entry-length", ImportKind::repaired), 1);
  EXPECT_EQ(read.notes("entry-length", ImportKind::assumed), 1);
  EXPECT_EQ(read.notes("pdo-entry", ImportKind::left_out), 1);
}

TEST(EsiPdos, WhatTheFileMapsCanBeMapped) {
  const Read read("mapped_without_flag");
  EXPECT_EQ(read.row(0x6040).mapping, PdoMapping::both);
  EXPECT_EQ(read.notes("mapping-flag", ImportKind::repaired), 2);
}

TEST(EsiPdos, TheFirstOfTwoCounts) {
  const Read read("pdos_twice");
  ASSERT_EQ(read->transmit_pdos.size(), 2U);
  EXPECT_EQ(read->transmit_pdos[0].name, "First");
  EXPECT_FALSE(read->transmit_pdos[1].sync_manager);
  for (const char* rule : {"pdo-twice", "pdo-index", "pdo-sync-manager"}) {
    EXPECT_EQ(read.notes(rule, ImportKind::left_out), 1) << rule;
  }
}

}  // namespace
}  // namespace stator::formats
