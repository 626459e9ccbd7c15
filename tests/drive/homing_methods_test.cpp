// Where every method finds home, from everywhere.

#include "stator/drive/modes/homing_methods.hpp"

#include <cstdlib>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "drive/axis_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

constexpr std::int64_t kFar = std::numeric_limits<std::int32_t>::max();
constexpr double kFast = 50'000.0;
constexpr double kSlow = 10'000.0;
constexpr double kAcceleration = 500'000.0;

/// The way of the axis in microsteps: limit switches at both ends, a home switch, and an index mark
/// every 51200: ... -95400, -44200, 7000, 58200 ...
constexpr AxisBench::Cam kLeft{-kFar, -100'000};
constexpr AxisBench::Cam kRight{100'000, kFar};
constexpr std::int64_t kIndexMark = 7000;
constexpr AxisBench::Cam kPositiveHome{20'000, kFar};   // pressed on the positive side of 20000
constexpr AxisBench::Cam kNegativeHome{-kFar, 20'000};  // and on the negative side
constexpr AxisBench::Cam kWideHome{20'000, 24'000};     // the motor turns round on it
constexpr AxisBench::Cam kNarrowHome{20'000, 20'800};   // and beyond it: braking takes 2500

struct Run {
  int method;
  AxisBench::Cam home;
  std::int64_t start;
  std::int64_t expected;  ///< first position at which the switch is seen released, or the mark
};

/// Shows a run in the message of a failed test.
std::string name_of(const Run& run) {
  return "method " + std::to_string(run.method) + " from " + std::to_string(run.start) +
         ", home switch " + std::to_string(run.home.from) + " to " + std::to_string(run.home.to);
}

AxisBench::Cam seen_from(std::int64_t start, const AxisBench::Cam& cam) {
  return {cam.from - start, cam.to - start};
}

/// An axis that was switched on at `run.start`.
class HomingRun {
 public:
  explicit HomingRun(const Run& run) : run_(run) {
    bench_.left_switch = seen_from(run.start, kLeft);
    bench_.right_switch = seen_from(run.start, kRight);
    bench_.home_switch = seen_from(run.start, run.home);
    bench_.index_mark = kIndexMark - run.start;
    bench_.write(0x606A, 0);
    bench_.write(0x6098, run.method);
    bench_.write(0x6099, 1, static_cast<std::int64_t>(kFast));
    bench_.write(0x6099, 2, static_cast<std::int64_t>(kSlow));
    bench_.write(0x609A, static_cast<std::int64_t>(kAcceleration));
    bench_.enable(ModeCode::homing);
    bench_.write(0x6040, 0x1F);
  }
  /// Lets the axis home, watching its velocity.
  void finish() {
    double before = bench_.velocity();
    for (int i = 0; i < 120'000 && !bench_.status(statusword::kHomeAttained); ++i) {
      bench_.pass(1_ms);
      const double velocity = bench_.velocity();
      highest_speed_ = std::max(highest_speed_, std::abs(velocity));
      highest_acceleration_ = std::max(highest_acceleration_, std::abs(velocity - before) * 1000.0);
      before = velocity;
    }
    bench_.pass(10_ms);
  }
  [[nodiscard]] std::int64_t home() const { return bench_.shaft() + run_.start; }
  [[nodiscard]] double highest_speed() const { return highest_speed_; }
  [[nodiscard]] double highest_acceleration() const { return highest_acceleration_; }
  [[nodiscard]] AxisBench& bench() { return bench_; }

 private:
  Run run_;
  AxisBench bench_;
  double highest_speed_ = 0.0;
  double highest_acceleration_ = 0.0;
};

void expect_home(const Run& run) {
  SCOPED_TRACE(name_of(run));
  HomingRun homing(run);
  homing.finish();
  EXPECT_TRUE(homing.bench().status(statusword::kHomeAttained));
  EXPECT_TRUE(homing.bench().status(statusword::kTargetReached));
  EXPECT_EQ(homing.home(), run.expected) << "the motor stands on home";
  EXPECT_EQ(homing.bench().velocity(), 0.0);
  EXPECT_TRUE(homing.bench().all_positions_are(0));
  EXPECT_LE(homing.highest_speed(), kFast);
  EXPECT_LE(homing.highest_acceleration(), kAcceleration * 1.001);
}

TEST(HomingMethods, LimitSwitchesAreLeftTowardsTheMiddle) {
  for (const std::int64_t start : {-150'000, -100'000, -99'990, -60'000, 0, 99'000}) {
    expect_home({17, kWideHome, start, -99'999});
  }
  for (const std::int64_t start : {150'000, 100'000, 99'990, 60'000, 0, -99'000}) {
    expect_home({18, kWideHome, start, 99'999});
  }
}

TEST(HomingMethods, LimitSwitchWithIndexTakesTheFirstPulseBeyondTheSwitch) {
  for (const std::int64_t start : {-150'000, -100'000, -97'000, -95'400, 0, 99'000}) {
    expect_home({1, kWideHome, start, -95'400});
  }
  for (const std::int64_t start : {150'000, 100'000, 58'200, 58'100, 0, -99'000}) {
    expect_home({2, kWideHome, start, 58'200});
  }
}

TEST(HomingMethods, HomeSwitchOnOneSideIsLeftTowardsTheOther) {
  for (const std::int64_t start : {0, 19'999, 20'000, 30'000, 80'000}) {
    expect_home({19, kPositiveHome, start, 19'999});
    expect_home({21, kNegativeHome, start, 20'001});
  }
}

TEST(HomingMethods, HomeSwitchWithIndexTakesTheFirstPulseBeyondTheSwitch) {
  for (const std::int64_t start : {0, 7000, 19'999, 20'000, 30'000, 80'000}) {
    expect_home({3, kPositiveHome, start, 7000});
    expect_home({5, kNegativeHome, start, 58'200});
  }
}

TEST(HomingMethods, HomeSwitchInTheMiddleIsFoundFromBothSides) {
  for (const std::int64_t start : {-80'000, 0, 19'999, 20'000, 22'000, 24'000, 24'001, 90'000}) {
    expect_home({19, kWideHome, start, 19'999});
    expect_home({21, kWideHome, start, 24'001});
  }
}

TEST(HomingMethods, AnEdgePassedTooFastIsSearchedAgain) {
  for (const std::int64_t start : {-80'000, 19'999, 20'400, 20'801, 22'000, 90'000}) {
    expect_home({19, kNarrowHome, start, 19'999});
    expect_home({21, kNarrowHome, start, 20'801});
  }
}

TEST(HomingMethods, SearchReversesAtTheLimitSwitchMet) {
  HomingRun homing({19, kWideHome, 90'000, 19'999});
  std::int64_t farthest = 0;
  for (int i = 0; i < 1000; ++i) {
    homing.bench().pass(1_ms);
    farthest = std::max(farthest, homing.home());
  }
  EXPECT_GT(farthest, 100'000) << "the way to the switch leads away at first";
  EXPECT_LT(farthest, 105'000) << "braking on 609Ah and back";
  EXPECT_EQ(homing.bench().velocity(), -kFast);
}

TEST(HomingMethods, TheNextIndexInItsDirectionIsHome) {
  for (const std::int64_t start : {-44'200, -44'100, 0, 6999}) {
    expect_home({34, kWideHome, start, 7000});
  }
  for (const std::int64_t start : {58'200, 58'100, 20'000, 7001}) {
    expect_home({33, kWideHome, start, 7000});
  }
}

TEST(HomingMethods, OnlyTheSwitchIsSearchedFast) {
  HomingRun index({34, kWideHome, 0, 7000});
  index.finish();
  EXPECT_EQ(index.highest_speed(), kSlow) << "an index pulse is searched with 6099h:02";
  HomingRun on_switch({19, kPositiveHome, 30'000, 19'999});
  on_switch.finish();
  EXPECT_EQ(on_switch.highest_speed(), kSlow) << "the switch is found already";
  HomingRun searching({19, kPositiveHome, 0, 19'999});
  searching.finish();
  EXPECT_EQ(searching.highest_speed(), kFast);
  EXPECT_NEAR(searching.highest_acceleration(), kAcceleration, 1.0) << "609Ah";
}

TEST(HomingMethods, TheEdgeIsMetWithTheSlowSpeed) {
  HomingRun homing({19, kPositiveHome, 0, 19'999});
  bool was_on = false;
  double velocity_at_edge = 0.0;
  while (!homing.bench().status(statusword::kHomeAttained)) {
    const bool on = homing.home() >= kPositiveHome.from;
    if (was_on && !on && velocity_at_edge == 0.0) {
      velocity_at_edge = homing.bench().velocity();
    }
    was_on = on;
    homing.bench().pass(50_us);
  }
  EXPECT_NEAR(velocity_at_edge, -kSlow, 0.001 * kAcceleration) << "a control period later at most";
}

TEST(HomingMethods, CodesWithoutARowDoNothing) {
  EXPECT_EQ(find_homing_method(0), nullptr);
  EXPECT_EQ(find_homing_method(4), nullptr);
  HomingRun homing({0, kWideHome, 0, 0});
  homing.bench().pass(1_s);
  EXPECT_EQ(homing.home(), 0);
  EXPECT_FALSE(homing.bench().status(statusword::kTargetReached));
  EXPECT_FALSE(homing.bench().status(statusword::kHomeAttained));
}

}  // namespace
}  // namespace stator::drive
