// What progress says, and that nothing is said where nobody watches.
#include "stator/cli/progress.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::cli {
namespace {

TEST(Progress, TellsThePartAndTheTimeLeft) {
  EXPECT_EQ(Progress::text("replaying", 0.25, 3.0), "replaying: 25 %, 9 s left");
  EXPECT_EQ(Progress::text("testing", 0.5, 125.0), "testing: 50 %, 2 min 5 s left");
  EXPECT_EQ(Progress::text("testing", 1.0, 7.0), "testing: 100 %, 0 s left");
}

TEST(Progress, TellsTheTimeThatPassedWhereThePartIsNotKnownOrTooSmall) {
  EXPECT_EQ(Progress::text("measuring move", -1.0, 3.2), "measuring move: 4 s so far");
  EXPECT_EQ(Progress::text("measuring move", 0.001, 3.0), "measuring move: 3 s so far");
}

TEST(Progress, IsSilentWhereStandardErrorIsNoTerminal) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("testing");
    progress.reached(0.5);
    progress.clear();
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace stator::cli
