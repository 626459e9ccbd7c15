// Electronic data sheets and configuration files as they are in real life (CiA 306-1), each file of
// tests/data/eds_files with one of their constructs; and our own data sheets read back.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/canopen/eds/eds.hpp"
#include "stator/canopen/eds/eds_file.hpp"
#include "stator/canopen/eds/import_notes.hpp"

namespace stator::canopen {
namespace {

using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::ImportKind;
using dictionary::ImportReport;
using dictionary::ObjectCode;
using dictionary::PdoMapping;
using dictionary::Range;

std::string file_text(const std::string& name) {
  std::ifstream stream(STATOR_TEST_DATA "/eds_files/" + name, std::ios::binary);
  EXPECT_TRUE(stream) << name;
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A file that was read, and what was remarked.
class Import {
 public:
  explicit Import(std::string_view text) {
    auto read = read_eds(text, report_);
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
  [[nodiscard]] std::int64_t signed_number(std::uint16_t index) const {
    return static_cast<std::int64_t>(number(index));
  }
  [[nodiscard]] std::string_view text(std::uint16_t index) const {
    return row(index).default_value.text;
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

Import import_file(const std::string& name) {
  return Import(file_text(name));
}

std::string refusal_rule(std::string_view text, std::string_view says = {}) {
  ImportReport report;
  const auto read = read_eds(text, report);
  if (read) {
    return "none";
  }
  EXPECT_NE(read.error().text.find(says), std::string::npos) << read.error().text;
  return read.error().rule;
}

TEST(EdsReader, LinesEndInThreeWays) {
  for (const char* name : {"line_ends_cr_lf.eds", "line_ends_lf.eds", "line_ends_cr.eds"}) {
    SCOPED_TRACE(name);
    const Import import = import_file(name);
    ASSERT_EQ(import.rows().size(), 1U);
    EXPECT_EQ(import.row(0x1000).name, "Device type");
    EXPECT_EQ(import.number(0x1000), 0x20192U);
    EXPECT_TRUE(import.row(0x1000).default_value.number.hexadecimal);
    EXPECT_EQ(import.row(0x1000).access, Access::read_only);
    EXPECT_EQ(import.notes("line-without-value"), 0);
  }
}

TEST(EdsReader, NamesBecomeUtf8AndValuesStayTheBytesOfTheFile) {
  const Import latin = import_file("encoding_latin1.eds");
  EXPECT_EQ(latin.file().vendor_name, "M\xC3\xBCller");
  EXPECT_EQ(latin.row(0x1008).name, "Ger\xC3\xA4tename");
  EXPECT_EQ(latin.text(0x1008),
            "Gr\xF6\xDF"
            "e");
  const Import utf8 = import_file("encoding_utf8_mark.eds");
  EXPECT_EQ(utf8.file().vendor_name, "M\xC3\xBCller");
  EXPECT_EQ(utf8.text(0x1008),
            "Gr\xC3\xB6\xC3\x9F"
            "e");
}

TEST(EdsReader, CaseSpacesAndCommentsDoNotCount) {
  const Import import = import_file("spelling.eds");
  EXPECT_EQ(import.file().vendor_name, "Maker  of drives");
  EXPECT_EQ(import.file().product_name, "Drive ; not a comment");
  EXPECT_EQ(import.line("text-before-sections"), 1U);
  EXPECT_EQ(import.row(0x1A0F).object_name, "TPDO 16 mapping");
  EXPECT_EQ(import.row(0x1A0F).access, Access::read_write);
  EXPECT_EQ(import.number(0x1A0F), 1U);
  EXPECT_EQ(import.number(0x1A0F, 1), 0x60410010U) << "behind a number, a comment is none of it";
  EXPECT_TRUE(import.has(0x2000));
  EXPECT_TRUE(import.has(0x2001));
  EXPECT_EQ(import.notes("section-open"), 1);
  EXPECT_EQ(import.notes("line-without-value"), 1);
  EXPECT_EQ(import.notes("section-unknown", "Something else"), 1);
  EXPECT_EQ(import.rows().size(), 4U);
}

TEST(EdsReader, OfRepeatedSectionsAndKeysTheFirstCounts) {
  const Import import = import_file("repeated.eds");
  EXPECT_EQ(import.row(0x2000).name, "First");
  EXPECT_EQ(import.row(0x2000).access, Access::read_only);
  EXPECT_EQ(import.notes("key-repeated"), 1);
  EXPECT_EQ(import.line("key-repeated"), 5U);
  EXPECT_EQ(import.notes("section-repeated"), 3);
  EXPECT_EQ(import.row(0x2001, 1).name, "One");
  EXPECT_EQ(import.rows().size(), 3U);
}

TEST(EdsReader, DeviceInfoNamesTheDevice) {
  const Import import = import_file("device_info.eds");
  EXPECT_EQ(import.file().vendor_name, "Maker");
  EXPECT_EQ(import.file().product_name, "Drive");
  EXPECT_EQ(import.file().order_code, "D-1");
  EXPECT_EQ(import.file().vendor, 0x286U);
  EXPECT_EQ(import.file().code, 1234U);
  EXPECT_EQ(import.notes("identity-differs", "product"), 1);
  EXPECT_EQ(import.file().revision, 0x10002U) << "of 1018h, since DeviceInfo has none";
  EXPECT_EQ(import.file().bit_rates, (std::vector<std::uint32_t>{20'000, 125'000, 1'000'000}));
  EXPECT_TRUE(import.file().lss);
  EXPECT_TRUE(import.file().dummy_mapping);
  EXPECT_TRUE(import.file().block_transfer);
  EXPECT_FALSE(import.file().node_id);
  EXPECT_EQ(import.notes("compact-pdo"), 1);
}

TEST(EdsReader, AConfigurationFileNamesNodeIdAndBitRate) {
  const Import standard = import_file("commissioning.dcf");
  EXPECT_EQ(standard.file().node_id, 16);
  EXPECT_EQ(standard.file().bit_rate, 500'000U);
  EXPECT_EQ(standard.notes("device-info-missing"), 1);
  const Import other = import_file("commissioning_other_spelling.dcf");
  EXPECT_FALSE(other.file().node_id);
  EXPECT_EQ(other.notes("node-id"), 1);
  EXPECT_EQ(other.file().bit_rate, 250'000U);
  EXPECT_EQ(other.notes("bit-rate"), 1);
}

TEST(EdsReader, SectionsCountWhateverTheListsSay) {
  const Import import = import_file("lists.eds");
  EXPECT_TRUE(import.has(0x1001));
  EXPECT_EQ(import.notes("bare-hexadecimal", "1001"), 1);
  EXPECT_TRUE(import.has(0x2000));
  EXPECT_EQ(import.notes("object-unlisted", "2000h"), 1);
  EXPECT_FALSE(import.has(0x2005));
  EXPECT_EQ(import.notes("section-missing", "2005h"), 1);
  EXPECT_EQ(import.line("section-missing"), 7U);
  EXPECT_EQ(import.notes("list-count"), 1);
  EXPECT_EQ(import.notes("number-unreadable"), 1);
  EXPECT_EQ(import_file("commissioning.dcf").notes("lists-missing"), 1);
}

TEST(EdsReader, ObjectTypesThatAreMissingOrWrongAreGuessedFromTheEntries) {
  const Import import = import_file("object_types.eds");
  EXPECT_FALSE(import.has(0x0005)) << "a type";
  EXPECT_EQ(import.notes("type-definition"), 1);
  EXPECT_EQ(import.row(0x2000).object_code, ObjectCode::variable);
  EXPECT_EQ(import.row(0x2001).object_code, ObjectCode::array);
  EXPECT_EQ(import.row(0x2001, 1).object_code, ObjectCode::array);
  EXPECT_EQ(import.row(0x2002).object_code, ObjectCode::record);
  EXPECT_EQ(import.row(0x2003).object_code, ObjectCode::array);
  EXPECT_EQ(import.notes("variable-with-entries", "2003h"), 1);
  EXPECT_EQ(import.row(0x2004).object_code, ObjectCode::variable);
  EXPECT_EQ(import.row(0x2004).type, DataType::real32);
  EXPECT_EQ(import.notes("structure-without-entries"), 2);
  EXPECT_EQ(import.row(0x2005).object_code, ObjectCode::domain_object);
  EXPECT_EQ(import.row(0x2005).type, DataType::domain);
  EXPECT_EQ(import.row(0x2006).object_code, ObjectCode::array);
  EXPECT_EQ(import.number(0x2006), 2U);
  EXPECT_EQ(import.number(0x2006, 2), 7U);
  EXPECT_EQ(import.notes("entries-missing"), 1);
  EXPECT_EQ(import.row(0x2007).type, DataType::real32);
  EXPECT_EQ(import.row(0x2008).object_code, ObjectCode::variable);
  EXPECT_EQ(import.notes("object-type-unknown"), 1);
  EXPECT_EQ(import.row(0x2009, 1).name, "Of an object that is missing");
  EXPECT_EQ(import.notes("object-missing", "2009h"), 1);
}

TEST(EdsReader, AccessSaysInWhichPdosAnEntryMayBe) {
  const Import import = import_file("access.eds");
  struct Expected {
    Access access;
    PdoMapping mapping;
  };
  constexpr std::array<Expected, 12> kExpected{{
      {Access::read_only, PdoMapping::transmit},
      {Access::write_only, PdoMapping::receive},
      {Access::read_write, PdoMapping::both},
      {Access::read_write, PdoMapping::transmit},
      {Access::read_write, PdoMapping::receive},
      {Access::constant, PdoMapping::no},
      {Access::read_only, PdoMapping::no},
      {Access::read_write, PdoMapping::receive},
      {Access::read_write, PdoMapping::no},
      {Access::read_write, PdoMapping::no},
      {Access::read_only, PdoMapping::transmit},
      {Access::read_write, PdoMapping::no},
  }};
  for (std::size_t i = 0; i < kExpected.size(); ++i) {
    const EntryDeclaration& row = import.row(static_cast<std::uint16_t>(0x2000 + i));
    SCOPED_TRACE(row.name);
    EXPECT_EQ(row.access, kExpected[i].access);
    EXPECT_EQ(row.mapping, kExpected[i].mapping);
  }
  EXPECT_EQ(import.notes("constant-mapped", "2005h"), 1);
  EXPECT_EQ(import.notes("access-missing", "2008h"), 1);
  EXPECT_EQ(import.notes("access-unknown", "sometimes"), 1);
}

TEST(EdsReader, NumbersAreReadAsPeopleWriteThem) {
  const Import import = import_file("numbers.eds");
  EXPECT_EQ(import.number(0x2000), 4711U);
  EXPECT_FALSE(import.row(0x2000).default_value.number.hexadecimal);
  EXPECT_EQ(import.number(0x2001), 0x1267U);
  EXPECT_TRUE(import.row(0x2001).default_value.number.hexadecimal);
  EXPECT_EQ(import.number(0x2002), 8U);
  EXPECT_EQ(import.notes("octal-number"), 1);
  EXPECT_EQ(import.number(0x2003), 0x2EU);
  EXPECT_EQ(import.number(0x2004), 0x180U);
  EXPECT_EQ(import.notes("bare-hexadecimal"), 2);
  EXPECT_EQ(import.number(0x2005), 89U);
  EXPECT_EQ(import.notes("leading-zero"), 1);
  EXPECT_EQ(import.signed_number(0x2006), -5);
  EXPECT_EQ(import.signed_number(0x2007), 5);
  EXPECT_EQ(import.signed_number(0x2008), -1) << "all bits of an INTEGER16";
  EXPECT_EQ(import.signed_number(0x2009), -1);
  EXPECT_EQ(import.number(0x200A), 44U);
  EXPECT_EQ(import.number(0x200B), 0xFFFFFFFFU);
  EXPECT_EQ(import.number(0x200C), 0U);
  EXPECT_EQ(import.notes("value-unreadable", "abc xyz"), 1);
  EXPECT_EQ(import.number(0x200D), 1U);
  EXPECT_EQ(import.number(0x200E), 1U);
  EXPECT_EQ(import.number(0x200F), 2U);
  EXPECT_EQ(import.number(0x2010), 2U);
  EXPECT_EQ(import.number(0x2016), ~std::uint64_t{0});
  EXPECT_EQ(import.signed_number(0x2017), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(import.number(0x2018), 0U);
  EXPECT_EQ(import.signed_number(0x2019), -1) << "all bits of an INTEGER24";
  EXPECT_EQ(import.number(0x201A), 0U);
  EXPECT_EQ(import.number(0x201B), 0x010000000000U);
  EXPECT_EQ(import.number(0x201C), 16U);
  EXPECT_EQ(import.number(0x201D), 16U);
  EXPECT_FALSE(import.row(0x201E).default_value.documented);
  // 65535 as INTEGER16, 300, -1, 2 as BOOLEAN, 2.7, 2^64, 2^24.
  EXPECT_EQ(import.notes("value-cut"), 7);
}

TEST(EdsReader, RealsAreKeptAsTheirBits) {
  const Import import = import_file("numbers.eds");
  EXPECT_EQ(import.number(0x2011), std::bit_cast<std::uint32_t>(-1.5F));
  EXPECT_EQ(import.number(0x2012), std::bit_cast<std::uint32_t>(1.0F));
  EXPECT_EQ(import.notes("real-in-hexadecimal"), 1);
  EXPECT_EQ(import.number(0x2013), std::bit_cast<std::uint32_t>(1.25F));
  EXPECT_EQ(import.number(0x2014), std::bit_cast<std::uint64_t>(1000.0));
  EXPECT_EQ(import.number(0x2015), std::bit_cast<std::uint64_t>(2.5));
  EXPECT_EQ(import.number(0x201F), 0x7F800000U) << "infinite";
}

TEST(EdsReader, DefaultsThatCountFromTheNodeId) {
  const Import import = import_file("node_id.eds");
  for (const auto& [index, number] :
       {std::pair{0x2000, 0x180U}, std::pair{0x2001, 0x180U}, std::pair{0x2002, 0U},
        std::pair{0x2003, 384U}, std::pair{0x2004, 0x40000200U}, std::pair{0x2005, 0U}}) {
    SCOPED_TRACE(index);
    EXPECT_EQ(import.number(static_cast<std::uint16_t>(index)), number);
    EXPECT_TRUE(import.row(static_cast<std::uint16_t>(index)).node_id_relative);
  }
  for (const int index : {0x2006, 0x2007, 0x2008, 0x2009, 0x200A, 0x200B}) {
    SCOPED_TRACE(index);
    EXPECT_FALSE(import.row(static_cast<std::uint16_t>(index)).node_id_relative);
  }
  EXPECT_EQ(import.number(0x2006), 200U);
  EXPECT_EQ(import.notes("node-id-beyond-type"), 3);
  EXPECT_EQ(import.notes("value-unreadable"), 3);
  EXPECT_FALSE(import.row(0x2010).range);
  EXPECT_EQ(import.notes("limit-unreadable"), 1);
}

TEST(EdsReader, EveryDataTypeOfTheStandardIsKnown) {
  const Import import = import_file("types.eds");
  for (std::uint16_t number = 1; number <= 0x1B; ++number) {
    const bool reserved = number == 0x0E || number == 0x17;
    EXPECT_EQ(import.row(static_cast<std::uint16_t>(0x2000 + number)).type,
              reserved ? DataType::octet_string : static_cast<DataType>(number))
        << number;
  }
  EXPECT_EQ(import.row(0x2040).type, DataType::octet_string);
  EXPECT_EQ(import.text(0x2040), std::string_view("\0", 1));
  EXPECT_EQ(import.notes("type-unknown"), 3);
  EXPECT_EQ(import.row(0x2041).type, DataType::unsigned32);
  EXPECT_EQ(import.row(0x2042).type, DataType::unsigned16) << "by its name";
  EXPECT_EQ(import.row(0x2043).type, DataType::unsigned32);
  EXPECT_EQ(import.notes("type-missing"), 2);
  EXPECT_EQ(import.row(0x2044, 1).type, DataType::integer16);
}

TEST(EdsReader, StringsAreTextsOrOctets) {
  const Import import = import_file("strings.eds");
  EXPECT_EQ(import.text(0x2000), "one = two; three");
  EXPECT_EQ(import.text(0x2001), "\x01\x02\xFF");
  EXPECT_EQ(import.text(0x2002), "\x01\x02\xFF");
  EXPECT_EQ(import.text(0x2003), "nobody");
  EXPECT_EQ(import.notes("octets-as-text", "2003h"), 1);
  EXPECT_EQ(import.text(0x2004), std::string_view("H\0i\0", 4));
  EXPECT_EQ(import.text(0x2005), "");
  EXPECT_EQ(import.text(0x2006), "");
  EXPECT_FALSE(import.row(0x2006).default_value.documented);
}

TEST(EdsReader, CompactArraysHaveAsManyEntriesAsTheySay) {
  const Import import = import_file("compact.dcf");
  EXPECT_EQ(import.row(0x2100).object_name, "Sensor");
  EXPECT_EQ(import.row(0x2100).type, DataType::unsigned8);
  EXPECT_EQ(import.number(0x2100), 3U);
  EXPECT_EQ(import.row(0x2100, 1).name, "With a section");
  EXPECT_EQ(import.number(0x2100, 1), 9U);
  EXPECT_EQ(import.row(0x2100, 2).name, "The second");
  EXPECT_EQ(import.number(0x2100, 2), 3U);
  EXPECT_EQ(import.row(0x2100, 2).mapping, PdoMapping::transmit);
  EXPECT_EQ(import.row(0x2100, 2).range->maximum.bits, 100U);
  EXPECT_EQ(import.row(0x2100, 3).name, "Sensor 3");
  EXPECT_EQ(import.number(0x2100, 3), 16U);
  EXPECT_FALSE(import.has(0x2100, 4));
  EXPECT_EQ(import.notes("compact-beyond", "2100h"), 1);
  EXPECT_EQ(import.notes("subindex-0-missing"), 0);
  EXPECT_EQ(import.row(0x2101, 254).name, "As a variable 254");
  EXPECT_FALSE(import.has(0x2101, 255));
  EXPECT_EQ(import.notes("compact-beyond", "2101h"), 1);
  EXPECT_FALSE(import.has(0x2102));
  EXPECT_EQ(import.notes("object-missing", "2102h"), 1);
}

TEST(EdsReader, SubindicesMayHaveGapsAndFlaws) {
  const Import import = import_file("subindices.eds");
  EXPECT_TRUE(import.has(0x2000, 3));
  EXPECT_EQ(import.row(0x2000, 0x1B).name, "Hexadecimal");
  EXPECT_EQ(import.notes("sub-number", "2000h"), 0);
  EXPECT_EQ(import.number(0x2001), 2U);
  EXPECT_EQ(import.row(0x2001).access, Access::read_only);
  EXPECT_EQ(import.notes("subindex-0-missing", "2001h"), 1);
  EXPECT_EQ(import.notes("sub-number", "2001h"), 1);
  EXPECT_EQ(import.row(0x2002).type, DataType::unsigned8);
  EXPECT_EQ(import.notes("subindex-0-type", "2002h"), 1);
  EXPECT_EQ(import.notes("name-missing", "2002h:00"), 1);
  EXPECT_EQ(import.number(0x2002), 1U) << "FFh is no entry";
  EXPECT_EQ(import.number(0x2002, 0xFF), 0x0609U);
  EXPECT_EQ(import.number(0x2003), 0U);
  EXPECT_EQ(import.number(0x1003), 0U) << "no errors";
  EXPECT_EQ(import.number(0x1A00), 1U) << "one object is mapped";
  EXPECT_EQ(import.notes("mapped-count-assumed"), 1);
}

TEST(EdsReader, RowsStandInTheOrderOfAddressesAndMakeADictionary) {
  for (const char* name : {"object_types.eds", "numbers.eds", "node_id.eds", "types.eds",
                           "compact.dcf", "subindices.eds", "limits.eds", "repeated.eds"}) {
    SCOPED_TRACE(name);
    const Import import = import_file(name);
    const auto address = [](const EntryDeclaration& row) {
      return std::uint32_t{row.index} << 8 | row.subindex;
    };
    EXPECT_EQ(std::ranges::adjacent_find(import.rows(), std::ranges::greater_equal{}, address),
              import.rows().end());
    dictionary::Dictionary dictionary;
    dictionary.add(import.rows());
    EXPECT_NO_THROW(dictionary.finish());
    EXPECT_NO_THROW(dictionary.set_node_id(127));
  }
}

TEST(EdsReader, ModulesAreLeftOut) {
  const Import import = import_file("modules.eds");
  EXPECT_EQ(import.rows().size(), 1U);
  EXPECT_EQ(import.notes("modules", "none: 5"), 1);
  EXPECT_EQ(import.notes("section-unknown"), 0);
}

TEST(EdsReader, LimitsThatCannotHoldAreLeftOut) {
  const Import import = import_file("limits.eds");
  const auto range = [&import](std::uint16_t index) { return import.row(index).range; };
  EXPECT_EQ(range(0x2000)->minimum.as_signed(), -10);
  EXPECT_EQ(range(0x2000)->maximum.as_signed(), 10);
  EXPECT_FALSE(range(0x2001)) << "the default is below";
  EXPECT_EQ(range(0x2002)->minimum.bits, 0U);
  EXPECT_EQ(range(0x2002)->maximum.bits, 9U);
  EXPECT_FALSE(range(0x2003)) << "low is above high";
  EXPECT_EQ(import.notes("limits-contradict"), 1);
  EXPECT_FALSE(range(0x2004)) << "the default is above";
  EXPECT_EQ(range(0x2005)->minimum.bits, 4U);
  EXPECT_EQ(import.number(0x2005), 4U) << "0 cannot be";
  EXPECT_EQ(import.notes("default-assumed"), 1);
  EXPECT_EQ(range(0x2006)->maximum.as_signed(), -1) << "all bits of an INTEGER32";
  EXPECT_FALSE(range(0x2007)) << "all values of the type";
  EXPECT_FALSE(range(0x2008)) << "nothing but 0";
  EXPECT_EQ(import.notes("limits-empty"), 1);
  EXPECT_FALSE(range(0x2009)) << "70000 is no value of the type, 0 its lowest";
  EXPECT_EQ(import.notes("limit-beyond-type"), 1);
  EXPECT_EQ(range(0x200A)->maximum.bits, std::bit_cast<std::uint32_t>(2.0F));
  EXPECT_FALSE(range(0x200B));
  EXPECT_EQ(import.notes("limits-of-real"), 1);
  EXPECT_EQ(range(0x200C)->maximum.bits, 2U);
  EXPECT_EQ(import.notes("limit-unreadable"), 1);
  EXPECT_EQ(range(0x200D)->minimum.bits, 2U);
  EXPECT_EQ(import.notes("limits-exclude-default"), 3);
}

TEST(EdsReader, TheValueOfTheOneDeviceIsBeforeTheDefault) {
  const Import import = import_file("parameter_value.dcf");
  EXPECT_EQ(import.number(0x2000), 0x181U);
  EXPECT_FALSE(import.row(0x2000).node_id_relative);
  EXPECT_EQ(import.number(0x2001), 5U);
  EXPECT_EQ(import.notes("parameter-values", "default: 1"), 1);
  EXPECT_EQ(import.notes("file-of-value"), 2);
  EXPECT_EQ(import.row(0x2002).type, DataType::domain);
}

TEST(EdsReader, WhatIsNoDataSheetIsRefusedByName) {
  EXPECT_EQ(refusal_rule("", "empty"), "not-eds");
  EXPECT_EQ(refusal_rule(" \r\n\t\n", "empty"), "not-eds");
  EXPECT_EQ(refusal_rule("<?xml version=\"1.0\"?><EtherCATInfo/>", "ESI"), "not-eds");
  EXPECT_EQ(refusal_rule("<ISO15745ProfileContainer/>", ".xdd"), "not-eds");
  EXPECT_EQ(refusal_rule("<html/>", "XML"), "not-eds");
  EXPECT_EQ(refusal_rule("{\"a\": 1}", "JSON"), "not-eds");
  EXPECT_EQ(refusal_rule("[\n  {\"a\": 1}]", "JSON"), "not-eds");
  EXPECT_EQ(refusal_rule(std::string_view("[FileInfo]\0\x01", 12), "binary"), "not-eds");
  EXPECT_EQ(refusal_rule("\xFF\xFE[\0F\0", "UTF-16"), "not-eds");
  EXPECT_EQ(refusal_rule("PK\x03\x04rest", "ZIP"), "not-eds");
  EXPECT_EQ(refusal_rule("VERSION \"\"\nBO_ 1 A: 8\n", "DBC"), "not-eds");
  EXPECT_EQ(refusal_rule("some words\nand more\n", "no section"), "not-eds");
  EXPECT_EQ(refusal_rule("[core]\nbare = false\n", "none such as"), "not-eds");
  EXPECT_EQ(refusal_rule(file_text("ethernet_ip.eds"), "EtherNet/IP"), "not-eds");
  EXPECT_EQ(refusal_rule(file_text("no_objects.eds")), "no-objects");
}

TEST(EdsReader, AFileOfTooManyEntriesIsRefused) {
  std::string text;
  for (int index = 0x2000; index < 0x2200; ++index) {
    text += "[";
    for (const int shift : {12, 8, 4, 0}) {
      text += "0123456789ABCDEF"[index >> shift & 0xF];
    }
    text += "]\nParameterName=A\nDataType=5\nAccessType=rw\nCompactSubObj=254\n";
  }
  EXPECT_EQ(refusal_rule(text), "too-many-entries");
}

TEST(EdsReader, OneFlawOfManyLinesMakesAReportThatCanBeRead) {
  std::string text = "[1000]\nParameterName=A\nDataType=5\nAccessType=ro\n";
  for (int line = 0; line < 1000; ++line) {
    text += "nonsense\n";
  }
  const Import import(text);
  EXPECT_EQ(import.notes("line-without-value"),
            static_cast<std::ptrdiff_t>(ImportNotes::kMostOfARule) + 1);
  EXPECT_EQ(import.notes("line-without-value", "950 more"), 1);
}

TEST(EdsReader, NotesAreUtf8WhateverKeysTheFileHas) {
  const Import import("[DeviceInfo]\nBaudRate_\xE4=often\n[1000]\nParameterName=A\nDataType=5\n");
  EXPECT_EQ(import.notes("number-unreadable", "BaudRate_\xC3\xA4"), 1);
}

// What Stator writes of a dictionary is read as the same declarations.

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x1000,
     .name = "Device type",
     .access = Access::read_only,
     .default_value = dictionary::hex(0x192)},
    {.index = 0x1014,
     .name = "COB-ID EMCY",
     .default_value = dictionary::hex(0x80),
     .node_id_relative = true},
    {.index = 0x1018,
     .name = "Entries",
     .object_code = ObjectCode::record,
     .type = DataType::unsigned8,
     .access = Access::constant,
     .default_value = 2,
     .object_name = "Identity"},
    {.index = 0x1018,
     .subindex = 1,
     .name = "Vendor",
     .object_code = ObjectCode::record,
     .access = Access::read_only,
     .default_value = dictionary::hex(0x286)},
    {.index = 0x1018,
     .subindex = 2,
     .name = "Product",
     .object_code = ObjectCode::record,
     .access = Access::read_only,
     .default_value = dictionary::hex(0xA0)},
    {.index = 0x2000,
     .name = "Gain",
     .type = DataType::integer16,
     .default_value = -5,
     .range = Range{-10, 10}},
    {.index = 0x2001,
     .name = "Bits",
     .type = DataType::integer8,
     .default_value = dictionary::hex(static_cast<std::uint64_t>(-1))},
    {.index = 0x2002, .name = "Owner", .type = DataType::visible_string, .default_value = "nobody"},
    {.index = 0x2003,
     .name = "Program",
     .object_code = ObjectCode::domain_object,
     .type = DataType::domain,
     .default_value = dictionary::undocumented(0)},
    {.index = 0x2004,
     .name = "Number of times",
     .object_code = ObjectCode::array,
     .type = DataType::unsigned8,
     .access = Access::read_only,
     .default_value = 1,
     .object_name = "Times"},
    {.index = 0x2004,
     .subindex = 1,
     .name = "First time",
     .object_code = ObjectCode::array,
     .type = DataType::unsigned64,
     .default_value = std::uint64_t{1} << 63},
    {.index = 0x6040,
     .name = "Controlword",
     .type = DataType::unsigned16,
     .mapping = PdoMapping::receive,
     .default_value = dictionary::undocumented(0)},
    {.index = 0x6041,
     .name = "Statusword",
     .type = DataType::unsigned16,
     .access = Access::read_only,
     .mapping = PdoMapping::transmit,
     .default_value = dictionary::undocumented(0)},
    {.index = 0x607A,
     .name = "Target position",
     .type = DataType::integer32,
     .mapping = PdoMapping::both,
     .default_value = 7},
    {.index = 0x60B0,
     .name = "Offset",
     .type = DataType::integer32,
     .mapping = PdoMapping::transmit,
     .default_value = 0},
});

void expect_same(const EntryDeclaration& read, const EntryDeclaration& written) {
  EXPECT_EQ(read.index, written.index);
  EXPECT_EQ(read.subindex, written.subindex);
  EXPECT_EQ(read.name, written.name);
  EXPECT_EQ(read.object_name, written.object_name);
  EXPECT_EQ(read.object_code, written.object_code);
  EXPECT_EQ(read.type, written.type);
  EXPECT_EQ(read.access, written.access);
  EXPECT_EQ(read.mapping, written.mapping);
  EXPECT_EQ(read.node_id_relative, written.node_id_relative);
  EXPECT_EQ(read.default_value.number.bits, written.default_value.number.bits);
  EXPECT_EQ(read.default_value.number.hexadecimal, written.default_value.number.hexadecimal);
  EXPECT_EQ(read.default_value.text, written.default_value.text);
  EXPECT_EQ(read.default_value.documented, written.default_value.documented);
  ASSERT_EQ(read.range.has_value(), written.range.has_value());
  if (read.range) {
    EXPECT_EQ(read.range->minimum.bits, written.range->minimum.bits);
    EXPECT_EQ(read.range->maximum.bits, written.range->maximum.bits);
  }
}

TEST(EdsReader, OurOwnDataSheetGivesTheDeclarationsItWasMadeOf) {
  dictionary::Dictionary dictionary;
  dictionary.add(kObjects);
  dictionary.finish();
  constexpr std::array<std::int64_t, 2> kRates{125, 1000};
  const Import import(eds_text(dictionary, {.file_name = "drive.eds",
                                            .date = "01-02-2026",
                                            .vendor_name = "Maker",
                                            .product_name = "Drive",
                                            .order_code = "D-1",
                                            .bit_rates = kRates,
                                            .lss = true,
                                            .dummy_mapping = true}));
  EXPECT_EQ(import.file().vendor_name, "Maker");
  EXPECT_EQ(import.file().product_name, "Drive");
  EXPECT_EQ(import.file().order_code, "D-1");
  EXPECT_EQ(import.file().vendor, 0x286U);
  EXPECT_EQ(import.file().code, 0xA0U);
  EXPECT_EQ(import.file().bit_rates, (std::vector<std::uint32_t>{125'000, 1'000'000}));
  EXPECT_TRUE(import.file().lss);
  EXPECT_TRUE(import.file().dummy_mapping);
  ASSERT_EQ(import.rows().size(), kObjects.size());
  for (std::size_t i = 0; i < kObjects.size(); ++i) {
    SCOPED_TRACE(kObjects[i].name);
    expect_same(import.rows()[i], kObjects[i]);
  }
}

}  // namespace
}  // namespace stator::canopen
