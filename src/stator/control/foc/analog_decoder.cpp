#include "stator/control/foc/analog_decoder.hpp"

#include <cstddef>

#include "stator/control/foc/sine_table.hpp"
#include "stator/control/foc/transforms.hpp"

namespace stator::control::foc {

void AnalogDecoder::decode() {
  const std::array<std::uint16_t, 3> source{raw_.ux, raw_.vn, raw_.wy};
  clipped_ = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint16_t raw = source[settings_.source[k]];
    value_[k] = scaled_encoder(raw, settings_.scaler[k]);
    const bool counts = settings_.three_phases || k != 1;
    clipped_ |= counts && (raw == 0 || raw == 0xFFFF);
  }
  std::int32_t cosine = value_[0];
  std::int32_t sine = value_[2];
  if (settings_.three_phases) {
    // The sum need not be 0 here, so all three phases count; both parts times 3.
    cosine = 2 * value_[0] - value_[1] - value_[2];
    sine = static_cast<std::int32_t>(
        rounded_shift((std::int64_t{value_[1]} - value_[2]) * 3 * kInverseSqrt3Q30, kSineBits));
  }
  const auto angle = static_cast<std::int32_t>(arc_tangent(sine, cosine));
  const std::int32_t phi = wrap_s16(settings_.reversed ? -angle : angle);
  const std::int32_t turned = wrap_s16(std::int64_t{phi} - phi_a_raw_);
  phi_a_raw_ = phi;
  if (started_) {
    count_ += turned;
  } else {
    count_ = static_cast<std::uint16_t>(phi);
    started_ = true;
  }
  update_angles();
}

void AnalogDecoder::update_angles() {
  const std::int64_t count = count_ + settings_.phi_a_offset;
  phi_m_ = wrap_s16(floor_division(count, settings_.periods) + settings_.phi_m_offset);
  // From the count, not from phi_m, which has lost what the division left over.
  const std::int64_t shifted = count + std::int64_t{settings_.phi_m_offset} * settings_.periods;
  phi_e_ = wrap_s16(floor_division(shifted * settings_.pole_pairs, settings_.periods) +
                    settings_.phi_e_offset);
}

}  // namespace stator::control::foc
