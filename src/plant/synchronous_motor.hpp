#pragma once

#include <array>
#include <cstdint>

#include "base/trigonometry.hpp"
#include "plant/cogging.hpp"
#include "plant/held_forcing.hpp"
#include "plant/mechanical_load.hpp"
#include "plant/shaft_angle.hpp"
#include "plant/shaft_mechanics.hpp"
#include "plant/three_phase_motor.hpp"

namespace stator::plant {

/// A vector in the stator frame: alpha along phase U.
struct StatorVector {
  double alpha = 0.0;
  double beta = 0.0;

  friend bool operator==(const StatorVector&, const StatorVector&) = default;
};

struct SynchronousMotorState {
  StatorVector current;                  ///< A
  double speed = 0.0;                    ///< rad/s, mechanical; exactly 0 while the shaft sticks
  ElectricalAngle angle;                 ///< p times the shaft angle
  base::SineCosine direction{0.0, 1.0};  ///< of `angle`, carried along

  [[nodiscard]] double direct_current() const {  ///< id, A
    return direction.cosine * current.alpha + direction.sine * current.beta;
  }
  [[nodiscard]] double quadrature_current() const {  ///< iq, A
    return direction.cosine * current.beta - direction.sine * current.alpha;
  }
  void set_current(double direct, double quadrature) {
    current = {direction.cosine * direct - direction.sine * quadrature,
               direction.sine * direct + direction.cosine * quadrature};
  }

  friend bool operator==(const SynchronousMotorState& a, const SynchronousMotorState& b) {
    return a.current == b.current && a.speed == b.speed && a.angle == b.angle &&
           a.direction.sine == b.direction.sine && a.direction.cosine == b.direction.cosine;
  }
};

/// Amplitude-invariant Clarke transformation; what the three have in common drops out.
[[nodiscard]] constexpr StatorVector stator_vector(double u, double v, double w) {
  constexpr double kInverseSquareRootOfThree = 0.57735026918962576451;
  return {(2.0 * u - v - w) * (1.0 / 3.0), (v - w) * kInverseSquareRootOfThree};
}

/// Its inverse: the values of the phases, whose sum is 0.
[[nodiscard]] constexpr std::array<double, 3> phase_values(const StatorVector& vector) {
  constexpr double kHalfSquareRootOfThree = 0.86602540378443864676;
  const double half = 0.5 * vector.alpha;
  const double side = kHalfSquareRootOfThree * vector.beta;
  return {vector.alpha, side - half, -side - half};
}

/// Which windings can carry current.
enum class WindingConnection : std::uint8_t { all, without_u, without_v, without_w, none };

/// What acts on motor and shaft during one step.
struct SynchronousMotorInput {
  StatorVector voltage{};  ///< V at the phases, held over the step
  WindingConnection connection = WindingConnection::all;
  double series_resistance = 0.0;  ///< ohm of the transistors in each phase
  double torque = 0.0;             ///< N m on the shaft from outside, positive = forward
  bool brake_engaged = false;
};

/// Three-phase permanent-magnet motor in star connection with its load, in coordinates of the
/// rotor; we = p w, th = electrical angle:
///   Ld did/dt = ud - R id + we Lq iq - we psi fd(th)
///   Lq diq/dt = uq - R iq - we Ld id - we psi fq(th)
///   Te = 3/2 p (psi (fd id + fq iq) + (Ld - Lq) id iq)
///   J dw/dt = Te + Tcogging(th) - Tfriction(w) - B w + Tload,  dth/dt = we    (ShaftMechanics)
/// (fd, fq) is the form of the EMF: (0, 1) for a sine. With an open phase k the voltage across it
/// is the one that keeps ik at 0.
///
/// Integrated by fourth-order Runge-Kutta with the voltage held in the stator frame; the stages
/// turn it by small rotations, of which one is computed from a series and the others derived from
/// it.
class SynchronousMotor {
 public:
  SynchronousMotor(const ThreePhaseMotorParameters& motor, const MechanicalLoad& load);

  /// Advances `state` by `h` seconds; fastest_rate(state, h) * h must not exceed 0.33 rad. Returns
  /// the mean power the terminals took, W.
  double step(SynchronousMotorState& state, const SynchronousMotorInput& input, double h);

  /// The fastest of R/L, p |w|, and an end stop within reach in `h` seconds, rad/s. While this
  /// times the step is at most 0.33 the error stays below 1e-4 of rated values; it falls with the
  /// fourth power of the step.
  [[nodiscard]] double fastest_rate(const SynchronousMotorState& state, double h) const;

  /// Standing with no current at `revolutions`.
  [[nodiscard]] SynchronousMotorState at(double revolutions) const;
  /// Computes state.direction anew: rounding errors of the small rotations do not add up.
  static void refresh_direction(SynchronousMotorState& state) {
    state.direction = base::sine_cosine(state.angle.angle);
  }

  /// EMF of the phases against the star point, V.
  [[nodiscard]] std::array<double, 3> back_emf(const SynchronousMotorState& state) const;
  /// Upper limit of the EMF between two lines, V.
  [[nodiscard]] double largest_line_to_line_emf(const SynchronousMotorState& state) const;
  [[nodiscard]] double electromagnetic_torque(const SynchronousMotorState& state) const;  ///< N m
  [[nodiscard]] double cogging_torque(const SynchronousMotorState& state) const {         ///< N m
    return cogging_.around(state.direction).torque;
  }

  [[nodiscard]] const ShaftMechanics& shaft() const { return shaft_; }
  [[nodiscard]] const ThreePhaseMotorParameters& motor() const { return motor_; }
  /// Resistance and flux from now on: a winding and a magnet get warm (degree Celsius).
  void set_temperatures(double winding, double magnets);
  [[nodiscard]] double resistance() const { return resistance_; }      ///< ohm, now
  [[nodiscard]] double flux_linkage() const { return flux_linkage_; }  ///< V s, now

 private:
  struct Form;
  struct Slope;
  struct Stage;
  double step_at_rest(SynchronousMotorState& state, const SynchronousMotorInput& input, double h);
  double step_in_stator_frame(SynchronousMotorState& state, const SynchronousMotorInput& input,
                              const ShaftMechanics::Frozen& frozen, double h);
  /// The weights for a step of `h` with `series_resistance` in the phases.
  const HeldForcing& forcing(double h, double series_resistance);
  template <WindingConnection kConnection>
  double integrate(SynchronousMotorState& state, const SynchronousMotorInput& input,
                   const ShaftMechanics::Frozen& frozen, double h, bool resting) const;
  /// Takes over where a step leads: turned by `angle` electrical rad to `direction`.
  void arrive(SynchronousMotorState& state, const ShaftMechanics::Frozen& frozen, double speed,
              double angle, const base::SineCosine& direction, double h) const;
  [[nodiscard]] Form form(double angle, const base::SineCosine& direction) const;

  ThreePhaseMotorParameters motor_;
  ShaftMechanics shaft_;
  Cogging cogging_;
  double pole_pairs_;
  double inverse_pole_pairs_;
  double inverse_direct_inductance_;
  double inverse_quadrature_inductance_;
  double saliency_;      ///< Ld - Lq, H
  double inverse_ramp_;  ///< 1/rad, slope of the EMF's trapezoid
  bool shaped_;          ///< the EMF is not sinusoidal
  bool simple_;          ///< neither shaped nor salient
  double mobility_;      ///< torque into electrical acceleration, 1/(kg m^2)
  double damping_;       ///< 1/s
  double free_rate_;     ///< fastest_rate at speed 0 away from end stops, rad/s
  double stopped_rate_;  ///< and at one
  double resistance_;
  double flux_linkage_;
  double flux_rate_;      ///< psi / Ld, A
  double flux_mobility_;  ///< 3/2 p psi times mobility, 1/(A s^2)
  HeldForcing forcing_;   ///< of the latest step; derived from its length and the resistance
};

}  // namespace stator::plant
