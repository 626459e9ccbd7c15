#include "stator/drive/stepper/closed_loop_conditions.hpp"

#include <algorithm>

namespace stator::drive {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;

constexpr std::int64_t kMicrostepsPerFullStep = 256;  // of the motor's own coordinate
constexpr std::int64_t kCountsPerFullStep = 4;
constexpr std::int64_t kHighestResolution = std::int64_t{1} << 24;

// {0} axis, {1} 606Ah, {2} 608Fh:01, {3} lowest, {4} highest counts per revolution.
constexpr EventRule kNoEncoder{
    "closed-loop-no-encoder", Severity::refusal,
    "axis {0}: closed loop was switched on, but 606Ah is {1}, which selects no encoder; the axis "
    "stays in open loop until 606Ah is 0"};
constexpr EventRule kResolution{
    "closed-loop-encoder-resolution", Severity::refusal,
    "axis {0}: closed loop was switched on, but 608Fh:01 is {2} counts per revolution; from {3} (4 "
    "per full step) to {4} can commutate this motor; write the counts after quadrature evaluation"};
constexpr EventRule kNoGain{
    "closed-loop-no-gain", Severity::warning,
    "axis {0}: closed loop was switched on with a position gain (P) of 0: beyond the correction "
    "tolerance the current vector stands on the rotor and makes no torque; a gain of 65536 is 1"};
constexpr EventRule kTorqueNeedsClosedLoop{
    "torque-needs-closed-loop", Severity::refusal,
    "axis {0}: the target torque is ignored: mode 10 needs closed loop, switched on and "
    "initialised, for without it the angle between current and rotor is not known"};

}  // namespace

control::EncoderScale encoder_scale(const AxisObjects& objects, const StepperSettings& settings) {
  const unsigned resolution = std::min<unsigned>(settings.microstep_resolution, 8);
  return {.counts_per_revolution = std::max<std::int64_t>(1, objects.encoder_increments.get()),
          .steps_per_revolution =
              (settings.microsteps_per_revolution >> resolution) * kMicrostepsPerFullStep,
          .reversed = settings.encoder_reversed};
}

const EventRule* ClosedLoopConditions::problem(const AxisObjects& objects,
                                               const StepperSettings& settings) const {
  const control::EncoderScale scale = encoder_scale(objects, settings);
  const std::int64_t lowest =
      scale.steps_per_revolution / kMicrostepsPerFullStep * kCountsPerFullStep;
  if (!objects.uses_encoder()) {
    return &kNoEncoder;
  }
  if (lowest == 0 || scale.counts_per_revolution < lowest ||
      scale.counts_per_revolution > kHighestResolution) {
    return &kResolution;
  }
  return settings.closed_loop.position_gain == 0 ? &kNoGain : nullptr;
}

bool ClosedLoopConditions::fulfilled(const AxisObjects& objects, const StepperSettings& settings,
                                     base::SimTime now) {
  if (!settings.closed_loop.enabled) {
    reported_ = nullptr;
    return false;
  }
  const EventRule* rule = problem(objects, settings);
  if (rule != nullptr && rule != reported_) {
    const control::EncoderScale scale = encoder_scale(objects, settings);
    reporter_.report(
        now, *rule,
        {EventArgument(int{axis_}), EventArgument(int{objects.sensor_selection.get()}),
         EventArgument(std::int64_t{objects.encoder_increments.get()}),
         EventArgument(scale.steps_per_revolution / kMicrostepsPerFullStep * kCountsPerFullStep),
         EventArgument(kHighestResolution)});
  }
  reported_ = rule;
  return rule == nullptr || rule == &kNoGain;
}

void ClosedLoopConditions::explain_torque(bool missing, base::SimTime now) {
  if (missing && !torque_told_) {
    reporter_.report(now, kTorqueNeedsClosedLoop, {EventArgument(int{axis_})});
  }
  torque_told_ = missing;
}

}  // namespace stator::drive
