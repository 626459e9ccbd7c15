#include "stator/settings/reader.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/formats/toml/toml.hpp"

namespace stator::settings {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A text in TOML with a reader of its root.
class Text {
 public:
  explicit Text(const std::string& text) : tree_(*formats::parse_toml(text, "a.toml")) {}

  [[nodiscard]] Reader& reader() { return reader_; }
  [[nodiscard]] std::vector<std::string> problems() const {
    std::vector<std::string> texts;
    for (const Problem& problem : problems_.list) {
      texts.push_back(problem.text());
    }
    return texts;
  }

 private:
  Value tree_;
  Problems problems_;
  Reading reading_{problems_, nullptr, "a.toml"};
  Reader reader_{reading_, "the file", tree_};
};

TEST(Reader, FindsAllProblemsAtOnceWithTheirPlaces) {
  Text text("a = 5\nb = \"x\"\nc = true\n[t]\nd = 1979-05-27\n");
  EXPECT_EQ(text.reader().integer("a", 0, 4), std::nullopt);
  EXPECT_EQ(text.reader().number("b", 0.0, 1.0), std::nullopt);
  EXPECT_EQ(text.reader().text("c"), std::nullopt);
  auto table = text.reader().section("t");
  ASSERT_TRUE(table);
  EXPECT_EQ(table->boolean("d"), std::nullopt);
  EXPECT_THAT(text.problems(),
              ElementsAre("a.toml:1:5: \"a\" is 5; it must lie in 0 .. 4 in the file",
                          "a.toml:2:5: \"b\" must be a number in the file",
                          "a.toml:3:5: \"c\" must be a text in quotes in the file",
                          "a.toml:5:5: \"d\" must be true or false in [t]"));
}

TEST(Reader, TellsOneProblemOfAKey) {
  Text text("a = 5\n");
  EXPECT_EQ(text.reader().integer("a", 0, 4), std::nullopt);
  text.reader().refuse("a", "does not go with b");
  EXPECT_EQ(text.problems().size(), 1U);
}

TEST(Reader, RefusesKeysThatNobodyAskedFor) {
  Text text("known = 1\nknwon = 2\n");
  EXPECT_EQ(text.reader().integer("known", 0, 4), 1);
  text.reader().finish();
  ASSERT_EQ(text.problems().size(), 1U);
  EXPECT_THAT(text.problems().front(),
              HasSubstr("unknown key \"knwon\" (did you mean \"known\"?); the keys are: known;"));
}

TEST(Reader, KeepsTheDefaultOfAWrongValue) {
  Text text("a = \"five\"\nb = 7\n");
  int a = 3;
  int b = 3;
  text.reader().integer("a", 0, 10, a);
  text.reader().integer("b", 0, 10, b);
  EXPECT_EQ(a, 3);
  EXPECT_EQ(b, 7);
}

TEST(Reader, WhatComesFromNoFileTellsTheReasonAlone) {
  const Value tree(Table{{"a", Value(true)}});
  Problems problems;
  const Reading reading{problems};
  Reader reader(reading, "the fault", tree);
  EXPECT_EQ(reader.integer("a", 0, 4), std::nullopt);
  ASSERT_EQ(problems.list.size(), 1U);
  EXPECT_EQ(problems.list.front().text(), "\"a\" must be a whole number");
}

TEST(Reader, NamesWhoeverGaveTheValueInTheFilesPlace) {
  Value tree(Table{});
  const auto source = std::make_shared<const std::string>("--set a=9");
  tree.find<Table>()->emplace("a", Value(std::int64_t{9}, {0, 0, source}));
  Problems problems;
  const Reading reading{problems, nullptr, "a.toml"};
  Reader reader(reading, "the file", tree);
  EXPECT_EQ(reader.integer("a", 0, 4), std::nullopt);
  ASSERT_EQ(problems.list.size(), 1U);
  EXPECT_EQ(problems.list.front().text(),
            "--set a=9: \"a\" is 9; it must lie in 0 .. 4 in the file");
}

TEST(Reader, ListsOfTablesAreReadOneByOne) {
  Text text("[[t]]\na = 1\n[[t]]\na = 2\n");
  std::vector<Reader> tables = text.reader().sections("t");
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[1].path(), "[[t]] number 2");
  EXPECT_EQ(tables[1].integer("a", 0, 4), 2);
  EXPECT_THAT(text.problems(), IsEmpty());
  Text other("t = [1, { a = 1 }]\n");
  EXPECT_TRUE(other.reader().sections("t").empty());
  EXPECT_THAT(other.problems(), ElementsAre(HasSubstr("must be written as [[t]]")));
}

TEST(Reader, NotesTheFilesThatKeysNameAsTheyNameThem) {
  const Value tree(
      Table{{"image", Value(std::string("../b.bin"))}, {"log", Value(std::string("c.log"))}});
  Problems problems;
  std::vector<std::string> named;
  const Reading reading{problems, nullptr, "a.toml", &named};
  Reader reader(reading, "the file", tree);
  EXPECT_EQ(reader.file("image", "image"), std::nullopt) << "nobody opens files here";
  EXPECT_EQ(reader.file("other", "image"), std::nullopt);
  EXPECT_EQ(reader.output("log"), "c.log");
  EXPECT_THAT(named, ElementsAre("../b.bin")) << "what is written is not read";
}

}  // namespace
}  // namespace stator::settings
