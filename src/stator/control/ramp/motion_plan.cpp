#include "stator/control/ramp/motion_plan.hpp"

namespace stator::control {

namespace {

constexpr double kReferenceAge = 1.0;  // s; at 8 Mpps a double then still resolves 1e-9 microsteps

}  // namespace

void MotionPlan::rest(const MicrostepPosition& position) {
  cruise(position, 0.0);
}

void MotionPlan::cruise(const MicrostepPosition& position, double velocity) {
  append({.duration = kReferenceAge,
          .reference_position = position,
          .reference_velocity = velocity,
          .phase = velocity == 0.0 ? RampPhase::standstill : RampPhase::constant_velocity});
}

double MotionPlan::duration() const {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < size_; ++i) {
    sum += segments_[i].duration;
  }
  return sum;
}

}  // namespace stator::control
