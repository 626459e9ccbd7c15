#include "stator/formats/json/json.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/json_text.hpp"
#include "source_paths.hpp"
#include "stator/formats/toml/toml.hpp"

namespace stator::formats {
namespace {

using settings::List;
using settings::Table;
using settings::Value;
using ::testing::HasSubstr;

/// "LINE:COLUMN reason" of a text that is no JSON.
std::string refusal(const std::string& text) {
  const auto tree = parse_json(text, "a.json");
  if (tree) {
    return "";
  }
  const settings::Problem& problem = tree.error();
  EXPECT_EQ(problem.file(), "a.json");
  EXPECT_EQ(problem.text(), "a.json:" + std::to_string(problem.line()) + ":" +
                                std::to_string(problem.column()) + ": " + problem.reason());
  return std::to_string(problem.line()) + ":" + std::to_string(problem.column()) + " " +
         problem.reason();
}

/// "LINE:COLUMN" of a value.
std::string place(const Value* value) {
  return std::to_string(value->place().line) + ":" + std::to_string(value->place().column);
}

TEST(Json, BecomesTheTreeOfTheSameToml) {
  const auto json = parse_json(
      R"({"a": 1, "b": -2.5, "c": true, "d": "x\n\u00e4", "e": [], "f": {},
          "t": {"list": [1, 1.0, "1", [false]], "below": {"key": 9223372036854775807}},
          "device": [{"type": "x"}, {"type": "y", "": 0}]})",
      "a.json");
  const auto toml = parse_toml(R"(a = 1
b = -2.5
c = true
d = "x\nä"
e = []
f = {}
t.list = [1, 1.0, "1", [false]]
t.below.key = 9223372036854775807
[[device]]
type = "x"
[[device]]
type = "y"
"" = 0
)",
                               "a.toml");
  ASSERT_TRUE(json);
  ASSERT_TRUE(toml);
  EXPECT_TRUE(tests::same_tree(*json, *toml));
  EXPECT_TRUE(json->at("device")->is_list_of_tables());
}

TEST(Json, EveryRackInTheRepositoryIsTheSameInJson) {
  namespace fs = std::filesystem;
  int racks = 0;
  for (const auto& entry : fs::recursive_directory_iterator(STATOR_SOURCE_DIR "/racks")) {
    if (entry.path().extension() != ".toml") {
      continue;
    }
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto toml = parse_toml(text, "a.toml");
    ASSERT_TRUE(toml) << entry.path();
    const auto json = parse_json(tests::json_text(*toml), "a.json");
    ASSERT_TRUE(json) << entry.path() << ": " << json.error().text();
    EXPECT_TRUE(tests::same_tree(*json, *toml)) << entry.path();
    ++racks;
  }
  EXPECT_GE(racks, 20);
}

TEST(Json, WholeNumbersStayWholeAsFarAsTheyReach) {
  const auto number = [](const std::string& text) { return *parse_json(text, ""); };
  EXPECT_EQ(*number("-9223372036854775808").find<std::int64_t>(), INT64_MIN);
  EXPECT_EQ(*number("9223372036854775808").find<double>(), 9223372036854775808.0);
  EXPECT_EQ(*number("18446744073709551616").find<double>(), 18446744073709551616.0);
  EXPECT_EQ(*number("-9223372036854775809").find<double>(), -9223372036854775808.0);
  EXPECT_EQ(*number("1e3").find<double>(), 1000.0);
  EXPECT_EQ(*number("-0").find<std::int64_t>(), 0);
  EXPECT_TRUE(number("null").is<std::monostate>());
  EXPECT_EQ(refusal("[1,\n 1e999]"), "2:2 the number is too large; write one up to 1.7e308");
}

TEST(Json, EachValueHasItsPlace) {
  const auto tree = parse_json(
      "\xEF\xBB\xBF{\"a\": 12,\n \"\xC3\xA4\": \"\\\"[\", \"c\" :\t[ true,null,{\"d\":-1}],\r\n"
      " \"e\": 5 }",
      "a.json");
  ASSERT_TRUE(tree);
  EXPECT_EQ(place(&*tree), "1:1");
  EXPECT_EQ(place(tree->at("a")), "1:7");
  EXPECT_EQ(place(tree->at("\xC3\xA4")), "2:7") << "columns are characters";
  EXPECT_EQ(place(tree->at("c")), "2:20");
  const List& list = *tree->at("c")->find<List>();
  EXPECT_EQ(place(&list[0]), "2:22");
  EXPECT_EQ(place(&list[1]), "2:27");
  EXPECT_EQ(place(&list[2]), "2:32");
  EXPECT_EQ(place(list[2].at("d")), "2:37");
  EXPECT_EQ(place(tree->at("e")), "3:7");
}

TEST(Json, OfNoJsonSaysWhere) {
  EXPECT_THAT(refusal(""), HasSubstr("1:1 syntax error while parsing value - unexpected end"));
  EXPECT_THAT(refusal("{\"a\": 1}\n}"), HasSubstr("2:1 "));
  EXPECT_THAT(refusal("{\"a\": 1}\n}"), HasSubstr("expected end of input"));
  EXPECT_THAT(refusal("{\"a\": 1} {\"b\": 1}"), HasSubstr("1:10 "));
  EXPECT_THAT(refusal("{\"a\": 1\n"), HasSubstr("2:1 "));
  EXPECT_THAT(refusal("{\"a\": 1,}"), HasSubstr("1:9 "));
  EXPECT_THAT(refusal("{\n\"a\": tru }"), HasSubstr("2:6 "));
  EXPECT_THAT(refusal("[1,\n \"abc\" \"abc\"]"), HasSubstr("2:8 "));
  EXPECT_THAT(refusal("{'a': 1}"), HasSubstr("1:2 "));
  EXPECT_THAT(refusal("{\"a\": NaN}"), HasSubstr("1:7 "));
  EXPECT_THAT(refusal("{\"a\": 01}"), HasSubstr("1:7 "));
  EXPECT_THAT(refusal("// a comment\n{}"), HasSubstr("1:1 "));
  EXPECT_THAT(refusal("{\"a\": \"\xFF\"}"), HasSubstr("ill-formed UTF-8"));
  EXPECT_THAT(refusal("{\"a\": \"" + std::string(10'000, 'x')), testing::SizeIs(testing::Lt(200)));
}

TEST(Json, ANameThatStandsTwiceIsRefused) {
  EXPECT_EQ(refusal("{\"a\": {\"b\": 1,\n  \"c\": 2, \"b\": 1}}"),
            "2:11 the name \"b\" stands twice in its object; leave one out");
  EXPECT_EQ(refusal("{\"a\": {\"b\": 1}, \"b\": [{\"a\": 1}, {\"a\": 2}]}"), "");
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) {
    all += text;
  }
  return all;
}

TEST(Json, WhatIsNestedTooDeepIsRefused) {
  EXPECT_EQ(refusal(repeated("[", 256) + repeated("]", 256)), "");
  EXPECT_THAT(refusal(repeated("[", 257) + repeated("]", 257)),
              HasSubstr("1:257 tables and lists"));
  EXPECT_THAT(refusal(repeated("{\"a\":\n", 300)), HasSubstr("257:1 "));
  EXPECT_THAT(refusal(repeated("[", 1'000'000)), HasSubstr("deeper than 256"));
  EXPECT_THAT(refusal(repeated("[{\"a\":", 1'000'000)), HasSubstr("deeper than 256"));
}

}  // namespace
}  // namespace stator::formats
