#include "stator/control/stepper/open_load_detector.hpp"

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"

namespace stator::control {
namespace {

/// One electrical period in which each phase carries a share of its target.
void turn(OpenLoadDetector& detector, double amplitude, double share_a, double share_b) {
  for (int n = 0; n < 400; ++n) {
    const base::SineCosine x = base::sine_cosine(base::kTwoPi * (n + 0.5) / 400.0);
    detector.advance({amplitude * x.cosine, amplitude * x.sine},
                     {share_a * amplitude * x.cosine, share_b * amplitude * x.sine});
  }
}

TEST(OpenLoadDetector, FindsThePhaseThatCarriesNothing) {
  OpenLoadDetector detector;
  turn(detector, 2.0, 1.0, 0.0);
  turn(detector, 2.0, 1.0, 0.0);
  EXPECT_FALSE(detector.open(0));
  EXPECT_TRUE(detector.open(1));
  turn(detector, 2.0, 1.0, 1.0);
  turn(detector, 2.0, 1.0, 1.0);
  EXPECT_FALSE(detector.open(1)) << "repaired";
}

TEST(OpenLoadDetector, AFieldThatStandsFindsNothing) {
  OpenLoadDetector detector;
  for (int n = 0; n < 10'000; ++n) {
    detector.advance({2.0, -2.0}, {0.0, 0.0});
  }
  EXPECT_FALSE(detector.open(0));
  EXPECT_FALSE(detector.open(1));
}

TEST(OpenLoadDetector, CannotTellWithNextToNoCurrent) {
  OpenLoadDetector detector;
  turn(detector, 0.01, 0.0, 0.0);
  turn(detector, 0.01, 0.0, 0.0);
  EXPECT_FALSE(detector.open(0));
}

TEST(OpenLoadDetector, WhatIsSkippedTellsNothing) {
  OpenLoadDetector detector;
  turn(detector, 2.0, 0.0, 1.0);
  turn(detector, 2.0, 0.0, 1.0);
  ASSERT_TRUE(detector.open(0));
  detector.advance({2.0, 2.0}, {2.0, 0.0});
  detector.skip();
  detector.advance({-2.0, -2.0}, {-2.0, -2.0});
  EXPECT_FALSE(detector.open(1)) << "not seen as a whole";
  EXPECT_TRUE(detector.open(0)) << "what was found before stays";
  turn(detector, 2.0, 1.0, 0.0);
  turn(detector, 2.0, 1.0, 0.0);
  EXPECT_FALSE(detector.open(0));
  EXPECT_TRUE(detector.open(1));
}

}  // namespace
}  // namespace stator::control
