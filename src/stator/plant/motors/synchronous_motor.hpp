#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/mechanics/rotation.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"
#include "stator/plant/mechanics/shaft_mechanics.hpp"
#include "stator/plant/motors/cogging.hpp"
#include "stator/plant/motors/held_voltage.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"

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

/// What a step of a motor that turns freely calculates with.
struct FreeTurn {
  double pole_pairs;
  double rate;                ///< R / L, 1/s; transistors included
  double inverse_inductance;  ///< 1/H
  double flux_current;        ///< psi / L, A
  double mobility;            ///< torque into electrical acceleration, 1/(kg m^2)
  double flux_mobility;       ///< 3/2 p psi times mobility, 1/(A s^2)
  double damping;             ///< 1/s
  double free_rate;           ///< the fastest rate at speed 0, rad/s
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
/// The usual case, turns_freely(), is solved in the stator frame (HeldVoltage) with the torque of
/// begin and end and its derivatives; everything else is integrated by fourth-order Runge-Kutta
/// with the voltage held in the stator frame: the stages turn it by small rotations, of which one
/// is computed from a series and the others derived from it.
class SynchronousMotor {
 public:
  SynchronousMotor(const ThreePhaseMotorParameters& motor, const MechanicalLoad& load);

  /// Advances `state` by `h` seconds; fastest_rate(state, h) * h must not exceed 0.33 rad. Returns
  /// the mean power the terminals took, W.
  double step(SynchronousMotorState& state, const SynchronousMotorInput& input, double h);

  /// Whether nothing but the motor itself acts on the turning shaft and all its windings conduct;
  /// with an EMF that is sinusoidal and no saliency.
  [[nodiscard]] bool turns_freely(const SynchronousMotorState& state,
                                  const SynchronousMotorInput& input) const {
    return may_turn_freely() && state.speed != 0.0 && input.connection == WindingConnection::all;
  }
  /// The part of it that never changes.
  [[nodiscard]] bool may_turn_freely() const { return simple_ && !shaft_.depends_on_position(); }
  /// step() of a motor that turns freely. Inline, for the period of a servo axis is hardly anything
  /// else.
  double turn(SynchronousMotorState& state, const SynchronousMotorInput& input, double h);

  /// The fastest of R/L, p |w|, and an end stop within reach in `h` seconds, rad/s. While this
  /// times the step is at most 0.33 the error stays below 1e-4 of rated values; it falls with the
  /// fourth power of the step.
  [[nodiscard]] double fastest_rate(const SynchronousMotorState& state, double h) const {
    const double rate = shaft_.has_end_stops() ? rate_by_end_stops(state, h) : free_rate_;
    return std::max(rate, std::fabs(state.speed) * pole_pairs_);
  }

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

  /// The weights for a step of `h` with `series_resistance` ohm in the phases.
  const HeldVoltage& held_voltage(double h, double series_resistance) {
    if (held_voltage_.step != h || held_voltage_.series_resistance != series_resistance)
        [[unlikely]] {
      renew_held_voltage(h, series_resistance);
    }
    return held_voltage_;
  }
  /// What else such a step needs.
  [[nodiscard]] FreeTurn free_turn(double series_resistance) const {
    return {.pole_pairs = pole_pairs_,
            .rate = (resistance_ + series_resistance) * inverse_direct_inductance_,
            .inverse_inductance = inverse_direct_inductance_,
            .flux_current = flux_current_,
            .mobility = mobility_,
            .flux_mobility = flux_mobility_,
            .damping = damping_,
            .free_rate = free_rate_};
  }
  [[nodiscard]] const ShaftMechanics& shaft() const { return shaft_; }
  [[nodiscard]] const Cogging& cogging() const { return cogging_; }
  [[nodiscard]] const ThreePhaseMotorParameters& motor() const { return motor_; }
  /// Resistance and flux from now on: a winding and a magnet get warm (degree Celsius).
  void set_temperatures(double winding, double magnets);
  /// What is on the shaft from now on.
  void set_load(const MechanicalLoad& load);
  [[nodiscard]] double resistance() const { return resistance_; }      ///< ohm, now
  [[nodiscard]] double flux_linkage() const { return flux_linkage_; }  ///< V s, now

 private:
  struct Form;
  struct Slope;
  struct Stage;
  template <WindingConnection kConnection>
  struct RotorFrame;
  /// Where a step of turn() leads if the speed stays what it is: nothing in it waits for a torque.
  /// Currents along (direct) and across (quadrature) the magnets at begin and end, A; the voltage
  /// across them (forward), and along them at the end (outward), V.
  struct EvenTurn {
    double x;  ///< electrical rad
    base::SineCosine direction;
    StatorVector current;
    double direct0;
    double direct1;
    double quadrature0;
    double quadrature1;
    double forward0;
    double forward1;
    double outward1;
  };
  /// What torque adds to it.
  struct Gain {
    double speed;  ///< electrical rad/s
    double angle;  ///< electrical rad
  };
  [[nodiscard]] EvenTurn turn_evenly(const SynchronousMotorState& state, const StatorVector& u,
                                     const HeldVoltage& held, double w0, double h) const;
  [[nodiscard]] Gain gain(const SynchronousMotorState& state, const SynchronousMotorInput& input,
                          const EvenTurn& even, const HeldVoltage& held, double w0, double h) const;
  double step_at_rest(SynchronousMotorState& state, const SynchronousMotorInput& input, double h);
  void renew_held_voltage(double h, double series_resistance);
  [[nodiscard]] double rate_by_end_stops(const SynchronousMotorState& state, double h) const;
  /// Corrects a step that ended with the shaft turning the other way.
  void settle(SynchronousMotorState& state, const ShaftMechanics::Frozen& frozen,
              double speed_before, double h) const;
  template <WindingConnection kConnection>
  double integrate(SynchronousMotorState& state, const SynchronousMotorInput& input,
                   const ShaftMechanics::Frozen& frozen, double h, bool resting) const;
  /// Takes over where a step leads: turned by `angle` electrical rad to `direction`.
  void arrive(SynchronousMotorState& state, const ShaftMechanics::Frozen& frozen, double speed,
              double angle, const base::SineCosine& direction, double h) const;
  [[nodiscard]] static double survivable(double speed) {
    return std::clamp(speed, -kHighestSpeed, kHighestSpeed);
  }
  [[nodiscard]] Form form(double angle, const base::SineCosine& direction) const;

  /// rad/s; no shaft of this kind survives it. Speed is cut here so that a torque set by mistake
  /// cannot make the number of steps, or the numbers, grow without bound.
  static constexpr double kHighestSpeed = 1e4;

  ThreePhaseMotorParameters motor_;
  ShaftMechanics shaft_;
  Cogging cogging_;
  double pole_pairs_;
  double inverse_pole_pairs_;
  double inverse_direct_inductance_;
  double inverse_quadrature_inductance_;
  double saliency_;            ///< Ld - Lq, H
  double inverse_ramp_;        ///< 1/rad, slope of the EMF's trapezoid
  bool shaped_;                ///< the EMF is not sinusoidal
  bool simple_;                ///< neither shaped nor salient
  double mobility_ = 0.0;      ///< torque into electrical acceleration, 1/(kg m^2)
  double damping_ = 0.0;       ///< 1/s
  double free_rate_ = 0.0;     ///< fastest_rate at speed 0 away from end stops, rad/s
  double stopped_rate_ = 0.0;  ///< and at one
  double resistance_;
  double flux_linkage_;
  double flux_current_;         ///< psi / L, A
  double flux_mobility_ = 0.0;  ///< 3/2 p psi times mobility, 1/(A s^2)
  HeldVoltage held_voltage_;  ///< of the latest step; follows from its length and the temperatures
};

[[gnu::always_inline]] inline SynchronousMotor::EvenTurn SynchronousMotor::turn_evenly(
    const SynchronousMotorState& state, const StatorVector& u, const HeldVoltage& held, double w0,
    double h) const {
  const base::SineCosine z = state.direction;
  const StatorVector i0 = state.current;
  const auto along = [](const base::SineCosine& axis, const StatorVector& vector) {
    return axis.cosine * vector.alpha + axis.sine * vector.beta;
  };
  const auto across = [](const base::SineCosine& axis, const StatorVector& vector) {
    return axis.cosine * vector.beta - axis.sine * vector.alpha;
  };
  EvenTurn even{};
  even.x = h * w0;
  even.direction = sum(z, small_turn(even.x));
  const base::SineCosine& z1 = even.direction;
  const double square = even.x * even.x;
  const double both = square * (held.square + square * held.fourth);
  const double by_begin = held.from_begin + both;
  const double by_end = held.from_end + both;
  even.current = {
      (held.decay * i0.alpha + held.gain * u.alpha) + (by_begin * z.cosine + by_end * z1.cosine),
      (held.decay * i0.beta + held.gain * u.beta) + (by_begin * z.sine + by_end * z1.sine)};
  even.direct0 = along(z, i0);
  even.direct1 = along(z1, even.current);
  even.quadrature0 = across(z, i0);
  even.quadrature1 = across(z1, even.current);
  even.forward0 = across(z, u);
  even.forward1 = across(z1, u);
  even.outward1 = along(z1, u);
  return even;
}

[[gnu::always_inline]] inline SynchronousMotor::Gain SynchronousMotor::gain(
    const SynchronousMotorState& state, const SynchronousMotorInput& input, const EvenTurn& even,
    const HeldVoltage& held, double w0, double h) const {
  const double x = even.x;
  const double quadrature =
      (held.mean_begin * even.quadrature0 + held.mean_end * even.quadrature1) +
      held.twelfth * (inverse_direct_inductance_ * (even.forward0 - even.forward1) +
                      w0 * (even.direct1 - even.direct0));
  const NearbyCogging cogging =
      std::fabs(x) < cogging_.reach() ? cogging_.around(state.direction) : NearbyCogging();
  const double sign = state.speed > 0.0 ? 1.0 : -1.0;
  const double outside = shaft_.load().constant_torque + input.torque;
  const double steady = outside - sign * shaft_.coulomb_friction(input.brake_engaged);
  double rise = 0.0;
  if (shaft_.creeps(state.speed)) {
    rise = sign * shaft_.stribeck_friction(state.speed);
  }
  const double drag = damping_ * w0;
  const double gained = h * ((flux_mobility_ * even.quadrature0 - drag) +
                             mobility_ * ((steady - rise) + cogging.torque));
  const double rising =
      (inverse_direct_inductance_ * even.forward0 - held.rate * even.quadrature0) -
      w0 * (flux_current_ + even.direct0);
  const double bend = held.bend * (flux_mobility_ * rising + mobility_ * cogging.slope * w0);
  if (shaft_.creeps(state.speed)) {
    rise = sign * shaft_.stribeck_friction((w0 + 0.5 * gained) * inverse_pole_pairs_);
  }

  // What the speed gained takes from the current, and so from the torque.
  const double push = h * flux_mobility_;
  const double opposition =
      push * ((held.opposition + held.opposition_by_direct * even.direct1) -
              held.opposition_by_rise *
                  (w0 * even.quadrature1 + inverse_direct_inductance_ * even.outward1)) +
      0.5 * h * damping_;
  const double evenly =
      push * quadrature + h * (mobility_ * ((steady - rise) + cogging.mean(x)) - drag);
  const double speed = evenly - gained * opposition;
  // A cubic through both speeds with the first two derivatives at the begin.
  return {.speed = speed, .angle = held.quarter * (speed + gained) + bend};
}

[[gnu::always_inline]] inline double SynchronousMotor::turn(SynchronousMotorState& state,
                                                            const SynchronousMotorInput& input,
                                                            double h) {
  const HeldVoltage& held = held_voltage(h, input.series_resistance);
  const StatorVector i0 = state.current;
  const StatorVector u = input.voltage;
  const double speed_before = state.speed;
  const double w0 = speed_before * pole_pairs_;
  const EvenTurn even = turn_evenly(state, u, held, w0, h);
  const Gain gained = gain(state, input, even, held, w0, h);

  const base::SineCosine& z1 = even.direction;
  const double further = gained.angle;
  const double shift = held.yield * further;
  const double lift = further * (0.5 * flux_current_ * further + held.lift * even.x);
  state.current = {even.current.alpha + (shift * z1.sine + lift * z1.cosine),
                   even.current.beta - (shift * z1.cosine - lift * z1.sine)};
  const double shorter = 1.0 - 0.5 * further * further;
  state.direction = {shorter * z1.sine + further * z1.cosine,
                     shorter * z1.cosine - further * z1.sine};
  const double w1 = w0 + gained.speed;
  state.speed = survivable(w1 * inverse_pole_pairs_);
  state.angle = turned(state.angle, even.x + further);
  const double sign = speed_before > 0.0 ? 1.0 : -1.0;
  if (state.speed * sign < 0.0) [[unlikely]] {
    ShaftMechanics::Frozen frozen = shaft_.freeze(state.angle, input.torque, input.brake_engaged);
    frozen.friction_sign = sign;
    settle(state, frozen, speed_before, h);
  }
  const double mean_alpha = held.mean_begin * i0.alpha + held.mean_end * state.current.alpha;
  const double mean_beta = held.mean_begin * i0.beta + held.mean_end * state.current.beta;
  return 1.5 * ((u.alpha * mean_alpha + u.beta * mean_beta) +
                held.twelfth * flux_current_ * (w1 * even.forward1 - w0 * even.forward0));
}

}  // namespace stator::plant
