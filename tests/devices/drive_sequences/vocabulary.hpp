#pragma once

#include <cstdint>
#include <span>

#include "devices/drive_sequences/sequence.hpp"

namespace stator::tests {

/// What a CiA 402 product can be told, with the ranges in which its motor moves.
struct Vocabulary {
  double counts = 1.0;           ///< position increments per revolution
  double velocity = 1.0;         ///< velocity object per rev/s
  double acceleration = 1.0;     ///< acceleration object per rev/s²
  double slowest = 0.2;          ///< rev/s
  double fastest = 50.0;         ///< rev/s
  double gentlest = 20.0;        ///< rev/s²
  double steepest = 2000.0;      ///< rev/s²
  double farthest = 20.0;        ///< revolutions of a move
  std::span<const int> modes{};  ///< the ones that move first
  std::span<const int> quick_stop_options{};
  std::span<const int> halt_options{};   ///< none: 605Dh cannot be set
  std::span<const int> other_options{};  ///< 605Eh
  std::span<const int> homing_methods{};
  std::span<const int> network_states{};  ///< to leave for
  int operational = 0;                    ///< to come back to
  double load = 0.0;                      ///< N m, largest
  double inertia = 0.0;                   ///< kg m² that can be added
  std::span<const double> supplies{};     ///< V
  int torque = 0;                         ///< 6071h, largest; 0: no torque modes
  std::uint16_t torque_limit_index = 0;   ///< 0: none
  std::uint8_t torque_limit_subindex = 0;
  int torque_limit_minimum = 0;
  int torque_limit_maximum = 0;
  bool process_data = false;                 ///< exchanges can be lost
  bool following_error = false;              ///< 6065h exists
  bool following_time_out = false;           ///< 6066h exists
  bool maximum_profile_velocity = false;     ///< 607Fh exists
  bool interpolation = false;                ///< 60C2h exists
  std::span<const DriveStep> preparation{};  ///< before the drive is enabled first
};

[[nodiscard]] const Vocabulary& vocabulary_of(Product product);

}  // namespace stator::tests
