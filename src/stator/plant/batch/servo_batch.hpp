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

/// Many servo axes computed side by side: inverter averaged over the step, supply with capacitor
/// and brake chopper, three-phase motor with its load, sampled currents and angle. For tuning,
/// searching, learning and testing by the million steps; a device has a ServoAxis of its own. The
/// axes are equal unless set_plant() gives some a motor or load that differs.
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
  /// Gives `axis` a motor and a load of its own, which takes effect with the next step. They may
  /// differ from those of parameters() in resistance, inductance (without saliency), flux linkage,
  /// inertia, friction but the Stribeck speed, and constant torque; pole pairs, cogging, form of
  /// the EMF, end stops and unbalance have to be the same. The first call allocates memory; from
  /// then on a step reads the numbers of each axis, which takes it somewhat longer.
  void set_plant(std::size_t axis, const ThreePhaseMotorParameters& motor,
                 const MechanicalLoad& load);
  /// Begins anew with `axis`: its shaft at `revolutions` and `speed` (rad/s), without currents,
  /// source and capacitor at `supply_voltage` (V), no torque from outside, duties at one half. From
  /// there the axis has the bits of one whose first step is the next one.
  void restart(std::size_t axis, double revolutions, double speed, double supply_voltage);

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
  void step_lane(Block& block, Signals& signals, std::size_t lane, SynchronousMotor& plant);
  void refresh_each();

  ServoAxisParameters parameters_;
  std::size_t axes_;
  base::SimDuration step_;
  SynchronousMotor motor_;
  Supply supply_;
  ServoBatchConstants<Number> constants_;
  ServoBatchPlants<Number> plants_;
  std::vector<ServoBatchMotors<Number>> motors_;  ///< of each block; empty: all are equal
  std::vector<SynchronousMotor> own_motors_;      ///< of each axis; empty: all are motor_
  std::vector<Block> blocks_;
  std::vector<Signals> signals_;
  ServoBatchStep<Number> kernel_ = nullptr;
  ServoBatchRefresh<Number> refresh_ = nullptr;
  base::SimDuration unrefreshed_;
  /// The same of each axis, once one was restarted.
  std::vector<base::SimDuration> restarted_;
};

extern template class ServoBatch<double>;
extern template class ServoBatch<float>;

}  // namespace stator::plant
