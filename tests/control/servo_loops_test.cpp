// Step responses of the TMCC160's current, velocity and position loop, within 2 % of a linear
// model.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "control/servo_motor_model.hpp"
#include "stator/control/servo/servo_controller.hpp"

namespace stator::control {
namespace {

constexpr double kPeriod = 50e-6;
constexpr double kRpm = M_PI / 30.0;

/// The cascade on a motor without friction as a linear system in doubles and SI units, with the
/// gains as ServoControllerSettings states them: no transformation, no rounding, no limit.
class LinearModel {
 public:
  LinearModel(const ServoControllerSettings& gains, const ServoMotorModel::Parameters& motor)
      : m_(motor),
        current_p_(gains.torque_p / 256.0),
        current_i_(gains.torque_i / 65536.0),
        velocity_p_(outer_gain_unit(gains.commutation) * gains.velocity_p / 256e3 / kRpm),
        velocity_i_(outer_gain_unit(gains.commutation) * gains.velocity_i / 65536e3 / kRpm),
        position_p_(outer_gain_unit(gains.commutation) * gains.position_p / 15.0) {}

  void step(const ServoSetPoint& target, double target_angle = 0.0) {
    if (period_++ % 20 == 0) {
      const double speed = (angle_ - last_angle_) / (20.0 * kPeriod);
      last_angle_ = angle_;
      double demand = target.velocity * kRpm;
      if (target.loop == ServoLoop::position) {
        demand += position_p_ * (target_angle - angle_);
      }
      const double error = demand - speed;
      speed_sum_ += error;
      torque_ = target.loop == ServoLoop::torque ? target.torque
                                                 : velocity_p_ * error + velocity_i_ * speed_sum_;
    }
    const double error = torque_ - iq_;
    current_sum_ += error;
    const double applied = voltage_;
    voltage_ = current_p_ * error + current_i_ * current_sum_;
    constexpr int kParts = 20;
    for (int part = 0; part < kParts; ++part) {
      constexpr double kTime = kPeriod / kParts;
      const double emf = m_.pole_pairs * speed_ * m_.flux;
      const double decay = std::exp(-m_.resistance / m_.inductance * kTime);
      iq_ = iq_ * decay + (applied - emf) / m_.resistance * (1.0 - decay);
      if (m_.inertia > 0.0) {
        speed_ += (1.5 * m_.pole_pairs * m_.flux * iq_ - m_.viscous * speed_) / m_.inertia * kTime;
        angle_ += speed_ * kTime;
      }
    }
  }
  [[nodiscard]] double iq() const { return iq_; }
  [[nodiscard]] double rpm() const { return speed_ / kRpm; }
  [[nodiscard]] double angle() const { return angle_; }

 private:
  ServoMotorModel::Parameters m_;
  double current_p_;
  double current_i_;
  double velocity_p_;
  double velocity_i_;
  double position_p_;
  int period_ = 0;
  double current_sum_ = 0.0;
  double speed_sum_ = 0.0;
  double torque_ = 0.0;
  double voltage_ = 0.0;
  double iq_ = 0.0;
  double speed_ = 0.0;
  double angle_ = 0.0;
  double last_angle_ = 0.0;
};

ServoMotorModel::Parameters locked() {
  ServoMotorModel::Parameters motor;
  motor.inertia = 0.0;
  return motor;
}

/// Encoder commutation, initialised by the halls, which are right at angle 0.
ServoControllerSettings with_encoder() {
  ServoControllerSettings settings;
  settings.commutation = ServoCommutation::encoder;
  return settings;
}

struct StepFigures {
  double overshoot = 0.0;  ///< of the step
  double rise = 0.0;       ///< periods, 10 to 90 %
  double settling = 0.0;   ///< periods, to 2 %
};

/// Of a response sampled once per period, between whose samples a straight line is drawn.
StepFigures figures_of(const std::vector<double>& response, double target) {
  StepFigures figures;
  double ten = -1.0;
  double ninety = -1.0;
  for (std::size_t k = 1; k < response.size(); ++k) {
    const double before = response[k - 1] / target;
    const double now = response[k] / target;
    const auto crossing = [&](double level) {
      return static_cast<double>(k - 1) + (level - before) / (now - before);
    };
    if (ten < 0.0 && now >= 0.1) {
      ten = crossing(0.1);
    }
    if (ninety < 0.0 && now >= 0.9) {
      ninety = crossing(0.9);
    }
    figures.overshoot = std::max(figures.overshoot, now - 1.0);
    if (std::fabs(now - 1.0) > 0.02) {
      figures.settling = static_cast<double>(k);
    }
  }
  figures.rise = ninety - ten;
  return figures;
}

std::vector<double> current_step(const ServoControllerSettings& settings, int periods) {
  ServoBench bench(settings, locked());
  bench.set_point = {.loop = ServoLoop::torque, .torque = 0.0, .velocity = 0.0, .position = {}};
  bench.run(0.01);
  bench.set_point.torque = 2.0;
  std::vector<double> response;
  for (int k = 0; k < periods; ++k) {
    response.push_back(bench.motor.iq());
    bench.step();
  }
  return response;
}

TEST(CurrentLoop, WithPoleAndZeroCancelledAnswersAsAOneAndAHalfPeriodDelayedLoopDoes) {
  struct Row {
    double bandwidth;  ///< of 1 / period
    double overshoot;
    double rise;
    double settling;
  };
  // Of the linear loop, published for this structure: delay of one period and holding.
  for (const Row row :
       {Row{0.10, 0.0, 18.0, 33.0}, Row{0.20, 0.0, 7.1, 13.0}, Row{0.25, 0.0, 4.7, 8.0},
        Row{1.0 / 3.0, 0.039, 2.8, 8.0}, Row{0.40, 0.12, 2.2, 7.0}, Row{0.50, 0.26, 1.6, 10.0}}) {
    const ServoMotorModel::Parameters motor = locked();
    ServoControllerSettings settings = with_encoder();
    const double gain = motor.inductance * row.bandwidth / kPeriod;  // V/A
    settings.torque_p = static_cast<std::uint16_t>(std::lround(256.0 * gain));
    settings.torque_i =
        static_cast<std::uint16_t>(std::lround(65536.0 * motor.resistance * row.bandwidth));
    const StepFigures figures = figures_of(current_step(settings, 200), 2.0);
    EXPECT_NEAR(figures.overshoot, row.overshoot, 0.012) << row.bandwidth;
    EXPECT_NEAR(figures.rise, row.rise, 0.06 * row.rise) << row.bandwidth;
    EXPECT_NEAR(figures.settling, row.settling, 2.1) << row.bandwidth;
  }
}

TEST(CurrentLoop, WithDefaultGainsIsWithin2PercentOfTheLinearModel) {
  const ServoControllerSettings settings = with_encoder();
  const std::vector<double> response = current_step(settings, 2000);
  LinearModel model(settings, locked());
  ServoSetPoint target;
  target.loop = ServoLoop::torque;
  target.torque = 2.0;
  for (const double measured : response) {
    ASSERT_NEAR(measured, model.iq(), 0.02 * 2.0);
    model.step(target);
  }
  EXPECT_NEAR(response.back(), 2.0, 0.02);
}

TEST(CurrentLoop, TorqueAndFluxShowErrorsAndSumsInMilliampere) {
  ServoBench bench(with_encoder(), locked());
  bench.set_point.loop = ServoLoop::torque;
  bench.set_point.torque = 2.0;
  bench.step();
  EXPECT_EQ(bench.controller.target_current(), 2000);
  EXPECT_EQ(bench.controller.ramp_target_current(), 2000);
  EXPECT_EQ(bench.controller.actual_current(), 0);
  EXPECT_EQ(bench.controller.torque_error(), 2000);
  EXPECT_EQ(bench.controller.torque_error_sum(), 2000);
  EXPECT_EQ(bench.controller.flux_error(), 0);
  bench.run(0.1);
  EXPECT_NEAR(bench.controller.actual_current(), 2000, 5);
  EXPECT_NEAR(bench.controller.torque_error(), 0, 5);
  // What holds the current against the resistance is the integral part.
  EXPECT_NEAR(bench.controller.torque_error_sum() * 500.0 / 65536.0, 2000.0 * 0.36, 15.0);
  EXPECT_NEAR(bench.controller.flux_error_sum() * 500.0 / 65536.0, 0.0, 15.0);
}

TEST(CurrentLoop, FluxAnswersAsTorqueDoes_OnePairOfGainsServesBoth) {
  ServoControllerSettings settings = with_encoder();
  settings.torque_p = 700;
  settings.torque_i = 3000;
  settings.open_loop_current = 2000;
  ServoBench torque(settings, locked());
  torque.set_point.loop = ServoLoop::torque;
  torque.set_point.torque = 2.0;
  settings.commutation = ServoCommutation::controlled;
  ServoBench flux(settings, locked());
  flux.set_point.loop = ServoLoop::velocity;
  for (int k = 0; k < 400; ++k) {
    torque.step();
    flux.step();
    ASSERT_NEAR(flux.motor.id(), torque.motor.iq(), 0.02) << k;
  }
  EXPECT_NEAR(flux.motor.id(), 2.0, 0.02);
  EXPECT_NEAR(flux.motor.iq(), 0.0, 0.02);
}

TEST(CurrentLoop, AnImpossibleTargetIsLeftAtOnce) {
  ServoControllerSettings settings = with_encoder();
  settings.maximum_torque = 90'000;
  ServoBench bench(settings, locked());
  bench.set_point.loop = ServoLoop::torque;
  bench.set_point.torque = 80.0;  // 28.8 V of 13.9 V
  bench.run(0.2);
  EXPECT_TRUE(bench.controller.voltage_limited());
  EXPECT_NEAR(bench.motor.iq(), 24.0 / std::sqrt(3.0) / 0.36, 0.05);
  bench.set_point.torque = 1.0;
  bench.run(0.002);  // driven down with the full negative voltage
  EXPECT_LT(bench.motor.iq(), 20.0);
  bench.run(0.1);
  EXPECT_NEAR(bench.motor.iq(), 1.0, 0.05);
  EXPECT_FALSE(bench.controller.voltage_limited());
}

TEST(CurrentLoop, WithoutGainsThereIsNoCurrent) {
  ServoControllerSettings settings = with_encoder();
  settings.torque_p = 0;
  settings.torque_i = 0;
  ServoBench bench(settings, locked());
  bench.set_point.loop = ServoLoop::torque;
  bench.set_point.torque = 4.0;
  bench.run(0.1);
  EXPECT_NEAR(bench.motor.iq(), 0.0, 1e-9);
}

TEST(VelocityLoop, StepIsWithin2PercentOfTheLinearModel) {
  constexpr double kTarget = 400.0;  // rpm; 3.1 A at first, below the limit
  // Of a motor without friction, alone and with a load of its own inertia or twice that.
  for (const auto& [inertia, overshoot] : {std::pair{4.8e-6, 1.35}, {1e-5, 1.1}, {1.5e-5, 1.1}}) {
    ServoMotorModel::Parameters motor;
    motor.inertia = inertia;
    motor.encoder_steps = 40'000;  // the linear model has no steps
    ServoControllerSettings settings = with_encoder();
    settings.encoder_steps = 40'000;
    ServoBench bench(settings, motor);
    LinearModel model(settings, motor);
    bench.set_point.loop = ServoLoop::velocity;
    bench.set_point.velocity = kTarget;
    double highest = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      bench.step();
      model.step(bench.set_point);
      ASSERT_NEAR(bench.motor.rpm(), model.rpm(), 0.02 * kTarget) << k;
      highest = std::max(highest, bench.motor.rpm());
    }
    EXPECT_LT(highest, overshoot * kTarget);
    EXPECT_NEAR(bench.motor.rpm(), kTarget, 0.005 * kTarget);
  }
}

TEST(VelocityLoop, AnIntegralPartTakesOverTheLoad) {
  ServoBench bench(with_encoder());
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 1000.0;
  bench.run(1.0);
  bench.motor.set_load(0.036);  // 1 A
  bench.run(0.05);
  EXPECT_GT(bench.controller.velocity_error(), 50);
  EXPECT_LT(bench.motor.rpm(), 970.0);
  bench.run(2.0);
  EXPECT_NEAR(bench.motor.rpm(), 1000.0, 5.0);
  EXPECT_NEAR(bench.controller.velocity_error_sum() * 500.0 / 65536.0 * 4.0, 1000.0, 60.0);
}

/// Its EMF is met before it drives a current that brakes it hard and charges the supply.
TEST(VelocityLoop, CatchesAMotorThatTurnsWhenItIsClosed) {
  for (ServoControllerSettings settings : {with_encoder(), ServoControllerSettings{}}) {
    settings.hall_interpolated = true;
    ServoBench bench(settings);
    bench.set_point.loop = ServoLoop::velocity;
    bench.set_point.velocity = 2000.0;
    bench.run(1.0);
    bench.set_point.loop = ServoLoop::off;
    bench.run(0.005);
    ASSERT_GT(bench.motor.rpm(), 1500.0);
    bench.set_point.loop = ServoLoop::velocity;
    bench.set_point.velocity = bench.motor.rpm();
    double braking = 0.0;
    for (int k = 0; k < 600; ++k) {
      bench.step();
      braking = std::max(braking, k < 40 ? 0.0 : -bench.motor.iq());
    }
    EXPECT_LT(braking, 0.5) << "after 2 ms";
  }
}

TEST(VelocityLoop, DemandIsLimited) {
  ServoControllerSettings settings = with_encoder();
  settings.maximum_velocity = 700;
  ServoBench bench(settings);
  bench.set_point.loop = ServoLoop::velocity;
  for (const double demand : {3000.0, -3000.0}) {
    bench.set_point.velocity = demand;
    bench.run(2.0);
    EXPECT_EQ(bench.controller.velocity_demand(), std::copysign(700.0, demand));
    EXPECT_NEAR(bench.motor.rpm(), std::copysign(700.0, demand), 5.0);
  }
}

TEST(PositionLoop, StepIsWithin2PercentOfTheLinearModel) {
  ServoMotorModel::Parameters motor;
  motor.encoder_steps = 40'000;
  ServoControllerSettings settings = with_encoder();
  settings.encoder_steps = 40'000;
  ServoBench bench(settings, motor);
  LinearModel model(settings, motor);
  bench.set_point.loop = ServoLoop::position;
  bench.set_point.position.microsteps = 5'000;  // an eighth of a revolution: 600 rpm at first
  for (int k = 0; k < 20'000; ++k) {
    bench.step();
    model.step(bench.set_point, 0.25 * M_PI);
    ASSERT_NEAR(bench.motor.angle(), model.angle(), 0.02 * 0.25 * M_PI) << k;
  }
  EXPECT_NEAR(static_cast<double>(bench.controller.position()), 5'000.0, 12.5);
}

TEST(PositionLoop, IsProportionalOnly_300Means4800RpmPerRevolutionOfAnEncoder) {
  ServoControllerSettings settings = with_encoder();
  ServoBench bench(settings, locked());
  bench.set_point.loop = ServoLoop::position;
  bench.set_point.position = {1000, 0.5};
  bench.run(0.5);
  EXPECT_DOUBLE_EQ(bench.controller.velocity_demand(), 4800.0 * 1000.5 / 4000.0);
  EXPECT_EQ(bench.controller.position_error(), 1000);
  bench.run(0.5);
  EXPECT_DOUBLE_EQ(bench.controller.velocity_demand(), 4800.0 * 1000.5 / 4000.0)
      << "nothing is summed";
  bench.set_point.velocity = 50.0;
  bench.run(0.01);
  EXPECT_DOUBLE_EQ(bench.controller.velocity_demand(), 50.0 + 4800.0 * 1000.5 / 4000.0);
}

TEST(PositionLoop, WithHallsWhoseEdgesBearLess_300Means1200RpmPerRevolution) {
  ServoBench bench(ServoControllerSettings{}, locked());
  bench.set_point.loop = ServoLoop::position;
  bench.set_point.position = {6, 0.5};
  bench.run(0.5);
  EXPECT_DOUBLE_EQ(bench.controller.velocity_demand(), 1200.0 * 6.5 / 24.0);
}

TEST(PositionLoop, FollowsARampWithFeedForwardWithoutLag) {
  ServoBench bench(with_encoder());
  bench.set_point.loop = ServoLoop::position;
  bench.set_point.velocity = 600.0;  // 40000 steps/s
  for (int k = 0; k < 40'000; ++k) {
    bench.set_point.position = displaced({0, 0.0}, 2.0 * k);
    bench.step();
  }
  EXPECT_NEAR(bench.controller.position_error(), 0, 10);
  bench.set_point.velocity = 0.0;
  for (int k = 40'000; k < 80'000; ++k) {
    bench.set_point.position = displaced({0, 0.0}, 2.0 * k);
    bench.step();
  }
  EXPECT_NEAR(bench.controller.position_error(), 40'000.0 / 80.0, 5.0) << "v / Kv";
}

TEST(ServoLimits, TorqueIsBoundedInEveryLoopAndMode) {
  for (const ServoCommutation mode :
       {ServoCommutation::hall, ServoCommutation::encoder, ServoCommutation::controlled}) {
    for (const ServoLoop loop : {ServoLoop::torque, ServoLoop::velocity, ServoLoop::position}) {
      ServoControllerSettings settings;
      settings.commutation = mode;
      settings.maximum_torque = 800;
      ServoBench bench(settings, locked());
      for (const double sign : {1.0, -1.0}) {
        bench.set_point = {loop, sign * 5.0, sign * 3000.0, {static_cast<int>(sign) * 100'000, 0}};
        bench.run(0.2);
        const double current = std::hypot(bench.motor.id(), bench.motor.iq());
        EXPECT_NEAR(current, 0.8, 0.02) << static_cast<int>(mode) << static_cast<int>(loop);
        EXPECT_LE(std::abs(bench.controller.ramp_target_current()), 800);
      }
    }
  }
}

TEST(ServoLimits, VelocityIsBoundedInTorqueLoop) {
  ServoControllerSettings settings = with_encoder();
  settings.maximum_velocity = 1500;
  for (const double torque : {2.0, -2.0}) {
    ServoBench bench(settings);
    bench.set_point.loop = ServoLoop::torque;
    bench.set_point.torque = torque;
    bench.run(1.0);
    EXPECT_LT(std::fabs(bench.motor.rpm()), 1510.0);
    EXPECT_GT(std::fabs(bench.motor.rpm()), 1300.0);
    EXPECT_EQ(bench.controller.target_current(), static_cast<int>(torque * 1000.0));
    EXPECT_LT(std::abs(bench.controller.ramp_target_current()), 400);
  }
}

TEST(ServoLimits, AboveTheVoltageTheMotorTurnsAsFastAsItCan) {
  ServoControllerSettings settings = with_encoder();
  settings.maximum_velocity = 20'000;
  ServoBench bench(settings);
  bench.set_point.loop = ServoLoop::velocity;
  bench.set_point.velocity = 15'000.0;
  bench.run(2.0);
  EXPECT_TRUE(bench.controller.voltage_limited());
  const double no_load = 24.0 / std::sqrt(3.0) / (4.0 * 6e-3) / kRpm;
  EXPECT_NEAR(bench.motor.rpm(), no_load, 0.05 * no_load);
}

TEST(ServoLimits, I2tTakesTheCurrentAwayAfterTheComputedTime) {
  ServoControllerSettings settings = with_encoder();
  settings.i2t_time_constant = 1000;
  settings.i2t_limit = 2000;  // 4 A: 16000 in the long run
  ServoBench bench(settings, locked());
  bench.set_point.loop = ServoLoop::torque;
  bench.set_point.torque = 4.0;
  double time = 0.0;
  while (!bench.controller.i2t_exceeded() && time < 1.0) {
    bench.step();
    time += kPeriod;
  }
  EXPECT_NEAR(time, -std::log(1.0 - 2000.0 / 16'000.0), 0.005);  // the current takes 2 ms to rise
  bench.run(0.1);
  EXPECT_NEAR(bench.motor.iq(), 0.0, 0.01);
  EXPECT_TRUE(bench.actuation.bridge_enabled);
  EXPECT_EQ(bench.controller.ramp_target_current(), 0);
  EXPECT_EQ(bench.controller.target_current(), 4000);
  EXPECT_EQ(bench.controller.i2t_counter(), 1U);
  bench.controller.clear_i2t_exceeded();
  bench.run(0.005);
  EXPECT_GT(bench.motor.iq(), 3.0);
}

}  // namespace
}  // namespace stator::control
