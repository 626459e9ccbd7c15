// What can be recorded of the axis and set around it.

#include <string>

#include "stator/base/trigonometry.hpp"
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

double MotionAxis::shaft_speed() const {
  return plant_.observe().speed / base::kTwoPi;
}

void MotionAxis::append_signals(std::vector<product::Signal>& signals) {
  const auto add = [&](const char* name, const char* unit, base::Delegate<double()> read) {
    signals.push_back({std::string("axis0.") + name, unit, read});
  };
  using Read = base::Delegate<double()>;
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
  add("shaft_position", "rev", Read::bind<&MotionAxis::shaft_position>(*this));
  add("shaft_speed", "rev/s", Read::bind<&MotionAxis::shaft_speed>(*this));
  add("coil_current_a", "A", Read::bind<&MotionAxis::coil_current_a>(*this));
  add("coil_current_b", "A", Read::bind<&MotionAxis::coil_current_b>(*this));
  add("torque", "Nm", Read::bind<&MotionAxis::torque>(*this));
  add("load_torque", "Nm", Read::bind<&MotionAxis::load_torque>(*this));
  add("load_angle", "rad", Read::bind<&MotionAxis::load_angle>(*this));
  add("supply_voltage", "V", Read::bind<&MotionAxis::supply_voltage>(*this));
  add("winding_temperature", "degC", Read::bind<&MotionAxis::winding_temperature>(*this));
  add("driver_temperature", "degC", Read::bind<&MotionAxis::driver_temperature>(*this));
}

void MotionAxis::append_inputs(std::vector<product::Input>& inputs) {
  const auto add = [&](const char* name, const char* unit, double minimum, double maximum,
                       base::Delegate<void(double)> set) {
    inputs.push_back({std::string("axis0.") + name, unit, minimum, maximum, set});
  };
  using Set = base::Delegate<void(double)>;
  add("load_torque", "Nm", -1000.0, 1000.0, Set::bind<&MotionAxis::set_load_torque>(*this));
  add("supply_voltage", "V", 0.0, 100.0, Set::bind<&MotionAxis::set_supply_voltage>(*this));
  add("left_switch", "", 0.0, 1.0, Set::bind<&MotionAxis::press_left_switch>(*this));
  add("right_switch", "", 0.0, 1.0, Set::bind<&MotionAxis::press_right_switch>(*this));
  add("home_switch", "", 0.0, 1.0, Set::bind<&MotionAxis::press_home_switch>(*this));
  add("ambient_temperature", "degC", -50.0, 200.0,
      Set::bind<&MotionAxis::set_ambient_temperature>(*this));
  add("open_a", "", 0.0, 1.0, Set::bind<&MotionAxis::set_phase_fault<&Faults::open, 0>>(*this));
  add("open_b", "", 0.0, 1.0, Set::bind<&MotionAxis::set_phase_fault<&Faults::open, 1>>(*this));
  add("short_a", "", 0.0, 1.0, Set::bind<&MotionAxis::set_phase_fault<&Faults::shorted, 0>>(*this));
  add("short_b", "", 0.0, 1.0, Set::bind<&MotionAxis::set_phase_fault<&Faults::shorted, 1>>(*this));
  add("short_high_side", "", 0.0, 1.0, Set::bind<&MotionAxis::set_high_side_short>(*this));
  add("encoder_counts_lost", "count", -1e6, 1e6, Set::bind<&MotionAxis::lose_counts>(*this));
  fault_inputs_.append(inputs, "axis0.");
}

}  // namespace stator::devices::tmcm_142
