// Errors of angle that offset, amplitude, phase and harmonics of a sine/cosine sensor cause.
#include "stator/plant/sensors/analog_position_sensor.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

constexpr std::int64_t kPolePairs = 4;

/// The largest error of the angle, rad of the scale, that a reader of a sine/cosine encoder makes
/// who believes in its nominal tracks.
double largest_error(const AnalogSensorParameters& parameters) {
  const AnalogPositionSensor sensor(parameters, kPolePairs);
  base::Random random(1);
  double worst = 0.0;
  for (int n = 0; n < 3600; ++n) {
    const double shaft = n * base::kTwoPi / 3600.0;
    const double electrical = shaft * kPolePairs;
    const auto whole = static_cast<std::int64_t>(electrical / base::kTwoPi);
    const auto raw =
        sensor.read({whole + 8, electrical - static_cast<double>(whole) * base::kTwoPi}, random);
    const double seen = std::atan2(raw[1] - 32'768.0, raw[0] - 32'768.0);
    worst = std::max(worst, std::fabs(std::remainder(
                                seen - shaft * parameters.periods_per_revolution, base::kTwoPi)));
  }
  return worst;
}

constexpr double kDegree = base::kPi / 180.0;

TEST(AnalogPositionSensor, SineAndCosineTellTheAngleToTheirResolution) {
  EXPECT_LT(largest_error(sine_cosine_encoder(1)), 5e-5);
  EXPECT_LT(largest_error(sine_cosine_encoder(64)), 5e-5);
}

TEST(AnalogPositionSensor, OnePercentOfOffsetMakesHalfADegree) {
  AnalogSensorParameters parameters = sine_cosine_encoder(1);
  parameters.track[0].offset += 200.0;
  EXPECT_NEAR(largest_error(parameters), 0.573 * kDegree, 0.01 * kDegree);
}

TEST(AnalogPositionSensor, OnePercentOfAmplitudeMakesAQuarterOfADegree) {
  AnalogSensorParameters parameters = sine_cosine_encoder(1);
  parameters.track[1].amplitude *= 1.01;
  EXPECT_NEAR(largest_error(parameters), 0.286 * kDegree, 0.01 * kDegree);
}

TEST(AnalogPositionSensor, APhaseErrorShowsInFull) {
  AnalogSensorParameters parameters = sine_cosine_encoder(1);
  parameters.track[1].phase += 2.0 * kDegree;
  EXPECT_NEAR(largest_error(parameters), 2.0 * kDegree, 0.05 * kDegree);
}

TEST(AnalogPositionSensor, HarmonicsShowAsTheirShare) {
  AnalogSensorParameters parameters = sine_cosine_encoder(1);
  parameters.track[0].third_harmonic = 0.01;
  // The sine of a third harmonic in quadrature to the first's: cos(3y) sin(y) at its largest, 0.77.
  EXPECT_GT(largest_error(parameters), 0.005);
  EXPECT_LT(largest_error(parameters), 0.01);
}

TEST(AnalogPositionSensor, AnalogHallsAreAThirdOfAPeriodApart) {
  const AnalogPositionSensor sensor(analog_halls(kPolePairs), kPolePairs);
  base::Random random(1);
  const auto raw = sensor.read({3, 0.5}, random);
  for (int k = 0; k < 3; ++k) {
    const double expected = 32'768.0 + 20'000.0 * std::cos(0.5 - (k == 0   ? 0.0
                                                                  : k == 1 ? 1.0
                                                                           : -1.0) *
                                                                     base::kTwoPi / 3.0);
    EXPECT_NEAR(raw[static_cast<std::size_t>(k)], expected, 0.51) << k;
  }
}

TEST(AnalogPositionSensor, AnAmplitudeBeyondTheConverterIsClipped) {
  AnalogSensorParameters parameters = sine_cosine_encoder(1);
  parameters.track[0].amplitude = 40'000.0;
  const AnalogPositionSensor sensor(parameters, kPolePairs);
  base::Random random(1);
  EXPECT_EQ(sensor.read({0, 0.0}, random)[0], 65'535);
  EXPECT_EQ(sensor.read({2, 0.0}, random)[0], 0);
}

}  // namespace
}  // namespace stator::plant
