// What a logic analyser shows of the chip's outputs, against the formulae of its document.

#include <cmath>

#include <gtest/gtest.h>

#include "board/chip.hpp"
#include "board/vcd_file.hpp"

namespace stator::board {
namespace {

using namespace mfc::register_number;
using mfc::Signal;

constexpr double kClock = 40.0;  // ns of 25 MHz

/// A chip with its lines 0.. traced.
struct Traced {
  Collector collector;
  LogicTrace trace;
  Chip chip;

  Traced(std::initializer_list<std::pair<unsigned, Signal>> connections,
         std::vector<PeripheralConfiguration> parts = {}, const DecodedLines& decoded = {})
      : trace(lines_of(connections), decoded, 4096, collector.sink()),
        chip(connections, std::move(parts), &trace) {}
  [[nodiscard]] VcdFile vcd() { return VcdFile(vcd_text(trace, collector)); }

 private:
  static std::uint32_t lines_of(std::initializer_list<std::pair<unsigned, Signal>> connections) {
    std::uint32_t lines = 0;
    for (const auto& connection : connections) {
      lines |= 1U << connection.first;
    }
    return lines;
  }
};

// L9602-L9690: a step every 2^32/|c| clocks, the first SD_DELAY + 3 clocks later; pulses of
// SD_STEPLENGTH + 1 clocks.
TEST(PinTiming, OfStepPulsesIsTheirFormulasToOneClock) {
  struct Case {
    std::int32_t rate;
    unsigned delay;
    unsigned length;
  };
  for (const Case& its : {Case{171799, 0, 24}, Case{8'589'935, 7, 0}, Case{-8'589'935, 100, 99},
                          Case{123'456'789, 3, 10}, Case{1 << 30, 0, 0}}) {
    Traced traced({{0, Signal::s0}, {1, Signal::d0}});
    Chip& chip = traced.chip;
    chip.set(kSdSteplength, its.length);
    chip.set(kSdDelay, its.delay);
    chip.set(kSdCfg, 3);  // enabled, continuous
    chip.wait(1_ms);
    const std::int64_t written = chip.board->time().nanoseconds();
    chip.set(kSdCh0Steprate, static_cast<std::uint32_t>(its.rate));
    chip.wait(20_ms);
    const VcdFile vcd = traced.vcd();
    const double period = std::ldexp(1.0, 32) / std::abs(its.rate) * kClock;
    const std::vector<std::int64_t> rises = vcd.edges("MFCIO00", true);
    const std::vector<std::int64_t> falls = vcd.edges("MFCIO00", false);
    // A change of direction lets the first pulse wait for the delay too.
    const double offset = (its.delay + 3.0) * kClock;
    const auto expected = static_cast<std::size_t>((20e6 - offset) / period);
    ASSERT_NEAR(static_cast<double>(rises.size()), static_cast<double>(expected), 1.0) << its.rate;
    for (std::size_t k = 0; k < rises.size(); ++k) {
      const double at = static_cast<double>(rises[k] - written);
      ASSERT_NEAR(at, offset + period * static_cast<double>(k + 1), kClock)
          << its.rate << " step " << k;
      if (k < falls.size()) {
        ASSERT_EQ(falls[k] - rises[k], (its.length + 1) * 40) << its.rate << " step " << k;
      }
    }
    EXPECT_EQ(vcd.before("MFCIO01", 1LL << 60), its.rate < 0);
  }
}

// L9780-L9829, A-57: period 10 ns (1 + MAXCNT); break before make in 10 ns.
TEST(PinTiming, OfPwmIsItsFormulasToOneClock) {
  Traced traced({{0, Signal::hs0}, {1, Signal::ls0}, {2, Signal::hs3}, {3, Signal::ls3}});
  Chip& chip = traced.chip;
  constexpr std::uint64_t kBreakLow = 30;
  constexpr std::uint64_t kBreakHigh = 50;
  chip.set(kPwmCfg, 999U | 7U << 16U | 6U << 28U | kBreakLow << 48U | kBreakHigh << 56U);
  chip.set(kPwm1, 400);
  chip.set(kPwm4, 123);
  chip.wait(1_ms);
  const VcdFile vcd = traced.vcd();
  const auto high_on = vcd.edges("MFCIO00", true);
  const auto high_off = vcd.edges("MFCIO00", false);
  const auto low_on = vcd.edges("MFCIO01", true);
  const auto low_off = vcd.edges("MFCIO01", false);
  ASSERT_GE(high_on.size(), 98U);
  std::size_t off = 0;
  std::size_t low = 0;
  std::size_t low_end = 0;
  for (std::size_t k = 2; k + 2 < high_on.size(); ++k) {
    EXPECT_EQ(high_on[k] - high_on[k - 1], 10'000);
    while (high_off[off] <= high_on[k]) {
      ++off;
    }
    while (low_on[low] <= high_off[off]) {
      ++low;
    }
    while (low_off[low_end] <= low_on[low]) {
      ++low_end;
    }
    // The duty is what the high side is asked for; it comes late by its break.
    EXPECT_NEAR(static_cast<double>(high_off[off] - high_on[k]), 4'000.0 - 500.0, 10.0);
    EXPECT_NEAR(static_cast<double>(low_on[low] - high_off[off]), 300.0, 10.0);
    EXPECT_NEAR(static_cast<double>(low_off[low_end] - low_on[low]), 6'000.0 - 300.0, 10.0);
    EXPECT_NEAR(static_cast<double>(high_on[k + 1] - low_off[low_end]), 500.0, 10.0);
  }
  // Channel 3 chops its high side only.
  const auto chopped_on = vcd.edges("MFCIO02", true);
  const auto chopped_off = vcd.edges("MFCIO02", false);
  ASSERT_GE(chopped_on.size(), 98U);
  for (std::size_t k = 2; k < 90; ++k) {
    EXPECT_EQ(chopped_on[k] - chopped_on[k - 1], 10'000);
    const std::size_t end = chopped_off[k] > chopped_on[k] ? k : k + 1;
    EXPECT_NEAR(static_cast<double>(chopped_off[end] - chopped_on[k]), 1'230.0, 10.0);
  }
  EXPECT_TRUE(vcd.edges("MFCIO03", true).empty());
}

// L9124-L9130: SCK period (4 + 2 SPI_TIME) 40 ns, half of it from CS to the first edge and from the
// last edge to CS.
TEST(PinTiming, OfSpiIsItsFormulasInEveryMode) {
  for (const unsigned mode : {0U, 1U, 2U, 3U}) {
    for (const unsigned time : {0U, 2U, 17U}) {
      Traced traced({{0, Signal::sck}, {1, Signal::sdo}, {3, Signal::cs0}});
      Chip& chip = traced.chip;
      const bool polarity = mode >= 2;
      const bool phase = mode % 2 == 1;
      chip.set(kSpiTime, time);
      chip.set(kSpiLength, 19);
      chip.set(kSpiConf, (phase ? 0x20U : 0U) | (polarity ? 0x40U : 0U));
      chip.wait(10_us);
      constexpr std::uint64_t kSent = 0xEF010;
      chip.set(kSpiTxData, kSent);
      chip.wait(100_us);
      const VcdFile vcd = traced.vcd();
      const std::int64_t half = (2 + time) * 40;
      const auto select = vcd.edges("MFCIO03", false);
      const auto deselect = vcd.edges("MFCIO03", true);
      ASSERT_GE(select.size(), 1U);
      const std::int64_t begin = select.back();
      std::uint64_t seen = 0;
      std::int64_t edge = 0;
      for (const VcdFile::Change& change : vcd.of("MFCIO00")) {
        if (change.time <= begin) {
          continue;
        }
        ++edge;
        EXPECT_EQ(change.time - begin, edge * half) << "mode " << mode << " edge " << edge;
        // Data is taken at the first edge of each period with phase 0, at the second with phase 1.
        if ((edge % 2 == 1) != phase) {
          seen = seen << 1U | (vcd.before("MFCIO01", change.time) ? 1U : 0U);
        }
      }
      EXPECT_EQ(edge, 40) << "mode " << mode;
      EXPECT_EQ(seen, kSent) << "mode " << mode << " time " << time;
      EXPECT_EQ(deselect.back() - begin, 41 * half);
    }
  }
}

// L6742-L6753, A-47: a bit lasts I2C_TIMEBASE us.
TEST(PinTiming, OfI2cIsItsBitTime) {
  for (const unsigned timebase : {3U, 10U}) {
    Traced traced({{kSclLine, Signal::scl}, {kSdaLine, Signal::sda}},
                  {part("eeprom", kI2cEeprom, {{"scl", kSclLine}, {"sda", kSdaLine}})},
                  {.i2c_scl = kSclLine, .i2c_sda = kSdaLine});
    Chip& chip = traced.chip;
    const base::SimDuration command(timebase * 12'000);
    chip.set(kI2cTimebase, timebase);
    chip.wait(1_ms);
    const auto run = [&](std::uint64_t what) {
      chip.set(kI2cControl, what);
      chip.wait(command);
    };
    run(0x20);
    chip.set(kI2cAddress, 0xA0);
    run(0x08);
    chip.set(kI2cDataW, 0x12);
    run(0x04);
    chip.set(kI2cDataW, 0x34);
    run(0x04);
    run(0x20);
    chip.set(kI2cAddress, 0xA1);
    run(0x08);
    run(0x02);
    run(0x01);
    run(0x10);
    EXPECT_EQ(chip.get(kI2cDataR) & 0xFFU, 0xFFU) << "what an empty memory holds";
    const VcdFile vcd = traced.vcd();
    std::string words;
    for (const VcdFile::Change& change : vcd.of("i2c")) {
      words += change.value + ' ';
    }
    EXPECT_EQ(words, "start A0+ack 12+ack 34+ack start A1+ack FF+ack FF+nack stop ");
    // Within a byte SCL has the bit time as its period, half of it low.
    const auto rises = vcd.edges("MFCIO04", true);
    std::size_t within = 0;
    for (std::size_t k = 1; k < rises.size(); ++k) {
      if (rises[k] - rises[k - 1] == timebase * 1'000) {
        ++within;
      }
    }
    EXPECT_EQ(within, 6U * 8U) << "eight periods in each of six bytes";
    // SDA moves while SCL is low, but for the three conditions.
    std::size_t conditions = 0;
    for (std::size_t k = 1; k < vcd.of("MFCIO05").size(); ++k) {
      const std::int64_t time = vcd.of("MFCIO05")[k].time;
      // A slave answers at the falling edge of SCL itself.
      const bool high = vcd.before("MFCIO04", time) && vcd.before("MFCIO04", time + 1);
      conditions += high ? 1U : 0U;
    }
    EXPECT_EQ(conditions, 3U);
  }
}

}  // namespace
}  // namespace stator::board
