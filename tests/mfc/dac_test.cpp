// The bit stream of the DAC unit: density, edges, and the mean value behind a filter.
#include "stator/mfc/units/dac.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using base::SimTime;
using testing::at;
using testing::RecordingSink;

constexpr std::int64_t kPeriod = 65536;  // ticks of 10 ns: 655.36 us

TEST(DacUnit, EveryNumberComesOnceInAPeriod) {
  std::vector<bool> seen(kPeriod);
  for (std::int64_t tick = 0; tick < kPeriod; ++tick) {
    const std::uint16_t number = Dac::number(tick);
    EXPECT_FALSE(seen[number]);
    seen[number] = true;
    EXPECT_EQ(number, Dac::number(tick + kPeriod));
  }
}

TEST(DacUnit, IsHighForItsShareOfAPeriod) {
  for (const unsigned share : {0U, 1U, 0x1234U, 0x8000U, 0xFFFFU}) {
    const auto value = static_cast<std::uint16_t>(share);
    RecordingSink sink;
    Dac unit;
    unit.write_value(value, sink);
    std::int64_t high = 0;
    for (std::int64_t tick = 0; tick < kPeriod; ++tick) {
      unit.advance(at(tick * 10), sink);
      high += unit.level() ? 1 : 0;
    }
    EXPECT_EQ(high, value);
    EXPECT_DOUBLE_EQ(unit.mean(), static_cast<double>(high) / kPeriod);
  }
}

TEST(DacUnit, WatchedEdgesAreThoseOfTheNumbers) {
  base::Random random(3);
  for (int i = 0; i < 20; ++i) {
    RecordingSink sink;
    Dac unit;
    unit.watch({Signal::dac0});
    std::size_t edges = 0;
    bool level = false;
    std::int64_t tick = 0;
    for (int n = 0; n < 10; ++n) {
      const auto value = static_cast<std::uint16_t>(random.next());
      unit.write_value(value, sink);
      edges += level != unit.level() ? 1 : 0;
      level = Dac::number(tick) < value;
      const auto ticks = static_cast<std::int64_t>(random.below(300));
      for (std::int64_t last = tick + ticks; tick < last;) {
        ++tick;
        edges += (Dac::number(tick) < value) != level ? 1 : 0;
        level = Dac::number(tick) < value;
      }
      testing::run(unit, at(tick * 10 + 5), sink);
      EXPECT_EQ(unit.level(), level);
      EXPECT_EQ(sink.edges.size(), edges);
      EXPECT_TRUE(sink.edges.empty() || sink.edges.back().level == level);
    }
  }
}

TEST(DacUnit, AnRcFilterOfOneMillisecondMakesItsMeanValue) {
  // The document's filter: 10 kOhm, 100 nF. It keeps within a hundredth of the full scale.
  RecordingSink sink;
  Dac unit;
  unit.write_value(0x8000, sink);
  double voltage = 0.5;
  for (std::int64_t tick = 0; tick < 2 * kPeriod; ++tick) {
    unit.advance(at(tick * 10), sink);
    voltage += ((unit.level() ? 1.0 : 0.0) - voltage) * 1e-5;
    EXPECT_LT(std::abs(voltage - 0.5), 1e-2);
  }
}

TEST(DacUnit, CostsNothingUnlessWatched) {
  RecordingSink sink;
  Dac unit;
  unit.write_value(0x8000, sink);
  EXPECT_EQ(testing::run(unit, SimTime(1_s), sink), 0U);
  EXPECT_TRUE(sink.edges.empty());
  unit.watch({Signal::dac0});
  EXPECT_LT(unit.next_event(), SimTime(1_s) + base::SimDuration(1000));
  unit.write_value(0, sink);
  EXPECT_EQ(unit.next_event(), SimTime::never());
}

}  // namespace
}  // namespace stator::mfc
