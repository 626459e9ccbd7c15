// The synchronous motor's equations against analytic solutions, energy, and two methods of
// integration.
#include "stator/plant/motors/synchronous_motor.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

ThreePhaseMotorParameters named(const char* motor) {
  return *find_three_phase_motor(motor);
}

ThreePhaseMotorParameters frictionless(const char* motor) {
  ThreePhaseMotorParameters parameters = named(motor);
  parameters.cogging = {};
  parameters.viscous_friction = 0.0;
  parameters.coulomb_friction = 0.0;
  parameters.static_friction = 0.0;
  return parameters;
}

ThreePhaseMotorParameters salient() {
  ThreePhaseMotorParameters parameters = frictionless("QBL4208-61-04-013");
  parameters.quadrature_inductance = 1.5e-3;
  return parameters;
}

TEST(SynchronousMotor, BlockedRotorFollowsTheExponentialOfItsWinding) {
  ThreePhaseMotorParameters parameters = salient();
  parameters.static_friction = 100.0;
  SynchronousMotor motor(parameters, {});
  SynchronousMotorState state = motor.at(0.0);  // the d axis lies along phase U
  const SynchronousMotorInput input{.voltage = {1.0, 2.0}};
  for (int n = 0; n < 40; ++n) {
    motor.step(state, input, 50e-6);
  }
  const double r = parameters.resistance;
  const auto current = [&](double voltage, double inductance) {
    return voltage / r * (1.0 - std::exp(-2e-3 * r / inductance));
  };
  EXPECT_NEAR(state.direct_current(), current(1.0, parameters.direct_inductance), 1e-6);
  EXPECT_NEAR(state.quadrature_current(), current(2.0, parameters.quadrature_inductance), 1e-6);
  EXPECT_EQ(state.speed, 0.0);
}

TEST(SynchronousMotor, TorqueIsThatOfFluxAndSaliency) {
  SynchronousMotor motor(salient(), {});
  SynchronousMotorState state = motor.at(0.3);
  state.set_current(-4.0, 7.0);
  // 3/2 p (psi iq + (Ld - Lq) id iq)
  const double psi = salient().flux_linkage;
  EXPECT_NEAR(motor.electromagnetic_torque(state), 6.0 * (psi * 7.0 + 0.9e-3 * 28.0), 1e-12);
}

struct Sample {
  double direct;
  double quadrature;
};

/// 0.1 s of acceleration, reversal and load steps under voltages recorded from a commutated run,
/// replayed with each of them divided into `parts` steps.
std::vector<Sample> replay(const ThreePhaseMotorParameters& parameters, double step, int parts) {
  MechanicalLoad load;
  load.inertia = parameters.rotor_inertia;
  SynchronousMotor motor(parameters, load);
  SynchronousMotorState recorded = motor.at(0.0);
  SynchronousMotorState state = recorded;
  std::vector<Sample> samples;
  const int count = static_cast<int>(0.1 / step);
  const double top = 0.6 * parameters.rated_speed * parameters.pole_pairs * parameters.flux_linkage;
  for (int n = 0; n < count; ++n) {
    const double time = n * step;
    const double swing = time < 0.06 ? std::min(1.0, time / 0.02) : 1.0 - (time - 0.06) / 0.02;
    const double uq = top * swing;
    const base::SineCosine& z = recorded.direction;
    SynchronousMotorInput input;
    input.voltage = {-uq * z.sine, uq * z.cosine};
    input.torque = time > 0.04 ? -0.01 : 0.0;
    motor.step(recorded, input, step);
    for (int k = 0; k < parts; ++k) {
      motor.step(state, input, step / parts);
    }
    samples.push_back({state.direct_current(), state.quadrature_current()});
  }
  return samples;
}

double largest_error(const ThreePhaseMotorParameters& parameters, double step) {
  const std::vector<Sample> coarse = replay(parameters, step, 1);
  const std::vector<Sample> fine = replay(parameters, step, 64);
  double worst = 0.0;
  for (std::size_t n = 0; n < coarse.size(); ++n) {
    worst = std::max({worst, std::fabs(coarse[n].direct - fine[n].direct),
                      std::fabs(coarse[n].quadrature - fine[n].quadrature)});
  }
  return worst / parameters.rated_current;
}

TEST(SynchronousMotor, OneStepOf20MicrosecondsIsRightToAMillionthOfRatedCurrent) {
  for (const char* name : {"QBL4208-41-04-006", "QBL4208-61-04-013", "EC45-flat-70W", "mj5208"}) {
    ThreePhaseMotorParameters parameters = frictionless(name);
    parameters.viscous_friction = 1e-5;
    EXPECT_LT(largest_error(parameters, 20e-6), 1e-6) << name;
    EXPECT_LT(largest_error(parameters, 50e-6), 1e-4) << name;
  }
  EXPECT_LT(largest_error(salient(), 20e-6), 1e-6);
  EXPECT_LT(largest_error(salient(), 50e-6), 1e-4);
}

TEST(SynchronousMotor, CoggingAndFrictionKeepTheErrorSmall) {
  const ThreePhaseMotorParameters parameters = named("QBL4208-61-04-013");
  EXPECT_LT(largest_error(parameters, 20e-6), 1e-4);
  EXPECT_LT(largest_error(parameters, 50e-6), 1e-3);
}

/// Energy that went in by the terminals less what is in heat, load, shaft and field, as a share of
/// what went in.
double unbalanced_energy(const ThreePhaseMotorParameters& parameters) {
  SynchronousMotor motor(parameters, {});
  SynchronousMotorState state = motor.at(0.0);
  constexpr double kStep = 20e-6;
  constexpr double kLoad = -0.05;
  double supplied = 0.0;
  double heat = 0.0;
  double work = 0.0;
  const auto copper_loss = [&] {
    return 1.5 * motor.resistance() *
           (state.direct_current() * state.direct_current() +
            state.quadrature_current() * state.quadrature_current());
  };
  const auto friction_loss = [&] {
    return parameters.viscous_friction * state.speed * state.speed +
           parameters.coulomb_friction * std::fabs(state.speed);
  };
  for (int n = 0; n < 20'000; ++n) {
    const base::SineCosine z = state.direction;
    const double uq = n < 12'000 ? 8.0 : 2.0;
    const SynchronousMotorInput input{.voltage = {-uq * z.sine, uq * z.cosine}, .torque = kLoad};
    const double loss_before = copper_loss() + friction_loss();
    const double speed_before = state.speed;
    supplied += kStep * motor.step(state, input, kStep);
    heat += 0.5 * kStep * (loss_before + copper_loss() + friction_loss());
    work -= 0.5 * kStep * kLoad * (speed_before + state.speed);
  }
  const double stored =
      0.5 * motor.shaft().inertia() * state.speed * state.speed +
      0.75 * (parameters.direct_inductance * state.direct_current() * state.direct_current() +
              parameters.quadrature_inductance * state.quadrature_current() *
                  state.quadrature_current());
  return std::fabs(supplied - heat - work - stored) / supplied;
}

TEST(SynchronousMotor, NoEnergyIsLostOrWon) {
  EXPECT_LT(unbalanced_energy(frictionless("QBL4208-61-04-013")), 1e-4);
  EXPECT_LT(unbalanced_energy(salient()), 1e-4);
}

TEST(SynchronousMotor, WhateverTheFormOfItsEmfTheTorqueComesFromTheSameForm) {
  ThreePhaseMotorParameters parameters = frictionless("QBL4208-61-04-013");
  parameters.back_emf = {.trapezoidal_share = 1.0};
  EXPECT_LT(unbalanced_energy(parameters), 1e-3);
  parameters.back_emf = {
      .trapezoidal_share = 0.4, .sixth_harmonic_d = 0.03, .sixth_harmonic_q = 0.05};
  EXPECT_LT(unbalanced_energy(parameters), 1e-3);
}

TEST(SynchronousMotor, IdealTrapezoidIsFlatBetweenTwoLinesForASixthOfAPeriod) {
  ThreePhaseMotorParameters parameters = frictionless("QBL4208-61-04-013");
  parameters.back_emf = {.trapezoidal_share = 1.0};
  SynchronousMotor motor(parameters, {});
  const double flat = 4.0 * parameters.flux_linkage * 100.0;  // V of a phase at 100 rad/s
  // Phase U is at its negative flat top from 30 to 150 electrical degrees, phase V at its positive
  // one from -30 to 90 and phase W from 90 to 210.
  for (int degrees = 32; degrees <= 148; degrees += 4) {
    SynchronousMotorState state = motor.at(degrees / 360.0 / 4.0);
    state.speed = 100.0;
    const std::array<double, 3> emf = motor.back_emf(state);
    EXPECT_NEAR(emf[degrees < 90 ? 1 : 2] - emf[0], 2.0 * flat, 1e-9) << degrees;
  }
}

TEST(SynchronousMotor, AnOpenPhaseCarriesNothingAndTheOthersCarryTheSame) {
  const ThreePhaseMotorParameters parameters = salient();
  SynchronousMotor motor(parameters, {});
  SynchronousMotorState state = motor.at(0.05);
  state.speed = 50.0;
  SynchronousMotorInput input{.voltage = stator_vector(0.0, 6.0, -6.0),
                              .connection = WindingConnection::without_u};
  for (int n = 0; n < 100; ++n) {
    motor.step(state, input, 20e-6);
    const std::array<double, 3> current = phase_values(state.current);
    ASSERT_NEAR(current[0], 0.0, 1e-9);
    ASSERT_NEAR(current[1], -current[2], 1e-9);
  }
  EXPECT_GT(std::fabs(phase_values(state.current)[1]), 1.0);
}

TEST(SynchronousMotor, FrictionBrakesAsItsFormulaSaysAndEndsAtExactlyZero) {
  ThreePhaseMotorParameters parameters = frictionless("QBL4208-61-04-013");
  parameters.viscous_friction = 2e-5;
  parameters.coulomb_friction = 3e-3;
  parameters.static_friction = 3e-3;
  SynchronousMotor motor(parameters, {});
  SynchronousMotorState state = motor.at(0.0);
  state.speed = 300.0;
  const SynchronousMotorInput input{.connection = WindingConnection::none};
  // w(t) = (w0 + Tc/B) exp(-B t/J) - Tc/B
  const double b = parameters.viscous_friction / motor.shaft().inertia();
  const double limit = parameters.coulomb_friction / parameters.viscous_friction;
  const double end = std::log(1.0 + 300.0 / limit) / b;
  int n = 0;
  while (state.speed > 0.0 && n < 100'000) {
    motor.step(state, input, 50e-6);
    ++n;
    const double expected = std::max(0.0, (300.0 + limit) * std::exp(-b * n * 50e-6) - limit);
    ASSERT_NEAR(state.speed, expected, 1e-4 * 300.0);
  }
  EXPECT_EQ(state.speed, 0.0);
  EXPECT_NEAR(n * 50e-6, end, 100e-6);
}

TEST(SynchronousMotor, CoggingHoldsAShaftInItsValleysAndTurnsItFromItsCrests) {
  ThreePhaseMotorParameters parameters = frictionless("QBL4208-61-04-013");
  parameters.cogging[0] = {.order = 6, .amplitude = 4e-3};
  parameters.viscous_friction = 1e-4;
  SynchronousMotor motor(parameters, {});
  // T = A sin(6 th): stable where its slope is negative, at 30 electrical degrees.
  SynchronousMotorState state = motor.at(10.0 / 360.0 / 4.0);
  for (int n = 0; n < 40'000; ++n) {
    motor.step(state, {.connection = WindingConnection::none}, 50e-6);
  }
  EXPECT_NEAR(state.angle.angle, base::kPi / 6.0, 1e-3);
}

TEST(SynchronousMotor, TheCarriedDirectionStaysThatOfTheAngle) {
  for (const WindingConnection connection : {WindingConnection::none, WindingConnection::all}) {
    SynchronousMotor motor(frictionless("mj5208"), {});
    SynchronousMotorState state = motor.at(0.0);
    state.speed = 900.0;             // 0.31 electrical rad per step
    for (int n = 0; n < 200; ++n) {  // 10 ms, then an axis refreshes it
      const double emf = motor.flux_linkage() * state.speed * 7.0;
      motor.step(state,
                 {.voltage = {-emf * state.direction.sine, emf * state.direction.cosine},
                  .connection = connection},
                 50e-6);
    }
    EXPECT_GT(state.speed, 800.0);
    const base::SineCosine exact = base::sine_cosine(state.angle.angle);
    EXPECT_NEAR(state.direction.sine, exact.sine, 1e-7);
    EXPECT_NEAR(state.direction.cosine, exact.cosine, 1e-7);
  }
}

TEST(SynchronousMotor, AMotorWithItsPhasesTiedTogetherStopsAtExactlyZero) {
  SynchronousMotor motor(named("QBL4208-61-04-013"), {});
  SynchronousMotorState state = motor.at(0.1);
  state.speed = 30.0;
  for (int n = 0; n < 4000; ++n) {
    motor.step(state, {}, 50e-6);
  }
  EXPECT_EQ(state.speed, 0.0);
  EXPECT_LT(std::hypot(state.current.alpha, state.current.beta), 1e-6);
}

/// The usual case is solved in the stator frame, any other by Runge-Kutta in that of the rotor: an
/// EMF that is hardly no sine must make hardly a difference.
TEST(SynchronousMotor, BothMethodsOfIntegrationAgree) {
  for (const char* name : {"QBL4208-61-04-013", "EC45-flat-70W", "mj5208"}) {
    const ThreePhaseMotorParameters usual = frictionless(name);
    ThreePhaseMotorParameters other = usual;
    other.back_emf.sixth_harmonic_d = 1e-12;
    const std::vector<Sample> a = replay(usual, 20e-6, 1);
    const std::vector<Sample> b = replay(other, 20e-6, 1);
    double worst = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
      worst = std::max({worst, std::fabs(a[n].direct - b[n].direct),
                        std::fabs(a[n].quadrature - b[n].quadrature)});
    }
    EXPECT_LT(worst / usual.rated_current, 1e-5) << name;
  }
}

}  // namespace
}  // namespace stator::plant
