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

/// What the usual step needs of a motor and its load, as far as motors of one batch may differ in
/// it: numbers in SI units under the names that HeldVoltage, FreeTurn, ShaftMechanics and DeadTime
/// give them. T is a number, a vector of them, or an array of kLanes.
template <typename T>
struct ServoBatchMotor {
  T largest_speed;  ///< rad/s up to which one step will do

  // HeldVoltage.
  T rate, decay, gain, from_begin, from_end, square, fourth, yield, lift;
  T mean_begin, mean_end;
  T opposition, opposition_by_direct, opposition_by_rise;

  T inverse_inductance, flux_current, flux_mobility, mobility, damping;
  T constant_torque, coulomb_friction, stribeck_rise;
  T ripple_by_supply;  ///< A/V
  T ripple_by_drop;    ///< A/V
};

/// The motors of one block of base::ServoLanes where each is one of its own.
template <typename Number>
struct alignas(64) ServoBatchMotors {
  ServoBatchMotor<Number[base::ServoLanes<Number>::kLanes]> of;  // NOLINT(*-avoid-c-arrays)
};

/// SynchronousMotor, Supply and CurrentSensing as the usual step needs them: numbers in SI units
/// under the names they have there. What motors may differ in is ServoBatchMotor.
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
  Number pole_pairs{};
  Number inverse_pole_pairs{};
  Number twelfth{}, quarter{}, bend{};  // HeldVoltage
  Number inverse_stribeck_speed{};
  std::array<Cogging, 2> cogging{};
  std::size_t cogging_count = 0;
  Number cogging_reach{};

  bool dead_time = false;
  Number dead_share{};      ///< of the period
  Number drop_by_diodes{};  ///< V

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

/// The motors of a batch: one that all lanes have, or those of each block.
template <typename Number>
struct ServoBatchPlants {
  ServoBatchMotor<Number> common{};
  const ServoBatchMotors<Number>* own = nullptr;  ///< null: all have `common`
};

/// One step of the lanes of `count` blocks; true: some lanes have left_over set.
template <typename Number>
using ServoBatchStep = bool (*)(const ServoBatchConstants<Number>& constants,
                                const ServoBatchPlants<Number>& plants,
                                ServoBatchBlock<Number>* blocks, base::ServoLanes<Number>* signals,
                                std::size_t count);
/// Takes all directions anew from their angles.
template <typename Number>
using ServoBatchRefresh = void (*)(ServoBatchBlock<Number>* blocks, std::size_t count);

}  // namespace stator::plant
