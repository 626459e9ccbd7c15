// Loops of the FOC block on the plant at PWM rate, set and read through registers, against a linear
// drive in double precision: within 3 %.

#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "devices/tmc8670_linear_drive.hpp"
#include "devices/tmc8670_stage_bench.hpp"

namespace stator::devices::tmc8670 {
namespace {

constexpr double kTolerance = 0.03;
constexpr int kTorqueMode = 1;
constexpr int kVelocityMode = 2;
constexpr int kPositionMode = 3;

/// A shaft too heavy to move, its magnets somewhere between the phases.
plant::PwmAxisParameters held(const plant::MotorParameters& motor, plant::InverterModel model) {
  plant::PwmAxisParameters result = StageBench::stiff(motor);
  result.load.inertia = 1e3;
  result.inverter_model = model;
  return result;
}

/// A motor of each kind with what its current loop is tuned by.
struct HeldMotor {
  plant::MotorParameters motor;
  std::int32_t type = 3;
  std::int32_t pole_pairs = 4;
  double resistance = 0.0;
  double inductance = 0.0;
};
HeldMotor three_phase() {
  const plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
  return {motor, 3, motor.pole_pairs, motor.resistance, motor.quadrature_inductance};
}
HeldMotor two_phase() {
  plant::StepperMotorParameters motor = *plant::find_stepper_motor("QSH5718-55-30-098");
  motor.temperature_coefficient = 0.0;
  return {motor, 2, motor.pole_pairs, motor.resistance, motor.inductance};
}
HeldMotor direct_current() {
  plant::DcMotorParameters motor;
  motor.resistance_coefficient = motor.flux_coefficient = 0.0;
  return {motor, 1, 1, motor.resistance, motor.inductance};
}

/// A closed current loop and what its registers make of a linear one.
struct CurrentLoop {
  StageBench bench;
  LinearCurrentLoop linear;

  CurrentLoop(const StageBench& tuned, const LinearCurrentLoop& like)
      : bench(tuned), linear(like) {}
};
CurrentLoop current_loop(const HeldMotor& held_motor, double g, plant::InverterModel model) {
  StageBench bench(held(held_motor.motor, model), held_motor.type, held_motor.pole_pairs);
  const LoopGains gains =
      bench.tune_currents(g, held_motor.resistance, held_motor.inductance, held_motor.type);
  bench.set(field("PHI_E_EXT"), 5000);
  bench.set(field("PHI_E_SELECTION"), 1);
  bench.set(field("MODE_MOTION"), kTorqueMode);
  bench.run(1e-3);
  return {bench, LinearCurrentLoop(held_motor.resistance, held_motor.inductance,
                                   StageBench::kPeriod, gains)};
}

/// Gain from the target of the torque, in a register, to its actual value in another.
std::complex<double> measured_gain(StageBench& bench, double frequency) {
  constexpr double kAmplitude = 200.0;
  const int cycles = static_cast<int>(std::ceil(4000.0 * frequency));
  const int periods = static_cast<int>(std::lround(cycles / frequency));
  const double used = static_cast<double>(cycles) / periods;
  std::complex<double> sum;
  for (int k = 0; k < 2 * periods; ++k) {
    const double angle = 2.0 * M_PI * used * k;
    bench.set(field("PID_TORQUE_TARGET"), std::lround(kAmplitude * std::sin(angle)));
    bench.stage.step();
    if (k >= periods) {
      // As a sine, not a cosine, that is: a factor of i.
      sum += std::complex<double>(0.0, 2.0) * std::polar(1.0, -angle) *
             static_cast<double>(bench.get(field("PID_TORQUE_ACTUAL")));
    }
  }
  return sum / (kAmplitude * periods);
}

class CurrentLoopOf : public testing::TestWithParam<plant::InverterModel> {};
INSTANTIATE_TEST_SUITE_P(Inverter, CurrentLoopOf,
                         testing::Values(plant::InverterModel::averaged,
                                         plant::InverterModel::switched),
                         [](const auto& tested) {
                           return tested.param == plant::InverterModel::switched ? "Switched"
                                                                                 : "Averaged";
                         });

TEST_P(CurrentLoopOf, EachMotorHasTheBandwidthOfALoopOneAndAHalfPeriodsLate) {
  for (const HeldMotor& motor : {three_phase(), two_phase(), direct_current()}) {
    for (const double g : {0.1, 0.25, 0.4}) {
      auto [bench, linear] = current_loop(motor, g, GetParam());
      // Secant on the logarithm of the gain, from either side of the -3 dB point.
      const double expected = linear.bandwidth();
      const double below = 0.93 * expected;
      const double above = 1.07 * expected;
      const double gain_below = std::log(std::abs(measured_gain(bench, below)));
      const double gain_above = std::log(std::abs(measured_gain(bench, above)));
      const double wanted = 0.5 * std::log(0.5);
      ASSERT_GT(gain_below, wanted) << motor.type << ' ' << g;
      ASSERT_LT(gain_above, wanted) << motor.type << ' ' << g;
      const double found =
          below + (above - below) * (gain_below - wanted) / (gain_below - gain_above);
      EXPECT_NEAR(found, expected, kTolerance * expected) << motor.type << ' ' << g;
    }
  }
}

TEST_P(CurrentLoopOf, GainAndPhaseAreThoseOfTheLinearLoop) {
  constexpr double kBandwidth = 0.25;
  auto [bench, linear] = current_loop(three_phase(), kBandwidth, GetParam());
  for (const double frequency : {0.002, 0.01, 0.03, 0.06, 0.1, 0.15}) {
    const std::complex<double> expected = linear.gain(frequency);
    EXPECT_LT(std::abs(measured_gain(bench, frequency) / expected - 1.0), kTolerance) << frequency;
  }
}

TEST_P(CurrentLoopOf, EachMotorFollowsAStepAsTheLinearLoopDoes) {
  for (const HeldMotor& motor : {three_phase(), two_phase(), direct_current()}) {
    for (const double g : {0.15, 0.4}) {
      auto [bench, loop] = current_loop(motor, g, GetParam());
      constexpr double kStep = 400.0;
      bench.set(field("PID_TORQUE_TARGET"), std::lround(kStep));
      std::vector<double> response;
      for (int k = 0; k < 80; ++k) {
        bench.stage.step();
        response.push_back(bench.get(field("PID_TORQUE_ACTUAL")) / kStep);
      }
      const std::vector<double> linear = loop.step_response(response.size());
      for (std::size_t k = 0; k < response.size(); ++k) {
        EXPECT_NEAR(response[k], linear[k], kTolerance) << motor.type << ' ' << g << ' ' << k;
      }
      const StepFigures found = figures_of(response);
      const StepFigures expected = figures_of(linear);
      EXPECT_NEAR(found.rise, expected.rise, kTolerance * expected.rise) << motor.type;
      EXPECT_NEAR(found.overshoot, expected.overshoot, 0.01) << motor.type;
      EXPECT_NEAR(found.settling, expected.settling, kTolerance * expected.settling + 0.1)
          << motor.type;
    }
  }
}

/// A servo with the inertia of a load and the linear drive it should be like.
struct Servo {
  static constexpr double kLoadInertia = 2e-5;

  Servo(std::int32_t velocity_p, std::int32_t velocity_i, std::int32_t position_p)
      : bench(parameters(), 3, StageBench::textbook_motor().pole_pairs),
        linear(StageBench::textbook_motor(), kLoadInertia, StageBench::kPeriod,
               tuned(velocity_p, velocity_i, position_p)) {}

  static plant::PwmAxisParameters parameters() {
    plant::PwmAxisParameters result = StageBench::stiff(StageBench::textbook_motor());
    result.load.inertia = kLoadInertia;
    return result;
  }
  LoopGains tuned(std::int32_t velocity_p, std::int32_t velocity_i, std::int32_t position_p) {
    const plant::ThreePhaseMotorParameters motor = StageBench::textbook_motor();
    bench.tune_currents(0.1, motor.resistance, motor.quadrature_inductance);
    return bench.tune_outer(velocity_p, velocity_i, position_p);
  }

  StageBench bench;
  LinearDrive linear;
};

void expect_alike(const std::vector<double>& response, const std::vector<double>& linear) {
  const StepFigures found = figures_of(response);
  const StepFigures expected = figures_of(linear);
  ASSERT_GT(expected.rise, 10.0);
  ASSERT_GT(expected.settling, 10.0);
  EXPECT_NEAR(found.rise, expected.rise, kTolerance * expected.rise);
  EXPECT_NEAR(found.overshoot, expected.overshoot, 0.01);
  EXPECT_NEAR(found.settling, expected.settling, kTolerance * expected.settling);
  for (std::size_t k = 0; k < response.size(); ++k) {
    ASSERT_NEAR(response[k], linear[k], kTolerance) << k;
  }
}

TEST(VelocityStep, RisesOvershootsAndSettlesAsTheLinearDriveDoes) {
  // Bandwidths of about 32, 64 and 64 Hz; the last one with little damping.
  for (const auto& [p, i] : {std::pair{4250, 16}, std::pair{8500, 33}, std::pair{8500, 100}}) {
    Servo servo(p, i, 0);
    constexpr double kRpm = 120.0;  // no more than the voltage allows
    servo.bench.set(field("MODE_MOTION"), kVelocityMode);
    servo.bench.set(field("PID_VELOCITY_TARGET"), std::lround(kRpm));
    servo.linear.closes_velocity = true;
    servo.linear.velocity_target = kRpm * M_PI / 30.0;
    std::vector<double> response;
    std::vector<double> linear;
    for (int k = 0; k < 5000; ++k) {
      servo.bench.stage.step();
      servo.linear.step();
      response.push_back(servo.bench.seen().speed / servo.linear.velocity_target);
      linear.push_back(servo.linear.speed() / servo.linear.velocity_target);
    }
    expect_alike(response, linear);
    EXPECT_NEAR(servo.bench.get(field("PID_VELOCITY_ACTUAL")), kRpm, 3.0);
  }
}

TEST(PositionStep, RisesOvershootsAndSettlesAsTheLinearDriveDoes) {
  for (const std::int32_t position_p : {150, 250}) {
    Servo servo(4250, 16, position_p);
    const double units = 900'000.0 / position_p;  // no more than the voltage allows
    servo.bench.set(field("MODE_MOTION"), kPositionMode);
    servo.bench.set(field("PID_POSITION_TARGET"), std::lround(units));
    servo.linear.closes_position = true;
    servo.linear.position_target = units / 65536.0 * 2.0 * M_PI;
    std::vector<double> response;
    std::vector<double> linear;
    for (int k = 0; k < 8000; ++k) {
      servo.bench.stage.step();
      servo.linear.step();
      response.push_back(servo.bench.seen().shaft_angle / servo.linear.position_target);
      linear.push_back(servo.linear.angle() / servo.linear.position_target);
    }
    expect_alike(response, linear);
    servo.bench.run(0.5);
    // Velocities are whole rpm: less than one of them is no command.
    EXPECT_NEAR(servo.bench.get(field("PID_POSITION_ACTUAL")), units, 4096.0 / position_p + 1.0);
  }
}

}  // namespace
}  // namespace stator::devices::tmc8670
