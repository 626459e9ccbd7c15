#pragma once

#include <cmath>
#include <numbers>

#include "devices/drive_sequences/drive_under_test.hpp"
#include "devices/drive_sequences/recording.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/drive/motion/reference_switches.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"

namespace stator::tests {

/// What the plant of a servo axis does: a ServoAxis or a PwmAxis with `motor`, its `inertia` with
/// what is coupled to it, and switches read as `inputs` says.
template <typename Plant>
[[nodiscard]] Sample three_phase_sample(const Plant& plant, base::SimTime now,
                                        const plant::ThreePhaseMotorParameters& motor,
                                        double inertia, const Surroundings& surroundings,
                                        const drive::SwitchInputs& inputs) {
  const auto seen = plant.observe();
  const drive::SwitchStates pressed =
      inputs.pressed({plant.sensing().left_switch, plant.sensing().right_switch, false});
  Sample sample{.time = now,
                .position = seen.shaft_revolutions,
                .velocity = seen.speed / (2.0 * std::numbers::pi),
                .load = surroundings.load,
                .inertia = inertia + surroundings.inertia,
                .friction = motor.coulomb_friction,
                .supply = seen.supply_voltage,
                .source = surroundings.source,
                .supplied_energy = seen.supplied_energy,
                .jammed = surroundings.jammed};
  sample.current = std::hypot(seen.direct_current, seen.quadrature_current);
  sample.negative_switch = pressed.negative_limit;
  sample.positive_switch = pressed.positive_limit;
  return sample;
}

}  // namespace stator::tests
