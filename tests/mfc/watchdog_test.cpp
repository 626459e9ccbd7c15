#include "stator/mfc/units/watchdog.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using base::SimTime;
using testing::at;
using testing::RecordingSink;

// WD_CFG.
constexpr std::uint8_t kPersistent = 1U << 0;
constexpr std::uint8_t kPdiSelect = 1U << 1;
constexpr std::uint8_t kMfcSelect = 1U << 2;
constexpr std::uint8_t kStartOfFrame = 1U << 3;
constexpr std::uint8_t kInputEdge = 1U << 4;

struct Bench {
  RecordingSink sink;
  Watchdog unit;

  explicit Bench(unsigned configuration, std::uint32_t time = 1000) {
    unit.write_configuration(static_cast<std::uint8_t>(configuration));
    unit.write_time(time);
  }
  void to(std::int64_t nanoseconds) { unit.advance(at(nanoseconds), sink); }
  [[nodiscard]] bool active() const { return unit.action().active; }
};

constexpr std::int64_t kTime = 40'000;  // 1000 ticks

TEST(MfcWatchdog, ExpiresAfterItsTime) {
  for (const auto& [time, expiry] :
       {std::pair{2'500'000U, std::int64_t{100'000'000}}, {0xFFFFFFFFU, 171'798'691'800}}) {
    Bench bench(0, time);
    EXPECT_EQ(bench.unit.next_event(), at(expiry));
    bench.to(expiry - 1);
    EXPECT_FALSE(bench.active());
    bench.to(expiry);
    EXPECT_TRUE(bench.active());
    EXPECT_EQ(bench.sink.first(IrqSource::mfc_watchdog_timeout), expiry);
    EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  }
}

TEST(MfcWatchdog, TimeZeroSwitchesItOff) {
  Bench bench(kStartOfFrame, 0);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.to(1'000'000'000);
  bench.unit.trigger(WatchdogTrigger::start_of_frame);
  EXPECT_FALSE(bench.active());
  EXPECT_EQ(bench.unit.peak(), 0U);
}

TEST(MfcWatchdog, EachEnabledSourceRetriggers) {
  for (const unsigned enabled : {0U, unsigned{kPdiSelect}, unsigned{kMfcSelect},
                                 unsigned{kStartOfFrame}, unsigned{kPdiSelect | kStartOfFrame}}) {
    for (const auto& [trigger, bit] : {std::pair{WatchdogTrigger::pdi_select, kPdiSelect},
                                       {WatchdogTrigger::mfc_select, kMfcSelect},
                                       {WatchdogTrigger::start_of_frame, kStartOfFrame}}) {
      Bench bench(enabled);
      bench.to(30'000);
      bench.unit.trigger(trigger);
      EXPECT_EQ(bench.unit.next_event(), at((enabled & bit) != 0 ? 30'000 + kTime : kTime));
    }
  }
}

TEST(MfcWatchdog, InputConditionRetriggersOnTheChosenEdge) {
  for (const bool becoming_true : {false, true}) {
    Bench bench(becoming_true ? kInputEdge : 0U);
    bench.unit.write_inputs(std::uint64_t{0x800003} << 32 | 0x800001);
    bench.to(10'000);
    bench.unit.set_lines(0x800000);  // line 0 still wrong
    EXPECT_EQ(bench.unit.next_event(), at(kTime));
    bench.unit.set_lines(0x800001 | 0x000F00);  // all as required, others do not matter
    EXPECT_EQ(bench.unit.next_event(), at(becoming_true ? 10'000 + kTime : kTime));
    bench.to(20'000);
    bench.unit.set_lines(0x800001);
    EXPECT_EQ(bench.unit.next_event(), at(becoming_true ? 10'000 + kTime : kTime));
    bench.unit.set_lines(0x800003);
    EXPECT_EQ(bench.unit.next_event(), at(becoming_true ? 10'000 + kTime : 20'000 + kTime));
  }
}

TEST(MfcWatchdog, EveryLineHasItsBits) {
  for (unsigned line = 0; line < 24; ++line) {
    Bench bench(kInputEdge);
    bench.unit.write_inputs(std::uint64_t{1} << (32 + line) | std::uint64_t{1} << line);
    bench.unit.write_outputs(std::uint64_t{1} << (32 + line) | std::uint64_t{1} << line);
    bench.to(10'000);
    bench.unit.set_lines(1U << line);
    EXPECT_EQ(bench.unit.next_event(), at(10'000 + kTime));
    bench.to(1'000'000);
    EXPECT_EQ(bench.unit.action().lines, 1U << line);
    EXPECT_EQ(bench.unit.action().levels, 1U << line);
  }
}

TEST(MfcWatchdog, EmptyMaskNeverRetriggers) {
  for (const unsigned edge : {0U, unsigned{kInputEdge}}) {
    Bench bench(edge);
    bench.unit.write_inputs(0x00FFFFFF);
    bench.to(10'000);
    bench.unit.set_lines(0x00FFFFFF);
    bench.unit.set_lines(0);
    EXPECT_EQ(bench.unit.next_event(), at(kTime));
  }
}

TEST(MfcWatchdog, ActionSaysLevelsAndEnablesOfTheMaskedLines) {
  Bench bench(0);
  bench.unit.write_outputs(0xFF00'0F00'FF00'0500);
  bench.unit.write_output_enables(0xFF000300);
  EXPECT_EQ(bench.unit.action(), WatchdogAction{});
  bench.to(kTime);
  EXPECT_EQ(
      bench.unit.action(),
      (WatchdogAction{.active = true, .lines = 0x000F00, .levels = 0x000500, .enables = 0x300}));
}

TEST(MfcWatchdog, ActionEndsAtTheNextTriggerUnlessPersistent) {
  for (const bool persistent : {false, true}) {
    Bench bench(kStartOfFrame | (persistent ? kPersistent : 0U));
    bench.to(kTime + 10'000);
    EXPECT_EQ(bench.unit.configuration() & 0x80, 0x80);
    bench.unit.trigger(WatchdogTrigger::start_of_frame);
    EXPECT_EQ(bench.active(), persistent);
    EXPECT_EQ(bench.unit.next_event(), persistent ? SimTime::never() : at(kTime + 10'000 + kTime));
    bench.unit.write_time(1000);
    EXPECT_FALSE(bench.active());
    EXPECT_EQ(bench.unit.configuration() & 0x80, 0);
  }
}

TEST(MfcWatchdog, StatusBitIsNotWritten) {
  Bench bench(0x9F);
  EXPECT_EQ(bench.unit.configuration(), 0x1F);
}

TEST(MfcWatchdog, PeakIsTheLongestTimeBetweenTriggers) {
  base::Random random(5);
  Bench bench(kStartOfFrame);
  std::int64_t tick = 0;
  std::int64_t longest = 0;
  for (int i = 0; i < 100; ++i) {
    const auto pause = static_cast<std::int64_t>(random.below(900));
    longest = std::max(longest, pause);
    tick += pause;
    bench.to(tick * 40);
    EXPECT_EQ(bench.unit.peak(), static_cast<std::uint32_t>(longest));
    bench.unit.trigger(WatchdogTrigger::start_of_frame);
  }
  bench.to((tick + 5000) * 40);
  EXPECT_EQ(bench.unit.peak(), 1000U) << "the counter stops at WD_TIME";
  bench.unit.write_time(500);
  EXPECT_EQ(bench.unit.peak(), 0U);
}

TEST(MfcWatchdog, RetriggeringCostsNoEventsUntilItExpires) {
  Bench bench(kStartOfFrame);
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_EQ(testing::run(bench.unit, at(i * 30'000), bench.sink), 0U);
    bench.unit.trigger(WatchdogTrigger::start_of_frame);
  }
  EXPECT_EQ(testing::run(bench.unit, at(2'000'000'000), bench.sink), 1U);
}

}  // namespace
}  // namespace stator::mfc
