#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "stator/control/foc/register_field.hpp"
#include "stator/experiment/tuning/chip.hpp"
#include "stator/experiment/tuning/loop_model.hpp"
#include "stator/experiment/tuning/mechanics.hpp"
#include "stator/experiment/tuning/winding.hpp"

namespace stator::experiment::tuning {

/// A gain as calculated and as its register takes it.
struct Gain {
  const char* name = "";    ///< e.g. "P torque"
  const char* format = "";  ///< q8.8, q0.15 or q4.12
  control::foc::Field field{};
  double wanted = 0.0;     ///< in steps of the register
  std::int32_t value = 0;  ///< rounded and cut to 0..32767
  /// What rounding or cutting changes, as a share of what was wanted.
  [[nodiscard]] double error() const { return wanted != 0.0 ? value / wanted - 1.0 : 0.0; }
  [[nodiscard]] bool cut() const { return wanted > 32767.5; }
};

/// Gains of the loops, and what the linear model expects of them.
struct LoopDesign {
  double wanted_current = 0.0;  ///< Hz
  double wanted_velocity = 0.0;
  double wanted_position = 0.0;
  std::vector<Gain> gains;
  LoopModel model;
  double supply = 0.0;          ///< V that the gains hold for
  double torque_limit = 0.0;    ///< A
  double velocity_limit = 0.0;  ///< rpm
  std::vector<std::string> remarks;
};

/// Current controllers by pole-zero cancellation: I cancels the winding's time constant, P is the
/// one with which the loop, its dead time of 1.5 PWM periods included, has the wanted bandwidth.
/// Sets the registers. Throws TuningError: bandwidth above 0.124 times the PWM frequency (phase
/// margin 60 degrees), gain_range.
[[nodiscard]] LoopDesign design_current_loops(Chip& chip, const Winding& winding);

/// Velocity PI by the symmetrical optimum: the zero lies as far below the crossover as the lag of
/// current loop and meter lies above it, with a distance of 2 to 5; position P. Both have the
/// wanted bandwidth in the linear model. Sets the registers. Throws TuningError: bandwidth, with
/// the highest that can be had; gain_range.
void design_outer_loops(Chip& chip, const Mechanics& mechanics, LoopDesign& design);

}  // namespace stator::experiment::tuning
