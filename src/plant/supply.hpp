#pragma once

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
  explicit Supply(const SupplyParameters& parameters);

  [[nodiscard]] bool ideal() const { return parameters_.capacitance <= 0.0; }
  /// Lets `seconds` pass in which the bridge takes `power` (W).
  void advance(SupplyState& state, double power, double seconds) const;
  /// The same where the bridge takes `current` (A) and a drive switches the brake chopper.
  void draw(SupplyState& state, double current, double seconds, bool chopper_on) const;

 private:
  SupplyParameters parameters_;
  double inverse_capacitance_;  ///< 1/F; 0 for an ideal source
  double source_conductance_;   ///< 1/ohm
  double chopper_conductance_;
};

}  // namespace stator::plant
