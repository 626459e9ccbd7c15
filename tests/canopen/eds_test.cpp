// The EDS file of a device (CiA 306-1): areas, access, defaults, limits, names, and its storage as
// an object.
#include "stator/canopen/eds/eds.hpp"

#include <array>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace stator::canopen {
namespace {

using dictionary::DataType;
using dictionary::EntryDeclaration;
using enum dictionary::Access;
using dictionary::ObjectCode;
using dictionary::PdoMapping;
using dictionary::Range;

constexpr std::array<std::int64_t, 3> kOdd{-3, 1, 5};
constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x1000,
     .name = "Device type",
     .access = read_only,
     .default_value = dictionary::hex(0x192)},
    {.index = 0x1001,
     .name = "Error register",
     .type = DataType::unsigned8,
     .access = read_only,
     .live = true},
    {.index = 0x1014,
     .name = "COB-ID EMCY",
     .default_value = dictionary::hex(0x80),
     .node_id_relative = true},
    {.index = 0x1018,
     .name = "Entries",
     .object_code = ObjectCode::record,
     .type = DataType::unsigned8,
     .access = constant,
     .default_value = 1,
     .object_name = "Identity"},
    {.index = 0x1018,
     .subindex = 1,
     .name = "Vendor",
     .object_code = ObjectCode::record,
     .access = read_only,
     .default_value = dictionary::hex(0x286)},
    {.index = 0x1400,
     .name = "Count",
     .object_code = ObjectCode::record,
     .type = DataType::unsigned8,
     .access = read_only,
     .default_value = 0,
     .object_name = "RPDO 1"},
    {.index = 0x2000,
     .name = "Gain",
     .type = DataType::integer16,
     .default_value = -5,
     .range = Range{-10, 10}},
    {.index = 0x2001,
     .name = "Gain",
     .type = DataType::integer8,
     .default_value = 1,
     .legal_values = kOdd},
    {.index = 0x2002,
     .name = "Whole range",
     .type = DataType::integer16,
     .default_value = 0,
     .range = Range{-32768, 32767}},
    {.index = 0x2003,
     .name = "Order",
     .type = DataType::unsigned8,
     .access = write_only,
     .default_value = 0},
    {.index = 0x6040,
     .name = "Controlword",
     .type = DataType::unsigned16,
     .mapping = PdoMapping::receive,
     .default_value = dictionary::undocumented(0)},
    {.index = 0x607A,
     .name = "Offset",
     .type = DataType::integer32,
     .mapping = PdoMapping::transmit,
     .default_value = 7},
});

/// Key=Value lines by section.
using Sections = std::map<std::string, std::map<std::string, std::string>>;

Sections parse(const std::string& text) {
  Sections sections;
  std::istringstream lines(text);
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    EXPECT_FALSE(line.empty()) << "lines end with CR LF";
    EXPECT_EQ(line.back(), '\r');
    line.pop_back();
    if (!line.empty() && line.front() == '[') {
      section = line.substr(1, line.size() - 2);
      EXPECT_FALSE(sections.contains(section)) << section;
      sections[section];
    } else if (const std::size_t equals = line.find('='); equals != std::string::npos) {
      sections[section][line.substr(0, equals)] = line.substr(equals + 1);
    }
  }
  return sections;
}

class Eds : public testing::Test {
 protected:
  Eds() {
    dictionary_.add(kObjects);
    add_eds_objects(dictionary_);
    dictionary_.finish();
    sections_ = parse(eds_text(dictionary_, {.file_name = "drive.eds",
                                             .date = "01-02-2026",
                                             .vendor_name = "Maker",
                                             .bit_rates = kRates,
                                             .lss = true,
                                             .comments = kComments}));
  }
  static constexpr std::array<std::int64_t, 2> kRates{125, 100};
  static constexpr std::array<std::string_view, 1> kComments{"one line"};
  dictionary::Dictionary dictionary_;
  Sections sections_;
};

TEST_F(Eds, DescribesFileAndDevice) {
  EXPECT_EQ(sections_["FileInfo"]["FileName"], "drive.eds");
  EXPECT_EQ(sections_["FileInfo"]["EDSVersion"], "4.0");
  EXPECT_EQ(sections_["FileInfo"]["CreationDate"], "01-02-2026");
  EXPECT_EQ(sections_["DeviceInfo"]["VendorNumber"], "0x00000286");
  EXPECT_EQ(sections_["DeviceInfo"]["BaudRate_125"], "1");
  EXPECT_EQ(sections_["DeviceInfo"]["BaudRate_500"], "0");
  EXPECT_FALSE(sections_["DeviceInfo"].contains("BaudRate_100")) << "CiA 306-1 knows no such key";
  EXPECT_EQ(sections_["DeviceInfo"]["NrOfRXPDO"], "1");
  EXPECT_EQ(sections_["DeviceInfo"]["NrOfTXPDO"], "0");
  EXPECT_EQ(sections_["DeviceInfo"]["LSS_Supported"], "1");
  EXPECT_EQ(sections_["DummyUsage"]["Dummy0007"], "0");
  EXPECT_EQ(sections_["Comments"]["Line1"], "one line");
}

TEST_F(Eds, ListsObjectsByTheirAreas) {
  EXPECT_EQ(sections_["MandatoryObjects"]["SupportedObjects"], "3");
  EXPECT_EQ(sections_["MandatoryObjects"]["3"], "0x1018");
  EXPECT_EQ(sections_["OptionalObjects"]["SupportedObjects"], "6");
  EXPECT_EQ(sections_["OptionalObjects"]["6"], "0x607A");
  EXPECT_EQ(sections_["ManufacturerObjects"]["SupportedObjects"], "4");
}

TEST_F(Eds, SaysHowEntriesMayBeReadWrittenAndMapped) {
  EXPECT_EQ(sections_["6040"]["AccessType"], "rww");
  EXPECT_EQ(sections_["6040"]["PDOMapping"], "1");
  EXPECT_EQ(sections_["607A"]["AccessType"], "rwr");
  EXPECT_EQ(sections_["2000"]["AccessType"], "rw");
  EXPECT_EQ(sections_["2000"]["PDOMapping"], "0");
  EXPECT_EQ(sections_["2003"]["AccessType"], "wo");
  EXPECT_EQ(sections_["1018sub0"]["AccessType"], "const");
  EXPECT_EQ(sections_["1018"]["SubNumber"], "2");
  EXPECT_EQ(sections_["1018"]["ParameterName"], "Identity");
}

TEST_F(Eds, NamesDefaultsThatHoldAfterAReset) {
  EXPECT_EQ(sections_["1000"]["DefaultValue"], "0x00000192");
  EXPECT_EQ(sections_["1014"]["DefaultValue"], "$NODEID+0x80");
  EXPECT_EQ(sections_["2000"]["DefaultValue"], "-5");
  EXPECT_FALSE(sections_["1001"].contains("DefaultValue")) << "live";
  EXPECT_FALSE(sections_["6040"].contains("DefaultValue")) << "not documented";
  EXPECT_FALSE(sections_["2003"].contains("DefaultValue")) << "nobody can read it";
}

TEST_F(Eds, NamesLimitsThatAreNarrowerThanTheType) {
  EXPECT_EQ(sections_["2000"]["LowLimit"], "-10");
  EXPECT_EQ(sections_["2000"]["HighLimit"], "10");
  EXPECT_EQ(sections_["2001"]["LowLimit"], "-3");
  EXPECT_EQ(sections_["2001"]["HighLimit"], "5");
  EXPECT_FALSE(sections_["2002"].contains("LowLimit"));
}

TEST_F(Eds, GivesEachObjectANameOfItsOwn) {
  EXPECT_EQ(sections_["2000"]["ParameterName"], "Gain");
  EXPECT_EQ(sections_["2001"]["ParameterName"], "Gain (2001h)");
}

TEST_F(Eds, CanBeStoredInTheDictionaryItDescribes) {
  EXPECT_EQ(sections_["1021"]["DataType"], "0x000F");
  EXPECT_EQ(sections_["1022"]["DefaultValue"], "0");
  store_eds(dictionary_, "[FileInfo]\r\n");
  EXPECT_EQ(dictionary_.find(0x1021, 0)->text(), "[FileInfo]\r\n");
}

}  // namespace
}  // namespace stator::canopen
