// A motor on voltages instead of regulated currents, as StealthChop drives it.

#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

/// A voltage vector of constant amplitude that turns.
class RotatingVoltage {
 public:
  RotatingVoltage(StepperAxis& axis, double duty) : axis_(axis), duty_(duty) {}

  void run(double seconds, double acceleration = 0.0) {
    const int steps = static_cast<int>(std::lround(seconds / 50e-6));
    for (int n = 0; n < steps; ++n) {
      speed_ += acceleration * 50e-6;
      angle_ = std::fmod(angle_ + 50.0 * speed_ * 50e-6, base::kTwoPi);
      base::AxisActuation actuation{.bridge_enabled = true, .voltage_mode = true};
      actuation.coil_duty = {duty_ * std::cos(angle_), duty_ * std::sin(angle_)};
      axis_.step(actuation, 50_us);
      const auto current = axis_.observe().coil_current;
      square_ += current[0] * current[0] + current[1] * current[1];
      ++samples_;
    }
  }
  /// Root mean square of the current vector since the last call, A.
  double current() {
    const double result = std::sqrt(square_ / samples_);
    square_ = 0.0;
    samples_ = 0;
    return result;
  }
  void set_duty(double duty) { duty_ = duty; }

 private:
  StepperAxis& axis_;
  double duty_;
  double speed_ = 0.0;
  double angle_ = 0.0;
  double square_ = 0.0;
  int samples_ = 0;
};

StepperAxisParameters heavy() {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.motor.temperature_coefficient = 0.0;
  return parameters;
}

TEST(VoltageMode, ABlockedMotorCarriesVoltageOverImpedance) {
  StepperAxisParameters parameters = heavy();
  parameters.load.coulomb_friction = 100.0;  // the shaft does not move: no EMF
  StepperAxis axis(parameters);
  RotatingVoltage field(axis, 0.2);
  for (const double electrical : {0.0, 300.0, 1500.0}) {
    RotatingVoltage turning(axis, 0.2);
    turning.run(0.05, electrical / 50.0 / 0.05);
    turning.run(0.1);
    turning.current();
    turning.run(0.1);
    const double impedance = std::hypot(0.8, electrical * 2.1e-3);
    EXPECT_NEAR(turning.current(), 0.2 * 24.0 / impedance, 0.01 * 0.2 * 24.0 / impedance)
        << electrical << " rad/s";
    EXPECT_EQ(axis.observe().speed, 0.0);
  }
}

TEST(VoltageMode, TheEmfOfATurningMotorTakesCurrentAway) {
  StepperAxisParameters parameters = heavy();
  parameters.motor.detent_torque = 0.0;
  parameters.motor.viscous_friction = 5e-3;
  StepperAxis axis(parameters);
  RotatingVoltage field(axis, 0.08);
  field.run(0.5);
  field.current();
  field.run(0.1);
  const double standing = field.current();
  const double speed = base::kTwoPi;  // 1 rev/s
  field.run(1.0, speed);
  field.run(1.0);
  field.current();
  field.run(0.5);
  const double turning = field.current();
  EXPECT_NEAR(standing, 0.08 * 24.0 / 0.8, 0.01);
  // U, R I + j w L I and E in the frame of the rotor: Te = Kt iq = B w + friction; E lies on q.
  const double kt = 50.0 * parameters.motor.flux_linkage;
  const double iq = (5e-3 * speed + parameters.motor.coulomb_friction) / kt;
  const double reactance = 50.0 * speed * 2.1e-3;
  const double voltage = 0.08 * 24.0;
  // |U|^2 = (R id - X iq)^2 + (R iq + X id + E)^2, solved for id by bisection on its falling side.
  double low = -5.0;
  double high = 5.0;
  const auto excess = [&](double id) {
    return std::hypot(0.8 * id - reactance * iq, 0.8 * iq + reactance * id + kt * speed) - voltage;
  };
  low = -0.8 * 0.0 - reactance * kt * speed / (0.64 + reactance * reactance);  // the minimum
  for (int n = 0; n < 60; ++n) {
    const double middle = 0.5 * (low + high);
    (excess(middle) < 0.0 ? low : high) = middle;
  }
  EXPECT_NEAR(turning, std::hypot(low, iq), 0.02 * turning);
  EXPECT_LT(turning, standing);
}

}  // namespace
}  // namespace stator::plant
