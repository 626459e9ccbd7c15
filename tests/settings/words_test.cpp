// How durations and numbers are written for people, and which word a wrong one is taken for.
#include "stator/settings/words.hpp"

#include <gtest/gtest.h>

namespace stator::settings {
namespace {

using namespace base::literals;

TEST(Words, DurationsReadAsTheyAreWritten) {
  for (const char* const text : {"1ns", "250us", "15ms", "2s", "3600s", "0ms"}) {
    const auto duration = parse_duration(text);
    ASSERT_TRUE(duration) << text;
    EXPECT_EQ(duration_text(*duration), text);
  }
  EXPECT_EQ(parse_duration("2.5 ms"), 2500_us);
  EXPECT_EQ(parse_duration("1e3us"), 1_ms);
  for (const char* const text :
       {"", "5", "ms", "5 m", "1e300s", "nan s", "5msx", "7", "1e300s", "nans"}) {
    EXPECT_FALSE(parse_duration(text)) << text;
  }
}

TEST(Words, NumbersAreAsShortAsTheyCanBe) {
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(1e-5), "1e-05");
  EXPECT_EQ(number_text(1e6), "1000000");
  EXPECT_EQ(number_text(1.0 / 3.0, 3), "0.333");
}

TEST(Words, GuessWhatWasMeant) {
  EXPECT_EQ(guess_text("inertai", {"inertia", "friction"}), " (did you mean \"inertia\"?)");
  EXPECT_EQ(guess_text("xyz", {"inertia", "friction"}), "");
}

}  // namespace
}  // namespace stator::settings
