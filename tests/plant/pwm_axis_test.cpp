// An axis driven by PWM with each kind of motor: motion, braking, dead time, equal bits of a copy.
#include "stator/plant/axes/pwm_axis.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr base::SimDuration kPeriod = 20_us;

class PwmAxisWith : public testing::TestWithParam<InverterModel> {
 protected:
  PwmAxisParameters parameters() const {
    PwmAxisParameters result;
    result.inverter_model = GetParam();
    result.inverter.pwm_frequency = 50e3;
    return result;
  }
};

INSTANTIATE_TEST_SUITE_P(Inverter, PwmAxisWith,
                         testing::Values(InverterModel::averaged, InverterModel::switched),
                         [](const auto& tested) {
                           return tested.param == InverterModel::switched ? "Switched" : "Averaged";
                         });

/// A turning field pulls the rotor along; how far it came in revolutions.
double follow_field(PwmAxis& axis, double amplitude, double turns, int pole_pairs, bool two_phase) {
  constexpr int kSteps = 50'000;
  const double start = axis.revolutions();
  for (int n = 0; n < kSteps; ++n) {
    const double part = static_cast<double>(n) / kSteps;
    // Speeds up, and down again.
    const double way = part < 0.5 ? 2.0 * part * part : 1.0 - 2.0 * (1.0 - part) * (1.0 - part);
    const base::SineCosine field = base::sine_cosine(base::kTwoPi * turns * pole_pairs * way);
    PwmActuation actuation{.bridge_enabled = true};
    if (two_phase) {
      actuation.duty = {0.5 + amplitude * field.cosine, 0.5 - amplitude * field.cosine,
                        0.5 + amplitude * field.sine, 0.5 - amplitude * field.sine};
    } else {
      const auto phases = phase_values({amplitude * field.cosine, amplitude * field.sine});
      actuation.duty = {0.5 + phases[0], 0.5 + phases[1], 0.5 + phases[2]};
    }
    axis.step(actuation, kPeriod);
  }
  return axis.revolutions() - start;
}

TEST_P(PwmAxisWith, ThreePhaseMotorFollowsTheFieldAndItsSensorsTell) {
  PwmAxisParameters p = parameters();
  p.analog_encoder = sine_cosine_encoder(1);
  p.analog_halls = analog_halls(4);
  p.encoders[1] = {.counts_per_revolution = 1024, .reversed = true};
  PwmAxis axis(p);
  const double way = follow_field(axis, 0.1, 3.3, 4, false);
  EXPECT_NEAR(way, 3.3, 0.02);
  const PwmSensing& seen = axis.sensing();
  EXPECT_NEAR(static_cast<double>(seen.encoders[0].count), 4096.0 * way, 1.0);
  EXPECT_NEAR(static_cast<double>(seen.encoders[1].count), -1024.0 * way, 1.0);
  EXPECT_EQ(seen.encoders[0].index_passages, 3U);
  const double angle =
      std::atan2(seen.analog_encoder[1] - 32'768.0, seen.analog_encoder[0] - 32'768.0);
  EXPECT_NEAR(std::remainder(angle - base::kTwoPi * way, base::kTwoPi), 0.0, 1e-4);
  EXPECT_NEAR(seen.analog_halls[0], 32'768.0 + 20'000.0 * std::cos(base::kTwoPi * 4.0 * way), 1.0);
  EXPECT_NEAR(seen.converter.currents[0], 32'768.0 + 1000.0 * axis.currents()[0], 0.51);
  EXPECT_NEAR(seen.converter.currents[1], 32'768.0 + 1000.0 * axis.currents()[2], 0.51);
}

TEST_P(PwmAxisWith, StepperMotorFollowsTheField) {
  PwmAxisParameters p = parameters();
  p.motor = *find_stepper_motor("QSH5718-55-30-098");
  p.halls.fitted = false;
  PwmAxis axis(p);
  EXPECT_NEAR(follow_field(axis, 0.1, 0.5, 50, true), 0.5, 0.002);
  EXPECT_NEAR(static_cast<double>(axis.sensing().encoders[0].count), 2048.0, 8.0);
}

TEST_P(PwmAxisWith, DcMotorTurnsWithItsVoltageAndBrakesIntoTheCapacitor) {
  PwmAxisParameters p = parameters();
  p.motor = DcMotorParameters{};
  PwmAxis axis(p);
  for (int n = 0; n < 50'000; ++n) {
    axis.step({.bridge_enabled = true, .duty = {0.75, 0.25, 0.0, 0.0}}, kPeriod);
  }
  // 12 V less the drop of the no-load current.
  EXPECT_NEAR(axis.speed(), 12.0 / 0.035, 8.0);
  EXPECT_EQ(axis.sensing().converter.currents[1], 32'768);
  const double before = axis.bridge_energy();
  for (int n = 0; n < 200; ++n) {
    axis.step({.bridge_enabled = true, .duty = {0.6, 0.4, 0.0, 0.0}}, kPeriod);
  }
  EXPECT_LT(axis.bridge_energy(), before);
  EXPECT_GT(axis.supply_voltage(), 24.1);
}

TEST_P(PwmAxisWith, SwitchedOffTheCurrentDecaysIntoTheSupplyAndTheShaftCoasts) {
  for (const MotorParameters& motor :
       {MotorParameters{*find_three_phase_motor("QBL4208-61-04-013")},
        MotorParameters{*find_stepper_motor("QSH5718-55-30-098")},
        MotorParameters{DcMotorParameters{}}}) {
    PwmAxisParameters p = parameters();
    p.motor = motor;
    PwmAxis axis(p);
    for (int n = 0; n < 500; ++n) {
      axis.step({.bridge_enabled = true, .duty = {0.55, 0.45, 0.55, 0.45}}, kPeriod);
    }
    ASSERT_GT(std::fabs(axis.currents()[0]), 0.2);
    const double before = axis.bridge_energy();
    for (int n = 0; n < 500; ++n) {
      axis.step({}, kPeriod);
    }
    for (const double current : axis.currents()) {
      EXPECT_EQ(current, 0.0);
    }
    EXPECT_LT(axis.bridge_energy(), before);
  }
}

TEST_P(PwmAxisWith, ACopyGoesOnWithTheSameBits) {
  PwmAxisParameters p = parameters();
  p.converter.currents[0].noise = 5.0;
  p.encoder_disturbances[0].missed_edge_probability = 0.01;
  PwmAxis axis(p);
  follow_field(axis, 0.1, 0.3, 4, false);
  PwmAxis copy = axis;
  for (int n = 0; n < 1000; ++n) {
    const PwmActuation actuation{.bridge_enabled = true, .duty = {0.6, 0.5, 0.4, 0.0}};
    const PwmSensing first = axis.step(actuation, kPeriod);
    const PwmSensing& second = copy.step(actuation, kPeriod);
    ASSERT_EQ(first.converter.currents, second.converter.currents);
    ASSERT_EQ(first.encoders[0].count, second.encoders[0].count);
    ASSERT_EQ(axis.speed(), copy.speed());
  }
}

TEST(PwmAxis, DeadTimeDistortsCurrentsAlikeInBothModels) {
  // A slowly turning field: the fifth harmonic of a current tells of dead time.
  const auto run = [](InverterModel model, double dead_time) {
    PwmAxisParameters p;
    p.inverter_model = model;
    p.inverter.pwm_frequency = 50e3;
    p.inverter.dead_time = dead_time;
    p.supply.capacitance = 0.0;
    p.load.brake_torque = 10.0;
    p.brake.closed_by_current = false;
    PwmAxis axis(p);
    double sum = 0.0;
    for (int n = 0; n < 2'000; ++n) {
      axis.step({.bridge_enabled = true, .duty = {0.54, 0.48, 0.48, 0.0}, .brake_released = false},
                kPeriod);
      sum = axis.currents()[0];
    }
    return sum;
  };
  const double without = run(InverterModel::averaged, 0.0);
  const double averaged = run(InverterModel::averaged, 500e-9);
  const double switched = run(InverterModel::switched, 500e-9);
  EXPECT_GT(without - averaged, 1.0);
  EXPECT_NEAR(run(InverterModel::switched, 0.0), without, 1e-3);
  EXPECT_NEAR(switched, averaged, 0.03 * (without - averaged));
}

}  // namespace
}  // namespace stator::plant
