// Axes driven by PWM with each kind of motor on an ideal supply, and duties as an ideal commutation
// gives them.
#pragma once

#include <cmath>
#include <variant>

#include "stator/base/sim_time.hpp"
#include "stator/base/trigonometry.hpp"
#include "stator/plant/axes/pwm_axis.hpp"

namespace stator::plant {

inline constexpr base::SimDuration kCommutationPeriod{20'000};

/// `motor` on an ideal source of 24 V.
inline PwmAxisParameters stiff(const MotorParameters& motor) {
  PwmAxisParameters p;
  p.motor = motor;
  p.supply = {.capacitance = 0.0, .source_resistance = 0.0};
  p.inverter.pwm_frequency = 50e3;
  return p;
}
inline PwmAxisParameters three_phase_axis() {
  return stiff(*find_three_phase_motor("QBL4208-61-04-013"));
}
inline PwmAxisParameters stepper_axis() {
  return stiff(*find_stepper_motor("QSH5718-55-30-098"));
}
inline PwmAxisParameters dc_axis() {
  return stiff(DcMotorParameters{});
}

/// Duties that put `volts` of 24 V across the magnets.
inline PwmActuation commutated(const PwmAxis& axis, double volts) {
  const base::SineCosine z = base::sine_cosine(axis.observe().electrical_angle);
  PwmActuation actuation{.bridge_enabled = true};
  const MotorParameters& motor = axis.parameters().motor;
  const double half = volts / 48.0;
  if (std::holds_alternative<ThreePhaseMotorParameters>(motor)) {
    const auto phases = phase_values({-volts * z.sine, volts * z.cosine});
    actuation.duty = {0.5 + phases[0] / 24.0, 0.5 + phases[1] / 24.0, 0.5 + phases[2] / 24.0};
  } else if (std::holds_alternative<StepperMotorParameters>(motor)) {
    actuation.duty = {0.5 - half * z.sine, 0.5 + half * z.sine, 0.5 + half * z.cosine,
                      0.5 - half * z.cosine};
  } else {
    actuation.duty = {0.5 + half, 0.5 - half};
  }
  return actuation;
}

/// Lets an ideal commutator put `volts` across the magnets.
inline void run(PwmAxis& axis, double seconds, double volts) {
  for (auto n = std::llround(seconds * 50e3); n > 0; --n) {
    axis.step(commutated(axis, volts), kCommutationPeriod);
  }
}

}  // namespace stator::plant
