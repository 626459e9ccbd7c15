#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/environment/drives.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::environment {

/// Stepper axes, one after the other. The drive knows the angle from an encoder: a current is
/// turned into the targets of both coils for the end of each step, a voltage into shares of the
/// supply. Windings get warm and their resistance with them.
class StepperDrives final : public Drives {
 public:
  StepperDrives(const EnvironmentSettings& settings, const Scales& scales, std::size_t axes);

  void restart(std::size_t axis, const Conditions& conditions) override;
  void set_load_torque(std::size_t axis, double torque) override {
    axes_[axis].set_external_torque(torque);
  }
  void act(std::span<const float> actions) override;
  void pass() override;
  void read(std::span<Reading> readings) const override;
  [[nodiscard]] Reading read(std::size_t axis) const override;

 private:
  [[nodiscard]] double seen_angle(const plant::StepperAxis& axis) const;
  [[nodiscard]] base::AxisActuation actuation(const plant::StepperAxis& axis, const float* action,
                                              double ahead) const;

  ActionKind action_;
  int steps_;
  base::SimDuration step_;
  Scales scales_;
  plant::StepperAxisParameters parameters_;
  double counts_per_radian_ = 0.0;  ///< of the electrical angle; 0: exact
  std::size_t action_size_;
  std::vector<plant::StepperAxis> axes_;
  std::vector<float> actions_;
};

}  // namespace stator::environment
