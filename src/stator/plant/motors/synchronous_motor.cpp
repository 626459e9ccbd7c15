#include "stator/plant/motors/synchronous_motor.hpp"

#include <algorithm>
#include <cmath>

namespace stator::plant {

namespace {

constexpr double kSquareRootOfThree = 1.73205080756887729353;

/// Trapezoid with the zeros and the sign of sin(angle).
double trapezoid(double angle, double inverse_ramp) {
  constexpr double kRounder = 0x1.8p52;
  const double turns = (angle * (1.0 / base::kTwoPi) + kRounder) - kRounder;
  const double x = angle - turns * base::kTwoPi;  // -pi..pi
  const double magnitude = std::fabs(x);
  const double from_zero = std::min(magnitude, base::kPi - magnitude);
  return std::copysign(std::min(from_zero * inverse_ramp, 1.0), x);
}

/// Unit vector of the axis of the phase that `connection` leaves out.
base::SineCosine open_axis(WindingConnection connection) {
  constexpr double kHalfSquareRootOfThree = 0.5 * kSquareRootOfThree;
  switch (connection) {
    case WindingConnection::without_v:
      return {kHalfSquareRootOfThree, -0.5};
    case WindingConnection::without_w:
      return {-kHalfSquareRootOfThree, -0.5};
    default:
      return {0.0, 1.0};
  }
}

RotorMechanics rotor_of(const ThreePhaseMotorParameters& motor) {
  return {.inertia = motor.rotor_inertia,
          .viscous_friction = motor.viscous_friction,
          .coulomb_friction = motor.coulomb_friction,
          .static_friction = motor.static_friction,
          .stribeck_speed = motor.stribeck_speed,
          .pole_pairs = motor.pole_pairs};
}

}  // namespace

/// EMF per electrical rad/s and flux linkage on the axes of the rotor.
struct SynchronousMotor::Form {
  double d = 0.0;
  double q = 1.0;
};

struct SynchronousMotor::Slope {
  double d;      ///< A/s
  double q;      ///< A/s
  double speed;  ///< electrical rad/s^2
};

/// Where a stage of the integration looks: currents, electrical speed, and the turn since the step
/// began.
struct SynchronousMotor::Stage {
  double d;
  double q;
  double speed;
};

SynchronousMotor::SynchronousMotor(const ThreePhaseMotorParameters& motor,
                                   const MechanicalLoad& load)
    : motor_(motor),
      shaft_(rotor_of(motor), load),
      cogging_(motor.cogging),
      pole_pairs_(motor.pole_pairs),
      inverse_pole_pairs_(1.0 / motor.pole_pairs),
      inverse_direct_inductance_(1.0 / motor.direct_inductance),
      inverse_quadrature_inductance_(1.0 / motor.quadrature_inductance),
      saliency_(motor.direct_inductance - motor.quadrature_inductance),
      inverse_ramp_(1.0 / std::max(0.5 * (base::kPi - motor.back_emf.flat_top), 0.01)),
      shaped_(!motor.back_emf.sinusoidal()),
      simple_(!shaped_ && saliency_ == 0.0),
      resistance_(motor.resistance),
      flux_linkage_(motor.flux_linkage),
      flux_current_(flux_linkage_ * inverse_direct_inductance_) {
  set_load(load);
}

void SynchronousMotor::set_load(const MechanicalLoad& load) {
  shaft_ = ShaftMechanics(rotor_of(motor_), load);
  mobility_ = pole_pairs_ * shaft_.inverse_inertia();
  damping_ = shaft_.viscous_friction() * shaft_.inverse_inertia();
  flux_mobility_ = mobility_ * (1.5 * pole_pairs_) * flux_linkage_;
  // With the voltage held in the stator frame the field holds the rotor like a spring.
  const double stiffness = pole_pairs_ * motor_.torque_constant() * motor_.rated_current +
                           pole_pairs_ * cogging_.stiffness();
  const double electrical =
      motor_.resistance / std::min(motor_.direct_inductance, motor_.quadrature_inductance);
  free_rate_ = std::max(electrical, shaft_.fastest_rate(stiffness, false));
  stopped_rate_ = std::max(electrical, shaft_.fastest_rate(stiffness, true));
}

void SynchronousMotor::set_temperatures(double winding, double magnets) {
  constexpr double kSheetTemperature = 25.0;
  resistance_ =
      motor_.resistance * (1.0 + motor_.resistance_coefficient * (winding - kSheetTemperature));
  flux_linkage_ =
      motor_.flux_linkage * (1.0 + motor_.flux_coefficient * (magnets - kSheetTemperature));
  flux_current_ = flux_linkage_ * inverse_direct_inductance_;
  flux_mobility_ = mobility_ * (1.5 * pole_pairs_) * flux_linkage_;
  held_voltage_ = {};
}

double SynchronousMotor::rate_by_end_stops(const SynchronousMotorState& state, double h) const {
  constexpr double kNear = 1e-3;  // mechanical rad
  const double reach = std::fabs(state.speed) * h + kNear;
  return shaft_.near_end_stop(state.angle, reach) ? stopped_rate_ : free_rate_;
}

SynchronousMotorState SynchronousMotor::at(double revolutions) const {
  SynchronousMotorState state;
  state.angle = shaft_.angle_at(revolutions);
  refresh_direction(state);
  return state;
}

SynchronousMotor::Form SynchronousMotor::form(double angle,
                                              const base::SineCosine& direction) const {
  constexpr double kThird = base::kTwoPi / 3.0;
  const BackEmfShape& emf = motor_.back_emf;
  Form result{0.0, 1.0};
  if (emf.trapezoidal_share != 0.0) {
    // Forward, the EMF of phase k is that of the flux cos(th - k 2 pi/3), falling.
    const StatorVector flat =
        stator_vector(-trapezoid(angle, inverse_ramp_), -trapezoid(angle - kThird, inverse_ramp_),
                      -trapezoid(angle + kThird, inverse_ramp_));
    const double d = direction.cosine * flat.alpha + direction.sine * flat.beta;
    const double q = direction.cosine * flat.beta - direction.sine * flat.alpha;
    result.d = emf.trapezoidal_share * d;
    result.q += emf.trapezoidal_share * (q - 1.0);
  }
  if (emf.sixth_harmonic_d != 0.0 || emf.sixth_harmonic_q != 0.0) {
    const double sixth = multiple(direction, 6).cosine;
    result.d += emf.sixth_harmonic_d * sixth;
    result.q += emf.sixth_harmonic_q * sixth;
  }
  return result;
}

double SynchronousMotor::electromagnetic_torque(const SynchronousMotorState& state) const {
  const Form f = shaped_ ? form(state.angle.angle, state.direction) : Form{};
  const double direct = state.direct_current();
  const double quadrature = state.quadrature_current();
  return 1.5 * pole_pairs_ *
         (flux_linkage_ * (f.d * direct + f.q * quadrature) + saliency_ * direct * quadrature);
}

std::array<double, 3> SynchronousMotor::back_emf(const SynchronousMotorState& state) const {
  const Form f = shaped_ ? form(state.angle.angle, state.direction) : Form{};
  const base::SineCosine& z = state.direction;
  const double amplitude = flux_linkage_ * state.speed * pole_pairs_;
  return phase_values(
      {amplitude * (z.cosine * f.d - z.sine * f.q), amplitude * (z.sine * f.d + z.cosine * f.q)});
}

double SynchronousMotor::largest_line_to_line_emf(const SynchronousMotorState& state) const {
  const BackEmfShape& emf = motor_.back_emf;
  const double form = 1.0 + 0.16 * emf.trapezoidal_share + std::fabs(emf.sixth_harmonic_d) +
                      std::fabs(emf.sixth_harmonic_q);
  return kSquareRootOfThree * form * flux_linkage_ * std::fabs(state.speed) * pole_pairs_;
}

void SynchronousMotor::arrive(SynchronousMotorState& state, const ShaftMechanics::Frozen& frozen,
                              double speed, double angle, const base::SineCosine& direction,
                              double h) const {
  const double speed_before = state.speed;
  state.speed = survivable(speed);
  state.angle = turned(state.angle, angle);
  state.direction = normalised(direction);
  if (state.speed * frozen.friction_sign < 0.0) [[unlikely]] {
    settle(state, frozen, speed_before, h);
  }
}

void SynchronousMotor::settle(SynchronousMotorState& state, const ShaftMechanics::Frozen& frozen,
                              double speed_before, double h) const {
  shaft_.settle(state.speed, state.angle, frozen, speed_before, h);
  refresh_direction(state);
}

void SynchronousMotor::renew_held_voltage(double h, double series_resistance) {
  held_voltage_ =
      HeldVoltage(h, motor_.direct_inductance, resistance_ + series_resistance, flux_linkage_);
  held_voltage_.series_resistance = series_resistance;
}

double SynchronousMotor::step_at_rest(SynchronousMotorState& state,
                                      const SynchronousMotorInput& input, double h) {
  const HeldVoltage& held = held_voltage(h, input.series_resistance);
  const StatorVector before = state.current;
  const StatorVector& u = input.voltage;
  // The field stands: phi - k z is the current, and no EMF acts on it.
  state.current = {held.decay * before.alpha + held.gain * u.alpha,
                   held.decay * before.beta + held.gain * u.beta};
  return 1.5 * (u.alpha * (held.mean_begin * before.alpha + held.mean_end * state.current.alpha) +
                u.beta * (held.mean_begin * before.beta + held.mean_end * state.current.beta));
}

/// The equations in the rotor's frame during one step that begins at `state`.
template <WindingConnection kConnection>
struct SynchronousMotor::RotorFrame {
  static constexpr bool kOneOpen = kConnection == WindingConnection::without_u;

  RotorFrame(const SynchronousMotor& of, const SynchronousMotorState& state,
             const SynchronousMotorInput& input, const ShaftMechanics::Frozen& during, double h,
             bool resting)
      : motor(of),
        frozen(during),
        z(state.direction),
        angle(state.angle.angle),
        ud0(z.cosine * input.voltage.alpha + z.sine * input.voltage.beta),
        uq0(z.cosine * input.voltage.beta - z.sine * input.voltage.alpha),
        axis(kOneOpen ? open_axis(input.connection) : base::SineCosine{}),
        axis_d0(z.cosine * axis.cosine + z.sine * axis.sine),
        axis_q0(z.cosine * axis.sine - z.sine * axis.cosine),
        gd(of.inverse_direct_inductance_),
        gq(of.inverse_quadrature_inductance_),
        rd((of.resistance_ + input.series_resistance) * gd),
        rq((of.resistance_ + input.series_resistance) * gq),
        cross_d(of.motor_.quadrature_inductance * gd),
        cross_q(of.motor_.direct_inductance * gq),
        flux_d(of.flux_linkage_ * gd),
        flux_q(of.flux_linkage_ * gq),
        mobility(resting ? 0.0 : of.mobility_),
        by_flux(mobility * 1.5 * of.pole_pairs_ * of.flux_linkage_),
        by_saliency(mobility * 1.5 * of.pole_pairs_ * of.saliency_),
        by_speed(mobility * of.shaft_.viscous_friction() * of.inverse_pole_pairs_),
        cogging(std::fabs(h * state.speed * of.pole_pairs_) < of.cogging_.reach()
                    ? of.cogging_.around(z)
                    : NearbyCogging()) {}

  /// `turn`: electrical, since the step began; `rest`: acceleration by what does not depend on the
  /// stage's currents and speed. Adds `weight` of the power to `power`.
  Slope slope(const Stage& at, const base::SineCosine& turn, double turned, double rest,
              double weight) {
    const double ud = ud0 * turn.cosine + uq0 * turn.sine;
    const double uq = uq0 * turn.cosine - ud0 * turn.sine;
    power += weight * (ud * at.d + uq * at.q);
    const Form f = motor.shaped_ ? motor.form(angle + turned, sum(z, turn)) : Form{0.0, 1.0};
    Slope result{};
    if constexpr (kConnection != WindingConnection::none) {
      result.d = (gd * ud - rd * at.d) + at.speed * (cross_d * at.q - flux_d * f.d);
      result.q = (gq * uq - rq * at.q) - at.speed * (cross_q * at.d + flux_q * f.q);
    }
    if constexpr (kOneOpen) {
      // The voltage along the axis of the open phase that keeps its current as it is.
      const double ad = axis_d0 * turn.cosine + axis_q0 * turn.sine;
      const double aq = axis_q0 * turn.cosine - axis_d0 * turn.sine;
      const double missing =
          -((result.d - at.speed * at.q) * ad + (result.q + at.speed * at.d) * aq) /
          (ad * ad * gd + aq * aq * gq);
      result.d += missing * ad * gd;
      result.q += missing * aq * gq;
    }
    const double torque = by_flux * (f.d * at.d + f.q * at.q) + by_saliency * (at.d * at.q);
    result.speed = (torque - by_speed * at.speed) + rest;
    if (frozen.positional) {
      result.speed +=
          mobility * motor.shaft_.positional_torque(frozen, turned * motor.inverse_pole_pairs_,
                                                    at.speed * motor.inverse_pole_pairs_);
    }
    return result;
  }
  [[nodiscard]] double rest_at(double turned, double speed) const {
    const double friction =
        frozen.friction_sign * motor.shaft_.dry_friction(frozen, speed * motor.inverse_pole_pairs_);
    return mobility * ((frozen.steady_torque - friction) + cogging.after(turned));
  }
  /// Takes from the currents at the end of the step what rounding lets flow in the open phase.
  void keep_open(const base::SineCosine& end, double& direct, double& quadrature) const {
    const double ad = end.cosine * axis.cosine + end.sine * axis.sine;
    const double aq = end.cosine * axis.sine - end.sine * axis.cosine;
    const double along = direct * ad + quadrature * aq;
    direct -= along * ad;
    quadrature -= along * aq;
  }

  const SynchronousMotor& motor;
  const ShaftMechanics::Frozen& frozen;
  base::SineCosine z;     ///< direction at the begin
  double angle;           ///< electrical rad at the begin
  double ud0;             ///< V at the begin
  double uq0;             ///< V at the begin
  base::SineCosine axis;  ///< of the open phase
  double axis_d0;         ///< and seen from the rotor at the begin
  double axis_q0;
  double gd;  ///< 1/H
  double gq;
  double rd;  ///< 1/s
  double rq;
  double cross_d;
  double cross_q;
  double flux_d;    ///< A
  double flux_q;    ///< A
  double mobility;  ///< torque into electrical acceleration; a shaft that rests has none
  double by_flux;
  double by_saliency;
  double by_speed;
  NearbyCogging cogging;
  double power = 0.0;  ///< W, sum by the weights of the stages
};

template <WindingConnection kConnection>
double SynchronousMotor::integrate(SynchronousMotorState& state, const SynchronousMotorInput& input,
                                   const ShaftMechanics::Frozen& frozen, double h,
                                   bool resting) const {
  RotorFrame<kConnection> frame(*this, state, input, frozen, h, resting);
  const auto ahead = [](const Stage& from, const Slope& by, double time) {
    return Stage{from.d + time * by.d, from.q + time * by.q, from.speed + time * by.speed};
  };

  // Classical fourth-order Runge-Kutta; the angle's derivative is the speed of the stage before.
  // Friction and cogging are taken where the first slope leads: they then run beside the stages
  // and not between them. Turns after the first differ little from it and from twice it.
  const double half = 0.5 * h;
  const Stage start{state.direct_current(), state.quadrature_current(), state.speed * pole_pairs_};
  const base::SineCosine none{0.0, 1.0};
  const double turned2 = half * start.speed;
  const base::SineCosine turn2 = small_turn(turned2);
  const base::SineCosine twice = sum(turn2, turn2);
  const Slope k1 = frame.slope(start, none, 0.0, frame.rest_at(0.0, start.speed), 1.0);
  const double more3 = half * half * k1.speed;
  const base::SineCosine turn3 = nudged(turn2, more3);
  const double rest_halfway = frame.rest_at(turned2 + more3, start.speed + half * k1.speed);
  const Slope k2 = frame.slope(ahead(start, k1, half), turn2, turned2, rest_halfway, 2.0);
  const Slope k3 = frame.slope(ahead(start, k2, half), turn3, turned2 + more3, rest_halfway, 2.0);
  const double more4 = h * half * k2.speed;
  const base::SineCosine turn4 = nudged(twice, more4);
  const Slope k4 =
      frame.slope(ahead(start, k3, h), turn4, 2.0 * turned2 + more4,
                  frame.rest_at(2.0 * turned2 + more4, start.speed + h * k1.speed), 1.0);

  const double sixth = h * (1.0 / 6.0);
  double direct = start.d + sixth * ((k1.d + k4.d) + 2.0 * (k2.d + k3.d));
  double quadrature = start.q + sixth * ((k1.q + k4.q) + 2.0 * (k2.q + k3.q));
  if (!resting) {
    const double speed =
        start.speed + sixth * ((k1.speed + k4.speed) + 2.0 * (k2.speed + k3.speed));
    const double more = h * (sixth * (k1.speed + k2.speed + k3.speed));
    arrive(state, frozen, speed * inverse_pole_pairs_, 2.0 * turned2 + more,
           sum(frame.z, nudged(twice, more)), h);
  }
  if constexpr (kConnection == WindingConnection::without_u) {
    frame.keep_open(state.direction, direct, quadrature);
  }
  state.set_current(direct, quadrature);
  return frame.power * (1.5 / 6.0);
}

double SynchronousMotor::step(SynchronousMotorState& state, const SynchronousMotorInput& input,
                              double h) {
  if (turns_freely(state, input)) {
    return turn(state, input, h);
  }
  ShaftMechanics::Frozen frozen = shaft_.freeze(state.angle, input.torque, input.brake_engaged);
  bool resting = false;
  if (state.speed != 0.0) [[likely]] {
    frozen.friction_sign = state.speed > 0.0 ? 1.0 : -1.0;
  } else {
    double torque = electromagnetic_torque(state) + cogging_torque(state) + frozen.steady_torque;
    torque += frozen.positional ? shaft_.positional_torque(frozen, 0.0, 0.0) : 0.0;
    const double holding = shaft_.holding_friction(frozen);
    resting = holding > 0.0 && std::fabs(torque) <= holding;
    frozen.friction_sign = resting ? 0.0 : (torque > 0.0 ? 1.0 : -1.0);
  }
  switch (input.connection) {
    case WindingConnection::all:
      if (simple_ && resting) {
        return step_at_rest(state, input, h);
      }
      return integrate<WindingConnection::all>(state, input, frozen, h, resting);
    case WindingConnection::none:
      state.current = {};
      return integrate<WindingConnection::none>(state, input, frozen, h, resting);
    default:
      return integrate<WindingConnection::without_u>(state, input, frozen, h, resting);
  }
}

}  // namespace stator::plant
