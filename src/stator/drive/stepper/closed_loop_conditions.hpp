#pragma once

#include <cstdint>

#include "stator/base/event.hpp"
#include "stator/drive/motion/axis_objects.hpp"
#include "stator/drive/stepper/stepper_settings.hpp"

namespace stator::drive {

/// Checks whether an axis can commutate by its encoder, and reports why not to a person who wants
/// it to.
class ClosedLoopConditions {
 public:
  ClosedLoopConditions(base::EventReporter reporter, std::uint8_t axis)
      : reporter_(reporter), axis_(axis) {}

  /// True if closed loop is wanted and 606Ah and 608Fh describe an encoder that can serve it:
  /// selected, with 4 counts per full step at least and 2^24 per revolution at most. Says once why
  /// not.
  bool fulfilled(const AxisObjects& objects, const StepperSettings& settings, base::SimTime now);
  /// Says once, until `missing` is false again, that a torque cannot be controlled in open loop.
  void explain_torque(bool missing, base::SimTime now);

 private:
  [[nodiscard]] const base::EventRule* problem(const AxisObjects& objects,
                                               const StepperSettings& settings) const;

  base::EventReporter reporter_;
  std::uint8_t axis_;
  const base::EventRule* reported_ = nullptr;  ///< about the closed loop wanted at present
  bool torque_told_ = false;
};

/// The encoder as the axis knows it.
[[nodiscard]] control::EncoderScale encoder_scale(const AxisObjects& objects,
                                                  const StepperSettings& settings);

}  // namespace stator::drive
