// ADC scaling and PWM of the TMC8670's FOC block: on-times, pauses, polarities, choppers.
#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/foc/adc_engine.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/control/foc/pwm_engine.hpp"

namespace stator::control::foc {
namespace {

TEST(FocAdc, ScalesEveryRawValueByTheFormula) {
  for (const std::int32_t offset : {0, 1, 32768, 65535}) {
    for (const std::int32_t scale : {-32768, -256, -1, 0, 1, 195, 256, 32767}) {
      for (std::int32_t raw = 0; raw < 65536; ++raw) {
        const double exact = (raw - offset) * (scale / 256.0);
        ASSERT_EQ(scaled_current(raw, {offset, scale}),
                  std::clamp(std::floor(exact), -32768.0, 32767.0));
      }
    }
  }
  EXPECT_NEAR(scaled_current(35389, {32768, 195}), 1997, 1);  // +2 A in mA
}

TEST(FocAdc, EncoderChannelsAddTheirOffset) {
  const Scaler scaler{-32768, 256};
  EXPECT_EQ(scaled_encoder(32768, scaler), 0);
  EXPECT_EQ(scaled_encoder(40000, scaler), 7232);
  EXPECT_EQ(scaled_encoder(25536, scaler), -7232);
}

/// A block whose channels pass raw - 32768 on.
FocBlock plain_block() {
  FocBlock block;
  block.set(field("ADC_I0_OFFSET"), 32768);
  block.set(field("ADC_I1_OFFSET"), 32768);
  return block;
}

TEST(FocAdc, EachGroupHasItsOwnChoiceOfConverters) {
  FocBlock block = plain_block();
  Inputs inputs;
  inputs.delta_sigma_a.current = {33768, 34768};
  inputs.spi_a.current = {35768, 36768};
  inputs.delta_sigma_a.motor_supply = 11;
  inputs.spi_a.motor_supply = 22;
  inputs.delta_sigma_b.ux = 33;
  inputs.spi_b.ux = 44;
  for (const int a : {0, 1, 2, 3}) {
    for (const int b : {0, 1, 2, 3}) {
      block.set(field("CFG_DSMODULATOR_A"), a);
      block.set(field("CFG_DSMODULATOR_B"), b);
      block.step(inputs);
      EXPECT_EQ(block.get(field("ADC_IUX")), a == 0 ? 3000 : 1000);
      EXPECT_EQ(block.get(field("ADC_IWY")), a == 0 ? 4000 : 2000);
      EXPECT_EQ(block.get(field("ADC_VM_RAW")), a == 0 ? 22 : 11);
      EXPECT_EQ(block.get(field("ADC_AENC_UX_RAW")), b == 0 ? 44 : 33);
    }
  }
}

TEST(FocAdc, ChannelsAndPhasesAreMappedAsSelected) {
  FocBlock block = plain_block();
  block.write(0x0B, 35000U << 16U | 34000U);  // external I0 and I1
  Inputs inputs;
  inputs.delta_sigma_a.current = {33068, 33268};
  block.set(field("CFG_DSMODULATOR_A"), 2);
  const std::array<std::int32_t, 4> source{300, 500, 34000 - 32768, 35000 - 32768};
  for (int i0 = 0; i0 < 4; ++i0) {
    for (int i1 = 0; i1 < 4; ++i1) {
      block.set(field("ADC_I0_SELECT"), i0);
      block.set(field("ADC_I1_SELECT"), i1);
      const std::array<std::int32_t, 4> current{
          source[static_cast<unsigned>(i0)], source[static_cast<unsigned>(i1)],
          -source[static_cast<unsigned>(i0)] - source[static_cast<unsigned>(i1)], 0};
      for (int map = 0; map < 64; ++map) {
        block.set(field("ADC_I_UX_SELECT"), map & 3);
        block.set(field("ADC_I_V_SELECT"), (map >> 2) & 3);
        block.set(field("ADC_I_WY_SELECT"), map >> 4);
        block.step(inputs);
        ASSERT_EQ(block.get(field("ADC_IUX")), current[static_cast<unsigned>(map & 3)]);
        ASSERT_EQ(block.get(field("ADC_IV")), current[static_cast<unsigned>((map >> 2) & 3)]);
        ASSERT_EQ(block.get(field("ADC_IWY")), current[static_cast<unsigned>(map >> 4)]);
      }
    }
  }
}

TEST(FocAdc, ScaleFlipsTheSignAndClippingIsFlagged) {
  FocBlock block = plain_block();
  Inputs inputs;
  inputs.delta_sigma_a.current = {40000, 32768};
  block.set(field("CFG_DSMODULATOR_A"), 1);
  block.set(field("ADC_I0_SCALE"), -256);
  block.write(0x7C, 0);
  block.step(inputs);
  EXPECT_EQ(block.get(field("ADC_IUX")), -7232);
  EXPECT_EQ(block.get(field("ADC_I_CLIPPED")), 0);
  block.set(field("ADC_I0_SCALE"), -2560);
  block.step(inputs);
  EXPECT_EQ(block.get(field("ADC_IUX")), -32768);
  EXPECT_EQ(block.get(field("ADC_I_CLIPPED")), 1);
}

TEST(FocAdc, ShortDeltaSigmaFiltersResolveFewerBits) {
  FocBlock block = plain_block();
  Inputs inputs;
  inputs.delta_sigma_a.current = {0xABCD, 0x8000};
  block.set(field("CFG_DSMODULATOR_A"), 1);
  block.set(field("DSADC_MDEC_A"), 8);  // 3 x 3 = 9 bits
  block.step(inputs);
  EXPECT_EQ(block.get(field("ADC_I0_RAW")), 0xABCD & 0xFF80);
  block.set(field("DSADC_MDEC_A"), 334);
  block.step(inputs);
  EXPECT_EQ(block.get(field("ADC_I0_RAW")), 0xABCD);
  EXPECT_EQ(AdcEngine::delta_sigma_delay(334, 0x20000000), 333 * 40 * 3 / 2);  // 25 MHz
}

// --- PWM ---

PwmEngine engine(std::int32_t maxcnt, bool space_vector, MotorType motor) {
  RegisterFile registers;
  registers.set(field("PWM_MAXCNT"), maxcnt);
  registers.set(field("PWM_SV"), space_vector ? 1 : 0);
  registers.set(field("PWM_CHOP"), 7);
  registers.set(field("MOTOR_TYPE"), static_cast<int>(motor));
  PwmEngine result;
  result.configure(registers);
  return result;
}

TEST(FocPwm, FrequencyFollowsMaxcntEvenInOperation) {
  FocBlock block;
  EXPECT_EQ(block.period(), 4000);  // 25 kHz
  for (const int maxcnt : {3999, 1999, 999}) {
    block.set(field("PWM_MAXCNT"), maxcnt);
    EXPECT_EQ(block.step({}).pwm.period, maxcnt + 1);
    EXPECT_EQ(block.period(), maxcnt + 1);
  }
}

TEST(FocPwm, OnTimesAreWithinHalfATickOfTheExactOnes) {
  base::Random random(1);
  for (int k = 0; k < 50'000; ++k) {
    const std::int32_t maxcnt = 99 + static_cast<std::int32_t>(random.below(4000));
    const double period = maxcnt + 1;
    const double length = 32767.0 * random.uniform(), angle = 2.0 * M_PI * random.uniform();
    const StatorVector u{static_cast<std::int32_t>(std::lround(length * std::cos(angle))),
                         static_cast<std::int32_t>(std::lround(length * std::sin(angle)))};
    const PhaseVector phase = inverse_clarke(u);
    PwmEngine plain = engine(maxcnt, false, MotorType::three_phase);
    plain.set(phase);
    EXPECT_NEAR(plain.next()[0], period * (0.5 + phase.u / 65536.0), 0.501);
    EXPECT_NEAR(plain.next()[1], period * (0.5 + phase.v / 65536.0), 0.501);
    EXPECT_NEAR(plain.next()[2], period * (0.5 + phase.w / 65536.0), 0.501);
    PwmEngine space = engine(maxcnt, true, MotorType::three_phase);
    space.set(phase);
    const auto on = space.next();
    // Line to line: 32768 stands for supply / sqrt 3 of phase amplitude.
    const double unit = period * 2.0 / std::sqrt(3.0) / 65536.0;
    EXPECT_NEAR(on[0] - on[1], (phase.u - phase.v) * unit, 1.02);
    EXPECT_NEAR(on[1] - on[2], (phase.v - phase.w) * unit, 1.02);
    EXPECT_NEAR(std::min({on[0], on[1], on[2]}), period - std::max({on[0], on[1], on[2]}), 1.02);
  }
}

TEST(FocPwm, SpaceVectorReachesTheSquareRootOfThreeWithoutClipping) {
  PwmEngine space = engine(3999, true, MotorType::three_phase);
  for (int angle = 0; angle < 65536; angle += 16) {
    space.set(
        inverse_clarke(inverse_park({32767, 0}, sine_cosine(static_cast<std::uint16_t>(angle)))));
    const auto on = space.next();
    const double line = std::max(
        {on[0] - on[1], on[1] - on[2], on[2] - on[0], on[1] - on[0], on[2] - on[1], on[0] - on[2]});
    EXPECT_GE(line, 4000.0 * 0.8659);  // between sqrt(3)/2 and 1 of the supply
    EXPECT_LE(line, 4000.0);
  }
  space.set(inverse_clarke(inverse_park({32767, 0}, sine_cosine(65536 / 12))));
  EXPECT_NEAR(space.next()[0] - space.next()[2], 4000, 1);
}

TEST(FocPwm, TwoPhaseMotorsDriveTwoFullBridges) {
  PwmEngine two = engine(3999, false, MotorType::two_phase);
  two.set(StatorVector{16384, -8192});
  EXPECT_EQ(two.next(), (std::array<std::int32_t, 4>{3000, 1000, 1500, 2500}));
  PwmPeriod pwm;
  two.begin(pwm);
  EXPECT_EQ(pwm.half_bridges, 4);
  EXPECT_EQ(pwm.on_time, two.next());
  PwmEngine one = engine(3999, false, MotorType::direct_current);
  one.set(-16384);
  EXPECT_EQ(one.next()[0], 1000);
  EXPECT_EQ(one.next()[1], 3000);
  one.begin(pwm);
  EXPECT_EQ(pwm.half_bridges, 2);
}

/// Ticks of a period in which the low and the high side of half bridge 0 conduct.
std::pair<int, int> conducting(const PwmEngine& engine, const PwmPeriod& pwm) {
  std::pair<int, int> result;
  for (std::int32_t tick = 0; tick < pwm.period; ++tick) {
    const unsigned levels = engine.gate_levels(pwm, true, tick);
    result.first += static_cast<int>(levels & 1U);
    result.second += static_cast<int>((levels >> 1U) & 1U);
    EXPECT_NE(levels & 3U, 3U) << "both switches of a half bridge conduct at " << tick;
  }
  return result;
}

TEST(FocPwm, PausesComeOffTheSideThatSwitchesOn) {
  const PwmEngine pwm_engine = engine(999, false, MotorType::three_phase);
  PwmPeriod pwm;
  pwm.period = 1000;
  pwm.half_bridges = 3;
  pwm.chopper = Chopper::centred;
  for (const std::int32_t on : {0, 10, 24, 25, 26, 500, 975, 990, 1000}) {
    for (const auto& [high, low] : {std::pair{0, 0}, {25, 10}, {10, 25}, {255, 255}}) {
      pwm.on_time[0] = on;
      pwm.pause_high = high;
      pwm.pause_low = low;
      const auto [low_on, high_on] = conducting(pwm_engine, pwm);
      const int off = 1000 - on;
      EXPECT_EQ(high_on, on == 1000 ? 1000 : std::max(on - high, 0)) << on << ' ' << high;
      EXPECT_EQ(low_on, on == 0 ? 1000 : std::max(off - low, 0)) << on << ' ' << low;
    }
  }
}

TEST(FocPwm, PolaritiesInvertTheirSideAlsoWhileOff) {
  RegisterFile registers;
  for (const int polarity : {0, 1, 2, 3}) {
    registers.set(field("PWM_POLARITIES_0"), polarity & 1);
    registers.set(field("PWM_POLARITIES_1"), polarity >> 1);
    PwmEngine inverted;
    inverted.configure(registers);
    const unsigned off = (polarity & 1 ? 0x55U : 0U) | (polarity & 2 ? 0xAAU : 0U);
    EXPECT_EQ(inverted.gate_levels({}, true, 0), off);
    PwmPeriod low_sides;
    low_sides.half_bridges = 3;
    low_sides.chopper = Chopper::low_sides_on;
    EXPECT_EQ(inverted.gate_levels(low_sides, true, 7), off ^ 0x15U);
    low_sides.chopper = Chopper::high_sides_on;
    EXPECT_EQ(inverted.gate_levels(low_sides, true, 7), off ^ 0x2AU);
    EXPECT_EQ(inverted.gate_levels(low_sides, false, 7), off);
  }
}

TEST(FocPwm, OneSidedChoppersLeaveTheOtherSideOff) {
  const PwmEngine pwm_engine = engine(999, false, MotorType::three_phase);
  PwmPeriod pwm{.on_time = {300},
                .period = 1000,
                .pause_high = 10,
                .pause_low = 20,
                .half_bridges = 3,
                .chopper = Chopper::low_side};
  EXPECT_EQ(conducting(pwm_engine, pwm), (std::pair{680, 0}));
  pwm.chopper = Chopper::high_side;
  EXPECT_EQ(conducting(pwm_engine, pwm), (std::pair{0, 290}));
}

}  // namespace
}  // namespace stator::control::foc
