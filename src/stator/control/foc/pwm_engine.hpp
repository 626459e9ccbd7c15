#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "stator/control/foc/register_file.hpp"
#include "stator/control/foc/signals.hpp"
#include "stator/control/foc/transforms.hpp"

namespace stator::control::foc {

/// MOTOR_TYPE.
enum class MotorType : std::uint8_t {
  none = 0,
  direct_current = 1,
  two_phase = 2,
  three_phase = 3
};

/// Moments of one half bridge within a period, in ticks of 10 ns from its begin: the high side
/// conducts in [high_on, high_off), the low side outside of [low_off, low_on). Two moments out of
/// order mean that the switch does not conduct at all.
struct GateTimes {
  std::int32_t high_on = 0;
  std::int32_t high_off = 0;
  std::int32_t low_off = 0;
  std::int32_t low_on = 0;
};

/// Turns voltages into on-times. 100 MHz count up to PWM_MAXCNT: f = 100 MHz / (MAXCNT + 1)
/// (reading A-51), 25 kHz after power-on, 100 kHz at 999.
///
/// 32768 is full modulation: half the supply in each phase without space-vector modulation, 1/sqrt
/// 3 of it with, and the whole supply across a full bridge. On-times are rounded to the nearest
/// tick (0.5 ticks of error, 0.52 with space-vector modulation) and stay within 0..period.
class PwmEngine {
 public:
  void configure(const RegisterFile& registers);

  [[nodiscard]] std::int32_t period() const { return settings_.period; }
  [[nodiscard]] MotorType motor() const { return motor_; }
  /// Gates switch at all.
  [[nodiscard]] bool chopping() const { return settings_.chopper >= Chopper::low_side; }

  /// Three-phase motor; u, v, w from inverse_clarke().
  void set(const PhaseVector& u) {
    if (space_vector_) {
      const std::int32_t largest = std::max(std::max(u.u, u.v), u.w);
      const std::int32_t smallest = std::min(std::min(u.u, u.v), u.w);
      const std::int32_t centre = largest + smallest;  // twice the common part
      next_ = {on_time_space_vector(2 * u.u - centre), on_time_space_vector(2 * u.v - centre),
               on_time_space_vector(2 * u.w - centre), 0};
    } else {
      next_ = {on_time(u.u), on_time(u.v), on_time(u.w), 0};
    }
    shortest_ = std::min(std::min(next_[0], next_[1]), next_[2]);
    longest_ = std::max(std::max(next_[0], next_[1]), next_[2]);
  }
  /// Two full bridges, X and Y.
  void set(const StatorVector& u) {
    next_ = {on_time(u.a), on_time(-u.a), on_time(u.b), on_time(-u.b)};
    shortest_ = std::min(std::min(next_[0], next_[1]), std::min(next_[2], next_[3]));
    longest_ = std::max(std::max(next_[0], next_[1]), std::max(next_[2], next_[3]));
  }
  /// One full bridge, X.
  void set(std::int32_t u) {
    next_ = {on_time(u), on_time(-u), 0, 0};
    shortest_ = std::min(next_[0], next_[1]);
    longest_ = std::max(next_[0], next_[1]);
  }

  /// The period that begins now: with what was set before, at the rate valid now.
  void begin(PwmPeriod& pwm) const {
    pwm = settings_;
    pwm.on_time = next_;
  }
  /// On-times set for the next period.
  [[nodiscard]] const std::array<std::int32_t, 4>& next() const { return next_; }
  /// One of the half bridges in use is at an end of its range.
  [[nodiscard]] bool at_minimum() const { return shortest_ == 0; }
  [[nodiscard]] bool at_maximum() const { return longest_ == settings_.period; }

  /// When the switches of a half bridge (0..3: U/X1, V/X2, W/Y1, Y2) conduct in a period: the
  /// switch that comes on waits for the pause of its side.
  [[nodiscard]] static GateTimes gate_times(const PwmPeriod& pwm, unsigned half_bridge);
  /// Levels of the gate outputs at `tick` of the period: bit 2k the low, 2k + 1 the high side of
  /// half bridge k, as OUTPUTS_RAW shows them, with the polarities of PWM_POLARITIES.
  [[nodiscard]] std::uint8_t gate_levels(const PwmPeriod& pwm, bool enabled,
                                         std::int32_t tick) const;

 private:
  [[nodiscard]] std::int32_t within(std::int64_t ticks) const {
    return static_cast<std::int32_t>(cut(ticks, 0, settings_.period));
  }
  [[nodiscard]] std::int32_t on_time(std::int32_t u) const {
    return within(rounded_shift(std::int64_t{settings_.period} * (u + 32768), 16));
  }
  /// `twice` is twice the voltage without the common part.
  [[nodiscard]] std::int32_t on_time_space_vector(std::int32_t twice) const {
    constexpr std::int64_t kInverseSqrt3Q24 = 9686330;
    constexpr std::int64_t kHalf = std::int64_t{1} << 39;
    return within(
        rounded_shift(std::int64_t{settings_.period} * (twice * kInverseSqrt3Q24 + kHalf), 40));
  }

  PwmPeriod settings_;
  MotorType motor_ = MotorType::none;
  bool space_vector_ = false;
  std::uint8_t low_polarity_ = 0;
  std::uint8_t high_polarity_ = 0;
  std::array<std::int32_t, 4> next_{};
  std::int32_t shortest_ = 0;  ///< of those in use
  std::int32_t longest_ = 0;
};

}  // namespace stator::control::foc
