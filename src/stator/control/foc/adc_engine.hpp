#pragma once

#include <array>
#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/register_file.hpp"
#include "stator/control/foc/signals.hpp"
#include "stator/control/foc/transforms.hpp"

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
    const CurrentGroup& chosen = delta_sigma_a_ ? inputs.delta_sigma_a : inputs.spi_a;
    // Copied word by word: a wider load would have to wait for the narrow stores just made.
    a_.current[0] = chosen.current[0];
    a_.current[1] = chosen.current[1];
    a_.motor_supply = chosen.motor_supply;
    a_.general_a = chosen.general_a;
    a_.general_b = chosen.general_b;
    if (coarse_) [[unlikely]] {
      coarsen();
    }
    clipped_ = false;
    const std::int32_t first = scaled(source(source_[0]), scaler_[0]);
    const std::int32_t second = scaled(source(source_[1]), scaler_[1]);
    const std::int32_t third = saturate_s16(-(std::int64_t{first} + second));
    channel_[0] = first;
    channel_[1] = second;
    if (usual_phases_) [[likely]] {
      phase_.u = first;
      phase_.v = third;
      phase_.w = second;
    } else {
      const std::array<std::int32_t, 4> current{first, second, third, 0};
      phase_ = {current[phase_source_[0]], current[phase_source_[1]], current[phase_source_[2]]};
    }
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
  [[nodiscard]] std::int32_t source(unsigned selection) const {
    return selection < 2 ? a_.current[selection] : external_[selection - 2];
  }
  [[nodiscard]] std::int32_t scaled(std::int32_t raw, const Scaler& scaler) {
    const std::int64_t exact = unsaturated_current(raw, scaler);
    const std::int32_t current = saturate_s16(exact);
    // 0 and 65535 at once.
    if (static_cast<std::uint16_t>(raw + 1) <= 1 || current != exact) [[unlikely]] {
      clipped_ = true;
    }
    return current;
  }

  bool delta_sigma_a_ = true;
  bool delta_sigma_b_ = true;
  bool coarse_ = false;              ///< the filter of group A resolves less than 16 bits
  std::uint16_t resolved_ = 0xFFFF;  ///< the bits it resolves
  std::array<Scaler, 2> scaler_{};
  std::array<std::int32_t, 2> external_{};
  std::array<std::uint8_t, 2> source_{0, 1};
  std::array<std::uint8_t, 3> phase_source_{0, 2, 1};
  bool usual_phases_ = true;  ///< phase_source_ is as above
  CurrentGroup a_;
  PhaseVector phase_;
  std::array<std::int32_t, 2> channel_{};
  bool clipped_ = false;
};

}  // namespace stator::control::foc
