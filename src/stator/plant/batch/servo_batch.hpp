#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/instruction_set.hpp"
#include "stator/base/servo_lanes.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/batch/servo_batch_block.hpp"
#include "stator/plant/motors/synchronous_motor.hpp"
#include "stator/plant/power/supply.hpp"

namespace stator::plant {

/// Many equal servo axes computed side by side: inverter averaged over the step, supply with
/// capacitor and brake chopper, three-phase motor with its load, sampled currents and angle. For
/// tuning, searching and testing by the million steps; a device has a ServoAxis of its own.
///
/// Number is double or float. In double each axis has the bits of a ServoAxis that gets the same
/// duties and whose resistance and flux do not depend on temperature, on every compiler and
/// instruction set. In float currents are right to 1e-4 of rated ones.
///
/// Of ServoAxisParameters count motor, load, inverter, supply, sensing of currents (without noise)
/// and the encoder's counts per revolution; the bridge is always on, the brake open. What a vector
/// cannot do, a shaft that stands, turns round, is very fast or has end stops, an unbalance,
/// saliency or no sinusoidal EMF, SynchronousMotor does for its lane, at the speed of a ServoAxis.
template <typename Number>
class ServoBatch {
 public:
  using Signals = base::ServoLanes<Number>;
  static constexpr std::size_t kLanes = Signals::kLanes;

  /// `axes` of them, standing as the parameters say, which advance by `step` at a time.
  ServoBatch(const ServoAxisParameters& parameters, std::size_t axes, base::SimDuration step,
             base::InstructionSet instructions = base::best_instruction_set());

  /// Lets one step pass with the duties in signals() and puts there what the sensors tell.
  void step();

  /// One block for each kLanes axes; lanes beyond the last axis turn along idly.
  [[nodiscard]] std::span<Signals> signals() { return signals_; }
  [[nodiscard]] std::span<const Signals> signals() const { return signals_; }
  [[nodiscard]] std::size_t size() const { return axes_; }

  /// Torque on the shaft of `axis` from outside (N m, positive = forward) until set again.
  void set_external_torque(std::size_t axis, double torque);
  /// Voltage of the source of `axis`, V.
  void set_supply_voltage(std::size_t axis, double voltage);
  void set_motor(std::size_t axis, const SynchronousMotorState& state);

  [[nodiscard]] SynchronousMotorState motor(std::size_t axis) const;
  [[nodiscard]] double supply_voltage(std::size_t axis) const;  ///< V at the power stage
  [[nodiscard]] double supply_power(std::size_t axis) const;    ///< W, mean of the latest step
  [[nodiscard]] const ServoAxisParameters& parameters() const { return parameters_; }

 private:
  using Block = ServoBatchBlock<Number>;

  void choose(base::InstructionSet instructions);
  void sense_all();
  [[nodiscard]] static SynchronousMotorState motor(const Block& block, std::size_t lane);
  static void put(Block& block, std::size_t lane, const SynchronousMotorState& state);
  void step_left_over();
  void step_lane(Block& block, Signals& signals, std::size_t lane);

  ServoAxisParameters parameters_;
  std::size_t axes_;
  base::SimDuration step_;
  SynchronousMotor motor_;
  Supply supply_;
  ServoBatchConstants<Number> constants_;
  std::vector<Block> blocks_;
  std::vector<Signals> signals_;
  ServoBatchStep<Number> kernel_ = nullptr;
  ServoBatchRefresh<Number> refresh_ = nullptr;
  base::SimDuration unrefreshed_;
};

extern template class ServoBatch<double>;
extern template class ServoBatch<float>;

}  // namespace stator::plant
