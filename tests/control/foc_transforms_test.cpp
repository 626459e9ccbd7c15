// Sine, arc tangent, Clarke, Park and voltage circle of the TMC8670 in fixed point, within stated
// errors.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/foc/circular_limiter.hpp"
#include "stator/control/foc/transforms.hpp"

namespace stator::control::foc {
namespace {

double radian(int angle) {
  return angle * (2.0 * M_PI / 65536.0);
}

std::int32_t random_s16(base::Random& random, std::int32_t limit = 32767) {
  return static_cast<std::int32_t>(random.below(2U * static_cast<unsigned>(limit) + 1U)) - limit;
}

TEST(FocSine, IsWithinHalfAStepOfQ15AtEveryAngle) {
  double worst = 0.0;
  for (int angle = 0; angle < 65536; ++angle) {
    const SineCosine found = sine_cosine(static_cast<std::uint16_t>(angle));
    EXPECT_NEAR(found.sine, std::sin(radian(angle)) * 0x1p30, 2.0) << angle;
    EXPECT_NEAR(found.cosine, std::cos(radian(angle)) * 0x1p30, 2.0) << angle;
    const double q15 = static_cast<double>(rounded_shift(found.sine, 15));
    worst = std::max(worst, std::fabs(q15 - std::sin(radian(angle)) * 32768.0));
  }
  EXPECT_LE(worst, 0.5001);
}

TEST(FocArcTangent, IsWithinSixTenthsOfAStep) {
  base::Random random(1);
  for (int k = 0; k < 100'000; ++k) {
    const std::int32_t limit = k % 2 == 0 ? 32767 : 262'140;
    const std::int32_t x = random_s16(random, limit), y = random_s16(random, limit);
    if (std::abs(x) + std::abs(y) < 100) {
      continue;
    }
    const double exact = std::atan2(y, x) / (2.0 * M_PI) * 65536.0;
    const double error = std::remainder(arc_tangent(y, x) - exact, 65536.0);
    EXPECT_LE(std::fabs(error), 0.6) << y << ' ' << x;
  }
  EXPECT_EQ(arc_tangent(0, 0), 0);
  EXPECT_EQ(arc_tangent(7232, 7232), 8192);
  EXPECT_EQ(arc_tangent(0, -5), 32768);
  EXPECT_EQ(arc_tangent(-5, 0), 49152);
}

TEST(FocTransforms, GiveTheDocumentsExamples) {
  struct Row {
    std::int32_t u, v;
    int degrees;
    std::int32_t a, b, d, q;
  };
  for (const Row& row :
       {Row{1000, -500, 0, 1000, 0, 1000, 0}, Row{1000, -500, 90, 1000, 0, 0, -1000},
        Row{0, 866, 0, 0, 1000, 0, 1000}, Row{0, 866, 90, 0, 1000, 1000, 0}}) {
    const StatorVector stator = clarke(row.u, row.v);
    EXPECT_EQ(stator.a, row.a);
    EXPECT_EQ(stator.b, row.b);
    const RotorVector rotor =
        park(stator, sine_cosine(static_cast<std::uint16_t>(row.degrees * 65536 / 360)));
    EXPECT_EQ(rotor.d, row.d);
    EXPECT_EQ(rotor.q, row.q);
  }
}

TEST(FocTransforms, AreWithinHalfAStepOfTheExactOnes) {
  base::Random random(2);
  for (int k = 0; k < 200'000; ++k) {
    const std::int32_t x = random_s16(random, 23169), y = random_s16(random, 23169);
    const auto angle = static_cast<std::uint16_t>(random.next());
    const SineCosine direction = sine_cosine(angle);
    const double c = std::cos(radian(angle)), s = std::sin(radian(angle));
    const RotorVector rotor = park({x, y}, direction);
    EXPECT_NEAR(rotor.d, c * x + s * y, 0.5001);
    EXPECT_NEAR(rotor.q, c * y - s * x, 0.5001);
    const StatorVector stator = inverse_park({x, y}, direction);
    EXPECT_NEAR(stator.a, c * x - s * y, 0.5001);
    EXPECT_NEAR(stator.b, s * x + c * y, 0.5001);
    const PhaseVector phase = inverse_clarke({x, y});
    EXPECT_EQ(phase.u + phase.v + phase.w, 0);
    EXPECT_NEAR(phase.v, -0.5 * x + std::sqrt(0.75) * y, 0.5001);
    EXPECT_NEAR(phase.w, -0.5 * x - std::sqrt(0.75) * y, 0.5001);
    const std::int32_t u = x / 2, v = y / 2;
    EXPECT_NEAR(clarke(u, v).b, (u + 2.0 * v) / std::sqrt(3.0), 0.5001);
  }
}

TEST(FocTransforms, ThereAndBackMoveNoAngleByMoreThanAStep) {
  for (const std::int32_t amplitude : {1, 100, 5'000, 20'000, 32'767}) {
    for (int angle = 0; angle < 65536; ++angle) {
      const SineCosine direction = sine_cosine(static_cast<std::uint16_t>(angle));
      const RotorVector back = park(inverse_park({amplitude, 0}, direction), direction);
      ASSERT_LE(std::abs(back.d - amplitude), 1) << angle;
      ASSERT_LE(std::abs(back.q), 1) << angle;
      const StatorVector stator = inverse_park({0, amplitude}, direction);
      const PhaseVector phase = inverse_clarke(stator);
      const StatorVector again = clarke(phase.u, phase.v);
      ASSERT_EQ(again.a, stator.a);
      ASSERT_LE(std::abs(again.b - stator.b), 1) << angle;
    }
  }
}

TEST(FocTransforms, SaturateInsteadOfWrapping) {
  const SineCosine eighth = sine_cosine(8192);
  EXPECT_EQ(park({32767, 32767}, eighth).d, 32767);
  EXPECT_EQ(park({-32768, 32767}, eighth).q, 32767);
  EXPECT_EQ(inverse_park({32767, 32767}, eighth).b, 32767);
  EXPECT_EQ(clarke(-32768, -32768).b, -32768);
}

TEST(FocCircularLimiter, GivesTheDocumentsExamples) {
  struct Row {
    std::int32_t d, q, d_out, q_out;
  };
  for (const Row& row : {Row{0, 30000, 0, 23169}, Row{20000, 20000, 20000, 11696},
                         Row{-30000, 100, -23169, 0}, Row{1000, -15000, 1000, -15000}}) {
    const LimitedVoltage limited = limit_circle({row.d, row.q}, 23169);
    EXPECT_EQ(limited.voltage.d, row.d_out);
    EXPECT_EQ(limited.voltage.q, row.q_out);
    EXPECT_EQ(limited.d_limited, row.d != row.d_out);
    EXPECT_EQ(limited.q_limited, row.q != row.q_out);
  }
}

TEST(FocCircularLimiter, NeverLeavesTheCircleAndLeavesTheRestAlone) {
  base::Random random(3);
  for (int k = 0; k < 100'000; ++k) {
    const RotorVector u{random_s16(random), random_s16(random)};
    const auto limit = static_cast<std::int32_t>(random.below(65536));
    const LimitedVoltage result = limit_circle(u, limit);
    const double length = std::hypot(result.voltage.d, result.voltage.q);
    EXPECT_LE(length, limit);
    EXPECT_EQ(result.voltage.d, std::clamp(u.d, -limit, limit));
    if (std::hypot(u.d, u.q) <= limit) {
      EXPECT_EQ(result.voltage.q, u.q);
    } else if (result.q_limited) {
      const double room =
          std::sqrt(1.0 * limit * limit - 1.0 * result.voltage.d * result.voltage.d);
      EXPECT_LE(room - std::abs(result.voltage.q), 1.0);
    }
  }
}

TEST(FocFixedPoint, SquareRootIsTheLargestThatFits) {
  base::Random random(4);
  for (int k = 0; k < 100'000; ++k) {
    const auto value = static_cast<std::uint32_t>(random.next() >> (32 + k % 32));
    const std::uint64_t root = static_cast<std::uint64_t>(square_root(value));
    EXPECT_LE(root * root, value);
    EXPECT_GT((root + 1) * (root + 1), value);
  }
}

}  // namespace
}  // namespace stator::control::foc
