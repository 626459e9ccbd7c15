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
  double chopper_resistance = 10.0;  ///< ohm
  double chopper_hysteresis = 1.0;   ///< V below chopper_voltage at which it switches off
};

struct SupplyState {
  double source = 24.0;           ///< V of the source
  double voltage = 24.0;          ///< V at the power stage
  bool chopper_conducts = false;  ///< the brake chopper burns energy

  friend bool operator==(const SupplyState&, const SupplyState&) = default;
};

/// Source, capacitor and brake chopper:
///   C dV/dt = max(0, Vs - V) / Rs - P / V - (V / Rch while the chopper conducts)
/// P is what the bridge takes, negative while the motor brakes.
class Supply {
 public:
  explicit Supply(const SupplyParameters& parameters) : parameters_(parameters) {}

  [[nodiscard]] bool ideal() const { return parameters_.capacitance <= 0.0; }
  /// Lets `seconds` pass in which the bridge takes `power` (W).
  void advance(SupplyState& state, double power, double seconds) const;

 private:
  SupplyParameters parameters_;
};

}  // namespace stator::plant
