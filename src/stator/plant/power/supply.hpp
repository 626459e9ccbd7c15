#pragma once

#include <algorithm>
#include <limits>

namespace stator::plant {

/// What feeds a power stage.
struct SupplyParameters {
  /// F of the capacitor at the power stage; 0: an ideal source, which also takes back what a
  /// braking motor returns.
  double capacitance = 0.0;
  double source_resistance = 0.1;  ///< ohm of source and cable; the source takes nothing back
  /// V from which the brake chopper switches its resistor across the capacitor.
  double chopper_voltage = std::numeric_limits<double>::infinity();
  double chopper_resistance = 10.0;  ///< ohm of its resistor
  double chopper_hysteresis = 1.0;   ///< V below chopper_voltage at which it switches off
};

struct SupplyState {
  double source = 24.0;            ///< V of the source
  double voltage = 24.0;           ///< V at the power stage
  bool chopper_conducts = false;   ///< the brake chopper burns energy
  bool chopper_by_itself = false;  ///< its own threshold switched it on

  friend bool operator==(const SupplyState&, const SupplyState&) = default;
};

/// Source, capacitor and brake chopper:
///   C dV/dt = max(0, Vs - V) / Rs - P / V - (V / Rch while the chopper conducts)
/// P is what the bridge takes, negative while the motor brakes. The brake chopper conducts above
/// its own threshold, or as long as a drive tells it to.
class Supply {
 public:
  /// V at which a bridge that still wants power gets what the capacitor can give, not an infinite
  /// current.
  static constexpr double kLowestVoltage = 1.0;

  /// What a length of time and the chopper make of the voltage.
  struct Share {
    double seconds = -1.0;
    bool conducts = false;
    double of_current = 0.0;  ///< V/A
    double alone = 1.0;       ///< factor of the voltage without the source
    double feed = 0.0;        ///< factor of the source's voltage
    double supplied = 1.0;    ///< and of the sum with it
  };
  [[nodiscard]] Share share(double seconds, bool conducts) const;

  explicit Supply(const SupplyParameters& parameters);

  [[nodiscard]] const SupplyParameters& parameters() const { return parameters_; }
  [[nodiscard]] bool ideal() const { return parameters_.capacitance <= 0.0; }
  /// Lets `seconds` pass in which the bridge takes `power` (W).
  void advance(SupplyState& state, double power, double seconds) const;
  /// The same where a drive switches the brake chopper; faster when most calls have the same
  /// `seconds`.
  void draw(SupplyState& state, double power, double seconds, bool chopper_on) {
    if (ideal()) {
      state.voltage = state.source;
      return;
    }
    switch_chopper(state, chopper_on);
    if (share_.seconds != seconds || share_.conducts != state.chopper_conducts) [[unlikely]] {
      share_ = share(seconds, state.chopper_conducts);
    }
    draw(state, power, share_);
  }
  /// A stretch of time for the trapezoidal rule: the energy that leaves the capacitor in it is the
  /// bridge's current times the voltage halfway. For the segments of a PWM period.
  struct Stretch {
    double begin = 0.0;       ///< V at its begin
    double alone = 0.0;       ///< V at its end while the bridge takes nothing
    double of_current = 0.0;  ///< V/A

    /// V in the middle while the bridge takes `current` (A).
    [[nodiscard]] double halfway(double current) const {
      return 0.5 * (begin + alone) - 0.5 * of_current * current;
    }
    [[nodiscard]] double end(double current) const { return alone - of_current * current; }
  };
  [[nodiscard]] Stretch stretch(const SupplyState& state, double seconds) const {
    if (ideal()) {
      return {.begin = state.source, .alone = state.source};
    }
    const double share = seconds * inverse_capacitance_;
    const double feed = state.voltage < state.source ? share * source_conductance_ : 0.0;
    const double burn = state.chopper_conducts ? share * chopper_conductance_ : 0.0;
    const double half = 0.5 * (feed + burn);
    const double whole = 1.0 / (1.0 + half);
    const double kept = (1.0 - half) * whole;
    const double fed = feed * whole;
    return {.begin = state.voltage,
            .alone = kept * state.voltage + fed * state.source,
            .of_current = share * whole};
  }
  /// Takes over the end of a stretch in which the bridge took `current` (A).
  void flow(SupplyState& state, const Stretch& stretch, double current, bool chopper_on) const {
    switch_chopper(state, chopper_on);
    state.voltage = std::max(stretch.end(current), 0.0);
  }

 private:
  void switch_chopper(SupplyState& state, bool chopper_on) const {
    if (state.voltage >= parameters_.chopper_voltage) {
      state.chopper_by_itself = true;
    } else if (state.voltage < parameters_.chopper_voltage - parameters_.chopper_hysteresis) {
      state.chopper_by_itself = false;
    }
    state.chopper_conducts = state.chopper_by_itself || chopper_on;
  }
  static void draw(SupplyState& state, double power, const Share& share) {
    const double current = power * (1.0 / std::max(state.voltage, kLowestVoltage));
    const double charge = state.voltage - share.of_current * current;
    // Without the source the voltage would end above it: its diode blocks.
    const double alone = charge * share.alone;
    const double supplied = (charge + share.feed * state.source) * share.supplied;
    state.voltage = std::max(alone < state.source ? supplied : alone, 0.0);
  }

  SupplyParameters parameters_;
  double inverse_capacitance_;  ///< 1/F; 0 for an ideal source
  double source_conductance_;   ///< 1/ohm
  double chopper_conductance_;
  Share share_;  ///< of the latest step; follows from its length and the chopper
};

}  // namespace stator::plant
