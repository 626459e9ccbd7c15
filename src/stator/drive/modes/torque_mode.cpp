#include "stator/drive/modes/torque_mode.hpp"

#include <cmath>

#include "stator/drive/power/control_words.hpp"

namespace stator::drive {

void CyclicTorque::start(const ModeContext& context) {
  target_ = 0.0;
  period_ = base::SimDuration(0);
  on_target(context);
}

void CyclicTorque::on_target(const ModeContext& context) {
  from_ = interpolated(context.now);
  since_ = context.now;
  period_ = context.objects.interpolation_period();
  target_ = context.settings.torque_of(context.objects.target_torque.get() +
                                       context.objects.torque_offset.get());
}

void CyclicTorque::halt(const ModeContext& context) {
  if (context.settings.behaviour.stops_release_torque) {
    context.motion.apply_torque(0.0);
  } else {
    OperatingMode::halt(context);
  }
}

double CyclicTorque::interpolated(base::SimTime now) const {
  const base::SimDuration passed = now - since_;
  return passed >= period_ ? target_
                           : from_ + (target_ - from_) * (passed.seconds() / period_.seconds());
}

void CyclicTorque::tick(const ModeContext& context) {
  if (context.enabled && context.closed_loop) {
    context.motion.apply_torque(interpolated(context.now));
  }
}

std::uint16_t CyclicTorque::status(const ModeContext& context) const {
  return context.enabled && context.motion.torque() ? statusword::kTargetUsed : std::uint16_t{0};
}

void ProfileTorque::start(const ModeContext& context) {
  demand_ = 0.0;
  since_ = context.now;
}

double ProfileTorque::target(const ModeContext& context) const {
  return context.settings.torque_of(context.objects.target_torque.get());
}

void ProfileTorque::tick(const ModeContext& context) {
  if (!context.enabled || !context.closed_loop) {
    return;
  }
  const double slope = static_cast<double>(context.objects.torque_slope.get()) *
                       context.settings.torque_unit.amperes;
  const double way = target(context) - demand_;
  const double step = slope * (context.now - since_).seconds();
  since_ = context.now;
  demand_ =
      slope <= 0.0 || std::fabs(way) <= step ? target(context) : demand_ + std::copysign(step, way);
  context.motion.apply_torque(demand_);
}

std::uint16_t ProfileTorque::status(const ModeContext& context) const {
  const bool reached =
      context.halted ? context.ready && context.motion.stands()
                     : context.enabled && context.motion.torque() && demand_ == target(context);
  return reached ? statusword::kTargetReached : std::uint16_t{0};
}

}  // namespace stator::drive
