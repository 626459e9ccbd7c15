#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "stator/environment/conditions.hpp"
#include "stator/environment/settings.hpp"

namespace stator::environment {

/// What is known of one axis after a step.
struct Reading {
  double direct_current = 0.0;      ///< A along the magnets, measured
  double quadrature_current = 0.0;  ///< A across the magnets, measured
  double sine = 0.0;                ///< of the electrical angle as the encoder shows it
  double cosine = 1.0;
  double speed = 0.0;           ///< rad/s of the shaft, true
  double revolutions = 0.0;     ///< of the shaft since its zero, true
  double supply_voltage = 0.0;  ///< V at the power stage
};

/// Axes of one kind with what is in their drives, all of which pass the same time. Actions and
/// readings stand in the order of the axes.
class Drives {
 public:
  virtual ~Drives() = default;
  Drives() = default;
  Drives(const Drives&) = delete;
  Drives& operator=(const Drives&) = delete;

  /// Begins anew with `axis`, without currents.
  virtual void restart(std::size_t axis, const Conditions& conditions) = 0;
  /// Torque on the shaft from outside, N m, until set again.
  virtual void set_load_torque(std::size_t axis, double torque) = 0;
  /// What holds from now on; numbers in -1..1, action_size() for each axis.
  virtual void act(std::span<const float> actions) = 0;
  /// Lets the time of one action pass.
  virtual void pass() = 0;
  virtual void read(std::span<Reading> readings) const = 0;
  [[nodiscard]] virtual Reading read(std::size_t axis) const = 0;
};

/// Numbers in an action.
[[nodiscard]] std::size_t action_size(PlantKind plant, ActionKind action);

[[nodiscard]] std::unique_ptr<Drives> make_drives(const EnvironmentSettings& settings,
                                                  const Scales& scales, std::size_t axes);

}  // namespace stator::environment
