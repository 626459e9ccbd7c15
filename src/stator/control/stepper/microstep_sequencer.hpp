#pragma once

#include <array>
#include <cstdint>

namespace stator::control {

/// Turns a motor position into coil current targets through a sine table of 1024 entries per
/// electrical period (256 per quarter wave), as the sequencers of the TMC26x and TMC4361 do.
///
/// Table values are whole steps of the coil current converters, at most 248 of 255 per polarity:
/// full scale of a coil is 248. Phase A follows the cosine and phase B the sine, so at position 0
/// phase A carries all current and the rotor rests on a full step.
class MicrostepSequencer {
 public:
  static constexpr int kTableSize = 1024;
  static constexpr int kAmplitude = 248;

  /// `resolution`: microsteps per full step as a power of two, 0..8 (2000h); larger counts as 8.
  void set_resolution(std::uint8_t resolution) {
    resolution_ = resolution < 8 ? resolution : std::uint8_t{8};
  }
  [[nodiscard]] std::uint8_t resolution() const { return resolution_; }

  /// Table index of a position in microsteps of the resolution set; any position, also negative.
  [[nodiscard]] int table_index(std::int64_t microsteps) const {
    const auto scaled = static_cast<std::uint64_t>(microsteps) << (8U - resolution_);
    return static_cast<int>(scaled & (kTableSize - 1));
  }
  /// Current targets of phases A and B, A, when a fully driven coil carries `amplitude` (A, peak).
  [[nodiscard]] std::array<double, 2> coil_currents(std::int64_t microsteps,
                                                    double amplitude) const;
  /// Table entry of phase B, -248..248; `index` 0..1023.
  [[nodiscard]] static int sine_entry(int index);

 private:
  std::uint8_t resolution_ = 8;
};

}  // namespace stator::control
