// Which known word is suggested for a misspelt one, and when none is.
#include "stator/base/spelling.hpp"

#include <array>
#include <string>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

constexpr std::array<std::string_view, 4> kWords{"MVP", "STAP", "STGP", "MAX_POSITIONING_SPEED"};

TEST(Spelling, TheMostAlikeWordIsFound) {
  EXPECT_EQ(closest_match("MPV", kWords), "MVP");
  EXPECT_EQ(closest_match("stgb", kWords), "STGP");
  EXPECT_EQ(closest_match("SATP", kWords), "STAP") << "neighbours exchanged are one edit";
  EXPECT_EQ(closest_match("MAX_POSITIONING_SPED", kWords), "MAX_POSITIONING_SPEED");
}

TEST(Spelling, TheBeginningOfALongWordIsEnough) {
  EXPECT_EQ(closest_match("max_pos", kWords), "MAX_POSITIONING_SPEED");
  EXPECT_EQ(closest_match("max", kWords), "MVP") << "too short to be a beginning";
}

TEST(Spelling, NothingIsSuggestedForAWordUnlikeAll) {
  EXPECT_EQ(closest_match("encoder", kWords), "");
  EXPECT_EQ(closest_match(std::string(100000, 'M'), kWords), "");
  EXPECT_EQ(closest_match("MVP", {}), "");
  EXPECT_EQ(closest_match("A", std::array<std::string_view, 1>{"B"}), "") << "nothing in common";
}

TEST(Spelling, LetterCaseDoesNotCount) {
  EXPECT_TRUE(same_word("Loop_1", "LOOP_1"));
  EXPECT_FALSE(same_word("Loop", "Loops"));
  EXPECT_FALSE(same_word("a", "b"));
}

}  // namespace
}  // namespace stator::base
