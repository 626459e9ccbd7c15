#include "stator/plant/power/switched_turn.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "stator/plant/mechanics/rotation.hpp"
#include "stator/plant/power/pwm_period.hpp"

namespace stator::plant {

namespace {

/// Two numbers a processor computes with at once: alpha and beta, or cosine and sine.
using Pair = double __attribute__((vector_size(16)));

double dot(const Pair& a, const Pair& b) {
  const Pair product = a * b;
  return product[0] + product[1];
}
double cross(const Pair& a, const Pair& b) {
  const Pair product = a * Pair{b[1], b[0]};
  return product[0] - product[1];
}

/// Where the winding stands at an edge; see HeldVoltage for the formulas.
struct Node {
  double x;  ///< electrical rad since the begin of the period
  Pair z;    ///< direction of the magnets
  Pair phi;  ///< A
  Pair current;
  double quadrature;  ///< A
  double direct;      ///< A, of phi
};

Node node(double x, const Pair& z, const Pair& phi, double k) {
  return {x, z, phi, phi - k * z, cross(z, phi), dot(z, phi)};
}

/// The winding after `h` seconds with the voltage `u`, the magnets at `z` then.
Node follow(const FreeTurn& turn, const Node& from, double x, const Pair& z, const Pair& u,
            double h) {
  const double k = turn.flux_current;
  const double rate = turn.rate * h;
  const double first = 0.5 - rate * (1.0 / 6.0 - rate * (1.0 / 24.0 - rate * (1.0 / 120.0)));
  const double zeroth = 1.0 - rate * first;
  const double decay = 1.0 - rate * zeroth;
  const double gain = h * turn.inverse_inductance * zeroth;
  const double turned = x - from.x;
  const double weight = k * rate * (1.0 + turned * turned * (1.0 / 12.0));
  const double by_end = weight * first;
  const double by_begin = weight * (zeroth - first);
  return node(x, z, (decay * from.phi + (by_begin * from.z + by_end * z)) + gain * u, k);
}

/// Mean current between two nodes, by values and derivatives at its ends (Hermite).
Pair mean_current(const FreeTurn& turn, const Node& a, const Node& b, double w, double h) {
  const Pair turned = a.z - b.z;
  const double kw = turn.flux_current * w;
  const Pair slope =
      Pair{turned[1], turned[0]} * Pair{kw, -kw} - turn.rate * (a.current - b.current);
  return 0.5 * (a.current + b.current) + h * (1.0 / 12.0) * slope;
}

/// And mean quadrature current.
double mean_torque(const FreeTurn& turn, const Node& a, const Node& b, const Pair& u, double w,
                   double h) {
  const double slope =
      (turn.inverse_inductance * cross(a.z - b.z, u) - turn.rate * (a.quadrature - b.quadrature)) -
      w * (a.direct - b.direct);
  return 0.5 * (a.quadrature + b.quadrature) + h * (1.0 / 12.0) * slope;
}

ThreePhaseWinding::Values phases(const Pair& v) {
  return phase_values({v[0], v[1]});
}

/// di/dt, A/s.
Pair slope(const FreeTurn& turn, const Node& at, const Pair& u, double w) {
  const double kw = turn.flux_current * w;
  return (turn.inverse_inductance * u - turn.rate * at.current) +
         Pair{at.z[1], at.z[0]} * Pair{kw, -kw};
}

/// How the rotor turns as far as the begin of a period promises.
struct Course {
  double w = 0.0;              ///< electrical rad/s at the begin
  double rest = 0.0;           ///< electrical rad/s^2 by all but the current
  double half_promised = 0.0;  ///< half of the acceleration at the begin
};

Course course_of(const SynchronousMotor& motor, const SynchronousMotorState& state,
                 const ShaftInput& shaft, const FreeTurn& turn, double quadrature, double period) {
  const ShaftMechanics& mechanics = motor.shaft();
  Course course;
  course.w = state.speed * turn.pole_pairs;
  const double reach = period * course.w;
  const double cogs = std::fabs(reach) < motor.cogging().reach()
                          ? motor.cogging().around(state.direction).mean(reach)
                          : 0.0;
  const double sign = state.speed > 0.0 ? 1.0 : -1.0;
  const double steady = mechanics.load().constant_torque + shaft.torque + cogs -
                        sign * mechanics.coulomb_friction(shaft.brake_engaged);
  course.rest = turn.mobility * steady - turn.damping * course.w;
  if (mechanics.creeps(state.speed)) {
    const double gain = period * (turn.flux_mobility * quadrature + course.rest);
    course.rest -= turn.mobility * sign *
                   mechanics.stribeck_friction((course.w + 0.5 * gain) / turn.pole_pairs);
  }
  course.half_promised = 0.5 * (turn.flux_mobility * quadrature + course.rest);
  return course;
}

/// Shares of the supply by the terminals that are high: bits 0, 1, 2 for U, V, W.
constexpr std::array<Pair, 8> kTerminals = [] {
  std::array<Pair, 8> result{};
  for (unsigned n = 0; n < result.size(); ++n) {
    const StatorVector share = stator_vector(n & 1U, (n >> 1U) & 1U, n >> 2U);
    result[n] = Pair{share.alpha, share.beta};
  }
  return result;
}();

/// What a period adds up to.
struct Sums {
  double taken = 0.0;    ///< J by the bridge
  double impulse = 0.0;  ///< A s: integral of the quadrature current
  double reached = 0.0;  ///< A s^2: and of that
};

/// One period of the inverter with the winding that begins at `at`.
class Passage {
 public:
  Passage(const FreeTurn& turn, const Course& course, const InverterParameters& inverter,
          const Supply& supply, const SupplyState& link, const Node& at, double period)
      : turn_(turn),
        course_(course),
        supply_(supply),
        link_(link),
        at_(at),
        magnets_{at.z[1], at.z[0]},
        period_(period),
        dead_(inverter.dead_time > 0.0),
        loss_per_ampere_(inverter.dead_time * inverter.diode_drop) {}

  void pass(PwmPeriod<3>& pwm, const ThreePhaseWinding::Values& duty, bool chopper_on) {
    current_ = phases(at_.current);
    const bool predict = dead_ && signs_may_change(duty);
    if (dead_ && !predict) {
      pwm.keep_signs(current_);
    }
    while (!pwm.over()) {
      const unsigned high = pwm.high_sides();
      const Pair terminals = kTerminals[high];
      const double h =
          predict ? pwm.until_edge(current_,
                                   phases(slope(turn_, at_, link_.voltage * terminals, course_.w)))
                  : pwm.until_edge();
      if (h > 0.0) {
        go(pwm.time(), h, terminals, high != 0 && high != 7, chopper_on);
      }
      const std::size_t edge = pwm.pass();
      if (dead_) {
        current_ = phases(at_.current);
        if (edge < current_.size()) {
          lost_ += loss_per_ampere_ * std::fabs(current_[edge]);
        }
      }
    }
  }

  [[nodiscard]] const Node& at() const { return at_; }
  [[nodiscard]] const Sums& sums() const { return sums_; }
  [[nodiscard]] const SupplyState& link() const { return link_; }

 private:
  /// Whether a phase may have a current of either sign within the period.
  [[nodiscard]] bool signs_may_change(const ThreePhaseWinding::Values& duty) const {
    // No phase strays further from its mean course than this.
    const double ripple = 0.25 * link_.voltage * period_ * turn_.inverse_inductance;
    const StatorVector mean = stator_vector(duty[0], duty[1], duty[2]);
    const ThreePhaseWinding::Values way =
        phases(slope(turn_, at_, link_.voltage * Pair{mean.alpha, mean.beta}, course_.w));
    bool may = false;
    for (std::size_t n = 0; n < current_.size(); ++n) {
      may = may || std::fabs(current_[n]) < ripple + period_ * std::fabs(way[n]);
    }
    return may;
  }

  /// From `begin` (s) `h` seconds on with the terminals' shares of the supply; `active`: which are
  /// not all the same.
  void go(double begin, double h, const Pair& share, bool active, bool chopper_on) {
    const Supply::Stretch stretch = supply_.stretch(link_, h);
    const double drawn = active ? 1.5 * dot(share, at_.current) : 0.0;
    const double voltage = stretch.halfway(drawn);
    const Pair u = voltage * share;
    const double end = begin + h;
    const double x = end * (course_.w + course_.half_promised * end);
    const base::SineCosine z = sum(magnets_, small_turn(x));
    const Node next = follow(turn_, at_, x, Pair{z.cosine, z.sine}, u, h);
    const double torque = mean_torque(turn_, at_, next, u, course_.w, h);
    const double left = period_ - begin - 0.5 * h;
    sums_.impulse += h * torque;
    sums_.reached += h * (left * torque - h * (1.0 / 12.0) * (next.quadrature - at_.quadrature));
    double mean = 0.0;
    if (active) {
      mean = 1.5 * dot(share, mean_current(turn_, at_, next, course_.w, h));
      sums_.taken += voltage * mean * h;
    }
    if (dead_) {
      sums_.taken += lost_;
      mean += lost_ / (std::max(voltage, Supply::kLowestVoltage) * h);
      lost_ = 0.0;
    }
    supply_.flow(link_, stretch, mean, chopper_on);
    at_ = next;
  }

  const FreeTurn& turn_;
  const Course& course_;
  const Supply& supply_;
  SupplyState link_;
  Node at_;
  base::SineCosine magnets_;  ///< at the begin
  double period_;
  bool dead_;
  double loss_per_ampere_;  ///< J/A in diodes at an edge
  double lost_ = 0.0;       ///< J at edges that no stretch has paid for
  ThreePhaseWinding::Values current_{};
  Sums sums_;
};

}  // namespace

std::optional<double> turn_switched(ThreePhaseWinding& winding, const InverterParameters& inverter,
                                    Supply& supply, SupplyState& supply_state,
                                    const ThreePhaseWinding::Values& duty, const ShaftInput& shaft,
                                    bool chopper_on, double period) {
  const SynchronousMotor& motor = winding.motor();
  SynchronousMotorState& state = winding.state();
  if (!motor.may_turn_freely() || !winding.connected() || state.speed == 0.0 ||
      period * motor.fastest_rate(state, period) > kLargestTurn) {
    return std::nullopt;
  }
  const FreeTurn turn = motor.free_turn(inverter.on_resistance);
  const double k = turn.flux_current;
  const Pair magnets{state.direction.cosine, state.direction.sine};
  const Node begin =
      node(0.0, magnets, Pair{state.current.alpha, state.current.beta} + k * magnets, k);
  const Course course = course_of(motor, state, shaft, turn, begin.quadrature, period);
  PwmPeriod<3> pwm(inverter, std::max(supply_state.voltage, Supply::kLowestVoltage), duty, period);
  Passage passage(turn, course, inverter, supply, supply_state, begin, period);
  passage.pass(pwm, duty, chopper_on);

  const Sums& sums = passage.sums();
  const double gained = turn.flux_mobility * sums.impulse + course.rest * period;
  const double w1 = course.w + gained * (1.0 - 0.5 * turn.damping * period);
  if (w1 * course.w <= 0.0) {
    return std::nullopt;
  }
  const double turned_by =
      course.w * period + turn.flux_mobility * sums.reached + 0.5 * course.rest * period * period;
  const Node& at = passage.at();
  state.direction = nudged({at.z[1], at.z[0]}, turned_by - at.x);
  state.current = {at.phi[0] - k * state.direction.cosine, at.phi[1] - k * state.direction.sine};
  state.angle = turned(state.angle, turned_by);
  constexpr double kHighestSpeed = 1e4;  // rad/s, as SynchronousMotor has it
  state.speed = std::clamp(w1 / turn.pole_pairs, -kHighestSpeed, kHighestSpeed);
  supply_state = passage.link();
  return sums.taken;
}

}  // namespace stator::plant
