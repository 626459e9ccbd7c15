#include "stator/control/motion_controller/coil_current_selector.hpp"

namespace stator::control {

std::uint8_t CoilCurrentSelector::advance(const CoilCurrentSettings& settings, RampPhase phase,
                                          base::SimDuration duration) {
  if (phase == RampPhase::standstill) {
    standstill_ += duration;
    return standstill_ > settings.standby_delay ? settings.standby : settings.run;
  }
  standstill_ = base::SimDuration(0);
  const bool changes_speed = phase != RampPhase::constant_velocity;
  if (changes_speed && settings.boost > 0) {
    return settings.boost;
  }
  const int saved = 8 * settings.cool_step_reduction;
  return static_cast<std::uint8_t>(settings.run > saved ? settings.run - saved : 0);
}

}  // namespace stator::control
