#include "control/coil_current_selector.hpp"

namespace stator::control {

std::uint8_t CoilCurrentSelector::advance(const CoilCurrentSettings& settings, RampPhase phase,
                                          base::SimDuration duration) {
  if (phase == RampPhase::standstill) {
    standstill_ += duration;
    return standstill_ > settings.standby_delay ? settings.standby : settings.run;
  }
  standstill_ = base::SimDuration(0);
  const bool changes_speed = phase != RampPhase::constant_velocity;
  return changes_speed && settings.boost > 0 ? settings.boost : settings.run;
}

}  // namespace stator::control
