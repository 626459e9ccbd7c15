// Fixed-point angle, sine, Clarke, Park, voltage circle and space-vector modulation of the servo
// controller.
#include "stator/control/servo/space_vector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/control/servo/electrical_angle.hpp"

namespace stator::control {
namespace {

TEST(ElectricalAngle, ObjectsShowTheUpperHalfInTwosComplement) {
  EXPECT_EQ(angle_of_turns(0.25).object_value(), 16384);
  EXPECT_EQ(angle_of_turns(0.5).object_value(), -32768);
  EXPECT_EQ(angle_of_turns(-0.25).object_value(), -16384);
  EXPECT_EQ(angle_of_turns(3.75).object_value(), -16384);
  EXPECT_EQ(ElectricalAngle::of_object(-16384), angle_of_turns(-0.25));
}

TEST(ElectricalAngle, SixSixthsAreOneTurnWithinTwoUnits) {
  EXPECT_NEAR(static_cast<std::int32_t>(6U * kSixthTurn.value), 0, 3);
  EXPECT_NEAR(static_cast<std::int32_t>(12U * kTwelfthTurn.value), 0, 6);
}

TEST(SineTable, IsWithin31e8OfTheReferenceAtAllAngles) {
  double worst = 0.0;
  for (std::uint32_t n = 0; n < 65536 * 8; ++n) {
    const ElectricalAngle angle{n << 13};
    const double x = static_cast<double>(angle.value) * (base::kTwoPi / 4294967296.0);
    const base::SineCosine result = sine_cosine(angle);
    worst = std::max(
        {worst, std::fabs(result.sine - std::sin(x)), std::fabs(result.cosine - std::cos(x))});
  }
  EXPECT_LT(worst, 3.1e-7);
}

TEST(SineTable, HasTheExactValuesAtTheQuarters) {
  EXPECT_EQ(sine_cosine({0}).sine, 0.0);
  EXPECT_EQ(sine_cosine({0}).cosine, 1.0);
  EXPECT_EQ(sine_cosine(angle_of_turns(0.25)).sine, 1.0);
  EXPECT_EQ(sine_cosine(angle_of_turns(0.5)).cosine, -1.0);
  EXPECT_EQ(sine_cosine(angle_of_turns(0.75)).sine, -1.0);
}

TEST(ClarkePark, ASymmetricalSystemBecomesItsAmplitudeOnTheQAxis) {
  for (int n = 0; n < 360; ++n) {
    const double x = n * M_PI / 180.0;
    const std::array<double, 3> phase = {-3.0 * std::sin(x), -3.0 * std::sin(x - 2.0 * M_PI / 3.0),
                                         -3.0 * std::sin(x + 2.0 * M_PI / 3.0)};
    const RotorVector v = park(clarke(phase), sine_cosine(angle_of_turns(n / 360.0)));
    ASSERT_NEAR(v.d, 0.0, 2e-6) << n;
    ASSERT_NEAR(v.q, 3.0, 2e-6) << n;
  }
}

TEST(ClarkePark, AnOffsetOfAllPhasesDropsOut) {
  const StatorVector v = clarke({1.0 + 0.7, -0.5 + 0.7, -0.5 + 0.7});
  EXPECT_NEAR(v.alpha, 1.0, 1e-15);
  EXPECT_NEAR(v.beta, 0.0, 1e-15);
}

TEST(ClarkePark, ThereAndBackChangesNothing) {
  for (std::uint32_t n = 0; n < 65536; ++n) {
    const base::SineCosine angle = sine_cosine({n << 16});
    for (const double amplitude : {0.001, 0.1, 1.0, 10.0, 90.0}) {
      const RotorVector v{0.6 * amplitude, -0.8 * amplitude};
      const std::array<double, 3> phase = inverse_clarke(inverse_park(v, angle));
      ASSERT_NEAR(phase[0] + phase[1] + phase[2], 0.0, 1e-15 * amplitude * 4.0);
      const RotorVector back = park(clarke(phase), angle);
      ASSERT_NEAR(back.d, v.d, amplitude * 1e-6) << n;
      ASSERT_NEAR(back.q, v.q, amplitude * 1e-6) << n;
    }
  }
}

TEST(CircularLimiter, LeavesVectorsWithinTheCircleAlone) {
  RotorVector v{3.0, -3.9};
  EXPECT_FALSE(limit_circle(v, 5.0));
  EXPECT_EQ(v.q, -3.9);
}

TEST(CircularLimiter, TakesFromQWhatDLeaves) {
  RotorVector v{-3.0, -40.0};
  EXPECT_TRUE(limit_circle(v, 5.0));
  EXPECT_EQ(v.d, -3.0);
  EXPECT_DOUBLE_EQ(v.q, -4.0);
  RotorVector all_d{5.0, 1.0};
  EXPECT_TRUE(limit_circle(all_d, 5.0));
  EXPECT_EQ(all_d.q, 0.0);
}

TEST(SpaceVectorModulation, LineVoltagesAreThoseWantedUpToTheCircle) {
  constexpr double kSupply = 24.0;
  constexpr double kStep = kSupply / 4096.0;  // of the timer; each duty is off by half of it
  for (int n = 0; n < 3600; ++n) {
    for (const double share : {0.01, 0.5, 0.9, 1.0}) {
      const double amplitude = share * kSupply / std::sqrt(3.0);
      const double x = n * M_PI / 1800.0;
      const StatorVector v{amplitude * std::cos(x), amplitude * std::sin(x)};
      const std::array<double, 3> duty = space_vector_duties(v, 1.0 / kSupply);
      const std::array<double, 3> phase = inverse_clarke(v);
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_GE(duty[k], 0.0);
        ASSERT_LE(duty[k], 1.0);
        ASSERT_EQ(duty[k] * 4096.0, std::floor(duty[k] * 4096.0));
        const std::size_t next = (k + 1) % 3;
        ASSERT_NEAR((duty[k] - duty[next]) * kSupply, phase[k] - phase[next], 1.0001 * kStep);
      }
    }
  }
}

TEST(SpaceVectorModulation, LargestAndSmallestDutyAreCentred) {
  for (int n = 0; n < 360; ++n) {
    const double x = n * M_PI / 180.0;
    const std::array<double, 3> duty =
        space_vector_duties({9.0 * std::cos(x), 9.0 * std::sin(x)}, 1.0 / 24.0);
    const auto [low, high] = std::minmax_element(duty.begin(), duty.end());
    ASSERT_NEAR(*low + *high, 1.0, 1.0 / 4096.0) << n;
  }
}

}  // namespace
}  // namespace stator::control
