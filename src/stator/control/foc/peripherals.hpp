#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/signals.hpp"

namespace stator::control::foc {

/// Brake chopper with hysteresis on the raw motor supply (reading A-52): on from `high` upwards,
/// off below `low`; high = FFFFh switches it off.
class BrakeChopper {
 public:
  void configure(std::int32_t low, std::int32_t high) {
    low_ = low;
    high_ = high;
  }
  bool step(std::int32_t motor_supply) {
    constexpr std::int32_t kDisabled = 0xFFFF;
    on_ = high_ != kDisabled && (motor_supply >= high_ || (on_ && motor_supply >= low_));
    return on_;
  }
  [[nodiscard]] bool on() const { return on_; }

 private:
  std::int32_t low_ = 0xFFFF;
  std::int32_t high_ = 0xFFFF;
  bool on_ = false;
};

/// The three reference switches. REF_SWITCH_CONFIG: bits 0, 1, 2 make home, left, right active high
/// (they are active low after power-on, A-53); bits 4, 5, 6 let home, left, right keep the position
/// at which they become active. They stop nothing themselves.
class ReferenceSwitches {
 public:
  void configure(std::int32_t config) { config_ = static_cast<unsigned>(config); }

  void step(const Inputs& inputs, std::int32_t position) {
    const unsigned levels = (inputs.home_switch ? 1U : 0U) | (inputs.left_switch ? 2U : 0U) |
                            (inputs.right_switch ? 4U : 0U);
    const unsigned active = ~(levels ^ config_) & 7U;
    const unsigned entered = active & ~active_;
    active_ = active;
    if ((entered & (config_ >> 4U)) != 0) [[unlikely]] {
      keep(entered & (config_ >> 4U), position);
    }
  }

  /// Bits 0, 1, 2: home, left, right are active. Bits 4, 5, 6: their position has been kept.
  [[nodiscard]] unsigned status() const { return active_ | kept_ << 4U; }
  [[nodiscard]] std::int32_t home() const { return home_; }
  [[nodiscard]] std::int32_t left() const { return left_; }
  [[nodiscard]] std::int32_t right() const { return right_; }

 private:
  void keep(unsigned which, std::int32_t position) {
    kept_ |= which;
    home_ = (which & 1U) != 0 ? position : home_;
    left_ = (which & 2U) != 0 ? position : left_;
    right_ = (which & 4U) != 0 ? position : right_;
  }

  unsigned config_ = 0;
  unsigned active_ = 0;
  unsigned kept_ = 0;
  std::int32_t home_ = 0;
  std::int32_t left_ = 0;
  std::int32_t right_ = 0;
};

/// Target from one pin: AGPI_A or the duty of PWM_IN, as (in + offset) x scale / 256 (L1052, A-59).
/// With bit 0 of SINGLE_PIN_IF_CFG set, a PWM input outside of 20 Hz .. 20 kHz is neglected;
/// without any edge it always is. Then the position target stays and velocity and torque go to 0.
class SinglePinInterface {
 public:
  void configure(std::int32_t config, std::int32_t offset, std::int32_t scale) {
    checked_ = (config & 1) != 0;
    offset_ = offset;
    scale_ = scale;
  }

  /// Takes AGPI_A.
  void take(std::uint16_t analog) { set(analog); }
  /// Takes PWM_IN.
  void take(const PulseSignal& pulse) {
    constexpr std::uint32_t kShortest = 5'000;     // 20 kHz in ticks of 10 ns
    constexpr std::uint32_t kLongest = 5'000'000;  // 20 Hz
    const bool fits = pulse.period >= kShortest && pulse.period <= kLongest;
    valid_ = pulse.period != 0 && (fits || !checked_);
    if (!valid_) {
      value_ = 0;
      return;
    }
    const std::uint64_t duty = (std::uint64_t{pulse.high} << 16U) / pulse.period;
    duty_ = static_cast<std::uint16_t>(duty > 0xFFFFU ? 0xFFFFU : duty);
    set(duty_);
  }

  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] std::uint16_t duty() const { return duty_; }  ///< 65536 = 100 %
  [[nodiscard]] std::int32_t torque() const { return saturate_s16(value_); }
  [[nodiscard]] std::int32_t velocity() const { return value_; }
  [[nodiscard]] std::int32_t position() const { return position_; }

 private:
  void set(std::int32_t in) {
    valid_ = true;
    value_ = saturate_s32((std::int64_t{in} + offset_) * scale_ >> 8);
    position_ = value_;
  }

  bool checked_ = false;
  std::int32_t offset_ = 0;
  std::int32_t scale_ = 256;
  bool valid_ = false;
  std::uint16_t duty_ = 0;
  std::int32_t value_ = 0;
  std::int32_t position_ = 0;  ///< the last good one
};

/// Pseudo-random binary sequence of 2^15 - 1 steps (x^15 + x^14 + 1): +/- amplitude, each step held
/// for `ratio` + 1 periods.
class PseudoRandomSequence {
 public:
  void configure(std::int32_t amplitude, std::uint32_t ratio) {
    amplitude_ = amplitude;
    ratio_ = ratio;
  }
  std::int32_t step() {
    if (waited_ >= ratio_) {
      waited_ = 0;
      const unsigned bit = ((register_ >> 14U) ^ (register_ >> 13U)) & 1U;
      register_ = ((register_ << 1U) | bit) & 0x7FFFU;
    } else {
      ++waited_;
    }
    return (register_ & 1U) != 0 ? amplitude_ : -amplitude_;
  }

 private:
  std::int32_t amplitude_ = 0;
  std::uint32_t ratio_ = 0;
  std::uint32_t waited_ = 0;
  unsigned register_ = 0x7FFF;
};

}  // namespace stator::control::foc
