#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/mechanics/rotation.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"

namespace stator::plant {

/// What a motor itself puts on its shaft.
struct RotorMechanics {
  double inertia = 1e-5;          ///< kg m^2
  double viscous_friction = 0.0;  ///< N m s/rad
  double coulomb_friction = 0.0;  ///< N m
  double static_friction = 0.0;   ///< N m, at least coulomb_friction
  double stribeck_speed = 0.5;    ///< rad/s at which half of their difference is left
  std::int64_t pole_pairs = 1;    ///< electrical periods per revolution
};

/// Rotor and load on one stiff shaft:
///   J dw/dt = Tmotor - Tfriction(w) - B w + Tload(angle, w)
/// Friction: sgn(w) (Tc + (Ts - Tc) / (1 + (w / ws)^2)) (Hess and Soom's form of the Stribeck
/// curve, which needs no exponential function); at rest up to Ts against any torque.
///
/// The sign of dry friction is frozen over a step; settle() corrects a step that ends with the
/// opposite sign of speed by the part of it after the crossing, and the shaft sticks at exactly 0
/// if friction can hold it.
class ShaftMechanics {
 public:
  ShaftMechanics(const RotorMechanics& rotor, const MechanicalLoad& load);

  /// What one step holds fast: friction's direction, and where the shaft was when the step began.
  struct Frozen {
    double steady_torque = 0.0;  ///< load and outside, N m
    double friction_sign = 0.0;  ///< -1, 0, 1
    double coulomb_friction = 0.0;
    base::SineCosine shaft{};     ///< of the mechanical angle, for the unbalance
    double beyond_minimum = 0.0;  ///< mechanical rad the shaft is above the lower end stop
    double beyond_maximum = 0.0;  ///< and above the upper one
    /// Unbalance or an end stop may act within the step (which turns the shaft by less than a
    /// radian divided by p).
    bool positional = false;
  };

  /// A step that begins at `angle` with `outside_torque` on the shaft; friction_sign is left 0.
  [[nodiscard]] Frozen freeze(const ElectricalAngle& angle, double outside_torque,
                              bool brake_engaged) const {
    Frozen frozen;
    frozen.steady_torque = load_.constant_torque + outside_torque;
    frozen.coulomb_friction = coulomb_friction(brake_engaged);
    if (depends_on_position_) {
      locate(frozen, angle);
    }
    return frozen;
  }

  /// Magnitude of dry friction at `speed`, N m.
  [[nodiscard]] double dry_friction(const Frozen& frozen, double speed) const {
    return creeps(speed) ? frozen.coulomb_friction + stribeck_friction(speed)
                         : frozen.coulomb_friction;
  }
  /// The part of it that does not depend on speed.
  [[nodiscard]] double coulomb_friction(bool brake_engaged) const {
    return brake_engaged ? coulomb_friction_ + load_.brake_torque : coulomb_friction_;
  }
  /// And the part by which it is larger at low speed.
  [[nodiscard]] double stribeck_friction(double speed) const {
    const double ratio = speed * inverse_stribeck_speed_;
    return stribeck_rise_ / (1.0 + ratio * ratio);
  }
  /// Whether so much of that is left, 1e-4 of its value at rest, that it is worth a division.
  [[nodiscard]] bool creeps(double speed) const {
    const double ratio = speed * inverse_stribeck_speed_;
    return ratio * ratio <= 1e4;
  }
  /// Torque friction holds a standing shaft with, N m.
  [[nodiscard]] double holding_friction(const Frozen& frozen) const {
    return frozen.coulomb_friction + stribeck_rise_;
  }

  [[nodiscard]] bool depends_on_position() const { return depends_on_position_; }
  /// Torque of unbalance and end stops with the shaft `turned` mechanical rad since the step began.
  [[nodiscard]] double positional_torque(const Frozen& frozen, double turned, double speed) const {
    // Within a step the shaft turns by less than 0.33 / p rad: the series is exact to 1e-12.
    const double z = turned * turned;
    const double torque =
        -load_.unbalance_torque *
        (frozen.shaft.sine * (1.0 - 0.5 * z) + frozen.shaft.cosine * turned * (1.0 - z / 6.0));
    return has_end_stops_ ? torque + end_stop_torque(frozen, turned, speed) : torque;
  }
  /// The part of it with which an end stop pushes back.
  [[nodiscard]] double end_stop_torque(const Frozen& frozen, double turned, double speed) const {
    double torque = 0.0;
    const double above = frozen.beyond_maximum + turned;
    if (above > 0.0) {
      torque -= std::max(0.0, load_.end_stop_stiffness * above + load_.end_stop_damping * speed);
    }
    const double below = -(frozen.beyond_minimum + turned);
    if (below > 0.0) {
      torque += std::max(0.0, load_.end_stop_stiffness * below - load_.end_stop_damping * speed);
    }
    return torque;
  }
  /// Whether the shaft lies against an end stop or reaches one by `reach` mechanical rad.
  [[nodiscard]] bool near_end_stop(const ElectricalAngle& angle, double reach) const {
    return mechanical_distance(end_stop_minimum_, angle) < reach ||
           mechanical_distance(end_stop_maximum_, angle) > -reach;
  }
  [[nodiscard]] bool has_end_stops() const { return has_end_stops_; }

  /// Corrects `speed` and `angle` for friction that pushed the wrong way since speed crossed zero
  /// within a step of `step` seconds that began with `speed_before`. True: it had to.
  bool settle(double& speed, ElectricalAngle& angle, const Frozen& frozen, double speed_before,
              double step) const;

  /// Position since the zero of `angle`, revolutions.
  [[nodiscard]] double revolutions(const ElectricalAngle& angle) const {
    return (static_cast<double>(angle.periods) + angle.angle * (1.0 / base::kTwoPi)) *
           inverse_pole_pairs_;
  }
  /// The angle at which revolutions() is `revolutions`.
  [[nodiscard]] ElectricalAngle angle_at(double revolutions) const;

  /// The fastest of resonance with a torque of `stiffness` (N m/rad), damping and end stop, rad/s.
  [[nodiscard]] double fastest_rate(double stiffness, bool at_end_stop) const;

  [[nodiscard]] double inertia() const { return inertia_; }  ///< rotor and load, kg m^2
  [[nodiscard]] double inverse_inertia() const { return inverse_inertia_; }
  [[nodiscard]] double viscous_friction() const { return viscous_friction_; }  ///< of both
  [[nodiscard]] const MechanicalLoad& load() const { return load_; }

 private:
  void locate(Frozen& frozen, const ElectricalAngle& angle) const;
  /// From `to` to `angle` in mechanical radians.
  [[nodiscard]] double mechanical_distance(const ElectricalAngle& to,
                                           const ElectricalAngle& angle) const {
    return (static_cast<double>(angle.periods - to.periods) * base::kTwoPi +
            (angle.angle - to.angle)) *
           inverse_pole_pairs_;
  }

  MechanicalLoad load_;
  std::int64_t pole_pairs_;
  double inverse_pole_pairs_;
  double inertia_;
  double inverse_inertia_;   ///< 1/(kg m^2)
  double viscous_friction_;  ///< motor and load, N m s/rad
  double coulomb_friction_;  ///< motor and load, N m
  double stribeck_rise_;     ///< Ts - Tc, N m
  double inverse_stribeck_speed_;
  bool has_end_stops_;
  bool depends_on_position_;
  ElectricalAngle end_stop_minimum_;
  ElectricalAngle end_stop_maximum_;
};

}  // namespace stator::plant
