#pragma once

#include <array>

#include "stator/plant/motors/synchronous_motor.hpp"

namespace stator::plant {

/// Where the cables of the phases end while the transistors are off.
struct BridgeTerminals {
  double supply_voltage = 24.0;    ///< V
  double diode_drop = 0.7;         ///< V
  std::array<bool, 3> open{};      ///< nowhere: the cable is broken
  std::array<bool, 3> grounded{};  ///< on ground: shorted
};

/// What carries the currents for a short time.
struct DiodeConduction {
  std::array<bool, 3> connected{};
  std::array<double, 3> terminal{};  ///< V of the connected phases
  WindingConnection connection = WindingConnection::none;
  StatorVector voltage;  ///< of all three; an open phase's is arbitrary along its axis
};

/// The six diodes of three half bridges. A current into the motor flows through the lower diode,
/// one out of it through the upper one into the supply. A phase without current blocks until its
/// terminal would leave the range of the supply by a diode's drop.
[[nodiscard]] DiodeConduction diode_conduction(const BridgeTerminals& bridge,
                                               const std::array<double, 3>& current,
                                               const std::array<double, 3>& back_emf);

/// `current` at the end of that time less what diodes do not let through.
[[nodiscard]] std::array<double, 3> without_reverse_current(const BridgeTerminals& bridge,
                                                            const DiodeConduction& conduction,
                                                            const std::array<double, 3>& current);

}  // namespace stator::plant
