#include "stator/control/foc/adc_engine.hpp"

namespace stator::control::foc {
namespace {

/// CFG_DSMODULATOR 0 names a modulator on the chip, which this purely digital one does not have: it
/// selects the SPI converter.
constexpr std::int32_t kSpi = 0;

/// Bits that a sinc^3 filter of that decimation can resolve: 3 log2(M), 1..16.
constexpr int resolved_bits(std::int32_t decimation) {
  const std::int64_t steps = std::int64_t{decimation} * decimation * decimation;
  int bits = 1;
  while (bits < 16 && (std::int64_t{2} << bits) <= steps) {
    ++bits;
  }
  return bits;
}

}  // namespace

void AdcEngine::configure(const RegisterFile& registers) {
  delta_sigma_a_ = registers.get(field("CFG_DSMODULATOR_A")) != kSpi;
  delta_sigma_b_ = registers.get(field("CFG_DSMODULATOR_B")) != kSpi;
  const int bits = resolved_bits(registers.get(field("DSADC_MDEC_A")));
  coarse_ = delta_sigma_a_ && bits < 16;
  resolved_ = static_cast<std::uint16_t>(0xFFFFU << static_cast<unsigned>(16 - bits));
  scaler_[0] = {registers.get(field("ADC_I0_OFFSET")), registers.get(field("ADC_I0_SCALE"))};
  scaler_[1] = {registers.get(field("ADC_I1_OFFSET")), registers.get(field("ADC_I1_SCALE"))};
  external_ = {registers.get(field("ADC_I0_EXT")), registers.get(field("ADC_I1_EXT"))};
  source_ = {static_cast<std::uint8_t>(registers.get(field("ADC_I0_SELECT")) & 3),
             static_cast<std::uint8_t>(registers.get(field("ADC_I1_SELECT")) & 3)};
  phase_source_ = {static_cast<std::uint8_t>(registers.get(field("ADC_I_UX_SELECT"))),
                   static_cast<std::uint8_t>(registers.get(field("ADC_I_V_SELECT"))),
                   static_cast<std::uint8_t>(registers.get(field("ADC_I_WY_SELECT")))};
  usual_phases_ = phase_source_ == std::array<std::uint8_t, 3>{0, 2, 1};
}

void AdcEngine::coarsen() {
  const auto keep = [this](std::uint16_t value) {
    return static_cast<std::uint16_t>(value & resolved_);
  };
  a_ = {{keep(a_.current[0]), keep(a_.current[1])},
        keep(a_.motor_supply),
        keep(a_.general_a),
        keep(a_.general_b)};
}

std::int64_t AdcEngine::delta_sigma_delay(std::uint32_t decimation, std::uint32_t clock) {
  if (decimation == 0 || clock == 0) {
    return 0;
  }
  constexpr std::uint64_t kPeriodOfOneStep = 5ULL << 32U;  // ns: 2^32 steps are 200 MHz
  return static_cast<std::int64_t>(kPeriodOfOneStep / clock * (decimation - 1) * 3 / 2);
}

}  // namespace stator::control::foc
