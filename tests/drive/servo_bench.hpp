#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "drive/object_bench.hpp"
#include "stator/base/servo_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/drive/servo/servo_axis.hpp"

namespace stator::drive {

/// A motor with four pole pairs, resistance, inductance, flux and inertia, and what is on its
/// shaft: an encoder of 4000 counts, halls, hard stops, a load. 0.03 Nm/A, 24 V.
class ServoMotor {
 public:
  static constexpr double kCounts = 4000.0;  ///< per revolution

  void step(const base::ServoActuation& actuation);
  /// Everything but switches and supply.
  void read(base::ServoSensing& sensing) const;

  [[nodiscard]] double counts() const { return revolutions_ * kCounts; }
  [[nodiscard]] double rpm() const;
  /// Turned by hand.
  void turn_to(double counts) { revolutions_ = counts / kCounts; }
  void brake_hard() { speed_ = 0.0; }

  double load = 0.0;                 ///< Nm, positive drives forward
  bool blocked = false;              ///< the shaft does not turn
  std::optional<double> lower_stop;  ///< counts since power-on
  std::optional<double> upper_stop;

 private:
  void keep_between_stops();

  double revolutions_ = 1e-4;
  double speed_ = 0.0;  ///< rad/s
  double alpha_ = 0.0;  ///< A
  double beta_ = 0.0;
};

/// A servo axis with the objects of a TMCC160, its controller and a motor.
class ServoBench : public ObjectBench {
 public:
  ServoBench();

  [[nodiscard]] bool flag(ServoFlag which) const { return axis->flags().has(which); }

  void pass(base::SimDuration duration) override;
  /// 6060h, then 6, 7, 15.
  void enable(ModeCode mode);
  [[nodiscard]] double rpm() const { return motor.rpm(); }
  [[nodiscard]] std::int64_t position() const { return read(0x6064); }

  std::unique_ptr<ServoAxis> axis;
  ServoMotor motor;
  base::ServoSensing sensing;
  base::ServoActuation actuation;

  /// Pressed at and beyond these counts since power-on.
  std::optional<double> left_switch;
  std::optional<double> right_switch;

 private:
  void obey() override { axis->apply(now); }
  void read_switches();
  int steps_to_tick_ = 0;
};

}  // namespace stator::drive
