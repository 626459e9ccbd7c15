#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "stator/plant/motors/two_body_thermal.hpp"

namespace stator::plant {

/// The form of the EMF over the electrical angle. It is 1 on the q axis and 0 on the d axis for a
/// sine; whatever it is, torque and EMF follow from the same form, so that their powers agree.
struct BackEmfShape {
  /// w of F = (1 - w) sine + w trapezoid: 0 for a sinusoidal motor, 1 for an ideal BLDC motor.
  double trapezoidal_share = 0.0;
  /// Electrical rad over which the trapezoid is flat, 0..pi; 2 pi / 3 for an ideal BLDC motor.
  double flat_top = 2.09439510239319549;
  double sixth_harmonic_d = 0.0;  ///< a6: the d axis gets a6 cos(6 theta)
  double sixth_harmonic_q = 0.0;  ///< b6: the q axis gets 1 + b6 cos(6 theta)

  [[nodiscard]] constexpr bool sinusoidal() const {
    return trapezoidal_share == 0.0 && sixth_harmonic_d == 0.0 && sixth_harmonic_q == 0.0;
  }
};

/// One harmonic of the cogging torque: amplitude * sin(order * electrical angle + phase). A motor
/// with the least common multiple N of slots and poles cogs with order N / p.
struct CoggingHarmonic {
  int order = 6;           ///< electrical, 1..24
  double amplitude = 0.0;  ///< N m; 0: none
  double phase = 0.0;      ///< rad
};

/// A permanent-magnet synchronous or brushless DC motor in star connection; per phase (line to
/// star point), amplitude-invariant transformation, SI units. At electrical angle 0 the magnet
/// points along phase U.
struct ThreePhaseMotorParameters {
  int pole_pairs = 4;                     ///< p
  double resistance = 0.36;               ///< R, ohm at 25 degree Celsius
  double direct_inductance = 0.6e-3;      ///< Ld, H; includes the mutual one
  double quadrature_inductance = 0.6e-3;  ///< Lq, H
  double flux_linkage = 5.2e-3;           ///< psi, V s per electrical radian (peak), at 25 C
  BackEmfShape back_emf;
  std::array<CoggingHarmonic, 2> cogging{};
  double rotor_inertia = 4.8e-6;    ///< J, kg m^2
  double viscous_friction = 1e-5;   ///< B, N m s/rad; eddy currents included
  double coulomb_friction = 3e-3;   ///< Tc, N m; hysteresis of the iron included
  double static_friction = 3.6e-3;  ///< Ts, N m, at least Tc
  double stribeck_speed = 0.5;      ///< rad/s at which half of Ts - Tc is left
  double rated_current = 3.47;      ///< A, amplitude (peak) of the current vector
  double rated_speed = 419.0;       ///< rad/s
  /// 1/K of the winding's resistance; copper.
  double resistance_coefficient = 0.00393;
  /// 1/K of the magnets' flux; neodymium, -0.002 for ferrite. Magnets are as warm as the housing.
  double flux_coefficient = -0.0011;
  ThermalParameters thermal;  ///< winding inside, housing outside

  /// Kt = 3/2 p psi, N m per A of the current's q component (peak).
  [[nodiscard]] constexpr double torque_constant() const { return 1.5 * pole_pairs * flux_linkage; }
};

/// How the torque constant of a sheet was measured.
enum class TorqueConstantKind {
  /// Line-to-line peak EMF per mechanical rad/s: psi = Kt / (sqrt(3) p).
  line_to_line_peak,
  /// Mean of block commutation, 30 / (pi kn) of a speed constant: psi = Kt pi / (3 sqrt(3) p).
  block_commutation,
};

/// One motor as its maker's sheet states it, in the sheet's units.
struct ThreePhaseMotorSheet {
  std::string_view name;
  int pole_pairs;
  double resistance;       ///< ohm, line to line: R is half of it
  double inductance;       ///< mH, line to line: L is half of it
  double torque_constant;  ///< mN m/A
  TorqueConstantKind torque_constant_kind;
  double rotor_inertia;                        ///< g cm^2
  double rated_current;                        ///< A
  double rated_speed;                          ///< rpm
  double viscous_friction;                     ///< mN m s/rad
  double coulomb_friction;                     ///< mN m
  double cogging_torque;                       ///< mN m
  int cogging_per_revolution;                  ///< least common multiple of slots and poles
  double mass;                                 ///< kg
  std::optional<ThermalParameters> thermal{};  ///< where the sheet has thermal data
};

/// The named motors.
[[nodiscard]] std::span<const ThreePhaseMotorSheet> three_phase_motor_sheets();

/// SI parameters of a sheet. Static friction is taken to be 1.2 times that of motion; a motor whose
/// sheet says nothing of heat gets that of insulation class B at rated current.
[[nodiscard]] ThreePhaseMotorParameters parameters_of(const ThreePhaseMotorSheet& sheet);

/// Parameters of the motor called `name` (exact spelling), or nothing.
[[nodiscard]] std::optional<ThreePhaseMotorParameters> find_three_phase_motor(
    std::string_view name);

}  // namespace stator::plant
