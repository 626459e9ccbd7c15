#include "drive/torque_mode.hpp"

#include "drive/control_words.hpp"

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
  const std::int64_t milliamperes =
      context.objects.target_torque.get() + context.objects.torque_offset.get();
  target_ = static_cast<double>(milliamperes) * 1e-3;
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

}  // namespace stator::drive
