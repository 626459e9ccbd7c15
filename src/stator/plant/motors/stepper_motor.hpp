#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "stator/plant/motors/two_body_thermal.hpp"

namespace stator::plant {

/// A two-phase hybrid stepper motor, per phase, SI units.
struct StepperMotorParameters {
  int pole_pairs = 50;              ///< rotor teeth p; 50 for 1.8 degree per full step
  double resistance = 0.8;          ///< R, ohm
  double inductance = 2.1e-3;       ///< L, H
  double flux_linkage = 4.62e-3;    ///< psi, V s per electrical radian (peak)
  double detent_torque = 0.030;     ///< Td, N m, amplitude of the fourth electrical harmonic
  double rotor_inertia = 2.09e-5;   ///< J, kg m^2
  double viscous_friction = 5e-4;   ///< B, N m s/rad
  double coulomb_friction = 2e-3;   ///< Tc, N m
  double static_friction = 2.4e-3;  ///< Ts, N m, at least Tc
  double stribeck_speed = 0.5;      ///< rad/s at which half of Ts - Tc is left
  double rated_current = 3.0;       ///< A rms per phase
  /// 1/K, of the winding's resistance, which is `resistance` at 25 degree Celsius; copper.
  double temperature_coefficient = 0.00393;
  ThermalParameters thermal;  ///< winding inside, housing outside

  /// Th = p psi I with the current vector at rated_current (I = sqrt(2) times the rms value), N m.
  [[nodiscard]] constexpr double holding_torque() const {
    return pole_pairs * flux_linkage * 1.41421356237309504880 * rated_current;
  }
};

/// One motor as its maker's sheet states it, in the sheet's units.
struct StepperMotorSheet {
  std::string_view name;
  int full_steps_per_revolution;
  double rated_current;   ///< A rms
  double resistance;      ///< ohm
  double inductance;      ///< mH
  double holding_torque;  ///< N m at rated current, both phases
  double detent_torque;   ///< N m
  double rotor_inertia;   ///< g cm^2
  double mass;            ///< kg
};

/// The named motors.
[[nodiscard]] std::span<const StepperMotorSheet> stepper_motor_sheets();

/// SI parameters of a sheet: psi = Th / (p sqrt(2) I_rms). Friction is not on the sheets; the
/// defaults are an estimate for ball bearings of NEMA 23 and 24 motors. At 3 A it leaves the rotor
/// at most one microstep of 1/256 from where the field puts it. Nor are thermal data: the winding
/// settles 80 K above the air at rated current (insulation class B), a quarter of that between
/// winding and housing; copper is 15 % of the mass.
[[nodiscard]] StepperMotorParameters parameters_of(const StepperMotorSheet& sheet);

/// Parameters of the motor called `name` (exact spelling), or nothing.
[[nodiscard]] std::optional<StepperMotorParameters> find_stepper_motor(std::string_view name);

}  // namespace stator::plant
