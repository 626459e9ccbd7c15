#pragma once

#include <array>

namespace stator::plant {

/// A heat source inside a body that stands in air, e.g. winding and housing, or chip and board.
struct ThermalParameters {
  double inner_capacity = 37.0;   ///< J/K
  double outer_capacity = 250.0;  ///< J/K
  double inner_to_outer = 1.0;    ///< K/W
  double outer_to_ambient = 3.0;  ///< K/W
};

/// K by which a winding of insulation class B is warmer than the air at rated current.
inline constexpr double kClassBRise = 80.0;

/// An estimate for a motor of `mass` kg whose winding loses `rated_loss` W when hot, where the
/// sheet has no thermal data: the winding settles 80 K above the air at rated current (insulation
/// class B), a quarter of that between winding and housing; copper is 15 % of the mass.
[[nodiscard]] constexpr ThermalParameters class_b_motor(double rated_loss, double mass) {
  constexpr double kCopperShare = 0.15;
  constexpr double kCopper = 385.0;  // J/(kg K)
  constexpr double kSteel = 460.0;
  const double resistance = kClassBRise / rated_loss;
  return {.inner_capacity = kCopperShare * mass * kCopper,
          .outer_capacity = (1.0 - kCopperShare) * mass * kSteel,
          .inner_to_outer = 0.25 * resistance,
          .outer_to_ambient = 0.75 * resistance};
}

struct ThermalState {
  double inner = 25.0;  ///< degree Celsius
  double outer = 25.0;

  friend bool operator==(const ThermalState&, const ThermalState&) = default;
};

/// Two heat capacities in a row:
///   Ci dTi/dt = P - (Ti - To) / Rio        Co dTo/dt = (Ti - To) / Rio - (To - Ta) / Roa
/// Advanced in steps of fixed length by the exact solution for constant power, so that the length
/// of the step is no matter of accuracy.
class TwoBodyThermal {
 public:
  /// `step` in seconds.
  TwoBodyThermal(const ThermalParameters& parameters, double step);

  /// Lets one step pass with `power` (W) in the inner body.
  void advance(ThermalState& state, double power, double ambient) const {
    const double inner = state.inner - ambient - power * (inner_to_outer_ + outer_to_ambient_);
    const double outer = state.outer - ambient - power * outer_to_ambient_;
    state.inner += change_[0][0] * inner + change_[0][1] * outer;
    state.outer += change_[1][0] * inner + change_[1][1] * outer;
  }

 private:
  using Matrix = std::array<std::array<double, 2>, 2>;

  double inner_to_outer_;
  double outer_to_ambient_;
  Matrix change_{};  ///< exp(A step) - 1: what a step makes of the distance from the final state
};

}  // namespace stator::plant
