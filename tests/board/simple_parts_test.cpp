// Switches with bounce, push-buttons, RC filters, LEDs and loads on a board.
#include <cmath>

#include <gtest/gtest.h>

#include "board/bench.hpp"
#include "stator/board/parts/decay.hpp"

namespace stator::board {
namespace {

TEST(Switch, SetsItsLineWithoutBouncing) {
  Bench bench({part("s", kSwitch, {{"line", 7}})});
  EXPECT_FALSE(bench.pins.level(7));
  bench.wait(1_ms);
  bench.input("s.closed", 1.0);
  EXPECT_TRUE(bench.pins.level(7));
  ASSERT_EQ(bench.pins.edges(7).size(), 1U);
  EXPECT_EQ(bench.pins.edges(7)[0].time, base::SimTime(1_ms));
  EXPECT_EQ(bench.board.next_event(), base::SimTime::never());
}

TEST(Switch, IsHighWhileOpenWhenItIsActiveLow) {
  Bench bench({part("s", kSwitch, {{"line", 7}}, {{"active_low", 1}})});
  EXPECT_TRUE(bench.pins.level(7));
  bench.input("s.closed", 1.0);
  EXPECT_FALSE(bench.pins.level(7));
}

TEST(Switch, BouncesForItsTimeAndThenStays) {
  const auto edges_with_seed = [](double seed) {
    Bench bench({part("s", kSwitch, {{"line", 7}}, {{"bounce_time", 2000}, {"seed", seed}})});
    bench.wait(1_ms);
    bench.input("s.closed", 1.0);
    bench.wait(10_ms);
    EXPECT_TRUE(bench.pins.level(7));
    const auto& edges = bench.pins.edges(7);
    EXPECT_GE(edges.size(), 5U);
    EXPECT_LE(edges.back().time, base::SimTime(3_ms));
    std::vector<std::int64_t> times;
    for (const auto& edge : edges) {
      times.push_back(edge.time.nanoseconds());
    }
    return times;
  };
  EXPECT_EQ(edges_with_seed(1), edges_with_seed(1));
  EXPECT_NE(edges_with_seed(1), edges_with_seed(2));
}

TEST(PushButton, OpensByItself) {
  Bench bench({part("b", kPushButton, {{"line", 7}}, {{"hold_time", 50}})});
  bench.wait(1_ms);
  bench.input("b.press", 1.0);
  bench.wait(200_ms);
  ASSERT_EQ(bench.pins.edges(7).size(), 2U);
  EXPECT_EQ(bench.pins.edges(7)[1].time, base::SimTime(51_ms));
}

TEST(RcFilter, ApproachesTheMeanExponentially) {
  Bench bench({part("f", kRcFilter, {{"line", 7}}, {{"resistance", 1000}, {"capacitance", 1000}})});
  bench.pins.put_mean(base::SimTime(), 7, 0.5);
  for (int k = 1; k <= 5; ++k) {
    bench.wait(1_ms);
    EXPECT_NEAR(bench.signal("f.voltage"), 1.65 * (1.0 - std::exp(-k)), 1e-9);
  }
  bench.pins.put_mean(bench.board.time(), 7, 0.0);
  bench.wait(2_ms);
  EXPECT_NEAR(bench.signal("f.voltage"), 1.65 * (1.0 - std::exp(-5.0)) * std::exp(-2.0), 1e-9);
  EXPECT_EQ(bench.board.next_event(), base::SimTime::never()) << "it costs nothing";
}

TEST(Decay, IsTheExponentialFunction) {
  for (double x = 0.0; x < 100.0; x = x * 1.03 + 0.001) {
    EXPECT_NEAR(decay(x) / std::exp(-x), 1.0, 1e-12) << x;
  }
  EXPECT_EQ(decay(1e9), 0.0);
}

TEST(Led, ShinesWithTheMeanLevel) {
  Bench bench({part("led", kLed, {{"line", 7}}, {{"active_low", 1}})});
  bench.pins.put_mean(base::SimTime(), 7, 0.25);
  EXPECT_DOUBLE_EQ(bench.signal("led.brightness"), 0.75);
}

TEST(Load, DrawsCurrentUntilItIsAShort) {
  Bench bench({part("valve", kLoad, {{"line", 16}}, {{"resistance", 480}})});
  bench.pins.put_mean(base::SimTime(), 16, 0.5);
  EXPECT_DOUBLE_EQ(bench.signal("valve.current"), 0.025);
  EXPECT_EQ(bench.pins.short_at(16), LineShort::none);
  bench.input("valve.resistance", 100.0);  // 240 mA
  EXPECT_EQ(bench.pins.short_at(16), LineShort::ground);
  bench.input("valve.resistance", 480.0);
  EXPECT_EQ(bench.pins.short_at(16), LineShort::none);
  bench.input("valve.short", 2.0);
  EXPECT_EQ(bench.pins.short_at(16), LineShort::supply);
  bench.input("valve.short", 0.0);
  EXPECT_EQ(bench.pins.short_at(16), LineShort::none);
}

}  // namespace
}  // namespace stator::board
