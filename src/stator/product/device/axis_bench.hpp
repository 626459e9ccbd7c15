#pragma once

#include "stator/base/sim_time.hpp"

namespace stator::control {
class RampGenerator;
}
namespace stator::dictionary {
class Dictionary;
}
namespace stator::plant {
class StepperAxis;
}

namespace stator::product {

/// A stepper module on a test bench: one axis is wired to the motor under test and commanded
/// through the module's objects, without a bus. The network counts as operational.
class AxisBench {
 public:
  AxisBench() = default;
  AxisBench(const AxisBench&) = delete;
  AxisBench& operator=(const AxisBench&) = delete;
  virtual ~AxisBench() = default;

  [[nodiscard]] virtual dictionary::Dictionary& dictionary() = 0;
  /// The axis obeys what was written.
  virtual void apply(base::SimTime now) = 0;
  virtual void advance(base::SimTime now) = 0;

  /// How long a step of its plant is.
  [[nodiscard]] virtual base::SimDuration plant_step() const = 0;
  [[nodiscard]] virtual double microsteps_per_revolution() const = 0;
  /// The set-point, in microsteps.
  [[nodiscard]] virtual const control::RampGenerator& ramp() = 0;
  [[nodiscard]] virtual plant::StepperAxis& plant() = 0;
};

}  // namespace stator::product
