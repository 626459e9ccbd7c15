// Paths of names and numbers that lead to a value of a tree, and set it.
#include "stator/settings/path.hpp"

#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::settings {
namespace {

using testing::HasSubstr;

Path path_of(const std::string& text) {
  const auto path = parse_path(text);
  EXPECT_TRUE(path) << text;
  return path ? *path : Path();
}

std::string problem_of(const std::string& text) {
  const auto path = parse_path(text);
  return path ? "" : path.error();
}

TEST(Path, HasNamesAndNumbers) {
  EXPECT_EQ(path_of("clock"), (Path{"clock"}));
  EXPECT_EQ(path_of("gantry.axis[1].load.inertia"),
            (Path{"gantry", "axis", std::size_t{1}, "load", "inertia"}));
  EXPECT_EQ(path_of("a[0][2]"), (Path{"a", std::size_t{0}, std::size_t{2}}));
  EXPECT_EQ(path_of("x.objects.\"2030:03\""), (Path{"x", "objects", "2030:03"}));
}

TEST(Path, OfOtherTextsSaysWhatIsExpectedWhere) {
  EXPECT_THAT(problem_of(""), HasSubstr("a name is expected at its end"));
  EXPECT_THAT(problem_of("a."), HasSubstr("a name is expected at its end"));
  EXPECT_THAT(problem_of("a..b"), HasSubstr("a name is expected at \".b\""));
  EXPECT_THAT(problem_of("a[x]"), HasSubstr("a number in brackets is expected at \"[x]\""));
  EXPECT_THAT(problem_of("a[1"), HasSubstr("a number in brackets"));
  EXPECT_THAT(problem_of("a[-1]"), HasSubstr("a number in brackets"));
  EXPECT_THAT(problem_of("a[99999999999999999999]"), HasSubstr("a number in brackets"));
  EXPECT_THAT(problem_of("a b"), HasSubstr("a dot is expected at \" b\""));
  EXPECT_THAT(problem_of("\"a"), HasSubstr("a name is expected"));
}

TEST(Path, HasNoMoreStepsThanAnyKey) {
  std::string text = "a";
  for (int i = 1; i < 256; ++i) {
    text += i % 2 == 0 ? ".a" : "[0]";
  }
  EXPECT_EQ(path_of(text).size(), 256U);
  EXPECT_THAT(problem_of(text + ".a"), HasSubstr("the path has 257 steps"));
  for (int i = 0; i < 10; ++i) {
    text += '.' + text;
  }
  EXPECT_THAT(problem_of(text), HasSubstr("no key is more than 256 deep"));
}

TEST(Path, LeadsThroughTablesAndLists) {
  Table inner;
  inner.emplace("x", Value(std::int64_t{5}));
  List list;
  list.emplace_back(inner);
  Table table;
  table.emplace("list", Value(list));
  const Value root(table);
  const Value* const found = find(root, path_of("list[0].x"));
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(*found->find<std::int64_t>(), 5);
  EXPECT_EQ(find(root, path_of("list[1].x")), nullptr);
  EXPECT_EQ(find(root, path_of("list.x")), nullptr);
  EXPECT_EQ(find(root, path_of("other")), nullptr);
}

TEST(Path, MakesWhatIsNotThereWhenSomethingIsSet) {
  Value root;
  const Place place{0, 0, std::make_shared<const std::string>("--set")};
  ASSERT_TRUE(set(root, path_of("axis[1].load.inertia"), Value(2e-4, place)));
  const Value* const first = find(root, path_of("axis[0]"));
  ASSERT_NE(first, nullptr);
  EXPECT_TRUE(first->is<Table>());
  const Value* const load = find(root, path_of("axis[1].load"));
  ASSERT_NE(load, nullptr);
  EXPECT_EQ(*load->at("inertia")->find<double>(), 2e-4);
  EXPECT_EQ(*load->at("inertia")->place().source, "--set");
  EXPECT_EQ(*find(root, path_of("axis"))->place().source, "--set");
}

TEST(Path, ReplacesWhatIsThere) {
  Value root;
  ASSERT_TRUE(set(root, path_of("a.b"), Value(std::string("old"))));
  ASSERT_TRUE(set(root, path_of("a.b"), Value(true)));
  EXPECT_TRUE(*find(root, path_of("a.b"))->find<bool>());
}

TEST(Path, IsStoppedByWhatStandsInTheWay) {
  Value root;
  ASSERT_TRUE(set(root, path_of("a.b"), Value(std::int64_t{1})));
  const auto through = set(root, path_of("a.b.c"), Value(true));
  ASSERT_FALSE(through);
  EXPECT_EQ(through.error(), "\"a.b\" is no table, so it has no \"c\"");
  const auto into = set(root, path_of("a[0]"), Value(true));
  ASSERT_FALSE(into);
  EXPECT_EQ(into.error(), "\"a\" is no list, so it has no [0]");
  const auto beyond = set(root, path_of("list[1000000]"), Value(true));
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error(), HasSubstr("at most 1000"));
}

}  // namespace
}  // namespace stator::settings
