#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/control/motion_controller/motion_controller_settings.hpp"

namespace stator::control::motion_controller {

/// The chip's PID position regulator (easyPID): a velocity from the difference of encoder and
/// microstep position, which is added to that of the ramp, so that the sequencer moves until the
/// encoder shows the position that the ramp asks for. Integers only; quotients go towards zero.
/// Every 8 us:
///   e      = pid_e; 0 from an exact hit on, while |e| < tolerance, and isum = 0 then
///   isum  += e, |isum| <= integral_clip * 65536                                     (A30, A31)
///   d_part = clip(e_last - e, 127) * d, every d_divider-th time                     (A32)
///   result = clip(-(e p / 256) - ((isum / 256) i / 256) + d_part, velocity_clip)    (A28)
/// each part within +-2^31.
///
/// The error is told once per control period and taken as going there in a straight line from the
/// one told before, so the regulator is one control period late; within it, every update is exact.
class PositionRegulator {
 public:
  void configure(const RegulatorSettings& settings);

  /// Lets `period` pass, at whose begin the error is `error` (encoder minus microsteps, as 32-bit
  /// difference).
  void advance(std::int32_t error, base::SimDuration period);
  /// Forgets history and sum; the correction made so far stays.
  void reset();
  /// While paused the regulator is off whatever AP 40 says; the error is still told.
  void pause(bool paused);
  /// AP 34 is written.
  void clear_sum() { sum_ = 0; }

  /// AP 38: clipped to 24 bits.
  [[nodiscard]] std::int32_t error() const { return error_; }
  /// AP 34.
  [[nodiscard]] std::int32_t sum() const { return static_cast<std::int32_t>(sum_); }
  /// Velocity to be added to the ramp's, in the chip's units, since the latest update.
  [[nodiscard]] std::int32_t result() const { return static_cast<std::int32_t>(result_); }
  /// What the regulator has moved the sequencer by, in 2^-23 microsteps: one unit of velocity for
  /// 8 us.
  [[nodiscard]] std::int64_t correction() const { return correction_; }
  static constexpr int kCorrectionBits = 23;

 private:
  void update(std::int64_t error);
  void repeat_update(std::int64_t count);
  void update_many(std::int32_t before, std::int64_t count);

  RegulatorSettings settings_;
  std::int64_t sum_limit_ = 0;
  std::int64_t d_divider_ = 256;
  std::int32_t error_ = 0;
  base::SimDuration since_update_;
  std::int64_t sum_ = 0;
  std::int64_t to_d_update_ = 1;  ///< updates until the next of the D part
  std::int64_t last_error_ = 0;   ///< at the latest of these
  std::int64_t d_part_ = 0;
  std::int64_t result_ = 0;
  std::int64_t correction_ = 0;
  bool hit_ = false;
  bool paused_ = false;
};

}  // namespace stator::control::motion_controller
