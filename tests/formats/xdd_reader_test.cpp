// XML descriptions of CANopen devices (CiA 311), each file of tests/data/xdd_files with one of
// their constructs.
#include "stator/formats/xdd/xdd_reader.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::formats {
namespace {

using canopen::EdsFile;
using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::ImportReport;
using dictionary::ObjectCode;
using dictionary::PdoMapping;

std::string file_text(const std::string& name) {
  std::ifstream stream(STATOR_TEST_DATA "/xdd_files/" + name, std::ios::binary);
  EXPECT_TRUE(stream) << name;
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A file that was read, and what was remarked.
class Import {
 public:
  explicit Import(const std::string& name) {
    auto read = read_xdd(file_text(name), report_);
    if (read) {
      file_ = std::move(*read);
    } else {
      ADD_FAILURE() << read.error().rule << ": " << read.error().text;
    }
  }

  [[nodiscard]] const EdsFile& file() const { return file_; }
  [[nodiscard]] const std::vector<EntryDeclaration>& rows() const { return file_.objects.rows(); }
  /// The row, or one of index 0 if there is none.
  [[nodiscard]] const EntryDeclaration& row(std::uint16_t index, std::uint8_t subindex = 0) const {
    static const EntryDeclaration kNone;
    for (const EntryDeclaration& row : rows()) {
      if (row.index == index && row.subindex == subindex) {
        return row;
      }
    }
    return kNone;
  }
  [[nodiscard]] bool has(std::uint16_t index, std::uint8_t subindex = 0) const {
    return row(index, subindex).index != 0;
  }
  [[nodiscard]] std::uint64_t number(std::uint16_t index, std::uint8_t subindex = 0) const {
    EXPECT_TRUE(has(index, subindex)) << std::hex << index << ":" << int{subindex};
    return row(index, subindex).default_value.number.bits;
  }
  /// How many notes there are of a rule that contain a text.
  [[nodiscard]] std::ptrdiff_t notes(std::string_view rule, std::string_view text = {}) const {
    return std::ranges::count_if(report_.notes, [&](const dictionary::ImportNote& note) {
      return note.rule == rule && note.text.find(text) != std::string::npos;
    });
  }
  /// Of the first note of a rule; 0 if there is none.
  [[nodiscard]] std::size_t line(std::string_view rule) const {
    const auto found = std::ranges::find(report_.notes, rule, &dictionary::ImportNote::rule);
    return found != report_.notes.end() ? found->line : 0;
  }

 private:
  EdsFile file_;
  ImportReport report_;
};

std::string refusal_rule(std::string_view text, std::string_view says) {
  ImportReport report;
  const auto read = read_xdd(text, report);
  if (read) {
    return "none";
  }
  EXPECT_NE(read.error().text.find(says), std::string::npos) << read.error().text;
  return read.error().rule;
}

TEST(XddReader, ADescriptionNamesTheDeviceItsObjectsAndBitRates) {
  const Import import("device.xdd");
  EXPECT_EQ(import.file().vendor_name, "Maker");
  EXPECT_EQ(import.file().product_name, "Drive");
  EXPECT_EQ(import.file().order_code, "D-1");
  EXPECT_EQ(import.file().vendor, 0x286U);
  EXPECT_EQ(import.file().code, 1234U);
  EXPECT_EQ(import.file().revision, 0x10002U);
  EXPECT_EQ(import.file().bit_rates, (std::vector<std::uint32_t>{20'000, 125'000, 1'000'000}));
  EXPECT_TRUE(import.file().lss);
  EXPECT_TRUE(import.file().dummy_mapping);
  EXPECT_FALSE(import.file().node_id);
  EXPECT_FALSE(import.file().bit_rate);
  EXPECT_EQ(import.row(0x1000).name, "Device type");
  EXPECT_EQ(import.row(0x1000).access, Access::constant);
  EXPECT_EQ(import.number(0x1000), 0x20192U);
  EXPECT_EQ(import.row(0x1018).object_code, ObjectCode::record);
  EXPECT_EQ(import.row(0x1018).object_name, "Identity");
  EXPECT_EQ(import.number(0x1A00, 10), 0x60410010U) << "subindices are hexadecimal";
  EXPECT_EQ(import.notes("sub-number", "1A00h"), 1);
  EXPECT_EQ(import.number(0x1800), 0x180U);
  EXPECT_TRUE(import.row(0x1800).node_id_relative);
}

TEST(XddReader, AConfigurationHasValuesOfTheOneDevice) {
  const Import import("configured.xdc");
  EXPECT_EQ(import.file().node_id, 5);
  EXPECT_EQ(import.file().bit_rate, 250'000U);
  EXPECT_EQ(import.number(0x1014), 0x85U);
  EXPECT_FALSE(import.row(0x1014).node_id_relative);
  EXPECT_EQ(import.notes("parameter-values", "default: 1"), 1);
  ASSERT_TRUE(import.row(0x1017).range);
  EXPECT_EQ(import.row(0x1017).range->maximum.bits, 5000U);
}

TEST(XddReader, MappingSaysInWhichPdosAnEntryMayBe) {
  const Import import("mapping.xdd");
  constexpr std::array<PdoMapping, 10> kExpected{
      PdoMapping::transmit, PdoMapping::receive, PdoMapping::transmit, PdoMapping::both,
      PdoMapping::both,     PdoMapping::no,      PdoMapping::no,       PdoMapping::no,
      PdoMapping::receive,  PdoMapping::no};
  for (std::size_t i = 0; i < kExpected.size(); ++i) {
    const EntryDeclaration& row = import.row(static_cast<std::uint16_t>(0x2000 + i));
    EXPECT_EQ(row.mapping, kExpected[i]) << row.name;
  }
  EXPECT_EQ(import.notes("mapping-contradicts-access", "2006h"), 1);
  EXPECT_EQ(import.notes("constant-mapped", "2007h"), 1);
  EXPECT_EQ(import.notes("number-unreadable", "sometimes"), 1);
}

TEST(XddReader, ParametersSayWhatObjectsLeaveOut) {
  const Import import("parameters.xdd");
  const EntryDeclaration& mode = import.row(0x2000);
  EXPECT_EQ(mode.name, "Modes of operation");
  EXPECT_EQ(mode.type, DataType::integer8);
  EXPECT_EQ(mode.access, Access::read_write);
  EXPECT_EQ(mode.mapping, PdoMapping::receive);
  EXPECT_EQ(mode.default_value.number.as_signed(), -1);
  ASSERT_TRUE(mode.range);
  EXPECT_EQ(mode.range->minimum.as_signed(), -6);
  EXPECT_EQ(import.row(0x2001).object_code, ObjectCode::array);
  EXPECT_EQ(import.row(0x2001, 1).type, DataType::unsigned16) << "of the array's elements";
  EXPECT_EQ(import.number(0x2001, 1), 0x11U);
  EXPECT_EQ(import.row(0x2002, 1).type, DataType::real32);
  EXPECT_EQ(import.row(0x2002, 1).access, Access::read_only) << "where no access is said";
  EXPECT_EQ(import.number(0x2002, 1), std::bit_cast<std::uint32_t>(0.5F));
  EXPECT_EQ(import.row(0x2003).type, DataType::integer32);
  EXPECT_EQ(import.row(0x2003).mapping, PdoMapping::transmit);
  EXPECT_EQ(import.number(0x2003), 7U);
  EXPECT_EQ(import.row(0x2004).type, DataType::unsigned32);
  EXPECT_EQ(import.notes("type-missing", "2004h"), 1);
  EXPECT_EQ(import.row(0x2005).type, DataType::unsigned8);
  EXPECT_EQ(import.notes("parameter-missing", "UID_OBJ_2005"), 1);
}

TEST(XddReader, FlawsAreRepairedAndToldWithTheirLines) {
  const Import import("flaws.xdd");
  EXPECT_EQ(import.row(0x2000).name, "First");
  EXPECT_EQ(import.notes("object-repeated"), 2);
  EXPECT_EQ(import.line("object-repeated"), 8U);
  EXPECT_EQ(import.notes("number-unreadable", "index of an object"), 1);
  EXPECT_EQ(import.notes("number-unreadable", "1FF"), 1);
  EXPECT_EQ(import.notes("number-unreadable", "word"), 1);
  EXPECT_EQ(import.notes("subindex-0-missing"), 1);
  EXPECT_EQ(import.number(0x2001), 2U);
  EXPECT_EQ(import.number(0x2001, 1), 4464U) << "70000 cut to 16 bits";
  EXPECT_EQ(import.row(0x2001, 2).type, DataType::unsigned32);
  EXPECT_EQ(import.rows().size(), 4U);
  dictionary::Dictionary dictionary;
  dictionary.add(import.rows());
  EXPECT_NO_THROW(dictionary.finish());
}

TEST(XddReader, BytesCountMoreThanTheNameOfTheEncoding) {
  EXPECT_EQ(Import("latin1_without_saying_so.xdd").row(0x2000).name,
            "Gr\xC3\xB6\xC3\x9F"
            "e");
}

TEST(XddReader, WhatIsNoCanopenDescriptionIsRefusedByName) {
  EXPECT_EQ(refusal_rule(file_text("powerlink.xdd"), "POWERLINK"), "powerlink-xdd");
  EXPECT_EQ(refusal_rule(file_text("powerlink_by_technology.xdd"), "POWERLINK"), "powerlink-xdd");
  EXPECT_EQ(refusal_rule(file_text("no_objects.xdd"), "CANopenObjectList"), "no-objects");
  EXPECT_EQ(
      refusal_rule("<ISO15745ProfileContainer><CANopenObjectList/></ISO15745ProfileContainer>",
                   "no object"),
      "no-objects");
  EXPECT_EQ(refusal_rule("<EtherCATInfo/>", "ESI"), "not-xdd");
  EXPECT_EQ(refusal_rule("<EtherCATConfig/>", "ENI"), "not-xdd");
  EXPECT_EQ(refusal_rule("<html/>", "<html>"), "not-xdd");
  EXPECT_EQ(refusal_rule("[FileInfo]\n", "no XML"), "not-xdd");
  EXPECT_EQ(refusal_rule("", "no XML"), "not-xdd");
  EXPECT_EQ(refusal_rule("<ISO15745ProfileContainer><a>", "well-formed"), "not-xml");
  EXPECT_EQ(refusal_rule("<!DOCTYPE a [<!ENTITY b \"c\">]><ISO15745ProfileContainer/>", "entities"),
            "xml-entity");
}

TEST(XddReader, NestingHasABound) {
  std::string text;
  for (int level = 0; level < 100'000; ++level) {
    text += "<a>";
  }
  for (int level = 0; level < 100'000; ++level) {
    text += "</a>";
  }
  EXPECT_EQ(refusal_rule(text, "nested"), "too-deep");
}

}  // namespace
}  // namespace stator::formats
