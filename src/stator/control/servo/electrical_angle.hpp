#pragma once

#include <array>
#include <cstdint>

#include "stator/base/trigonometry.hpp"

namespace stator::control {

/// An angle of the motor's electrical period: 2^32 = one turn, so that adding wraps as angles do.
/// Objects show the upper half, 65536 to the turn. 0: the rotor's flux (d axis) along phase U;
/// positive angles from U to V to W.
struct ElectricalAngle {
  std::uint32_t value = 0;

  [[nodiscard]] static constexpr ElectricalAngle of_object(std::int16_t value) {
    return {static_cast<std::uint32_t>(static_cast<std::uint16_t>(value)) << 16};
  }
  /// 65536 = one turn, two's complement: -32768..32767.
  [[nodiscard]] constexpr std::int16_t object_value() const {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(value >> 16));
  }
  friend constexpr ElectricalAngle operator+(ElectricalAngle a, ElectricalAngle b) {
    return {a.value + b.value};
  }
  friend constexpr ElectricalAngle operator-(ElectricalAngle a, ElectricalAngle b) {
    return {a.value - b.value};
  }
  friend constexpr bool operator==(ElectricalAngle, ElectricalAngle) = default;
};

inline constexpr ElectricalAngle kSixthTurn{715'827'883};  // rounded to the nearest
inline constexpr ElectricalAngle kTwelfthTurn{357'913'941};

/// Turns (any number, |turns| < 2^31) as an angle.
[[nodiscard]] constexpr ElectricalAngle angle_of_turns(double turns) {
  return {static_cast<std::uint32_t>(static_cast<std::int64_t>(turns * 4294967296.0))};
}

/// Sine and cosine of the 256 angles n / 256 turn.
struct SineTable {
  static const std::array<base::SineCosine, 256> entries;
};

/// Sine and cosine from a table of 256 entries and a second-order step from the nearest one. Error
/// below 3.1e-7, a hundredth of a bit of Q15; same bits everywhere.
[[nodiscard]] inline base::SineCosine sine_cosine(ElectricalAngle angle) {
  constexpr double kRadian = base::kTwoPi / 4294967296.0;
  const std::uint32_t nearest = angle.value + 0x0080'0000U;
  const base::SineCosine& entry = SineTable::entries[nearest >> 24];
  const double x =
      static_cast<double>(static_cast<std::int32_t>((nearest & 0x00FF'FFFFU) - 0x0080'0000U)) *
      kRadian;
  const double loss = 1.0 - 0.5 * (x * x);
  return {entry.sine * loss + entry.cosine * x, entry.cosine * loss - entry.sine * x};
}

}  // namespace stator::control
