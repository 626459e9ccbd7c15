// TOML read as a tree of values with their places, and nesting that is too deep.
#include "stator/formats/toml/toml.hpp"

#include <string>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::formats {
namespace {

using settings::List;
using settings::Table;
using settings::Value;
using ::testing::HasSubstr;

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

/// A text some times.
std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) {
    all += text;
  }
  return all;
}

TEST(Toml, WhatIsNestedTooDeepIsRefused) {
  const auto refused = [](const std::string& text) {
    const auto tree = parse_toml(text, "a.toml");
    return tree ? "" : tree.error().text();
  };
  const auto deep = HasSubstr("deeper than 256");
  EXPECT_EQ(refused("a" + repeated(".a", 200) + " = 1\n"), "");
  EXPECT_THAT(refused("b = 1\na" + repeated(".a", 1'000'000) + " = 1\n"), deep);
  EXPECT_THAT(refused("b = 1\na" + repeated(".a", 300) + " = 1\n"), HasSubstr("a.toml:2:514: "));
  EXPECT_THAT(refused("[a" + repeated(".a", 1'000'000) + "]\n"), deep);
  EXPECT_THAT(refused("[[a" + repeated(" . \"a\"", 1'000'000) + "]]\n"), deep);
  EXPECT_THAT(refused("a = " + repeated("[", 1'000'000)), deep);
  EXPECT_THAT(refused("a = " + repeated("{a.b.c.d.e=", 100)), deep);
  EXPECT_THAT(refused("[a" + repeated(".a", 200) + "]\nb" + repeated(".b", 100) + " = 1\n"), deep);
  // Dots of anything else.
  EXPECT_EQ(
      refused("[t.u] # " + repeated(".", 1'000) + "\na = [" + repeated("1.5, \n", 1'000) +
              "]\nb = \"" + repeated(".\\\"", 1'000) + "\"\nc = '''\n" + repeated("x.y'\n", 1'000) +
              "'''''\nd.e = { f = \"\"\"" + repeated(".\\\n", 999) +
              "\"\"\"\"\", g.h = [[1.5], [2.5]] }\n" + repeated("[[v.w]]\nx.y = 1.5\n", 999)),
      "");
  EXPECT_EQ(std::get<std::string>(parse_toml_value("{a" + repeated(".a", 300) + "=1}")).size(),
            605U)
      << "a word, as anything that is no value";
}

}  // namespace
}  // namespace stator::formats
