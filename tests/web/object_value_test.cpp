// Values of objects as JSON, read and written by their type.
#include "stator/web/api/object_value.hpp"

#include <array>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace stator::web {
namespace {

using dictionary::DataType;
using Json = nlohmann::ordered_json;

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> result;
  for (const int value : values) {
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

std::array<dictionary::EntryDeclaration, 1> declared(DataType type) {
  return {{{.index = 0x2000, .name = "value", .type = type}}};
}

/// What a JSON text becomes for an entry of that type; nothing: it is refused.
std::optional<std::vector<std::byte>> encoded(DataType type, const char* text) {
  const auto declarations = declared(type);
  dictionary::Dictionary objects;
  objects.add(declarations);
  objects.finish();
  const auto result = to_bytes(*objects.find(0x2000, 0), Json::parse(text));
  return result ? std::optional(*result) : std::nullopt;
}

TEST(ObjectValue, IsReadAsItsTypeSays) {
  EXPECT_EQ(to_json(DataType::integer16, bytes({0xFE, 0xFF})), -2);
  EXPECT_EQ(to_json(DataType::unsigned16, bytes({0xFE, 0xFF})), 65534);
  EXPECT_EQ(to_json(DataType::unsigned64, bytes({255, 255, 255, 255, 255, 255, 255, 255})),
            UINT64_MAX);
  EXPECT_EQ(to_json(DataType::boolean, bytes({1})), true);
  EXPECT_EQ(to_json(DataType::real32, bytes({0, 0, 0xC0, 0x3F})), 1.5);
  EXPECT_EQ(to_json(DataType::visible_string, bytes({'a', 'b'})), "ab");
  EXPECT_EQ(to_json(DataType::octet_string, bytes({0, 0xAB})), "00ab");
}

TEST(ObjectValue, IsWrittenLittleEndianInItsLength) {
  EXPECT_EQ(encoded(DataType::integer16, "-2"), bytes({0xFE, 0xFF}));
  EXPECT_EQ(encoded(DataType::unsigned32, "\"0x1F\""), bytes({0x1F, 0, 0, 0}));
  EXPECT_EQ(encoded(DataType::integer64, "\"-9223372036854775808\""),
            bytes({0, 0, 0, 0, 0, 0, 0, 0x80}));
  EXPECT_EQ(encoded(DataType::boolean, "true"), bytes({1}));
  EXPECT_EQ(encoded(DataType::visible_string, "\"ab\""), bytes({'a', 'b'}));
  EXPECT_EQ(encoded(DataType::octet_string, "\"00AB\""), bytes({0, 0xAB}));
  EXPECT_EQ(encoded(DataType::real32, "1.5"), bytes({0, 0, 0xC0, 0x3F}));
}

TEST(ObjectValue, ThatDoesNotFitItsTypeIsRefused) {
  EXPECT_EQ(encoded(DataType::integer8, "128"), std::nullopt);
  EXPECT_EQ(encoded(DataType::integer8, "-128"), bytes({0x80}));
  EXPECT_EQ(encoded(DataType::integer8, "-129"), std::nullopt);
  EXPECT_EQ(encoded(DataType::unsigned8, "256"), std::nullopt);
  EXPECT_EQ(encoded(DataType::unsigned8, "-1"), std::nullopt);
  EXPECT_EQ(encoded(DataType::unsigned64, "18446744073709551615"),
            bytes({255, 255, 255, 255, 255, 255, 255, 255}));
  EXPECT_EQ(encoded(DataType::unsigned8, "1.5"), std::nullopt);
  EXPECT_EQ(encoded(DataType::unsigned8, "\"\""), std::nullopt);
  EXPECT_EQ(encoded(DataType::unsigned8, "null"), std::nullopt);
  EXPECT_EQ(encoded(DataType::unsigned8, "[1]"), std::nullopt);
  EXPECT_EQ(encoded(DataType::visible_string, "1"), std::nullopt);
  EXPECT_EQ(encoded(DataType::octet_string, "\"0\""), std::nullopt);
  EXPECT_EQ(encoded(DataType::octet_string, "\"0x\""), std::nullopt);
}

}  // namespace
}  // namespace stator::web
