// Analog encoders at the TMC8670's FOC block: angle, count, and what wrong offsets and gains do.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/foc/analog_decoder.hpp"
#include "stator/control/foc/foc_block.hpp"

namespace stator::control::foc {
namespace {

EncoderGroup signals(double angle, bool three_phases, double amplitude = 20'000.0) {
  const auto raw = [&](double value) {
    return static_cast<std::uint16_t>(std::lround(32768.0 + amplitude * value));
  };
  if (three_phases) {
    return {raw(std::cos(angle)), raw(std::cos(angle - 2.0 * M_PI / 3.0)),
            raw(std::cos(angle + 2.0 * M_PI / 3.0))};
  }
  return {raw(std::cos(angle)), 32768, raw(std::sin(angle))};
}

AnalogSettings analog(bool three_phases) {
  AnalogSettings settings;
  settings.three_phases = three_phases;
  settings.scaler.fill({-32768, 256});
  return settings;
}

TEST(FocAnalog, AngleIsWithinAStepAndTheConvertersRounding) {
  base::Random random(3);
  for (const bool three_phases : {false, true}) {
    AnalogDecoder decoder;
    decoder.configure(analog(three_phases));
    for (int k = 0; k < 50'000; ++k) {
      const double angle = 2.0 * M_PI * random.uniform();
      decoder.step(signals(angle, three_phases));
      const double exact = angle / (2.0 * M_PI) * 65536.0;
      // 0.71 LSB of rounding across 20000 turn the vector by 0.37.
      EXPECT_LE(std::fabs(std::remainder(decoder.phi_a_raw() - exact, 65536.0)), 0.98);
    }
  }
}

TEST(FocAnalog, GivesTheDocumentsExample) {
  AnalogDecoder decoder;
  decoder.configure(analog(false));
  decoder.step({40000, 0, 40000});
  EXPECT_EQ(decoder.phi_a_raw(), 8192);
  EXPECT_EQ(decoder.values()[0], 7232);
}

TEST(FocAnalog, CountsPeriodsIntoMechanicalAndElectricalAngle) {
  base::Random random(4);
  AnalogSettings settings = analog(false);
  settings.periods = 100;
  settings.pole_pairs = 7;
  settings.phi_m_offset = 500;
  settings.phi_e_offset = -300;
  AnalogDecoder decoder;
  decoder.configure(settings);
  double periods = 0.25;
  for (int k = 0; k < 20'000; ++k) {
    decoder.step(signals(2.0 * M_PI * periods, false));
    const double mechanical = periods / 100.0 * 65536.0 + 500.0;
    EXPECT_LE(std::fabs(std::remainder(decoder.phi_m() - mechanical, 65536.0)), 1.5);
    const double electrical = periods / 100.0 * 7.0 * 65536.0 + 3500.0 - 300.0;
    EXPECT_LE(std::fabs(std::remainder(decoder.phi_e() - electrical, 65536.0)), 1.5);
    EXPECT_NEAR(decoder.position(), periods / 100.0 * 65536.0, 1.5);
    periods += 0.4 * (random.uniform() - 0.45);
  }
}

TEST(FocAnalog, DirectionBitTurnsTheAngle) {
  AnalogSettings settings = analog(false);
  settings.reversed = true;
  settings.phi_a_offset = 100;
  AnalogDecoder decoder;
  decoder.configure(settings);
  decoder.step(signals(1.0, false));
  EXPECT_NEAR(decoder.phi_a(), -65536.0 / (2.0 * M_PI) + 100.0, 1.0);
}

TEST(FocAnalog, WrongOffsetAndGainShowAsTheyDoInReality) {
  AnalogSettings settings = analog(false);
  settings.scaler[0].offset += 1000;  // 5 % of the amplitude: 0.05 rad once per period
  AnalogDecoder decoder;
  decoder.configure(settings);
  double worst = 0.0;
  for (int k = 0; k < 1000; ++k) {
    const double angle = k * 2.0 * M_PI / 1000.0;
    decoder.step(signals(angle, false));
    worst = std::max(worst, std::fabs(std::remainder(
                                decoder.phi_a_raw() / 65536.0 * 2.0 * M_PI - angle, 2.0 * M_PI)));
  }
  EXPECT_NEAR(worst, 0.05, 0.002);
}

TEST(FocAnalog, RegistersShowChannelsAnglesAndCount) {
  FocBlock block;
  for (const Field& f : {field("AENC_0_OFFSET"), field("AENC_1_OFFSET"), field("AENC_2_OFFSET")}) {
    block.set(f, -32768);
  }
  block.set(field("CFG_DSMODULATOR_B"), 1);
  block.set(field("PHI_E_SELECTION"), 6);
  Inputs inputs;
  inputs.delta_sigma_b = {40000, 30000, 40000};
  block.step(inputs);
  EXPECT_EQ(block.get(field("AENC_UX")), 7232);
  EXPECT_EQ(block.get(field("AENC_VN")), -2768);  // N is a raw value, scaled like the others
  EXPECT_EQ(block.get(field("AENC_WY")), 7232);
  EXPECT_EQ(block.get(field("ADC_AENC_VN_RAW")), 30000);
  EXPECT_EQ(block.get(field("AENC_DECODER_PHI_A")), 8192);
  EXPECT_EQ(block.get(field("AENC_DECODER_COUNT")), 8192);
  EXPECT_EQ(block.get(field("PHI_E")), 8192);
  block.write(0x41, 65536 + 5);
  EXPECT_EQ(block.get(field("AENC_DECODER_POSITION")), 65541);
  // The selectors choose which raw value is which channel.
  block.write(0x11, 0x00000201);  // UX from VN, VN from WY, WY from UX
  block.step(inputs);
  EXPECT_EQ(block.get(field("AENC_UX")), -2768);
  EXPECT_EQ(block.get(field("AENC_VN")), 7232);
}

}  // namespace
}  // namespace stator::control::foc
