#pragma once

#include <cstddef>
#include <span>

#include "stator/control/current_loop/current_loop_batch.hpp"
#include "stator/environment/drives.hpp"
#include "stator/plant/batch/servo_batch.hpp"

namespace stator::environment {

/// Servo axes in the lanes of vectors, each with a motor of its own. Voltages and currents are
/// modulated with the angle that the encoder shows; a drive's current loop has the gains for the
/// motor as it is nominally, whatever the motor of an episode is. Motors do not get warm.
template <typename Number>
class ServoDrives final : public Drives {
 public:
  ServoDrives(const EnvironmentSettings& settings, const Scales& scales, std::size_t axes);

  void restart(std::size_t axis, const Conditions& conditions) override;
  void set_load_torque(std::size_t axis, double torque) override {
    plants_.set_external_torque(axis, torque);
  }
  void act(std::span<const float> actions) override;
  void pass() override;
  void read(std::span<Reading> readings) const override;
  [[nodiscard]] Reading read(std::size_t axis) const override;

 private:
  static constexpr std::size_t kLanes = base::ServoLanes<Number>::kLanes;

  ActionKind action_;
  int steps_;
  Scales scales_;
  double inverse_pole_pairs_;
  plant::ServoBatch<Number> plants_;
  control::CurrentLoopBatch<Number> loops_;
};

extern template class ServoDrives<double>;
extern template class ServoDrives<float>;

}  // namespace stator::environment
