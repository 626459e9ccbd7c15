#pragma once

#include <array>
#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/signals.hpp"

namespace stator::control::foc {

/// HALL_MODE, positions and offsets.
struct HallSettings {
  bool inverted = false;      ///< HALL_POLARITY: all three levels
  bool interpolated = false;  ///< HALL_INTERPOLATION
  bool reversed = false;      ///< HALL_DIRECTION
  std::int32_t blanking = 0;  ///< 10 ns after each edge of the power stage (HALL_MASKING)
  std::int32_t filter = 0;    ///< 5 us a level must stand to pass (HALL_DIG_FILTER)
  std::array<std::int32_t, 6> position{0, 0x2AAA, 0x5555, -0x8000, -0x5556, -0x2AAB};  ///< s16
  std::int32_t phi_m_offset = 0;
  std::int32_t phi_e_offset = 0;
  std::int32_t largest_interpolation = 0x2AAA;  ///< HALL_DPHI_MAX
  std::int32_t pole_pairs = 1;
};

/// Digital Hall sensors (L658-L681, reading A-41). Levels UX, V, WY forward:
///   001  011  010  110  100  101    at    0  60  120  180  240  300 degrees
/// with bit 0 = UX; 000 and 111 keep the last angle.
///
/// Interpolated, the angle runs on from the border between two sectors at the speed of the last
/// complete sector, by HALL_DPHI_MAX at most, while the shaft turns at 60 rpm or faster. Inputs are
/// looked at once per PWM period, so edges lie up to one period late. At constant speed the
/// interpolated angle is within one period's turn (and the spread of the sectors) of the true one.
class HallDecoder {
 public:
  void configure(const HallSettings& settings);

  /// `ticks` of 10 ns have passed; `pwm` is the period that ended.
  void step(std::uint8_t levels, const PwmPeriod& pwm, std::int32_t ticks) {
    if (levels != raw_) {
      raw_ = levels;
      stable_ = 0;
    } else if (stable_ < filter_ticks_) {
      stable_ += ticks;
    }
    since_edge_ = since_edge_ < kLongest ? since_edge_ + ticks : since_edge_;
    if (raw_ != filtered_ && stable_ >= filter_ticks_ && !masked(pwm)) {
      accept(raw_);
    }
    if (active_) {
      interpolate();
    }
  }

  [[nodiscard]] std::uint8_t filtered() const { return filtered_; }
  /// HALL_PHI_E: electrical angle with offset, in steps of 60 degrees. s16
  [[nodiscard]] std::int32_t phi_e() const { return phi_e_; }
  /// HALL_PHI_E_INTERPOLATED; equals phi_e() while interpolation rests or is off. s16
  [[nodiscard]] std::int32_t phi_e_interpolated() const { return interpolated_; }
  /// Electrical angle for commutation: which of the two HALL_INTERPOLATION chooses.
  [[nodiscard]] std::int32_t phi_e_used() const {
    return settings_.interpolated ? interpolated_ : phi_e_;
  }
  /// HALL_PHI_M: electrical revolutions counted since power-on, divided by the pole pairs. s16
  [[nodiscard]] std::int32_t phi_m() const { return phi_m_; }
  /// Interpolation is at work.
  [[nodiscard]] bool interpolating() const { return active_; }
  /// Sectors entered so far, modulo 2^32.
  [[nodiscard]] std::uint32_t edges() const { return edges_; }
  /// Angle (s16, with offset) of the border crossed last.
  [[nodiscard]] std::int32_t border() const { return border_; }

 private:
  static constexpr std::int64_t kLongest = 1'000'000'000;  ///< 10 s

  /// No moment of that period was free of switching long enough for a level to pass.
  [[nodiscard]] bool masked(const PwmPeriod& pwm) const {
    return settings_.blanking != 0 && longest_calm(pwm) <= settings_.blanking;
  }
  [[nodiscard]] static std::int32_t longest_calm(const PwmPeriod& pwm);
  void accept(std::uint8_t levels);
  void enter(int sector);
  void interpolate();
  void update_mechanical();
  [[nodiscard]] std::int32_t placed(std::int32_t position) const {
    return wrap_s16((settings_.reversed ? -position : position) + settings_.phi_e_offset);
  }

  HallSettings settings_;
  std::int64_t filter_ticks_ = 0;
  std::int64_t slowest_sector_ = 16'666'666;  ///< 10 ns per sector at 60 rpm
  std::uint8_t raw_ = 7;
  std::uint8_t filtered_ = 7;
  std::int64_t stable_ = 0;  ///< 10 ns, counted up to the filter's time only
  int sector_ = -1;          ///< 0..5; -1: none seen yet
  std::int64_t since_edge_ = kLongest;
  int direction_ = 0;           ///< of the latest edge
  std::int64_t increment_ = 0;  ///< angle per tick, 2^32 = one LSB
  std::int32_t border_ = 0;
  std::int32_t phi_e_ = 0;
  std::int32_t interpolated_ = 0;
  std::int32_t phi_m_ = 0;
  bool active_ = false;
  std::uint32_t edges_ = 0;
  std::int64_t turned_ = 0;  ///< electrical angle since power-on, not wrapped, of phi_e_
};

}  // namespace stator::control::foc
