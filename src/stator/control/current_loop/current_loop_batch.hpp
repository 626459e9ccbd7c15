// Field-oriented current loops of many drives, computed side by side in the lanes of vector
// instructions.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/base/instruction_set.hpp"
#include "stator/base/servo_lanes.hpp"
#include "stator/control/current_loop/current_loop_block.hpp"

namespace stator::control {

struct CurrentLoopSettings {
  double proportional = 1.0;  ///< V/A
  double integral = 0.0;      ///< V/(A s)
  double period = 20e-6;      ///< s
  int timer_steps = 4000;     ///< of a PWM period, which duties are whole parts of; 0: any duty
};

/// Gains for a closed loop that follows as 1 - exp(-bandwidth t): proportional = L * bandwidth,
/// integral = R * bandwidth cancels the winding's pole. `bandwidth` in rad/s; up to a fifth of 1 /
/// period there is no overshoot.
[[nodiscard]] constexpr CurrentLoopSettings current_loop_for(double resistance, double inductance,
                                                             double bandwidth, double period) {
  return {
      .proportional = inductance * bandwidth, .integral = resistance * bandwidth, .period = period};
}

/// Field-oriented current loops of many drives side by side: Clarke and Park transformation, PI
/// controllers for both currents, space-vector modulation by the common part that centres the
/// phases. A voltage beyond the supply is shortened to the hexagon and keeps its direction; the
/// integrals stand meanwhile. Number is double or float; the results have the same bits with every
/// instruction set.
template <typename Number>
class CurrentLoopBatch {
 public:
  using Signals = base::ServoLanes<Number>;
  static constexpr std::size_t kLanes = Signals::kLanes;

  CurrentLoopBatch(const CurrentLoopSettings& settings, std::size_t axes,
                   base::InstructionSet instructions = base::best_instruction_set());

  /// One period: from what the sensors told to the duties of the next one. As many blocks as
  /// `axes` take.
  void step(std::span<Signals> signals) {
    kernel_(constants_, blocks_.data(), signals.data(), blocks_.size());
  }

  void set_target(std::size_t axis, double direct, double quadrature);  ///< A
  /// What the integral parts of the controllers hold, V. With both gains 0 these are the voltages
  /// that are modulated until set again: drives without a current loop.
  void set_voltage(std::size_t axis, double direct, double quadrature);
  /// Takes target and integral parts of `axis` to 0.
  void restart(std::size_t axis);
  [[nodiscard]] double direct_current(std::size_t axis) const;      ///< A, measured
  [[nodiscard]] double quadrature_current(std::size_t axis) const;  ///< A, measured

 private:
  CurrentLoopConstants<Number> constants_;
  std::vector<CurrentLoopBlock<Number>> blocks_;
  CurrentLoopStep<Number> kernel_ = nullptr;
};

extern template class CurrentLoopBatch<double>;
extern template class CurrentLoopBatch<float>;

}  // namespace stator::control
