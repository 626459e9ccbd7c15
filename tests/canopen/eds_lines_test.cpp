// Single lines of an EDS file: FileInfo, DeviceInfo, kinds of objects, limits (CiA 306-1).
#include <array>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "stator/canopen/eds/eds.hpp"

namespace stator::canopen {
namespace {

using dictionary::DataType;
using dictionary::EntryDeclaration;
using enum dictionary::Access;
using dictionary::ObjectCode;
using dictionary::Range;

constexpr EntryDeclaration identity(std::uint8_t subindex, std::string_view name,
                                    std::uint32_t value) {
  return {.index = 0x1018,
          .subindex = subindex,
          .name = name,
          .object_code = ObjectCode::record,
          .access = read_only,
          .default_value = dictionary::hex(value)};
}

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x1018,
     .name = "Entries",
     .object_code = ObjectCode::record,
     .type = DataType::unsigned8,
     .access = constant,
     .default_value = 4},
    identity(1, "Vendor", 0x286),
    identity(2, "Product", 0xA0),
    identity(3, "Revision", 0x30001),
    identity(4, "Serial", 0x77),
    {.index = 0x2000,
     .name = "Counter",
     .type = DataType::unsigned64,
     .default_value = 0,
     .range = Range{1, 1000}},
    {.index = 0x2001, .name = "Program", .type = DataType::domain, .default_value = "bytes"},
    {.index = 0x2002, .name = "Owner", .type = DataType::visible_string, .default_value = "nobody"},
});

/// The lines of one section.
class EdsLines : public testing::Test {
 protected:
  EdsLines() {
    dictionary_.add(kObjects);
    dictionary_.finish();
    text_ = eds_text(dictionary_, {.file_name = "drive.eds",
                                   .author = "Someone",
                                   .vendor_name = "Maker",
                                   .product_name = "Drive"});
  }
  [[nodiscard]] bool has(std::string_view section, const std::string& line) const {
    const std::string_view lines = of(section);
    return lines.find("\n" + line + "\r\n") != std::string_view::npos;
  }
  [[nodiscard]] bool has_key(std::string_view section, const std::string& key) const {
    return of(section).find("\n" + key + "=") != std::string_view::npos;
  }

 private:
  [[nodiscard]] std::string_view of(std::string_view section) const {
    const std::size_t begin = text_.find("[" + std::string(section) + "]");
    EXPECT_NE(begin, std::string::npos) << section;
    const std::string_view rest =
        std::string_view(text_).substr(begin == std::string::npos ? 0 : begin);
    return rest.substr(0, rest.find("\n["));
  }
  dictionary::Dictionary dictionary_;
  std::string text_;
};

TEST_F(EdsLines, FileInfoNamesWhoMadeTheFile) {  // CiA 306-1 §4.3
  EXPECT_TRUE(has("FileInfo", "CreatedBy=Someone"));
  EXPECT_TRUE(has("FileInfo", "ModifiedBy=Someone"));
}

TEST_F(EdsLines, DeviceInfoTakesTheIdentityPartByPartFrom1018h) {
  EXPECT_TRUE(has("DeviceInfo", "VendorNumber=0x00000286"));
  EXPECT_TRUE(has("DeviceInfo", "ProductName=Drive"));
  EXPECT_TRUE(has("DeviceInfo", "ProductNumber=0x000000A0"));
  EXPECT_TRUE(has("DeviceInfo", "RevisionNumber=0x00030001")) << "1018h:03, not the serial number";
}

TEST_F(EdsLines, DeviceInfoSaysThatThereAreNoDynamicChannels) {
  // Those are of programmable devices.
  EXPECT_TRUE(has("DeviceInfo", "DynamicChannelsSupported=0"));
}

TEST_F(EdsLines, AnObjectOfSeveralEntriesNamesItsObjectCode) {
  EXPECT_TRUE(has("1018", "ObjectType=0x9")) << "RECORD";
}

TEST_F(EdsLines, ADomainHasNoDefaultButAStringHas) {
  EXPECT_FALSE(has("2001", "DefaultValue=bytes"));
  EXPECT_TRUE(has("2002", "DefaultValue=nobody"));
}

TEST_F(EdsLines, NumbersOf64BitsHaveNoLimits) {
  // The span of such a type does not fit the numbers that limits are compared in.
  EXPECT_FALSE(has_key("2000", "LowLimit"));
  EXPECT_FALSE(has_key("2000", "HighLimit"));
}

}  // namespace
}  // namespace stator::canopen
