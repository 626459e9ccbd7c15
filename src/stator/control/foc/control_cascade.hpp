#pragma once

#include <cstdint>

#include "stator/control/foc/biquad.hpp"
#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/peripherals.hpp"
#include "stator/control/foc/pi_controller.hpp"
#include "stator/control/foc/register_file.hpp"
#include "stator/control/foc/transforms.hpp"

namespace stator::control::foc {

/// The outermost loop a motion mode closes.
enum class Loop : std::uint8_t { stopped, voltage, mini_move, torque, velocity, position };

/// Where a motion mode takes its target from.
enum class TargetSource : std::uint8_t { registers, noise_flux, noise, analog_pin, pwm_pin };

/// What MODE_MOTION means (motion modes of L1041-L1052; numbers of A-38).
struct MotionMode {
  Loop loop = Loop::stopped;
  TargetSource source = TargetSource::registers;
};
/// A number without a mode stops.
[[nodiscard]] MotionMode motion_mode(std::int32_t number);

/// Targets at the input of the cascade.
struct Targets {
  std::int32_t torque = 0;    ///< s16
  std::int32_t flux = 0;      ///< s16
  std::int32_t velocity = 0;  ///< rpm
  std::int32_t position = 0;  ///< 65536 per revolution
};

/// Derivative of a target, times a gain of 2^-16, through a first-order filter whose constant is a
/// share of 65536 per evaluation; 0 does not filter.
class FeedForward {
 public:
  void configure(std::int32_t gain, std::uint32_t filter) {
    gain_ = gain;
    filter_ = filter == 0 || filter > 0x10000U ? 0x10000 : static_cast<std::int32_t>(filter);
  }
  /// `change` of the target since the latest evaluation.
  std::int32_t step(std::int32_t change) {
    const std::int64_t wanted = std::int64_t{change} * gain_;  // 2^-16
    value_ +=
        ((wanted - value_) >> 16) * filter_ + ((((wanted - value_) & 0xFFFF) * filter_) >> 16);
    return saturate_s32(value_ >> 16);
  }
  void reset() { value_ = 0; }

 private:
  std::int32_t gain_ = 0;
  std::int32_t filter_ = 0x10000;
  std::int64_t value_ = 0;  ///< 2^-16
};

/// Position P(I) over velocity PI over torque and flux PI, with filters, limits, offsets and
/// feed-forward. For each controller: target, filter, limit, plus offset, minus actual, PI, limit
/// (A-04; L998). Velocity and position are evaluated in every (MODE_PID_SMPL + 1)-th period.
class ControlCascade {
 public:
  void configure(const RegisterFile& registers);
  /// Starts anew: integrals, filters and feed-forward forget.
  void reset(const Targets& targets);
  /// The same for velocity and position only.
  void reset_outer(const Targets& targets);

  /// Velocity and position loops, if this period is theirs; `loop` is velocity or position.
  void step_outer(Loop loop, const Targets& targets, std::int32_t velocity, std::int32_t position,
                  std::int32_t ticks);
  /// Torque and flux loops: voltages for the currents. `outer`: the torque target is that of
  /// step_outer().
  [[nodiscard]] RotorVector step_inner(bool outer, const Targets& targets,
                                       const RotorVector& current, std::int32_t ticks);
  /// Only the torque loop, for motors without a flux axis.
  [[nodiscard]] std::int32_t step_torque(bool outer, const Targets& targets, std::int32_t current,
                                         std::int32_t ticks);

  /// Target words at the input of each controller, and after filter, limit and offset.
  [[nodiscard]] const Targets& input() const { return input_; }
  [[nodiscard]] const Targets& limited() const { return limited_; }
  [[nodiscard]] const PiController<8>& torque() const { return torque_; }
  [[nodiscard]] const PiController<8>& flux() const { return flux_; }
  [[nodiscard]] const PiController<8>& velocity() const { return velocity_; }
  [[nodiscard]] const PiController<12>& position() const { return position_; }
  [[nodiscard]] std::int32_t velocity_feed_forward() const { return ahead_velocity_; }
  [[nodiscard]] std::int32_t torque_feed_forward() const { return ahead_torque_; }
  /// Bits 0..15 of STATUS_FLAGS, of the latest evaluation.
  [[nodiscard]] std::uint32_t flags() const {
    return (position_clipped_ | position_.state().clipped) << field("PID_X_TARGET_LIMIT").low |
           (velocity_clipped_ | velocity_.state().clipped) << field("PID_V_TARGET_LIMIT").low |
           (flux_axis_.clipped | flux_.state().clipped) << field("PID_ID_TARGET_LIMIT").low |
           (torque_axis_.clipped | torque_.state().clipped) << field("PID_IQ_TARGET_LIMIT").low;
  }

 private:
  /// Everything between a current target and its error.
  struct CurrentTarget {
    Biquad filter;
    std::int32_t offset = 0;
    std::int32_t slewed = 0;
    std::uint32_t clipped = 0;
  };

  static constexpr std::uint8_t kVelocityAhead = 1;  ///< of MODE_FF
  static constexpr std::uint8_t kTorqueAhead = 2;

  [[nodiscard]] std::int32_t prepared(CurrentTarget& axis, std::int32_t target) const;
  void step_velocity(std::int32_t target, std::int32_t velocity, std::int64_t ticks);
  [[nodiscard]] std::int32_t outer_torque(bool outer, const Targets& targets) const {
    return outer ? torque_target_ : targets.torque;
  }

  PiController<8> torque_;
  PiController<8> flux_;
  PiController<8> velocity_;
  PiController<12> position_;
  CurrentTarget torque_axis_;
  CurrentTarget flux_axis_;
  Biquad position_filter_;
  FeedForward velocity_ahead_;
  FeedForward torque_ahead_;
  std::uint8_t feed_forward_ = 0;  ///< MODE_FF
  std::uint8_t decimation_ = 1;
  std::uint8_t waited_ = 0;
  std::int32_t current_limit_ = kS16Max;
  std::int64_t rate_limit_ = 0;
  std::int64_t velocity_limit_ = 0;
  std::int32_t velocity_offset_ = 0;
  std::int32_t position_low_ = 0;
  std::int32_t position_high_ = 0;
  std::int64_t waited_ticks_ = 0;
  std::int32_t last_position_target_ = 0;
  std::int32_t last_velocity_target_ = 0;
  std::int32_t ahead_velocity_ = 0;
  std::int32_t ahead_torque_ = 0;
  std::int32_t torque_target_ = 0;
  std::uint32_t velocity_clipped_ = 0;
  std::uint32_t position_clipped_ = 0;
  Targets input_;
  Targets limited_;
};

// Inline, for one PWM period after the other goes through all of it.

inline void ControlCascade::step_outer(Loop loop, const Targets& targets, std::int32_t velocity,
                                       std::int32_t position, std::int32_t ticks) {
  const std::int32_t wanted =
      loop == Loop::position ? position_filter_.step(targets.position) : targets.position;
  waited_ticks_ += ticks;
  if (waited_ != 0) {
    --waited_;
    return;
  }
  waited_ = static_cast<std::uint8_t>(decimation_ - 1);
  const std::int64_t passed = waited_ticks_;
  waited_ticks_ = 0;
  std::int32_t velocity_target = targets.velocity;
  if (loop == Loop::position) {
    input_.position = targets.position;
    const auto target = static_cast<std::int32_t>(cut(wanted, position_low_, position_high_));
    position_clipped_ = target != wanted ? kTargetClipped : 0;
    limited_.position = target;
    const std::int32_t error = wrap_s32(std::int64_t{target} - position);
    velocity_target = position_.step(error, passed);
    if ((feed_forward_ & kVelocityAhead) != 0) {
      ahead_velocity_ =
          velocity_ahead_.step(wrap_s32(std::int64_t{target} - last_position_target_));
      velocity_target = saturate_s32(std::int64_t{velocity_target} + ahead_velocity_);
    }
    last_position_target_ = target;
  }
  step_velocity(velocity_target, velocity, passed);
}

inline void ControlCascade::step_velocity(std::int32_t target, std::int32_t velocity,
                                          std::int64_t ticks) {
  input_.velocity = target;
  std::int64_t limited = target;
  velocity_clipped_ = 0;
  if (!within(limited, velocity_limit_)) [[unlikely]] {
    limited = limited < 0 ? -velocity_limit_ : velocity_limit_;
    velocity_clipped_ = kTargetClipped;
  }
  const std::int32_t wanted = saturate_s32(limited + velocity_offset_);
  limited_.velocity = wanted;
  torque_target_ = velocity_.step(saturate_s32(std::int64_t{wanted} - velocity), ticks);
  if ((feed_forward_ & kTorqueAhead) != 0) {
    ahead_torque_ = saturate_s16(
        torque_ahead_.step(saturate_s32(std::int64_t{wanted} - last_velocity_target_)));
    torque_target_ = saturate_s16(std::int64_t{torque_target_} + ahead_torque_);
  }
  last_velocity_target_ = wanted;
}

inline std::int32_t ControlCascade::prepared(CurrentTarget& axis, std::int32_t target) const {
  std::int64_t wanted = axis.filter.step(target);
  axis.clipped = 0;
  if (!within(wanted - axis.slewed, rate_limit_)) [[unlikely]] {
    wanted = axis.slewed + (wanted < axis.slewed ? -rate_limit_ : rate_limit_);
    axis.clipped = kRateClipped;
  }
  axis.slewed = static_cast<std::int32_t>(wanted);
  if (!within(wanted, current_limit_)) [[unlikely]] {
    wanted = wanted < 0 ? -current_limit_ : current_limit_;
    axis.clipped |= kTargetClipped;
  }
  return static_cast<std::int32_t>(wanted) + axis.offset;
}

inline RotorVector ControlCascade::step_inner(bool outer, const Targets& targets,
                                              const RotorVector& current, std::int32_t ticks) {
  input_.flux = targets.flux;
  limited_.flux = prepared(flux_axis_, targets.flux);
  const std::int32_t ud = flux_.step(saturate_s16(limited_.flux - current.d), ticks);
  return {ud, step_torque(outer, targets, current.q, ticks)};
}

inline std::int32_t ControlCascade::step_torque(bool outer, const Targets& targets,
                                                std::int32_t current, std::int32_t ticks) {
  input_.torque = outer_torque(outer, targets);
  limited_.torque = prepared(torque_axis_, input_.torque);
  return torque_.step(saturate_s16(limited_.torque - current), ticks);
}

}  // namespace stator::control::foc
