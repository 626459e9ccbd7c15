// Patterns of names with *, ? and [], letter case, and the time that many stars take.
#include "stator/base/name_pattern.hpp"

#include <string>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

TEST(NamePattern, AStarStandsForAnyRun) {
  EXPECT_TRUE(matches("*", ""));
  EXPECT_TRUE(matches("a*c", "abbc"));
  EXPECT_TRUE(matches("*.axis0.*", "gantry.axis0.position"));
  EXPECT_TRUE(matches("a*b*c", "a_b_b_c"));
  EXPECT_TRUE(matches("*ab", "aab"));
  EXPECT_FALSE(matches("a*c", "abcd"));
  EXPECT_FALSE(matches("", "a"));
  EXPECT_FALSE(matches("a", ""));
  EXPECT_FALSE(matches("abc", "ab"));
}

TEST(NamePattern, AQuestionMarkStandsForOne) {
  EXPECT_TRUE(matches("axis?.position", "axis2.position"));
  EXPECT_TRUE(matches("*?", "a"));
  EXPECT_FALSE(matches("axis?", "axis"));
  EXPECT_FALSE(matches("axis?", "axis12"));
}

TEST(NamePattern, BracketsStandForOneOfASet) {
  EXPECT_TRUE(matches("axis[02]", "axis2"));
  EXPECT_FALSE(matches("axis[02]", "axis1"));
  EXPECT_TRUE(matches("axis[0-2].*", "axis1.speed"));
  EXPECT_FALSE(matches("axis[0-2]", "axis3"));
  EXPECT_TRUE(matches("axis[!0-2]", "axis3"));
  EXPECT_FALSE(matches("axis[!0-2]", "axis2"));
  EXPECT_TRUE(matches("[]a]", "]"));
  EXPECT_TRUE(matches("a[b", "a[b")) << "a bracket that is not closed stands for itself";
  EXPECT_FALSE(matches("a[b", "ab"));
}

TEST(NamePattern, CaseMattersUnlessItIsNotAskedFor) {
  EXPECT_FALSE(matches("Axis*", "axis0"));
  EXPECT_TRUE(matches_in_any_case("Axis[A-C]", "aXISb"));
  EXPECT_TRUE(matches_in_any_case("GO*", "Go_Home"));
}

TEST(NamePattern, ManyStarsTakeNoLongerThanTheLengthsSay) {
  std::string pattern;
  for (int i = 0; i < 500; ++i) {
    pattern += "*a";
  }
  EXPECT_FALSE(matches(pattern + "b", std::string(2000, 'a')));
}

}  // namespace
}  // namespace stator::base
