#include "stator/devices/tmcm_142/driver_stage.hpp"

#include <algorithm>

namespace stator::devices::tmcm_142 {

namespace {

using drive::AxisError;
using drive::AxisErrors;

constexpr double kClock = 16e6;        // Hz
constexpr double kBlankTime = 0.7e-6;  // s, in which the driver cannot end a pulse
constexpr AxisErrors kShorts{AxisError::overcurrent_a, AxisError::overcurrent_b,
                             AxisError::overcurrent_high_side};
constexpr AxisErrors kDriverErrors{AxisError::overcurrent_a, AxisError::overcurrent_b,
                                   AxisError::overcurrent_high_side, AxisError::over_temperature,
                                   AxisError::undervoltage};

constexpr double kSmallestEmf = 0.3;      // V, below which there is no load to be measured
constexpr double kMeasurementEmf = 10.0;  // V, with which a measurement uses its whole range

/// What the load measurement is to see: the share of the EMF that the load leaves unused, whatever
/// the speed.
base::AxisSensing normalised(const base::AxisSensing& sensing) {
  base::AxisSensing measured = sensing;
  const double amplitude =
      sensing.induced_voltage < 0.0 ? -sensing.induced_voltage : sensing.induced_voltage;
  const double gain = amplitude < kSmallestEmf ? 0.0 : kMeasurementEmf / amplitude;
  measured.induced_voltage *= gain;
  measured.converted_power *= gain;
  return measured;
}

double with_minimum(double target, double minimum) {
  if (target > 0.0) {
    return std::max(target, minimum);
  }
  return target < 0.0 ? std::min(target, -minimum) : 0.0;
}

}  // namespace

DriverStage::DriverStage() {
  settings_.full_scale_current = kFullScaleCurrent;
  settings_.driver.limits.undervoltage = kMinimumSupply;
}

base::AxisActuation DriverStage::advance(const StageInput& input, const base::AxisSensing& sensing,
                                         base::SimDuration period) {
  base::AxisActuation actuation;
  actuation.bridge_enabled = input.enabled && !overvoltage_;
  const double current = kFullScaleCurrent * std::min(input.scale, kFullScale) / kFullScale;
  actuation.coil_current_target = {input.phases[0] * current, input.phases[1] * current};
  const bool mixed_decay = input.standing ? input.mixed_decay_standby : input.mixed_decay_run;
  if (!mixed_decay) {
    const double duty = kBlankTime * kClock / input.chopper_divider;
    const double minimum = duty * sensing.supply_voltage / input.resistance;
    for (double& target : actuation.coil_current_target) {
      target = with_minimum(target, std::min(minimum, current));
    }
  }
  chip_.advance(settings_, input.full_steps_per_second, actuation, normalised(sensing));
  since_supervision_ += period;
  since_retry_ += period;
  if (since_supervision_ >= kSupervisionPeriod) {
    since_supervision_ = base::SimDuration();
    supervise(sensing);
  }
  return actuation;
}

void DriverStage::supervise(const base::AxisSensing& sensing) {
  overvoltage_ = sensing.supply_voltage > kMaximumSupply;
  chip_.supervise(settings_.driver.limits);
  const AxisErrors flags = chip_.flags() & kDriverErrors;
  // A short is shown until an attempt has gone well for the whole time between two of them.
  shown_ = since_retry_ < kRetryTime ? flags | (shown_ & kShorts) : flags;
  if (since_retry_ >= kRetryTime && flags.any_of(kShorts)) {
    since_retry_ = base::SimDuration();
    chip_.clear_shorts();
  }
  error_ = overvoltage_ || !shown_.empty();
}

}  // namespace stator::devices::tmcm_142
