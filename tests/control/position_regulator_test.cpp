// The TMCM-142's PID position regulator against its difference equations (PID-001 to PID-012), bit
// by bit.
#include "stator/control/motion_controller/position_regulator.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;

constexpr base::SimDuration kUpdate = 8_us;

PositionRegulator with(RegulatorSettings settings) {
  settings.enabled = true;
  PositionRegulator regulator;
  regulator.configure(settings);
  return regulator;
}

/// The rules of PID-001..012 as difference equations, one update after the other.
struct RegulatorReference {
  RegulatorSettings settings;
  long long sum = 0;
  long long e_last = 0;
  long long d_part = 0;
  long long correction = 0;
  long long result = 0;
  int updates = 0;
  bool exact_hit = false;

  static long long clip(long long value, long long limit) {
    return std::max(-limit, std::min(limit, value));
  }
  /// +-2^31 as 32 bits hold it.
  static long long clip_to_register(long long value) {
    return std::max(-(1LL << 31), std::min((1LL << 31) - 1, value));
  }
  void update(long long e) {
    e = std::max(-8'388'608LL, std::min(8'388'607LL, e));
    if (e == 0) {
      exact_hit = true;
    }
    if (std::abs(e) >= static_cast<long long>(settings.tolerance)) {
      exact_hit = false;
    }
    if (exact_hit) {
      e = 0;
      sum = 0;
    }
    sum = clip(sum + e, settings.integral_clip * 65'536LL);
    const int divider = settings.d_divider == 0 ? 256 : settings.d_divider;
    if (updates++ % divider == 0) {
      d_part = clip(e_last - e, 127) * settings.d;
      e_last = e;
    }
    const long long p_part = clip_to_register(e * settings.p / 256);
    const long long i_part = clip_to_register((sum / 256) * settings.i / 256);
    result = clip(-p_part - i_part + clip_to_register(d_part), settings.velocity_clip);
    correction += result;
  }
};

RegulatorSettings random_settings(base::Random& random) {
  const auto factor = [&] {
    return static_cast<std::uint32_t>(random.below(1ULL << random.below(25)));
  };
  return {.tolerance = static_cast<std::uint32_t>(random.below(20)),
          .p = factor(),
          .i = factor(),
          .d = factor(),
          .integral_clip = static_cast<std::uint16_t>(random.below(32'641)),
          .d_divider = static_cast<std::uint8_t>(random.below(256)),
          .velocity_clip = static_cast<std::uint32_t>(random.below(1ULL << 31)),
          .enabled = true};
}

TEST(PositionRegulator, MatchesItsDifferenceEquationsBitByBit) {
  base::Random random(125'000);
  for (int run = 0; run < 400; ++run) {
    const RegulatorSettings settings = random_settings(random);
    PositionRegulator regulator = with(settings);
    RegulatorReference reference{.settings = settings};
    std::int64_t e = static_cast<std::int64_t>(random.below(2'000)) - 1'000;
    for (int i = 0; i < 1'000; ++i) {
      const std::int64_t span = std::int64_t{1} << random.below(run % 3 == 0 ? 20 : 6);
      e += static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(2 * span + 1))) - span;
      e = random.below(10) == 0 ? 0 : e;
      regulator.advance(static_cast<std::int32_t>(e), kUpdate);
      reference.update(e);
      ASSERT_EQ(regulator.result(), reference.result) << run << " " << i;
      ASSERT_EQ(regulator.sum(), reference.sum) << run << " " << i;
      ASSERT_EQ(regulator.correction(), reference.correction) << run << " " << i;
    }
  }
}

TEST(PositionRegulator, ABlockIsItsUpdatesWithTheErrorGoingInAStraightLine) {
  base::Random random(8);
  for (int run = 0; run < 2'000; ++run) {
    const RegulatorSettings settings = random_settings(random);
    PositionRegulator blocks = with(settings);
    PositionRegulator updates = with(settings);
    std::int32_t e = 0;
    for (int block = 0; block < 20; ++block) {
      // 13 updates; every third block keeps the error, many of them at 0.
      const std::int32_t slope =
          block % 3 == 0 ? 0 : static_cast<std::int32_t>(random.below(41)) - 20;
      const std::int32_t next = random.below(4) == 0 ? 0 : e + 13 * slope;
      if ((next - e) % 13 != 0) {
        continue;
      }
      for (int k = 1; k <= 13; ++k) {
        updates.advance(e + (next - e) / 13 * k, kUpdate);
      }
      e = next;
      blocks.advance(e, kUpdate * 13);
      ASSERT_EQ(blocks.correction(), updates.correction()) << "run " << run << " block " << block;
      ASSERT_EQ(blocks.sum(), updates.sum());
      ASSERT_EQ(blocks.result(), updates.result());
    }
  }
}

TEST(PositionRegulator, ErrorsInBetweenAreRoundedToTheNearest) {
  PositionRegulator regulator = with({.p = 256, .velocity_clip = 1'000});
  regulator.advance(1, kUpdate * 9);  // 1/9, 2/9 ... from 5/9 on the error is 1
  EXPECT_EQ(regulator.correction(), -5);
}

TEST(PositionRegulator, ZeroErrorIsTheSameInBlocksOfAnyLength) {
  for (const std::uint8_t divider : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{7}}) {
    const RegulatorSettings settings{
        .i = 3'000, .d = 5, .integral_clip = 100, .d_divider = divider, .velocity_clip = 1U << 30U};
    PositionRegulator blocks = with(settings);
    PositionRegulator updates = with(settings);
    for (const std::int32_t e : {40'000, 40'000, 0, 0}) {
      for (int k = 0; k < 300; ++k) {
        blocks.advance(e, kUpdate);
        updates.advance(e, kUpdate);
      }
    }
    for (int block = 0; block < 50; ++block) {
      blocks.advance(0, kUpdate * 12);
      for (int k = 0; k < 12; ++k) {
        updates.advance(0, kUpdate);
      }
      ASSERT_EQ(blocks.correction(), updates.correction());
    }
    blocks.advance(100, kUpdate);  // and the D part keeps its beat
    updates.advance(100, kUpdate);
    EXPECT_EQ(blocks.result(), updates.result()) << int{divider};
  }
}

TEST(PositionRegulator, PartsAreThoseComputedByHand) {
  constexpr std::uint32_t kWide = 0x7FFF'FFFF;
  PositionRegulator p = with({.p = 384, .velocity_clip = kWide});
  p.advance(-1'001, kUpdate);
  EXPECT_EQ(p.result(), 1'501);  // 1001 * 384 / 256 = 1501.5
  PositionRegulator i = with({.i = 512, .integral_clip = 1, .velocity_clip = kWide});
  for (int k = 0; k < 10; ++k) {
    i.advance(1'000, kUpdate);
  }
  EXPECT_EQ(i.sum(), 10'000);
  EXPECT_EQ(i.result(), -78);  // (10000 / 256 = 39) * 512 / 256
  for (int k = 0; k < 100; ++k) {
    i.advance(1'000, kUpdate);
  }
  EXPECT_EQ(i.sum(), 65'536) << "clipped to pid_iclip * 65536";
  EXPECT_EQ(i.result(), -512);
  i.clear_sum();
  EXPECT_EQ(i.sum(), 0);
  PositionRegulator d = with({.d = 1'000, .d_divider = 4, .velocity_clip = kWide});
  const int results[] = {-10'000,  -10'000,  -10'000,  -10'000, -127'000,
                         -127'000, -127'000, -127'000, 0};
  for (int k = 0; k < 9; ++k) {
    d.advance(k < 1 ? 10 : 500, kUpdate);
    EXPECT_EQ(d.result(), results[k]) << "update " << k;
  }
}

TEST(PositionRegulator, ResultAndErrorAreClipped) {
  PositionRegulator regulator = with({.p = 16'777'215, .velocity_clip = 12'345});
  regulator.advance(2'000'000'000, kUpdate);
  EXPECT_EQ(regulator.error(), 8'388'607);
  EXPECT_EQ(regulator.result(), -12'345);
  regulator.advance(-2'000'000'000, kUpdate);
  EXPECT_EQ(regulator.error(), -8'388'608);
  EXPECT_EQ(regulator.result(), 12'345);
  PositionRegulator silent = with({.p = 256});
  silent.advance(100, kUpdate);
  EXPECT_EQ(silent.result(), 0) << "AP 37 = 0 lets nothing through";
}

TEST(PositionRegulator, ToleranceActsFromAnExactHitOn) {
  PositionRegulator regulator =
      with({.tolerance = 5, .p = 256, .i = 1, .integral_clip = 100, .velocity_clip = 1U << 30U});
  regulator.advance(3, kUpdate);
  EXPECT_EQ(regulator.result(), -3) << "no hit yet";
  regulator.advance(0, kUpdate);
  EXPECT_EQ(regulator.sum(), 0);
  regulator.advance(4, kUpdate);
  EXPECT_EQ(regulator.result(), 0);
  EXPECT_EQ(regulator.error(), 4) << "AP 38 shows the error itself";
  regulator.advance(5, kUpdate);
  EXPECT_EQ(regulator.result(), -5) << "the zone is left";
  regulator.advance(4, kUpdate);
  EXPECT_EQ(regulator.result(), -4) << "until the next hit";
}

TEST(PositionRegulator, DDividerZeroIs256) {
  PositionRegulator regulator = with({.d = 1, .velocity_clip = 1'000});
  regulator.advance(0, kUpdate);
  for (int k = 1; k < 256; ++k) {
    regulator.advance(20, kUpdate);
    ASSERT_EQ(regulator.result(), 0) << k;
  }
  regulator.advance(20, kUpdate);
  EXPECT_EQ(regulator.result(), -20);
}

TEST(PositionRegulator, SwitchedOffItMovesNothing) {
  PositionRegulator regulator =
      with({.p = 256, .i = 1, .integral_clip = 1, .velocity_clip = 1'000});
  regulator.advance(100, kUpdate);
  EXPECT_EQ(regulator.result(), -100);
  regulator.configure({.p = 256, .velocity_clip = 1'000, .enabled = false});
  EXPECT_EQ(regulator.result(), 0);
  EXPECT_EQ(regulator.sum(), 0);
  regulator.advance(100, 1_ms);
  EXPECT_EQ(regulator.correction(), -100);
  EXPECT_EQ(regulator.error(), 100);
}

TEST(PositionRegulator, PeriodsNeedNotBeMultiplesOfItsOwn) {
  PositionRegulator regulator = with({.p = 256, .velocity_clip = 1'000});
  regulator.advance(100, 1_ns);
  for (int k = 0; k < 8; ++k) {
    regulator.advance(100, 50_us);
  }
  EXPECT_EQ(regulator.correction(), -100 * 50) << "400 us";
}

}  // namespace
}  // namespace stator::control::motion_controller
