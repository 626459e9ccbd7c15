// Raw values of a current converter: gain, offset, range, bits, drift, delay, noise.
#include "stator/plant/sensors/current_converter.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

constexpr double kPeriod = 20e-6;

ConverterSample sample(const ConverterParameters& parameters, double first, double second,
                       double voltage = 24.0, double temperature = 25.0) {
  const CurrentConverter converter(parameters);
  ConverterState state{.earlier = {first, second}};
  base::Random random(1);
  return converter.sample(state, {first, second}, voltage, temperature, kPeriod, random);
}

TEST(CurrentConverter, RawValueIsGainTimesCurrentPlusOffset) {
  ConverterParameters parameters;
  parameters.currents[1] = {.gain = -990.0, .offset = 32'700.0};
  const ConverterSample raw = sample(parameters, 1.2344, 2.0);
  EXPECT_EQ(raw.currents[0], 34'002);
  EXPECT_EQ(raw.currents[1], 30'720);
  EXPECT_EQ(raw.voltage, 24'000);
}

TEST(CurrentConverter, ValuesBeyondItsRangeStandAtTheEnds) {
  EXPECT_EQ(sample({}, 40.0, -40.0).currents[0], 65'535);
  EXPECT_EQ(sample({}, 40.0, -40.0).currents[1], 0);
}

TEST(CurrentConverter, FewerBitsLeaveTheLowerOnesZero) {
  ConverterParameters parameters;
  parameters.bits = 12;
  const ConverterSample raw = sample(parameters, 0.0239, 40.0);
  EXPECT_EQ(raw.currents[0], 32'784);
  EXPECT_EQ(raw.currents[1], 65'520);
}

TEST(CurrentConverter, OffsetDriftsWithTemperature) {
  ConverterParameters parameters;
  parameters.currents[0].drift = 2.5;
  EXPECT_EQ(sample(parameters, 0.0, 0.0, 24.0, 65.0).currents[0], 32'868);
}

TEST(CurrentConverter, FilterTellsTheCurrentOfItsDelayAgo) {
  ConverterParameters parameters;
  parameters.delay = 5e-6;
  const CurrentConverter converter(parameters);
  ConverterState state;
  base::Random random(1);
  converter.sample(state, {1.0, 0.0}, 24.0, 25.0, kPeriod, random);
  const ConverterSample raw = converter.sample(state, {2.0, 0.0}, 24.0, 25.0, kPeriod, random);
  EXPECT_EQ(raw.currents[0], 32'768 + 1'750);
}

TEST(CurrentConverter, NoiseHasItsDeviationNoBiasAndItsSeed) {
  ConverterParameters parameters;
  parameters.currents[0].noise = 20.0;
  const CurrentConverter converter(parameters);
  ConverterState state;
  base::Random random(42);
  base::Random same(42);
  ConverterState same_state;
  constexpr int kCount = 100'000;
  double sum = 0.0;
  double squares = 0.0;
  for (int n = 0; n < kCount; ++n) {
    const auto raw = converter.sample(state, {}, 24.0, 25.0, kPeriod, random);
    const auto again = converter.sample(same_state, {}, 24.0, 25.0, kPeriod, same);
    ASSERT_EQ(raw.currents, again.currents);
    const double error = raw.currents[0] - 32'768.0;
    sum += error;
    squares += error * error;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 0.3);
  EXPECT_NEAR(std::sqrt(squares / kCount), 20.0, 0.3);
}

}  // namespace
}  // namespace stator::plant
