#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <vector>

#include "stator/plant/motors/three_phase_motor.hpp"

namespace stator::devices::tmc8670 {

/// Gains of the loops in SI units.
struct LoopGains {
  double current = 0.0;            ///< V/A
  double current_integral = 0.0;   ///< share of it that each period adds
  double velocity = 0.0;           ///< A per rad/s
  double velocity_integral = 0.0;  ///< share of it that each period adds
  double position = 0.0;           ///< rad/s per rad
};

/// What a FOC drive would do with numbers that have no steps: a three-phase motor without dry
/// friction, voltages held for a period and a period late, PI controllers without limits, velocity
/// from what the shaft turned in four intervals of 15/65536 s. Integrated by fourth-order
/// Runge-Kutta in sixteenths of a period in the stator frame: shares nothing with what it judges.
class LinearDrive {
 public:
  LinearDrive(const plant::ThreePhaseMotorParameters& motor, double load_inertia, double period,
              const LoopGains& gains)
      : motor_(motor),
        inertia_(motor.rotor_inertia + load_inertia),
        period_(period),
        gains_(gains) {}

  double direct_target = 0.0;      ///< A
  double quadrature_target = 0.0;  ///< A, of the current loop alone
  double velocity_target = 0.0;    ///< rad/s
  double position_target = 0.0;    ///< rad
  bool closes_velocity = false;
  bool closes_position = false;
  double load_torque = 0.0;  ///< N m, positive = forward

  [[nodiscard]] double direct() const { return dq()[0]; }
  [[nodiscard]] double quadrature() const { return dq()[1]; }
  [[nodiscard]] double speed() const { return state_[2]; }  ///< rad/s
  [[nodiscard]] double angle() const { return state_[3]; }  ///< rad of the shaft
  void set_speed(double speed) { state_[2] = speed; }

  void step() {
    meter();
    double target = quadrature_target;
    if (closes_velocity || closes_position) {
      const double wanted =
          closes_position ? gains_.position * (position_target - angle()) : velocity_target;
      const double error = wanted - measured_speed_;
      speed_integral_ += gains_.velocity * gains_.velocity_integral * error;
      target = gains_.velocity * error + speed_integral_;
    }
    const auto [d, q] = dq();
    const double direct_error = direct_target - d;
    const double quadrature_error = target - q;
    integral_[0] += gains_.current * gains_.current_integral * direct_error;
    integral_[1] += gains_.current * gains_.current_integral * quadrature_error;
    const double ud = gains_.current * direct_error + integral_[0];
    const double uq = gains_.current * quadrature_error + integral_[1];
    const double electrical = motor_.pole_pairs * angle();
    const double c = std::cos(electrical);
    const double s = std::sin(electrical);
    const Vector applied = next_;
    next_ = {c * ud - s * uq, s * ud + c * uq};
    constexpr int kParts = 16;
    for (int n = 0; n < kParts; ++n) {
      integrate(applied, period_ / kParts);
    }
  }

 private:
  using Vector = std::array<double, 2>;
  using State = std::array<double, 4>;  ///< i_alpha, i_beta, speed, angle

  [[nodiscard]] Vector dq() const {
    const double electrical = motor_.pole_pairs * angle();
    const double c = std::cos(electrical);
    const double s = std::sin(electrical);
    return {c * state_[0] + s * state_[1], c * state_[1] - s * state_[0]};
  }
  [[nodiscard]] State slope(const State& x, const Vector& u) const {
    const double p = motor_.pole_pairs;
    const double c = std::cos(p * x[3]);
    const double s = std::sin(p * x[3]);
    const double emf = p * x[2] * motor_.flux_linkage;
    const double r = motor_.resistance;
    const double l = motor_.direct_inductance;
    const double torque = motor_.torque_constant() * (x[1] * c - x[0] * s);
    return {(u[0] - r * x[0] + emf * s) / l, (u[1] - r * x[1] - emf * c) / l,
            (torque - motor_.viscous_friction * x[2] + load_torque) / inertia_, x[2]};
  }
  void integrate(const Vector& u, double h) {
    const auto at = [this](const State& k, double by) {
      State result = state_;
      for (std::size_t n = 0; n < result.size(); ++n) {
        result[n] += by * k[n];
      }
      return result;
    };
    const State k1 = slope(state_, u);
    const State k2 = slope(at(k1, 0.5 * h), u);
    const State k3 = slope(at(k2, 0.5 * h), u);
    const State k4 = slope(at(k3, h), u);
    for (std::size_t n = 0; n < state_.size(); ++n) {
      state_[n] += h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]);
    }
  }
  void meter() {
    constexpr double kInterval = 15.0 / 65536.0;
    since_ += period_;
    if (since_ >= kInterval) {
      since_ -= kInterval;
      const double then = angle() - (angle() - last_angle_) * since_ / period_;
      measured_speed_ = (then - samples_[oldest_]) / (4.0 * kInterval);
      samples_[oldest_] = then;
      oldest_ = (oldest_ + 1) % samples_.size();
    }
    last_angle_ = angle();
  }

  plant::ThreePhaseMotorParameters motor_;
  double inertia_;
  double period_;
  LoopGains gains_;
  State state_{};
  Vector next_{};
  Vector integral_{};
  double speed_integral_ = 0.0;
  double measured_speed_ = 0.0;
  double since_ = 0.0;
  double last_angle_ = 0.0;
  std::array<double, 4> samples_{};
  std::size_t oldest_ = 0;
};

/// What the figure of a step response to 1 tells, in samples.
struct StepFigures {
  double rise = 0.0;       ///< from 10 % to 90 %
  double overshoot = 0.0;  ///< share of the step
  double settling = 0.0;   ///< until it stays within 5 %
};

inline StepFigures figures_of(const std::vector<double>& response) {
  const auto between = [&](std::size_t k, double level) {
    return static_cast<double>(k) - (response[k] - level) / (response[k] - response[k - 1]);
  };
  const auto first = [&](double level) {
    const auto found =
        std::find_if(response.begin(), response.end(), [&](double y) { return y >= level; });
    return found == response.end() || found == response.begin()
               ? 0.0
               : between(static_cast<std::size_t>(found - response.begin()), level);
  };
  StepFigures result{
      .rise = first(0.9) - first(0.1),
      .overshoot = *std::max_element(response.begin(), response.end()) - 1.0,
  };
  for (std::size_t k = 1; k < response.size(); ++k) {
    const double before = response[k - 1] - 1.0;
    if (std::fabs(before) > 0.05 && std::fabs(response[k] - 1.0) <= 0.05) {
      result.settling = between(k, before > 0.0 ? 1.05 : 0.95);
    }
  }
  return result;
}

/// A current loop at rest: the winding L di/dt = u - R i with the voltage held for a period and a
/// period late, i(k+1) = a i(k) + b u(k-1), and a PI controller u = P (e + I sum of e).
class LinearCurrentLoop {
 public:
  LinearCurrentLoop(double resistance, double inductance, double period, const LoopGains& gains)
      : a_(std::exp(-period * resistance / inductance)),
        b_((1.0 - a_) / resistance),
        p_(gains.current),
        i_(gains.current_integral) {}

  /// From target to current at `frequency` in parts of the PWM frequency.
  [[nodiscard]] std::complex<double> gain(double frequency) const {
    const std::complex<double> back = std::polar(1.0, -2.0 * M_PI * frequency);
    const std::complex<double> open =
        p_ * (1.0 + i_ / (1.0 - back)) * b_ * back * back / (1.0 - a_ * back);
    return open / (1.0 + open);
  }
  /// Where its magnitude is sqrt(0.5).
  [[nodiscard]] double bandwidth() const {
    double low = 1e-4;
    double high = 0.4;
    for (int n = 0; n < 60; ++n) {
      const double middle = 0.5 * (low + high);
      (std::abs(gain(middle)) > std::sqrt(0.5) ? low : high) = middle;
    }
    return low;
  }
  /// To a step of 1 at the first of `length` periods.
  [[nodiscard]] std::vector<double> step_response(std::size_t length) const {
    std::vector<double> result;
    double current = 0.0;
    double applied = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < length; ++k) {
      result.push_back(current);
      sum += i_ * (1.0 - current);
      const double voltage = p_ * (1.0 - current + sum);
      current = a_ * current + b_ * applied;
      applied = voltage;
    }
    return result;
  }

 private:
  double a_;
  double b_;
  double p_;
  double i_;
};

}  // namespace stator::devices::tmc8670
