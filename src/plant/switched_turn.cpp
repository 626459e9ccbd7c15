#include "plant/switched_turn.hpp"

#include <algorithm>
#include <cmath>

#include "plant/pwm_period.hpp"
#include "plant/rotation.hpp"

namespace stator::plant {

namespace {

/// A period must not turn the fastest motion of the model by more than this, rad.
constexpr double kLargestTurn = 0.33;

double dot(const base::SineCosine& z, const StatorVector& v) {
  return z.cosine * v.alpha + z.sine * v.beta;
}
double cross(const base::SineCosine& z, const StatorVector& v) {
  return z.cosine * v.beta - z.sine * v.alpha;
}

/// The winding between two edges; see HeldVoltage for the formulas.
struct Stretch {
  StatorVector mean_current;  ///< A
  double torque;              ///< mean of the quadrature current, A
  double torque_rise;         ///< A, of the quadrature current from begin to end
};

/// Where the winding stands at an edge.
struct Node {
  double x;            ///< electrical rad since the begin of the period
  base::SineCosine z;  ///< direction of the magnets
  StatorVector phi;    ///< A
  StatorVector current;
  double quadrature;  ///< A
  double direct;      ///< A, of phi
};

Node node(double x, const base::SineCosine& z, const StatorVector& phi, double k) {
  return {x, z, phi, {phi.alpha - k * z.cosine, phi.beta - k * z.sine}, cross(z, phi), dot(z, phi)};
}

Node follow(const FreeTurn& turn, const Node& from, double x, const base::SineCosine& z,
            const StatorVector& u, double h) {
  const double k = turn.flux_current;
  const double rate = turn.rate * h;
  const double first =
      0.5 - rate * (1.0 / 6.0 - rate * (1.0 / 24.0 - rate * (1.0 / 120.0 - rate * (1.0 / 720.0))));
  const double zeroth = 1.0 - rate * first;
  const double decay = 1.0 - rate * zeroth;
  const double gain = h * turn.inverse_inductance * zeroth;
  const double turned = x - from.x;
  const double weight = k * rate * (1.0 + turned * turned * (1.0 / 12.0));
  const double by_end = weight * first;
  const double by_begin = weight * (zeroth - first);
  const StatorVector phi{
      (decay * from.phi.alpha + gain * u.alpha) + (by_begin * from.z.cosine + by_end * z.cosine),
      (decay * from.phi.beta + gain * u.beta) + (by_begin * from.z.sine + by_end * z.sine)};
  return node(x, z, phi, k);
}

/// Means over a stretch by values and derivatives at its ends (Hermite).
Stretch between(const FreeTurn& turn, const Node& a, const Node& b, const StatorVector& u, double w,
                double h) {
  const double r = turn.rate;
  const double twelfth = h * (1.0 / 12.0);
  const double sines = a.z.sine - b.z.sine;
  const double cosines = a.z.cosine - b.z.cosine;
  const double kw = turn.flux_current * w;
  const double slope_alpha = kw * sines - r * (a.current.alpha - b.current.alpha);
  const double slope_beta = -kw * cosines - r * (a.current.beta - b.current.beta);
  const double slope = (turn.inverse_inductance * (cosines * u.beta - sines * u.alpha) -
                        r * (a.quadrature - b.quadrature)) -
                       w * (a.direct - b.direct);
  return {{0.5 * (a.current.alpha + b.current.alpha) + twelfth * slope_alpha,
           0.5 * (a.current.beta + b.current.beta) + twelfth * slope_beta},
          0.5 * (a.quadrature + b.quadrature) + twelfth * slope,
          b.quadrature - a.quadrature};
}

/// dphases/dt, A/s.
ThreePhaseWinding::Values slopes(const FreeTurn& turn, const Node& at, const StatorVector& u,
                                 double w) {
  const double r = turn.rate;
  const double kw = turn.flux_current * w;
  return phase_values({turn.inverse_inductance * u.alpha - r * at.current.alpha + kw * at.z.sine,
                       turn.inverse_inductance * u.beta - r * at.current.beta - kw * at.z.cosine});
}

}  // namespace

std::optional<double> turn_switched(ThreePhaseWinding& winding, const InverterParameters& inverter,
                                    Supply& supply, SupplyState& supply_state,
                                    const ThreePhaseWinding::Values& duty, const ShaftInput& shaft,
                                    bool chopper_on, double period) {
  SynchronousMotor& motor = winding.motor();
  SynchronousMotorState& state = winding.state();
  const ShaftMechanics& mechanics = motor.shaft();
  if (!motor.may_turn_freely() || state.speed == 0.0 ||
      period * motor.fastest_rate(state, period) > kLargestTurn) {
    return std::nullopt;
  }
  const FreeTurn turn = motor.free_turn(inverter.on_resistance);
  const double w = state.speed * turn.pole_pairs;
  const double k = turn.flux_current;
  const base::SineCosine z0 = state.direction;
  Node at =
      node(0.0, z0, {state.current.alpha + k * z0.cosine, state.current.beta + k * z0.sine}, k);
  const Cogging& cogging = motor.cogging();
  const double reach = period * w;
  const double cogs = std::fabs(reach) < cogging.reach() ? cogging.around(z0).mean(reach) : 0.0;
  const double sign = state.speed > 0.0 ? 1.0 : -1.0;
  const double steady = mechanics.load().constant_torque + shaft.torque + cogs -
                        sign * mechanics.coulomb_friction(shaft.brake_engaged);
  double rest = turn.mobility * steady - turn.damping * w;
  if (mechanics.creeps(state.speed)) {
    const double gain = period * (turn.flux_mobility * at.quadrature + rest);
    rest -= turn.mobility * sign * mechanics.stribeck_friction((w + 0.5 * gain) / turn.pole_pairs);
  }
  const double half_promised = 0.5 * (turn.flux_mobility * at.quadrature + rest);

  SupplyState link = supply_state;
  const bool dead = inverter.dead_time > 0.0;
  const double loss_per_ampere = inverter.dead_time * inverter.diode_drop;
  PwmPeriod<3> pwm(inverter, std::max(link.voltage, Supply::kLowestVoltage), duty, period);
  double taken = 0.0;
  double lost = 0.0;
  double impulse = 0.0;  // A s: integral of the quadrature current
  double reached = 0.0;  // A s^2: and of that
  ThreePhaseWinding::Values current = phase_values(at.current);
  while (!pwm.over()) {
    const ThreePhaseWinding::Values& high = pwm.high();
    const StatorVector share = stator_vector(high[0], high[1], high[2]);
    const double drawn = 1.5 * (share.alpha * at.current.alpha + share.beta * at.current.beta);
    double h = 0.0;
    if (dead) {
      const StatorVector now{link.voltage * share.alpha, link.voltage * share.beta};
      h = pwm.until_edge(current, slopes(turn, at, now, w));
    } else {
      h = pwm.until_edge();
    }
    if (h > 0.0) {
      const Supply::Stretch link_stretch = supply.stretch(link, h);
      const double voltage = link_stretch.halfway(drawn);
      const StatorVector u{voltage * share.alpha, voltage * share.beta};
      const double begin = pwm.time();
      const double end = begin + h;
      const double x = end * (w + half_promised * end);
      const Node next = follow(turn, at, x, sum(z0, small_turn(x)), u, h);
      const Stretch stretch = between(turn, at, next, u, w, h);
      const double left = period - begin - 0.5 * h;
      impulse += h * stretch.torque;
      reached += h * (left * stretch.torque - h * (1.0 / 12.0) * stretch.torque_rise);
      const double mean =
          1.5 * (share.alpha * stretch.mean_current.alpha + share.beta * stretch.mean_current.beta);
      const double energy = voltage * mean * h;
      taken += energy + lost;
      const double by_loss = dead ? lost / (std::max(voltage, Supply::kLowestVoltage) * h) : 0.0;
      supply.flow(link, link_stretch, mean + by_loss, chopper_on);
      lost = 0.0;
      at = next;
    }
    const std::size_t edge = pwm.pass();
    if (dead) {
      current = phase_values(at.current);
      for (std::size_t n = 0; n < current.size(); ++n) {
        lost += n == edge ? loss_per_ampere * std::fabs(current[n]) : 0.0;
      }
    }
  }

  const double gained = turn.flux_mobility * impulse + rest * period;
  const double w1 = w + gained * (1.0 - 0.5 * turn.damping * period);
  if (w1 * w <= 0.0) {
    return std::nullopt;
  }
  const double turned_by = w * period + turn.flux_mobility * reached + 0.5 * rest * period * period;
  state.direction = nudged(at.z, turned_by - at.x);
  state.current = {at.phi.alpha - k * state.direction.cosine,
                   at.phi.beta - k * state.direction.sine};
  state.angle = turned(state.angle, turned_by);
  constexpr double kHighestSpeed = 1e4;  // rad/s, as SynchronousMotor has it
  state.speed = std::clamp(w1 / turn.pole_pairs, -kHighestSpeed, kHighestSpeed);
  supply_state = link;
  return taken;
}

}  // namespace stator::plant
