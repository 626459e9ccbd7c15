#pragma once

#include <array>
#include <cstdint>

#include "stator/control/foc/adc_engine.hpp"
#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/signals.hpp"

namespace stator::control::foc {

/// AENC_..., the scalers and selectors of the analog encoder.
struct AnalogSettings {
  bool three_phases = false;  ///< 0/120/240 degrees (UX, VN, WY); else 0/90 (UX cosine, WY sine)
  bool reversed = false;
  std::array<Scaler, 3> scaler{};               ///< of the channels 0, 1, 2
  std::array<std::uint8_t, 3> source{0, 1, 2};  ///< of UX, VN, WY: raw UX, VN, WY
  std::int32_t phi_a_offset = 0;
  std::int32_t periods = 1;  ///< of the signals per revolution (AENC_DECODER_PPR), not 0
  std::int32_t phi_m_offset = 0;
  std::int32_t phi_e_offset = 0;
  std::int32_t pole_pairs = 1;
};

/// Analog Hall sensors and sin/cos encoders (L699-L722, reading A-42): offset, scale, for three
/// phases a Clarke transformation, arc tangent, and a count of signal periods.
///
/// The angle within a period is within 0.6 LSB of 65536 of the exact arc tangent of the scaled
/// words; what offsets, gains and phases that do not fit falsify shows in it as in reality.
class AnalogDecoder {
 public:
  void configure(const AnalogSettings& settings) {
    settings_ = settings;
    stale_ = true;
  }

  void step(const EncoderGroup& raw) {
    if (raw == raw_ && !stale_) {
      return;
    }
    raw_ = raw;
    stale_ = false;
    decode();
  }

  /// The user writes the count; 65536 = one signal period.
  void set_count(std::int32_t count) {
    count_ = count;
    update_angles();
  }

  [[nodiscard]] const EncoderGroup& raw() const { return raw_; }
  /// AENC_UX, AENC_VN, AENC_WY, scaled. s16
  [[nodiscard]] const std::array<std::int32_t, 3>& values() const { return value_; }
  [[nodiscard]] bool clipped() const { return clipped_; }
  [[nodiscard]] std::int32_t phi_a_raw() const { return phi_a_raw_; }  ///< s16
  [[nodiscard]] std::int32_t phi_a() const {                           ///< with its offset; s16
    return wrap_s16(std::int64_t{phi_a_raw_} + settings_.phi_a_offset);
  }
  [[nodiscard]] std::int32_t count() const {
    return wrap_s32(count_);
  }                                                            ///< s32, 65536 = one signal period
  [[nodiscard]] std::int32_t phi_m() const { return phi_m_; }  ///< s16
  [[nodiscard]] std::int32_t phi_e() const { return phi_e_; }  ///< s16
  /// AENC_DECODER_POSITION: 65536 = one revolution.
  [[nodiscard]] std::int32_t position() const {
    return wrap_s32(floor_division(count_, settings_.periods));
  }

 private:
  void decode();
  void update_angles();

  AnalogSettings settings_;
  EncoderGroup raw_;
  bool stale_ = true;
  bool started_ = false;
  bool clipped_ = false;
  std::array<std::int32_t, 3> value_{};
  std::int32_t phi_a_raw_ = 0;
  std::int64_t count_ = 0;  ///< since power-on, 65536 = one signal period
  std::int32_t phi_m_ = 0;
  std::int32_t phi_e_ = 0;
};

}  // namespace stator::control::foc
