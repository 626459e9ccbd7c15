// What can be recorded of the axis.

#include <string>

#include "stator/control/motion_controller/motion_controller_units.hpp"
#include "stator/devices/tmcm_142/motion_axis.hpp"

namespace stator::devices::tmcm_142 {

using control::motion_controller::kVelocityUnit;

double MotionAxis::velocity() const {
  return controller_.velocity() * kVelocityUnit;
}

double MotionAxis::target_velocity() const {
  return controller_.target_velocity() * kVelocityUnit;
}

void MotionAxis::append_signals(std::vector<product::Signal>& signals) const {
  const auto add = [&](const char* name, const char* unit, base::SignalReader read) {
    signals.push_back({std::string("axis0.") + name, unit, read});
  };
  using Read = base::SignalReader;
  add("position_actual", "microstep", Read::bind<&MotionAxis::position>(*this));
  add("position_target", "microstep", Read::bind<&MotionAxis::target_position>(*this));
  add("velocity_actual", "pps", Read::bind<&MotionAxis::velocity>(*this));
  add("velocity_target", "pps", Read::bind<&MotionAxis::target_velocity>(*this));
  add("encoder_position", "microstep", Read::bind<&MotionAxis::encoder_position>(*this));
  add("encoder", "count", Read::bind<&MotionAxis::encoder_count>(*this));
  add("ramp_mode", "", Read::bind<&MotionAxis::ramp_mode>(*this));
  add("search_state", "", Read::bind<&MotionAxis::search_state>(*this));
  add("status_flags", "", Read::bind<&MotionAxis::status_flags>(*this));
  add("left_switch", "", Read::bind<&MotionAxis::left_switch>(*this));
  add("right_switch", "", Read::bind<&MotionAxis::right_switch>(*this));
  add("current_scale", "", Read::bind<&MotionAxis::current_scale>(*this));
  add("load_value", "", Read::bind<&MotionAxis::load_value>(*this));
  add("driver_error", "", Read::bind<&MotionAxis::driver_error>(*this));
  add("step_pulses", "", Read::bind<&MotionAxis::step_pulses>(*this));
  add("step_forward", "", Read::bind<&MotionAxis::step_forward>(*this));
  add("full_step_pulses", "", Read::bind<&MotionAxis::full_step_pulses>(*this));
  instruments_.append_signals(signals, "axis0.");
}

}  // namespace stator::devices::tmcm_142
