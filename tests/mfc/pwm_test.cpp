// The PWM unit's edges: alignment, chopper modes, pauses, polarities, pulses, emergency.
#include "stator/mfc/units/pwm.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/csv_file.hpp"
#include "mfc/pwm_registers.hpp"
#include "mfc/recording_sink.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using base::SimTime;
using testing::at;
using testing::Edge;
using testing::PwmConfiguration;
using testing::RecordingSink;

struct Bench {
  RecordingSink sink;
  Pwm unit;

  explicit Bench(const PwmConfiguration& configuration, std::uint16_t duty = 0) {
    unit.write_configuration(configuration.value(), sink);
    for (std::size_t i = 0; i < Pwm::kChannels; ++i) {
      unit.write_duty(i, duty, sink);
    }
  }
  void run(std::int64_t to) { testing::run(unit, at(to), sink); }
};

constexpr std::uint8_t kComplementary = 7;

TEST(PwmUnit, PeriodIsTenNanosecondsPerCount) {
  EXPECT_EQ(Bench({.maxcnt = 4095}).unit.period().nanoseconds(), 40'960);
  EXPECT_EQ(Bench({.maxcnt = 999}).unit.period().nanoseconds(), 10'000);
  Bench bench({.maxcnt = 999});
  bench.unit.listen(irq_bit(IrqSource::pwm_zero_pulse));
  bench.run(35'000);
  EXPECT_EQ(bench.sink.count(IrqSource::pwm_zero_pulse), 3U);
  EXPECT_EQ(bench.sink.first(IrqSource::pwm_zero_pulse), 10'000);
  EXPECT_EQ(bench.unit.counter(), 500);
}

TEST(PwmUnit, AlignmentPlacesTheOnTime) {
  struct Case {
    std::uint8_t alignment;
    std::int64_t on, off;
  };
  // 100 counts, 30 of them on.
  for (const Case& expected :
       {Case{0, 1000, 1300}, Case{1, 1350, 1650}, Case{2, 1700, 2000}, Case{3, 1350, 1650}}) {
    Bench bench({.maxcnt = 99, .modes = {6, 6, 6, 6}, .alignment = expected.alignment}, 30);
    bench.run(995);
    bench.unit.watch({Signal::hs2});
    bench.run(2000);
    std::vector<Edge> edges = bench.sink.edges;
    if (!edges.front().level) {
      edges.erase(edges.begin());  // the end of the on time before
    }
    ASSERT_GE(edges.size(), 2U);
    EXPECT_EQ(edges[0], (Edge{expected.on, Signal::hs2, true})) << int{expected.alignment};
    EXPECT_EQ(edges[1], (Edge{expected.off, Signal::hs2, false})) << int{expected.alignment};
  }
}

TEST(PwmUnit, ChopperModesAreThoseOfTheTable) {
  for (const auto& row : testing::document_table("pwm_modes.csv")) {
    PwmConfiguration configuration{.maxcnt = 99, .alignment = 0};
    configuration.modes[1] = static_cast<std::uint8_t>(std::stoi(row.at("code")));
    Bench bench(configuration, 30);
    for (const bool on : {true, false}) {
      bench.run(on ? 1100 : 1500);
      const auto expected = [&](const std::string& text) {
        return text == "on" || (text == "pwm" && on) || (text == "not pwm" && !on);
      };
      EXPECT_EQ(bench.unit.level(Signal::hs1), expected(row.at("high_side"))) << row.at("function");
      EXPECT_EQ(bench.unit.level(Signal::ls1), expected(row.at("low_side"))) << row.at("function");
    }
  }
}

TEST(PwmUnit, EachChannelHasItsDuty) {
  Bench bench({.maxcnt = 99, .modes = {6, 6, 6, 6}});
  for (std::size_t i = 0; i < 4; ++i) {
    bench.unit.write_duty(i, static_cast<std::uint16_t>(10 * i), bench.sink);
    EXPECT_DOUBLE_EQ(bench.unit.on_share(i).high_side, 0.1 * static_cast<double>(i));
  }
  bench.run(1150);
  EXPECT_FALSE(bench.unit.level(Signal::hs0));
  EXPECT_FALSE(bench.unit.level(Signal::hs1));
  EXPECT_TRUE(bench.unit.level(Signal::hs2));
  EXPECT_TRUE(bench.unit.level(Signal::hs3));
}

TEST(PwmUnit, DutyOfZeroIsOffAndAboveMaxcntOn) {
  Bench off({.maxcnt = 99, .modes = {kComplementary}, .bbm_low = 5, .bbm_high = 5}, 0);
  Bench on({.maxcnt = 99, .modes = {kComplementary}, .bbm_low = 5, .bbm_high = 5}, 100);
  off.unit.watch({Signal::hs0, Signal::ls0});
  on.unit.watch({Signal::hs0, Signal::ls0});
  off.run(10'000);
  on.run(10'000);
  EXPECT_TRUE(on.unit.level(Signal::hs0));
  EXPECT_TRUE(off.unit.level(Signal::ls0));
  EXPECT_LE(on.sink.edges.size(), 2U);
  EXPECT_EQ(off.sink.edges.size(), 0U);
  EXPECT_EQ(on.unit.next_event(), SimTime::never());
}

TEST(PwmUnit, PausesDelayTheSwitchThatComesOn) {
  Bench bench({.maxcnt = 99, .modes = {kComplementary}, .bbm_low = 7, .bbm_high = 12}, 40);
  bench.run(1995);
  bench.unit.watch({Signal::hs0, Signal::ls0});
  bench.run(2995);
  const std::vector<Edge> expected{{2000, Signal::ls0, false},
                                   {2120, Signal::hs0, true},
                                   {2400, Signal::hs0, false},
                                   {2470, Signal::ls0, true}};
  EXPECT_EQ(bench.sink.edges, expected);
  EXPECT_DOUBLE_EQ(bench.unit.on_share(0).high_side, 0.28);
  EXPECT_DOUBLE_EQ(bench.unit.on_share(0).low_side, 0.53);
}

TEST(PwmUnit, PausesHoldAcrossAChangeOfMode) {
  PwmConfiguration configuration{.maxcnt = 99, .modes = {2}, .bbm_low = 20, .bbm_high = 20};
  Bench bench(configuration);
  bench.unit.watch({Signal::hs0, Signal::ls0});
  bench.run(5000);
  configuration.modes[0] = 1;
  bench.unit.write_configuration(configuration.value(), bench.sink);
  bench.run(10'000);
  const std::vector<Edge> expected{{5000, Signal::hs0, false}, {5200, Signal::ls0, true}};
  EXPECT_EQ(bench.sink.edges, expected);
}

TEST(PwmUnit, PolaritiesInvertEachKindOfOutput) {
  const std::vector<std::pair<unsigned, Signal>> bits{
      {40, Signal::ls0},     {41, Signal::hs0},     {42, Signal::pulse_ab}, {43, Signal::pulse_b},
      {44, Signal::pulse_c}, {45, Signal::pulse_a}, {46, Signal::pulse_z}};
  for (const auto& [bit, inverted] : bits) {
    Bench bench({.maxcnt = 99, .polarities = static_cast<std::uint8_t>(1U << (bit - 40))});
    for (const auto& [other, signal] : bits) {
      EXPECT_EQ(bench.unit.level(signal), signal == inverted) << bit << ' ' << other;
    }
  }
}

TEST(PwmUnit, PulsesComeAtTheirPositionsForTheirLength) {
  Bench bench({.maxcnt = 99});
  bench.unit.write_marks(20 | 70 << 16, bench.sink);
  bench.unit.write_pulse_length(5, bench.sink);
  bench.run(995);
  bench.unit.watch(
      {Signal::pulse_z, Signal::pulse_c, Signal::pulse_a, Signal::pulse_b, Signal::pulse_ab});
  bench.run(1995);
  const std::vector<Edge> expected{{1000, Signal::pulse_z, true},  {1050, Signal::pulse_z, false},
                                   {1200, Signal::pulse_a, true},  {1200, Signal::pulse_ab, true},
                                   {1250, Signal::pulse_a, false}, {1250, Signal::pulse_ab, false},
                                   {1490, Signal::pulse_c, true},  {1540, Signal::pulse_c, false},
                                   {1700, Signal::pulse_b, true},  {1700, Signal::pulse_ab, true},
                                   {1750, Signal::pulse_b, false}, {1750, Signal::pulse_ab, false}};
  EXPECT_EQ(bench.sink.edges, expected);
}

TEST(PwmUnit, PositionBeyondTheCounterNeverComes) {
  Bench bench({.maxcnt = 99});
  bench.unit.write_marks(100 | 99 << 16, bench.sink);
  bench.unit.write_pulse_length(5, bench.sink);
  bench.unit.watch({Signal::pulse_a});
  bench.unit.listen(irq_bit(IrqSource::pwm_a_pulse) | irq_bit(IrqSource::pwm_b_pulse));
  bench.run(10'000);
  EXPECT_TRUE(bench.sink.edges.empty());
  EXPECT_EQ(bench.sink.count(IrqSource::pwm_a_pulse), 0U);
  EXPECT_EQ(bench.sink.count(IrqSource::pwm_b_pulse), 10U);
}

TEST(PwmUnit, ShiftMovesEdgesAndKeepsTheDuty) {
  Bench bench({.maxcnt = 99, .modes = {6, 6}, .alignment = 1}, 30);
  bench.unit.write_shift(1, 20, bench.sink);
  bench.run(995);
  bench.unit.watch({Signal::hs0, Signal::hs1});
  bench.run(2000);
  const std::vector<Edge> expected{{1350, Signal::hs0, true},
                                   {1550, Signal::hs1, true},
                                   {1650, Signal::hs0, false},
                                   {1850, Signal::hs1, false}};
  EXPECT_EQ(bench.sink.edges, expected);
  EXPECT_DOUBLE_EQ(bench.unit.on_share(1).high_side, bench.unit.on_share(0).high_side);
}

TEST(PwmUnit, EmergencySwitchesGatesOffWithTheirPolarity) {
  Bench bench({.maxcnt = 99, .modes = {2, 1, 6, kComplementary}, .polarities = 3}, 50);
  bench.unit.write_pulse_length(3, bench.sink);
  bench.run(1010);
  EXPECT_FALSE(bench.unit.level(Signal::hs0));
  bench.unit.watch({Signal::hs0, Signal::ls1, Signal::hs2, Signal::pulse_z});
  bench.unit.set_emergency(true, bench.sink);
  EXPECT_EQ(bench.sink.edges,
            (std::vector<Edge>{
                {1010, Signal::hs0, true}, {1010, Signal::ls1, true}, {1010, Signal::hs2, true}}));
  bench.sink.clear();
  bench.run(2995);
  EXPECT_EQ(bench.sink.of(Signal::pulse_z).size(), bench.sink.edges.size());
  EXPECT_GT(bench.sink.edges.size(), 0U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(bench.unit.level(offset(Signal::hs0, 2 * i)));
    EXPECT_TRUE(bench.unit.level(offset(Signal::ls0, 2 * i)));
    EXPECT_EQ(bench.unit.on_share(i).high_side, 0.0);
  }
  bench.unit.set_emergency(false, bench.sink);
  EXPECT_FALSE(bench.unit.level(Signal::hs0));
}

TEST(PwmUnit, CostsNothingUnlessWatchedOrListenedTo) {
  Bench bench({.maxcnt = 999, .modes = {7, 7, 7, 7}, .bbm_low = 10, .bbm_high = 10}, 500);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  EXPECT_EQ(testing::run(bench.unit, SimTime(1_s), bench.sink), 0U);
  // The flags of all four marks are set all the same.
  EXPECT_EQ(bench.sink.interrupts.size(), 4U);
  EXPECT_EQ(bench.sink.first(IrqSource::pwm_center_pulse), 4990);
  EXPECT_TRUE(bench.sink.edges.empty());
}

TEST(PwmUnit, CounterWithoutAPeriodStands) {
  Bench bench({.maxcnt = 0, .modes = {2, 6, 7, 5}}, 1);
  bench.unit.listen(0xF000);
  bench.unit.watch({Signal::hs0, Signal::pulse_z});
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.run(1'000'000);
  EXPECT_TRUE(bench.sink.interrupts.empty());
  EXPECT_TRUE(bench.unit.level(Signal::hs0));
}

TEST(PwmUnit, NewPeriodKeepsTheCounterIfItFits) {
  Bench bench({.maxcnt = 99});
  bench.run(800);
  bench.unit.write_configuration(PwmConfiguration{.maxcnt = 199}.value(), bench.sink);
  EXPECT_EQ(bench.unit.counter(), 80);
  bench.unit.write_configuration(PwmConfiguration{.maxcnt = 49}.value(), bench.sink);
  EXPECT_EQ(bench.unit.counter(), 0);
}

}  // namespace
}  // namespace stator::mfc
