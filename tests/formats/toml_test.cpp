#include "stator/formats/toml/toml.hpp"

#include <string>
#include <variant>

#include <gtest/gtest.h>

namespace stator::formats {
namespace {

using settings::List;
using settings::Table;
using settings::Value;

TEST(Toml, BecomesATreeWithThePlaceOfEachValue) {
  const auto tree = parse_toml(
      "a = 1\n[t]\nb = [1.5, true]\n[[u]]\n[[u]]\nc = { d = \"x\" }\ne = 1979-05-27\n", "a.toml");
  ASSERT_TRUE(tree);
  EXPECT_EQ(*tree->at("a")->find<std::int64_t>(), 1);
  EXPECT_EQ(tree->at("a")->find<double>(), nullptr) << "1 is a whole number";
  const Value* const b = tree->at("t")->at("b");
  ASSERT_NE(b->find<List>(), nullptr);
  EXPECT_EQ(*(*b->find<List>())[0].find<double>(), 1.5);
  EXPECT_TRUE(*(*b->find<List>())[1].find<bool>());
  EXPECT_EQ(b->place().line, 3U);
  EXPECT_EQ(b->place().column, 5U);
  const Value* const u = tree->at("u");
  ASSERT_TRUE(u->is_list_of_tables());
  const Value& second = (*u->find<List>())[1];
  EXPECT_EQ(second.place().line, 5U);
  EXPECT_EQ(*second.at("c")->at("d")->find<std::string>(), "x");
  EXPECT_TRUE(second.at("e")->is<std::monostate>()) << "no key takes a date";
}

TEST(Toml, OfNoTomlSaysWhere) {
  const auto tree = parse_toml("a = 1\nb = = 2\n", "a.toml");
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().line(), 2U);
  EXPECT_EQ(tree.error().text().substr(0, 9), "a.toml:2:");
}

TEST(Toml, ValuesOfOptionsNeedNoQuotes) {
  EXPECT_EQ(std::get<std::int64_t>(parse_toml_value("0x10")), 16);
  EXPECT_EQ(std::get<double>(parse_toml_value("2e-4")), 2e-4);
  EXPECT_TRUE(std::get<bool>(parse_toml_value("true")));
  EXPECT_EQ(std::get<std::string>(parse_toml_value("5ms")), "5ms");
  EXPECT_EQ(std::get<std::string>(parse_toml_value("\"5\"")), "5");
  EXPECT_EQ(std::get<std::string>(parse_toml_value("a b")), "a b");
  EXPECT_EQ(std::get<List>(parse_toml_value("[1, 2]")).size(), 2U);
  EXPECT_EQ(std::get<std::string>(parse_toml_value("1\nb = 2")), "1\nb = 2")
      << "no second key comes in";
}

}  // namespace
}  // namespace stator::formats
