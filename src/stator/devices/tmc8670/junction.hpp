#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace stator::devices::tmc8670 {

// The chip as a source of heat (document L2692-L2737).

inline constexpr double kStaticPower = 0.028;        ///< W, typical, L2699
inline constexpr double kDynamicPower = 0.534;       ///< W, typical, L2700
inline constexpr double kJunctionOperating = 100.0;  ///< degree Celsius, L2661
inline constexpr double kJunctionMaximum = 125.0;    ///< degree Celsius, absolute, L2649

/// K/W from the junction to air that moves with so many m/s (L2710-L2712).
struct ThermalResistance {
  double air_speed;
  double to_ambient;
};
inline constexpr std::array<ThermalResistance, 3> kThermalResistances{
    {{0.0, 27.03}, {1.0, 22.91}, {2.5, 21.25}}};

/// Theta_JA in K/W; between the speeds of the table in proportion, beyond them that of the last.
[[nodiscard]] constexpr double junction_to_ambient(double air_speed) {
  for (std::size_t i = 1; i < kThermalResistances.size(); ++i) {
    const ThermalResistance& slow = kThermalResistances[i - 1];
    const ThermalResistance& fast = kThermalResistances[i];
    if (air_speed <= fast.air_speed) {
      const double share =
          (std::max(air_speed, 0.0) - slow.air_speed) / (fast.air_speed - slow.air_speed);
      return slow.to_ambient + share * (fast.to_ambient - slow.to_ambient);
    }
  }
  return kThermalResistances.back().to_ambient;
}

/// T_J = T_A + P theta, degree Celsius.
[[nodiscard]] constexpr double junction_temperature(double ambient, double power,
                                                    double air_speed) {
  return ambient + power * junction_to_ambient(air_speed);
}

/// Largest power in W that keeps the junction below its absolute maximum (L2735-L2737).
[[nodiscard]] constexpr double maximum_power(double ambient, double air_speed) {
  return (kJunctionMaximum - ambient) / junction_to_ambient(air_speed);
}

}  // namespace stator::devices::tmc8670
