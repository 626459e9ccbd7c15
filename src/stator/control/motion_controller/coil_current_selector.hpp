#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/control/ramp/motion_plan.hpp"

namespace stator::control {

/// Current settings of an open-loop stepper axis, each 0..255 with 255 = 100 % of the module.
struct CoilCurrentSettings {
  std::uint8_t run = 128;    ///< while the set-point moves (2003h)
  std::uint8_t standby = 8;  ///< at standstill after the delay (2004h)
  std::uint8_t boost = 0;    ///< while it gains or loses speed (204Eh); 0 = use run
  base::SimDuration standby_delay{2'000'000'000};  ///< standstill before standby (2089h * 10 ms)
  std::uint8_t cool_step_reduction = 0;  ///< steps of 8 that CoolStep takes from the run current
};

/// Chooses between run, boost and standby current.
class CoilCurrentSelector {
 public:
  /// Lets `duration` pass in which the set-point was in `phase`; returns the setting that holds
  /// now.
  std::uint8_t advance(const CoilCurrentSettings& settings, RampPhase phase,
                       base::SimDuration duration);
  /// Starts the delay anew, as a drive does when its bridge is switched on.
  void reset() { standstill_ = base::SimDuration(0); }

 private:
  base::SimDuration standstill_;
};

/// Fraction of the module's full-scale current the driver chip makes of a setting of 0..255: 32
/// current scales CS = setting / 8, (CS + 1) / 32.
[[nodiscard]] constexpr double current_fraction(std::uint8_t setting) {
  return static_cast<double>((setting >> 3U) + 1) / 32.0;
}

}  // namespace stator::control
