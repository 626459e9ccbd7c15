// A stepper driver with the registers of the TMC262: step/direction, coil currents by SPI, load and
// shorts.
#include <gtest/gtest.h>

#include "board/bench.hpp"

namespace stator::board {
namespace {

constexpr Line kStepLine = 8;
constexpr Line kDirLine = 9;

// DRVCONF with RDSEL 0..2, CHOPCONF on, SGCSCONF at full current.
constexpr std::uint64_t kShowPosition = 0xE0000;
constexpr std::uint64_t kShowStallGuard = 0xEF010;  // of the chip's document
constexpr std::uint64_t kShowBoth = 0xE0020;
constexpr std::uint64_t kBySpi = 0xE0080;
constexpr std::uint64_t kChopperOn = 0x901B4;
constexpr std::uint64_t kFullCurrent = 0xD001F;

PeripheralConfiguration driver(std::initializer_list<std::pair<const char*, double>> numbers = {}) {
  return part("drv", kSpiStepperDriver,
              {{"sck", kSckLine},
               {"mosi", kMosiLine},
               {"miso", kMisoLine},
               {"cs", kCsLine},
               {"step", kStepLine},
               {"dir", kDirLine}},
              numbers);
}

void make_steps(Bench& bench, int steps, base::SimDuration period) {
  for (int k = 0; k < steps; ++k) {
    bench.set(kStepLine, true);
    bench.set(kStepLine, false);
    bench.wait(period);
  }
}

TEST(SpiStepperDriver, HasNoCurrentUntilItsChopperIsSwitchedOn) {
  Bench bench({driver()});
  bench.spi(kFullCurrent, 20);
  bench.wait(10_ms);
  EXPECT_EQ(bench.signal("drv.current_a"), 0.0);
  bench.spi(kChopperOn, 20);
  bench.wait(20_ms);
  EXPECT_NEAR(bench.signal("drv.current_a"), 0.310 / 0.075, 0.05);
}

TEST(SpiStepperDriver, AnswersWithTheStateAtTheBeginOfTheDatagram) {
  Bench bench({driver()});
  bench.spi(kShowPosition, 20);
  bench.spi(kChopperOn, 20);
  bench.spi(kFullCurrent, 20);
  make_steps(bench, 300, 1_ms);
  EXPECT_EQ(bench.spi(kShowStallGuard, 20) >> 10U, 300U);
  // The read-out chosen holds from the next datagram on; 0 while the motor stands.
  bench.wait(100_ms);
  const std::uint64_t stands = bench.spi(kShowBoth, 20);
  EXPECT_EQ(stands >> 10U, 0U);
  EXPECT_EQ(stands & 0xFFU, 0x81U);  // STST, SG
  EXPECT_EQ(bench.spi(kShowPosition, 20) >> 10U, 0x1FU) << "StallGuard 9:5 and current scale";
}

TEST(SpiStepperDriver, MovesByStepAndDirectionInItsResolution) {
  Bench bench({driver()});
  for (const std::uint64_t datagram : {kShowPosition, kChopperOn, kFullCurrent}) {
    bench.spi(datagram, 20);
  }
  bench.spi(0x00004, 20);  // 16 microsteps
  make_steps(bench, 800, 500_us);
  bench.wait(200_ms);
  EXPECT_NEAR(bench.signal("drv.position"), 0.25, 0.0005);
  bench.set(kDirLine, true);
  bench.spi(0x00104, 20);  // both edges
  make_steps(bench, 400, 500_us);
  bench.wait(200_ms);
  EXPECT_NEAR(bench.signal("drv.position"), 0.0, 0.0005);
}

TEST(SpiStepperDriver, TakesCoilCurrentsBySpi) {
  Bench bench({driver({{"load_friction", 0.05}})});
  for (const std::uint64_t datagram : {kBySpi, kChopperOn, kFullCurrent}) {
    bench.spi(datagram, 20);
  }
  // Full steps: (+,0), (0,+), (-,0), (0,-).
  const std::array<std::uint64_t, 4> kWave{248ULL << 9U, 248, 1ULL << 17U | 248ULL << 9U,
                                           1ULL << 8U | 248};
  for (int k = 0; k <= 40; ++k) {
    bench.spi(kWave[static_cast<std::size_t>(k % 4)], 20);
    bench.wait(40_ms);
  }
  EXPECT_NEAR(bench.signal("drv.position"), 40.0 / 200.0, 0.001);
}

TEST(SpiStepperDriver, MeasuresLoadAndReportsAStall) {
  Bench bench({driver({{"load_friction", 0.03}, {"supply_voltage", 48}})});
  for (const std::uint64_t datagram : {kShowStallGuard, kChopperOn, kFullCurrent}) {
    bench.spi(datagram, 20);
  }
  bench.spi(0x00004, 20);
  // Gently up to 24,000 steps of 1/16 per second, 7.4 revolutions per second.
  for (int k = 1; k <= 240; ++k) {
    make_steps(bench, k, base::SimDuration(10'000'000 / k));
  }
  const std::uint64_t free = bench.spi(kShowStallGuard, 20);
  EXPECT_GT(free >> 10U, 200U);
  EXPECT_EQ(free & 0x81U, 0U) << "it neither stands nor stalls";
  for (const double torque : {-0.1, -0.2, -0.3}) {
    bench.input("drv.load_torque", torque);
    make_steps(bench, 2000, 42_us);
  }
  const std::uint64_t loaded = bench.spi(kShowStallGuard, 20) >> 10U;
  EXPECT_LT(loaded, (free >> 10U) / 2U);
  EXPECT_GT(loaded, 0U);
  bench.input("drv.load_torque", -2.0);
  make_steps(bench, 3000, 42_us);
  EXPECT_EQ(bench.spi(kShowStallGuard, 20) & 0x01U, 1U);
}

TEST(SpiStepperDriver, ReportsShortsUntilItIsSwitchedOff) {
  Bench bench({driver()});
  for (const std::uint64_t datagram : {kShowPosition, kChopperOn, kFullCurrent}) {
    bench.spi(datagram, 20);
  }
  bench.wait(10_ms);
  bench.input("drv.short_a", 1.0);
  bench.wait(10_ms);
  EXPECT_EQ(bench.spi(kShowPosition, 20) & 0x18U, 0x08U);
  bench.input("drv.short_a", 0.0);
  bench.wait(10_ms);
  EXPECT_EQ(bench.spi(kShowPosition, 20) & 0x18U, 0x08U) << "it stays off";
  EXPECT_EQ(bench.signal("drv.current_a"), 0.0);
  bench.spi(0x901B0, 20);  // TOFF 0
  bench.wait(1_ms);
  bench.spi(kChopperOn, 20);
  bench.wait(20_ms);
  EXPECT_EQ(bench.spi(kShowPosition, 20) & 0x18U, 0x00U);
  EXPECT_GT(bench.signal("drv.current_a"), 4.0);
}

TEST(SpiStepperDriver, IgnoresShortDatagramsAndHandsLongOnesOn) {
  Bench bench({driver()});
  bench.spi(kChopperOn, 20);
  bench.spi(kFullCurrent >> 1U, 19);
  bench.wait(10_ms);
  EXPECT_NEAR(bench.signal("drv.current_a"), 0.310 / 32 / 0.075, 0.01) << "still current scale 0";
  const std::uint64_t out = bench.spi(0xABCDE'0000F | kFullCurrent, 40);
  EXPECT_EQ(out & 0xFFFFFU, 0xABCDEU);
}

}  // namespace
}  // namespace stator::board
