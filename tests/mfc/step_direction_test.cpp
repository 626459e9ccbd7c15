#include "stator/mfc/units/step_direction.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using base::SimTime;
using testing::at;
using testing::Edge;
using testing::RecordingSink;

// SD_CFG of channel 0.
constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kContinuous = 1U << 1;
constexpr std::uint32_t kStepPolarity = 1U << 2;
constexpr std::uint32_t kDirectionPolarity = 1U << 3;
constexpr std::uint32_t kClearCount = 1U << 4;
constexpr std::uint32_t kUseNextRate = 1U << 6;

constexpr std::int32_t kKilohertz = 171799;  // 1000.0018 steps per second

struct Bench {
  RecordingSink sink;
  StepDirection unit;

  explicit Bench(std::uint32_t configuration) {
    unit.watch({Signal::s0, Signal::d0});
    unit.write_configuration(configuration, sink);
  }
  void to(std::int64_t nanoseconds) { unit.advance(at(nanoseconds), sink); }
};

TEST(StepDirectionUnit, FirstStepComesAPeriodAndTheDelayAfterTheWrite) {
  // examples.md 9: 999.998 us + 40 ns + 80 ns, to the clock.
  for (const auto delay : std::initializer_list<std::uint16_t>{0, 1, 250, 65535}) {
    Bench bench(kEnable | kContinuous);
    bench.unit.write_delays(delay);
    bench.to(4000);
    bench.unit.write_rate(0, kKilohertz, bench.sink);
    const std::int64_t expected = 4000 + (25000 + delay + 1 + 2) * 40;
    EXPECT_EQ(bench.unit.next_event(), at(expected));
    bench.to(expected);
    ASSERT_EQ(bench.sink.edges.size(), 1U);
    EXPECT_EQ(bench.sink.edges[0], (Edge{expected, Signal::s0, true}));
    EXPECT_NEAR(static_cast<double>(expected - 4000), 999998 + (delay + 3) * 40, 40);
  }
}

TEST(StepDirectionUnit, StepsAtItsFormulasFrequency) {
  base::Random random(9);
  for (int i = 0; i < 100; ++i) {
    Bench bench(kEnable | kContinuous);
    bench.unit.watch({});
    const auto rate = static_cast<std::int32_t>(random.next() >> (33 + random.below(20)));
    bench.unit.write_rate(0, rate, bench.sink);
    bench.unit.advance(SimTime(base::SimDuration(120 + 1'000'000'000)), bench.sink);
    const std::int64_t expected = static_cast<std::int64_t>(
        std::uint64_t{25'000'000} * static_cast<std::uint64_t>(rate) >> 32);
    EXPECT_EQ(bench.unit.channel(0).count(), expected) << rate;
  }
}

TEST(StepDirectionUnit, FastestRateStepsEveryOtherClock) {
  Bench bench(kEnable | kContinuous);
  bench.unit.write_rate(0, INT32_MIN, bench.sink);
  bench.to(120 + 4 * 80);
  EXPECT_EQ(bench.sink.of(Signal::d0), (std::vector<Edge>{{0, Signal::d0, true}}));
  const std::vector<Edge> steps = bench.sink.of(Signal::s0);
  ASSERT_EQ(steps.size(), 7U);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    EXPECT_EQ(steps[i], (Edge{200 + 40 * static_cast<std::int64_t>(i), Signal::s0, i % 2 == 0}));
  }
  EXPECT_EQ(bench.unit.channel(0).count(), -4);
}

TEST(StepDirectionUnit, RateZeroStopsAndClearsTheAccumulator) {
  Bench bench(kEnable | kContinuous);
  bench.unit.write_rate(0, 1 << 28, bench.sink);  // a step in 16 clocks
  bench.to(120 + 15 * 40);
  bench.unit.write_rate(0, 0, bench.sink);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.to(100'000);
  EXPECT_EQ(bench.unit.channel(0).count(), 0);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  EXPECT_EQ(bench.unit.next_event(), at(100'000 + 120 + 16 * 40));
}

TEST(StepDirectionUnit, DirectionFollowsTheSignOfTheRateAtTheWrite) {
  Bench bench(kEnable | kContinuous);
  bench.unit.watch({Signal::d0, Signal::d0n});
  bench.unit.write_rate(0, -kKilohertz, bench.sink);
  bench.to(400);
  bench.unit.write_rate(0, 0, bench.sink);
  const std::vector<Edge> expected{{0, Signal::d0, true},
                                   {0, Signal::d0n, false},
                                   {400, Signal::d0, false},
                                   {400, Signal::d0n, true}};
  EXPECT_EQ(bench.sink.edges, expected);
}

TEST(StepDirectionUnit, ChangeOfDirectionWaitsTheDelayBeforeTheFirstStep) {
  Bench bench(kEnable | kContinuous);
  bench.unit.write_delays(100);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  bench.to(40'000);
  bench.sink.clear();
  bench.unit.write_rate(0, -(1 << 28), bench.sink);
  bench.to(80'000);
  EXPECT_EQ(bench.sink.edges[0], (Edge{40'000, Signal::d0, true}));
  EXPECT_EQ(bench.sink.of(Signal::s0)[0], (Edge{40'000 + (100 + 3 + 16) * 40, Signal::s0, true}));
}

TEST(StepDirectionUnit, TheSameRateWrittenAgainChangesNothing) {
  Bench bench(kEnable | kContinuous);
  bench.unit.watch({});
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  for (int i = 1; i <= 1000; ++i) {
    bench.to(i * 400);
    bench.unit.write_rate(0, 1 << 28, bench.sink);
  }
  EXPECT_EQ(bench.unit.channel(0).count(), (400'000 / 40 - 3) / 16);
}

TEST(StepDirectionUnit, KeepsTheAccumulatorAtANewRateIfToldTo) {
  Bench bench(kEnable | kContinuous);
  bench.unit.set_restart_on_new_rate(false);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  bench.to(120 + 8 * 40);  // half a step
  bench.unit.write_rate(0, 1 << 27, bench.sink);
  EXPECT_EQ(bench.unit.next_event(), at(120 + (8 + 16) * 40));
}

TEST(StepDirectionUnit, PolaritiesInvertTheOutputs) {
  Bench bench(kEnable | kContinuous | kStepPolarity | kDirectionPolarity);
  EXPECT_TRUE(bench.unit.level(Signal::s0));
  EXPECT_FALSE(bench.unit.level(Signal::s0n));
  EXPECT_TRUE(bench.unit.level(Signal::d0));
  bench.unit.write_rate(0, -(1 << 28), bench.sink);
  EXPECT_FALSE(bench.unit.level(Signal::d0));
  EXPECT_TRUE(bench.unit.level(Signal::d0n));
  bench.to(120 + 16 * 40);
  EXPECT_FALSE(bench.unit.level(Signal::s0));
  EXPECT_TRUE(bench.unit.level(Signal::s0n));
}

TEST(StepDirectionUnit, PulsesLastOneClockMoreThanTheirLength) {
  for (const auto length : std::initializer_list<std::uint16_t>{0, 24}) {
    Bench bench(kEnable | kContinuous);
    bench.unit.write_lengths(length);
    bench.unit.write_rate(0, kKilohertz, bench.sink);
    testing::run(bench.unit, at(3'000'000), bench.sink);
    const auto edges = bench.sink.of(Signal::s0);
    ASSERT_GE(edges.size(), 4U);
    EXPECT_EQ(edges[1].time - edges[0].time, length == 0 ? 40 : 1000);
    EXPECT_EQ(edges[2].time - edges[0].time, 1'000'000);
  }
}

TEST(StepDirectionUnit, PulsesAsLongAsTheirDistanceDisappear) {
  Bench bench(kEnable | kContinuous);
  bench.unit.write_lengths(15);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  testing::run(bench.unit, at(100'000), bench.sink);
  EXPECT_EQ(bench.sink.of(Signal::s0).size(), 1U);
  EXPECT_GT(bench.unit.channel(0).count(), 100);
}

TEST(StepDirectionUnit, FiniteModeMakesTheTargetsPulsesAndTellsTheLast) {
  Bench bench(kEnable);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.unit.write_target(0, 5);
  bench.to(120 + 3 * 16 * 40);
  EXPECT_EQ(bench.unit.channel(0).remaining(), 2U);
  bench.unit.write_target(0, 4);  // replaces what remains
  bench.to(1'000'000);
  EXPECT_EQ(bench.unit.channel(0).count(), 7);
  EXPECT_EQ(bench.unit.channel(0).remaining(), 0U);
  EXPECT_EQ(bench.sink.count(IrqSource::sd0_target_reached), 1U);
  EXPECT_EQ(bench.sink.first(IrqSource::sd0_target_reached), 120 + 7 * 16 * 40);
  EXPECT_EQ(bench.sink.of(Signal::s0).size(), 14U);
  bench.unit.write_target(0, 1);
  EXPECT_EQ(bench.unit.next_event(), at(1'000'000 + 120 + 16 * 40));
}

TEST(StepDirectionUnit, DisabledChannelMakesNoSteps) {
  Bench bench(kContinuous);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.unit.write_configuration(kContinuous | kEnable, bench.sink);
  bench.to(120 + 16 * 40);
  EXPECT_EQ(bench.unit.channel(0).count(), 1);
  bench.unit.write_configuration(kContinuous, bench.sink);
  bench.to(1'000'000);
  EXPECT_EQ(bench.unit.channel(0).count(), 1);
  EXPECT_EQ(bench.sink.of(Signal::s0).size(), 2U) << "a pulse that has begun ends in time";
}

TEST(StepDirectionUnit, CounterGoesBothWaysWrapsAndIsCleared) {
  Bench bench(kEnable | kContinuous);
  bench.unit.watch({});
  bench.unit.write_rate(0, -(1 << 28), bench.sink);
  bench.to(120 + 10 * 16 * 40);
  EXPECT_EQ(bench.unit.channel(0).count(), -10);
  bench.unit.write_configuration(kEnable | kContinuous | kClearCount, bench.sink);
  EXPECT_EQ(bench.unit.channel(0).count(), 0);
  EXPECT_EQ(bench.unit.channel(0).total_steps(), -10);
  // 2^31 steps forwards at 12.5 MHz take 171.8 s.
  bench.unit.write_rate(0, INT32_MAX, bench.sink);
  bench.unit.advance(SimTime(172_s), bench.sink);
  EXPECT_LT(bench.unit.channel(0).count(), 0);
  EXPECT_GT(bench.unit.channel(0).total_steps(), INT32_MAX);
}

TEST(StepDirectionUnit, CompareTellsAndTakesTheNextRateIfConfigured) {
  for (const bool use_next_rate : {false, true}) {
    Bench bench(kEnable | kContinuous | (use_next_rate ? kUseNextRate : 0));
    bench.unit.write_rate(0, 1 << 28, bench.sink);
    bench.unit.write_compare(0, 10);
    bench.unit.write_next_rate(0, -(1 << 27));
    bench.to(120 + 10 * 16 * 40);
    EXPECT_EQ(bench.sink.first(IrqSource::sd0_compare), 120 + 10 * 16 * 40);
    EXPECT_EQ(bench.unit.channel(0).rate(), use_next_rate ? -(1 << 27) : 1 << 28);
    EXPECT_EQ(bench.unit.level(Signal::d0), use_next_rate);
    bench.to(1'000'000);
    EXPECT_EQ(bench.sink.count(IrqSource::sd0_compare), 1U);
    EXPECT_EQ(bench.unit.channel(0).count() > 10, !use_next_rate);
  }
}

TEST(StepDirectionUnit, SimpleProfileRunsWithoutHost) {
  // Fast to step 100, slow for the rest of 120 steps: what the option is for.
  Bench bench(kEnable | kUseNextRate);
  bench.unit.watch({});
  bench.unit.listen(irq_bit(IrqSource::sd0_target_reached));
  bench.unit.write_target(0, 120);
  bench.unit.write_compare(0, 100);
  bench.unit.write_next_rate(0, 1 << 26);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  const std::int64_t end = (3 + 100 * 16 + 3 + 20 * 64) * 40;
  EXPECT_LE(testing::run(bench.unit, at(end + 1'000'000), bench.sink), 3U);
  EXPECT_EQ(bench.sink.first(IrqSource::sd0_target_reached), end);
  EXPECT_EQ(bench.unit.channel(0).count(), 120);
}

TEST(StepDirectionUnit, EmergencyFreezesOutputsAndCounters) {
  Bench bench(kEnable | kContinuous);
  bench.unit.write_lengths(7);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  bench.to(120 + (3 * 16 + 2) * 40);  // two clocks into a pulse
  bench.unit.set_emergency(true, bench.sink);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.to(1'000'000);
  EXPECT_TRUE(bench.unit.level(Signal::s0));
  EXPECT_EQ(bench.unit.channel(0).count(), 3);
  bench.unit.write_rate(0, 0, bench.sink);
  bench.unit.write_rate(0, 1 << 28, bench.sink);
  bench.unit.set_emergency(false, bench.sink);
  bench.sink.clear();
  bench.to(1'000'000 + 6 * 40);
  EXPECT_EQ(bench.sink.edges, (std::vector<Edge>{{1'000'000 + 6 * 40, Signal::s0, false}}));
  EXPECT_EQ(bench.unit.next_event(), at(1'000'000 + (3 + 16) * 40));
}

TEST(StepDirectionUnit, ChannelsAreIndependent) {
  RecordingSink sink;
  StepDirection unit;
  unit.write_configuration(0x030103, sink);  // channel 1 finite
  unit.write_lengths(std::uint64_t{2} << 32 | 1U << 16);
  unit.write_delays(std::uint64_t{20} << 32 | 10U << 16);
  unit.write_target(1, 3);
  unit.write_rate(0, 1 << 28, sink);
  unit.write_rate(1, -(1 << 28), sink);
  unit.write_rate(2, 1 << 27, sink);
  unit.advance(at(40 * (3 + 20 + 32 * 100)), sink);
  EXPECT_EQ(unit.channel(0).count(), (20 + 3200) / 16);
  EXPECT_EQ(unit.channel(1).count(), -3);
  EXPECT_EQ(unit.channel(2).count(), 100);
  EXPECT_EQ(unit.channel(2).length(), 2);
  EXPECT_EQ(sink.first(IrqSource::sd1_target_reached), 40 * (3 + 10 + 3 * 16));
  EXPECT_EQ(sink.count(IrqSource::sd0_target_reached), 0U);
}

TEST(StepDirectionUnit, UnwatchedChannelsCostNothing) {
  RecordingSink sink;
  StepDirection unit;
  unit.write_configuration(0x030303, sink);
  for (std::size_t i = 0; i < 3; ++i) {
    unit.write_rate(i, INT32_MAX, sink);
  }
  EXPECT_EQ(unit.next_event(), SimTime::never());
  EXPECT_EQ(testing::run(unit, SimTime(3600_s), sink), 0U);
  // 2^31 - 1 is just too slow for 12.5 MHz.
  const std::int64_t steps = unit.channel(0).total_steps();
  EXPECT_NEAR(static_cast<double>(steps), 3600 * 12.5e6, 30);
  // The counter has been all around ten times and met the compare value 0 each time.
  EXPECT_EQ(sink.count(IrqSource::sd0_compare), 10U);
}

TEST(StepDirectionUnit, ACopyGoesOnLikeItsOriginal) {
  Bench bench(kEnable | kContinuous);
  bench.unit.write_rate(0, 123'456'789, bench.sink);
  bench.to(777'777);
  StepDirection copy = bench.unit;
  RecordingSink other;
  bench.sink.clear();
  testing::run(bench.unit, at(2'000'000), bench.sink);
  testing::run(copy, at(2'000'000), other);
  EXPECT_EQ(bench.sink.edges, other.edges);
  EXPECT_FALSE(other.edges.empty());
}

}  // namespace
}  // namespace stator::mfc
