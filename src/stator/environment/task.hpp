#pragma once

#include <span>
#include <string_view>

#include "stator/environment/drives.hpp"
#include "stator/environment/settings.hpp"

namespace stator::environment {

/// What the numbers of an observation are, in their order. Each is divided by the value at which
/// the episode ends, or by what its description says, and cut to -1..1.
[[nodiscard]] std::span<const std::string_view> observation_names(Task task);

/// What the numbers of an action are, in their order.
[[nodiscard]] std::span<const std::string_view> action_names(PlantKind plant, ActionKind action);

/// How well an axis does what it is told, and how that looks.
class Judge {
 public:
  Judge(const EnvironmentSettings& settings, const Scales& scales);

  /// Fills an observation, observation_names() has its length.
  void observe(const Reading& reading, double target, std::span<float> observation) const;

  /// 1 for a target that is met, less by the error over twice the largest target, at least 0; less
  /// the effort, which is the mean square of `action`, times its weight.
  [[nodiscard]] double reward(const Reading& reading, double target,
                              std::span<const float> action) const;

  /// A limit is passed: of current, of speed, or of travel where a position is controlled.
  [[nodiscard]] bool ends(const Reading& reading) const;

 private:
  [[nodiscard]] double error(const Reading& reading, double target) const;

  Task task_;
  Scales scales_;
  double effort_weight_;
  double per_current_;         ///< 1/A
  double per_torque_;          ///< 1/(N m)
  double per_speed_;           ///< s/rad
  double per_revolution_;      ///< of the limit of travel
  double per_supply_voltage_;  ///< 1/V
  double per_error_;           ///< of twice the largest target
  double square_trip_current_;
};

}  // namespace stator::environment
