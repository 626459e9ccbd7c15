#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "stator/base/trigonometry.hpp"

namespace stator::plant {

/// Three digital Hall sensors 120 electrical degrees apart. Sensor k sees the magnet while it
/// points within 90 degrees of phase k, so that the codes (bits 0, 1, 2 for H1, H2, H3) forward are
///   001  011  010  110  100  101
/// centred at the electrical angles 0, 60, 120, 180, 240, 300 degrees.
struct HallSensorParameters {
  bool fitted = true;     ///< else all three read low
  bool inverted = false;  ///< open-collector outputs read the other way round
  double offset = 0.0;    ///< electrical rad the board is turned forward
  /// Electrical rad by which each sensor sits ahead of its place.
  std::array<double, 3> placement_error{};
  double hysteresis = 0.03;  ///< electrical rad from the middle to either switching point, < pi/2
};

/// What is wrong with one sensor's line.
enum class HallFault : std::uint8_t { none, stuck_low, stuck_high };

/// What arrives of the levels `signal` (bits 0, 1, 2) where the wires of H1 and H2 may be swapped
/// and lines of the drive are stuck.
[[nodiscard]] constexpr std::uint8_t through_cable(std::uint8_t signal, bool swapped,
                                                   const std::array<HallFault, 3>& lines) {
  unsigned seen = signal;
  if (swapped) {
    seen = (seen & 4U) | ((seen & 1U) << 1) | ((seen >> 1) & 1U);
  }
  for (unsigned k = 0; k < lines.size(); ++k) {
    if (lines[k] != HallFault::none) {
      seen = (seen & ~(1U << k)) | (static_cast<unsigned>(lines[k] == HallFault::stuck_high) << k);
    }
  }
  return static_cast<std::uint8_t>(seen);
}

/// The comparators; their state is the levels they hold.
class HallSensors {
 public:
  explicit HallSensors(const HallSensorParameters& parameters);

  /// Levels after power-on with the magnet at `direction`, without hysteresis: bits 0, 1, 2.
  [[nodiscard]] std::uint8_t power_on(const base::SineCosine& direction) const;

  /// Levels of the comparators after `levels` with the magnet at `direction`.
  [[nodiscard]] std::uint8_t next(std::uint8_t levels, const base::SineCosine& direction) const {
    std::uint64_t result = 0;
    for (unsigned k = 0; k < 3; ++k) {
      const double seen = axis_[k].cosine * direction.cosine + axis_[k].sine * direction.sine;
      // Takes the sign bit instead of comparing, since a processor cannot predict the three
      // branches.
      const double missing = threshold_[(levels >> k) & 1U] - seen;
      result |= (std::bit_cast<std::uint64_t>(missing) >> 63) << k;
    }
    return static_cast<std::uint8_t>(result);
  }

  /// Levels at the connector.
  [[nodiscard]] std::uint8_t signal(std::uint8_t levels) const {
    return static_cast<std::uint8_t>((levels ^ inversion_) & mask_);
  }

 private:
  std::array<base::SineCosine, 3> axis_{};  ///< electrical angle each sensor looks at
  std::array<double, 2> threshold_;         ///< above which a low and a high output is high
  std::uint8_t inversion_;
  std::uint8_t mask_;
};

}  // namespace stator::plant
