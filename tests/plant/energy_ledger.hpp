#pragma once

#include <cmath>
#include <cstddef>

#include "stator/plant/power/windings.hpp"

namespace stator::plant {

/// Where the energy of a motor goes, J.
struct EnergyLedger {
  double supplied = 0.0;  ///< by the terminals
  double copper = 0.0;    ///< heat of windings and transistors
  double friction = 0.0;
  double load = 0.0;   ///< given to what turns the shaft from outside
  double moved = 0.0;  ///< all that went either way: what errors are measured by
};

/// What a ledger needs to know of a motor: resistance and squares of currents of its phases, and
/// stored energy, each by its own formula.
struct LedgerOf {
  static double resistance(ThreePhaseWinding& w) {
    return w.motor().resistance() + w.inverter().on_resistance;
  }
  static double resistance(TwoPhaseWinding& w) { return w.motor().motor().resistance; }
  static double resistance(DcWinding& w) {
    return w.motor().motor().resistance + 2.0 * w.inverter().on_resistance;
  }

  static double stored(ThreePhaseWinding& w) {
    const SynchronousMotorState& s = w.state();
    const ThreePhaseMotorParameters& m = w.motor().motor();
    const double d = s.direct_current();
    const double q = s.quadrature_current();
    return 0.75 * (m.direct_inductance * d * d + m.quadrature_inductance * q * q) +
           0.5 * w.motor().shaft().inertia() * s.speed * s.speed;
  }
  static double stored(TwoPhaseWinding& w) {
    const HybridStepperState& s = w.state();
    const StepperMotorParameters& m = w.motor().motor();
    const double p = m.pole_pairs;
    return 0.5 * m.inductance * (s.current[0] * s.current[0] + s.current[1] * s.current[1]) +
           0.5 * w.motor().inertia() * s.speed * s.speed -
           m.detent_torque / (4.0 * p) * std::cos(4.0 * s.angle.angle);
  }
  static double stored(DcWinding& w) {
    const DcMotorState& s = w.state();
    return 0.5 * w.inductance() * s.current * s.current +
           0.5 * w.motor().shaft().inertia() * s.speed * s.speed;
  }

  /// Of the windings: the sum of the squares of all terminals' currents is that of the phases
  /// (three phases) or twice it.
  static double phases_per_terminal(const ThreePhaseWinding&) { return 1.0; }
  static double phases_per_terminal(const TwoPhaseWinding&) { return 0.5; }
  static double phases_per_terminal(const DcWinding&) { return 0.5; }
};

/// A motor that keeps the books of every stretch of time the inverter lets pass.
template <typename Winding>
class Audited : public Winding {
 public:
  using Winding::Winding;
  using Values = typename Winding::Values;

  double viscous_friction = 0.0;  ///< N m s/rad of motor and load
  double coulomb_friction = 0.0;  ///< N m

  double pass(const Values& voltage, const ShaftInput& shaft, double h) {
    const Values before = this->currents();
    const double speed_before = this->speed();
    const double energy = Winding::pass(voltage, shaft, h);
    const Values after = this->currents();
    const double speed = this->speed();
    double square = 0.0;
    for (std::size_t k = 0; k < Winding::kBridges; ++k) {
      square += before[k] * before[k] + before[k] * after[k] + after[k] * after[k];
    }
    const double mean_square = (1.0 / 3.0) * square * LedgerOf::phases_per_terminal(*this);
    const double speed_square =
        (1.0 / 3.0) * (speed_before * speed_before + speed_before * speed + speed * speed);
    const double way = 0.5 * h * (speed_before + speed);
    ledger.supplied += energy;
    ledger.moved += std::fabs(energy);
    ledger.copper += h * LedgerOf::resistance(*this) * mean_square;
    ledger.friction += h * viscous_friction * speed_square + coulomb_friction * std::fabs(way);
    ledger.load -= shaft.torque * way;
    return energy;
  }

  EnergyLedger ledger;
};

}  // namespace stator::plant
