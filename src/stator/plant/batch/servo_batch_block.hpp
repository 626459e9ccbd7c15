#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "stator/base/servo_lanes.hpp"

namespace stator::plant {

/// State of the motors and supplies of one block of base::ServoLanes, and what acts on them.
template <typename Number>
struct alignas(64) ServoBatchBlock {
  static constexpr std::size_t kLanes = base::ServoLanes<Number>::kLanes;
  using Integer = std::conditional_t<sizeof(Number) == 8, std::int64_t, std::int32_t>;

  Number current_alpha[kLanes];      ///< A
  Number current_beta[kLanes];       ///< A
  Number speed[kLanes];              ///< rad/s, mechanical; exactly 0 while the shaft sticks
  Number sine[kLanes];               ///< of the electrical angle
  Number cosine[kLanes];             ///< of the electrical angle
  Number angle[kLanes];              ///< electrical rad, 0..2 pi
  Integer periods[kLanes];           ///< whole electrical periods
  Number supply_voltage[kLanes];     ///< V at the power stage
  Integer chopper_conducts[kLanes];  ///< 1: the brake chopper burns energy
  Number supply_power[kLanes];       ///< W the bridge took in the latest step, mean
  Number torque[kLanes];             ///< N m on the shaft from outside, positive = forward
  Number supply_source[kLanes];      ///< V of the source
  Integer left_over[kLanes];  ///< 1: not stepped, for the lane needs more than the usual step
};

/// SynchronousMotor, Supply and CurrentSensing as the usual step needs them: numbers in SI units
/// under the names they have there.
template <typename Number>
struct ServoBatchConstants {
  struct Cogging {
    int times = 1;
    bool of_six = false;
    Number sine{};
    Number cosine{};
    Number order{};
    Number half_square{};
    Number sixth_square{};
  };

  Number h{};
  Number largest_speed{};  ///< rad/s up to which one step will do
  Number pole_pairs{};
  Number inverse_pole_pairs{};

  // HeldVoltage.
  Number rate{}, decay{}, gain{}, from_begin{}, from_end{}, square{}, fourth{}, yield{}, lift{};
  Number mean_begin{}, mean_end{}, twelfth{}, quarter{}, bend{};
  Number opposition{}, opposition_by_direct{}, opposition_by_rise{};

  Number inverse_inductance{}, flux_current{}, flux_mobility{}, mobility{}, damping{};
  Number constant_torque{}, coulomb_friction{}, stribeck_rise{}, inverse_stribeck_speed{};
  std::array<Cogging, 2> cogging{};
  std::size_t cogging_count = 0;
  Number cogging_reach{};

  bool dead_time = false;
  Number dead_share{};        ///< of the period
  Number drop_by_diodes{};    ///< V
  Number ripple_by_supply{};  ///< A/V
  Number ripple_by_drop{};    ///< A/V

  bool ideal_supply = false;
  Number lowest_voltage{};
  Number of_current{}, feed{};
  Number alone{}, supplied{};
  Number alone_chopping{}, supplied_chopping{};
  Number chopper_on_voltage{}, chopper_off_voltage{};

  bool exact_sensing = true;
  bool quantised = false;
  std::array<Number, 3> sense_gain{}, sense_offset{};
  Number sense_range{}, resolution{}, inverse_resolution{};
  Number counts_per_radian{};  ///< of the angle's sensor; 0: exact
  Number radians_per_count{};
};

/// One step of the lanes of `count` blocks; true: some lanes have left_over set.
template <typename Number>
using ServoBatchStep = bool (*)(const ServoBatchConstants<Number>& constants,
                                ServoBatchBlock<Number>* blocks, base::ServoLanes<Number>* signals,
                                std::size_t count);
/// Takes all directions anew from their angles.
template <typename Number>
using ServoBatchRefresh = void (*)(ServoBatchBlock<Number>* blocks, std::size_t count);

}  // namespace stator::plant
