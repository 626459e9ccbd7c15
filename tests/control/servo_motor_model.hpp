#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "stator/base/servo_signals.hpp"
#include "stator/control/servo/servo_controller.hpp"

namespace stator::control {

/// A linear three-phase motor, as small as the formulas it is compared with: R, L, flux, inertia,
/// Coulomb friction and a load; ideal inverter, halls, encoder and current measurement. libm is
/// fine here: it is the reference.
class ServoMotorModel {
 public:
  struct Parameters {
    int pole_pairs = 4;
    double resistance = 0.36;    ///< ohm, phase
    double inductance = 0.6e-3;  ///< H
    double flux = 6e-3;          ///< V s
    double inertia = 4.8e-6;     ///< kg m^2; 0: the shaft is locked
    double friction = 0.0;       ///< N m
    double viscous = 1e-5;       ///< N m s/rad
    double supply = 24.0;        ///< V
    int encoder_steps = 4000;    ///< per revolution
    double angle = 0.0;          ///< rad, of the shaft at power-on
    double index_angle = 1.0;    ///< rad, of the shaft at the N pulse
  };

  explicit ServoMotorModel(const Parameters& parameters)
      : p_(parameters), angle_(parameters.angle) {
    read_sensors();
  }

  /// One period of 50 us.
  void step(const base::ServoActuation& actuation) {
    constexpr int kParts = 20;
    constexpr double kTime = 50e-6 / kParts;
    for (int part = 0; part < kParts; ++part) {
      const double c = std::cos(electrical_angle());
      const double s = std::sin(electrical_angle());
      if (actuation.bridge_enabled) {
        const double u = actuation.duty[0] * p_.supply;
        const double v = actuation.duty[1] * p_.supply;
        const double w = actuation.duty[2] * p_.supply;
        const double alpha = (2.0 * u - v - w) / 3.0;
        const double beta = (v - w) / std::sqrt(3.0);
        const double omega = p_.pole_pairs * speed_;
        const double ud = c * alpha + s * beta + omega * p_.inductance * iq_;
        const double uq = c * beta - s * alpha - omega * (p_.inductance * id_ + p_.flux);
        const double decay = std::exp(-p_.resistance / p_.inductance * kTime);
        id_ = id_ * decay + ud / p_.resistance * (1.0 - decay);
        iq_ = iq_ * decay + uq / p_.resistance * (1.0 - decay);
      } else {
        id_ = 0.0;
        iq_ = 0.0;
      }
      turn(kTime);
    }
    read_sensors();
  }

  [[nodiscard]] const base::ServoSensing& sensing() const { return sensing_; }
  [[nodiscard]] base::ServoSensing& sensing() { return sensing_; }
  [[nodiscard]] Parameters& parameters() { return p_; }
  [[nodiscard]] double electrical_angle() const { return p_.pole_pairs * angle_; }
  [[nodiscard]] double electrical_turns() const {
    const double turns = electrical_angle() / (2.0 * M_PI);
    return turns - std::floor(turns);
  }
  [[nodiscard]] double angle() const { return angle_; }
  [[nodiscard]] double rpm() const { return speed_ * 30.0 / M_PI; }
  [[nodiscard]] double id() const { return id_; }
  [[nodiscard]] double iq() const { return iq_; }
  [[nodiscard]] double torque_constant() const { return 1.5 * p_.pole_pairs * p_.flux; }
  void set_load(double torque) { load_ = torque; }
  void set_speed(double speed) { speed_ = speed; }
  /// Turns the shaft by hand.
  void set_angle(double angle) {
    angle_ = angle;
    read_sensors();
  }
  /// The lines of H1 and H2 are swapped, or H1 is inverted.
  bool halls_swapped = false;
  bool hall_inverted = false;

 private:
  void turn(double time) {
    if (p_.inertia == 0.0) {
      return;
    }
    const double torque = torque_constant() * iq_ - load_ - p_.viscous * speed_;
    if (speed_ == 0.0 && std::fabs(torque) <= p_.friction) {
      return;
    }
    const double direction =
        speed_ != 0.0 ? std::copysign(1.0, speed_) : std::copysign(1.0, torque);
    const double before = speed_;
    speed_ += (torque - direction * p_.friction) / p_.inertia * time;
    if (before * speed_ < 0.0) {
      speed_ = 0.0;
    }
    const double turns = std::floor((angle_ - p_.index_angle) / (2.0 * M_PI));
    angle_ += speed_ * time;
    if (std::floor((angle_ - p_.index_angle) / (2.0 * M_PI)) != turns) {
      ++sensing_.encoder_index_passages;
      sensing_.encoder_index_count = count();
    }
  }
  [[nodiscard]] std::int64_t count() const {
    return static_cast<std::int64_t>(
        std::floor((angle_ - p_.angle) / (2.0 * M_PI) * p_.encoder_steps + 0.5));
  }
  void read_sensors() {
    const double c = std::cos(electrical_angle());
    const double s = std::sin(electrical_angle());
    const double alpha = c * id_ - s * iq_;
    const double beta = s * id_ + c * iq_;
    sensing_.phase_current = {alpha, -0.5 * alpha + std::sqrt(0.75) * beta,
                              -0.5 * alpha - std::sqrt(0.75) * beta};
    unsigned halls = 0;
    for (int k = 0; k < 3; ++k) {
      halls |= static_cast<unsigned>(std::cos(electrical_angle() - k * 2.0 * M_PI / 3.0) > 0.0)
               << k;
    }
    if (halls_swapped) {
      halls = (halls & 4U) | ((halls & 1U) << 1U) | ((halls & 2U) >> 1U);
    }
    if (hall_inverted) {
      halls ^= 1U;
    }
    sensing_.halls = static_cast<std::uint8_t>(halls);
    sensing_.encoder_count = count();
    sensing_.supply_voltage = p_.supply;
  }

  Parameters p_;
  double id_ = 0.0;
  double iq_ = 0.0;
  double speed_ = 0.0;
  double angle_;
  double load_ = 0.0;
  base::ServoSensing sensing_;
};

/// A controller on that motor.
struct ServoBench {
  explicit ServoBench(const ServoControllerSettings& settings = {},
                      const ServoMotorModel::Parameters& parameters = {})
      : motor(parameters) {
    controller.configure(settings);
  }
  void step() {
    actuation = controller.step(set_point, motor.sensing());
    motor.step(actuation);
  }
  void run(double seconds) {
    const auto periods = static_cast<std::int64_t>(seconds * 20'000.0 + 0.5);
    for (std::int64_t k = 0; k < periods; ++k) {
      step();
    }
  }

  ServoMotorModel motor;
  ServoController controller;
  ServoSetPoint set_point;
  base::ServoActuation actuation;
};

}  // namespace stator::control
