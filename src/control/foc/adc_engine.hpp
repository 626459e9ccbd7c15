#pragma once

#include <array>
#include <cstdint>

#include "control/foc/fixed_point.hpp"
#include "control/foc/register_file.hpp"
#include "control/foc/signals.hpp"
#include "control/foc/transforms.hpp"

namespace stator::control::foc {

/// Offset and gain of one channel, 256 = 1.
struct Scaler {
  std::int32_t offset = 0;
  std::int32_t scale = 256;
};

/// (raw - offset) x scale / 256 in s16, for currents (reading A-43): rounded down, saturated.
[[nodiscard]] constexpr std::int64_t unsaturated_current(std::int32_t raw, const Scaler& s) {
  return (std::int64_t{raw} - s.offset) * s.scale >> 8;
}
[[nodiscard]] constexpr std::int32_t scaled_current(std::int32_t raw, const Scaler& s) {
  return saturate_s16(unsaturated_current(raw, s));
}

/// (raw + offset) x scale / 256 in s16, for the analog encoder (equation 1, L703; A-42).
[[nodiscard]] constexpr std::int32_t scaled_encoder(std::int32_t raw, const Scaler& s) {
  return saturate_s16((std::int64_t{raw} + s.offset) * s.scale >> 8);
}

/// Chooses sources, removes offsets, scales and maps channels to phases: everything between the
/// converters and the Clarke transformation. The result is exact integer arithmetic.
class AdcEngine {
 public:
  void configure(const RegisterFile& registers);

  void step(const Inputs& inputs) {
    a_ = delta_sigma_a_ ? inputs.delta_sigma_a : inputs.spi_a;
    if (coarse_) [[unlikely]] {
      coarsen();
    }
    const std::array<std::int32_t, 4> source{a_.current[0], a_.current[1], external_[0],
                                             external_[1]};
    std::array<std::int32_t, 4> current{};
    clipped_ = false;
    for (unsigned k = 0; k < 2; ++k) {
      const std::int32_t raw = source[source_[k]];
      const std::int64_t exact = unsaturated_current(raw, scaler_[k]);
      current[k] = saturate_s16(exact);
      clipped_ |= current[k] != exact || raw == 0 || raw == 0xFFFF;
    }
    current[2] = saturate_s16(-(std::int64_t{current[0]} + current[1]));
    channel_ = {current[0], current[1]};
    phase_ = {current[phase_source_[0]], current[phase_source_[1]], current[phase_source_[2]]};
  }

  /// Raw values of the analog encoder from the converter in use.
  [[nodiscard]] const EncoderGroup& encoder_group(const Inputs& inputs) const {
    return delta_sigma_b_ ? inputs.delta_sigma_b : inputs.spi_b;
  }
  [[nodiscard]] const CurrentGroup& raw() const { return a_; }
  /// Currents of the phases U/X, V, W/Y after the selection.
  [[nodiscard]] const PhaseVector& phase() const { return phase_; }
  /// Scaled currents of the channels I0 and I1.
  [[nodiscard]] const std::array<std::int32_t, 2>& channel() const { return channel_; }
  /// A raw value stood at an end of its range or a current did not fit.
  [[nodiscard]] bool clipped() const { return clipped_; }

  /// Time between the middle of what a delta-sigma filter of `decimation` averaged and its result,
  /// in ns, at the modulator clock DSADC_MCLK `clock` (2^32 = 200 MHz): 1.5 (M - 1) periods.
  [[nodiscard]] static std::int64_t delta_sigma_delay(std::uint32_t decimation,
                                                      std::uint32_t clock);

 private:
  void coarsen();

  bool delta_sigma_a_ = true;
  bool delta_sigma_b_ = true;
  bool coarse_ = false;              ///< the filter of group A resolves less than 16 bits
  std::uint16_t resolved_ = 0xFFFF;  ///< the bits it resolves
  std::array<Scaler, 2> scaler_{};
  std::array<std::int32_t, 2> external_{};
  std::array<std::uint8_t, 2> source_{0, 1};
  std::array<std::uint8_t, 3> phase_source_{0, 2, 1};
  CurrentGroup a_;
  PhaseVector phase_;
  std::array<std::int32_t, 2> channel_{};
  bool clipped_ = false;
};

}  // namespace stator::control::foc
