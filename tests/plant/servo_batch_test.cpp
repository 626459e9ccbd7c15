// That lanes of a batch have the bits of single servo axes with every instruction set.
#include "stator/plant/batch/servo_batch.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/current_loop/current_loop_batch.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

constexpr base::SimDuration kStep = 20_us;

/// Cogging, friction, a supply that rises when the motor brakes, with a brake chopper; imperfect
/// electronics. Resistance and flux do not depend on temperature.
ServoAxisParameters drive() {
  ServoAxisParameters parameters;
  parameters.motor.resistance_coefficient = 0.0;
  parameters.motor.flux_coefficient = 0.0;
  parameters.load.inertia = 2e-6;
  parameters.supply.chopper_voltage = 26.0;
  parameters.inverter.pwm_frequency = 50e3;
  parameters.inverter.dead_time = 200e-9;
  parameters.current_sensing.gain = {1.01, 0.99, 1.0};
  parameters.current_sensing.offset = {0.01, -0.02, 0.005};
  parameters.current_sensing.resolution = 1e-3;
  parameters.current_sensing.range = 20.0;
  return parameters;
}

/// Duties that turn a voltage on the q axis up and down, differently for each axis, standstill and
/// reversal included.
std::array<double, 3> duties(const ServoAxis& axis, int axis_number, int step) {
  const double swing = 1.0 + 0.1 * axis_number;
  const int phase = step % 6000;
  const double uq = phase < 2000   ? swing * 4e-3 * phase
                    : phase < 4000 ? swing * 4e-3 * (4000 - phase) - 6.0
                                   : 0.0;
  const base::SineCosine& z = axis.state().motor.direction;
  const std::array<double, 3> phases = phase_values({-uq * z.sine, uq * z.cosine});
  return {0.5 + phases[0] / 24.0, 0.5 + phases[1] / 24.0, 0.5 + phases[2] / 24.0};
}

std::vector<base::InstructionSet> sets() {
  std::vector<base::InstructionSet> result;
  for (const auto set : {base::InstructionSet::scalar, base::InstructionSet::baseline,
                         base::InstructionSet::avx2, base::InstructionSet::avx512}) {
    if (base::supported(set)) {
      result.push_back(set);
    }
  }
  return result;
}

TEST(ServoBatch, EachLaneHasTheBitsOfAServoAxis) {
  constexpr std::size_t kAxes = 11;
  constexpr std::size_t kLanes = ServoBatch<double>::kLanes;
  for (const base::InstructionSet set : sets()) {
    const ServoAxisParameters parameters = drive();
    ServoBatch<double> batch(parameters, kAxes, kStep, set);
    std::vector<ServoAxis> axes(kAxes, ServoAxis(parameters));
    std::vector<double> lowest(kAxes, 0.0);
    bool chopped = false;
    bool stood = false;
    for (int step = 0; step < 30'000; ++step) {
      for (std::size_t n = 0; n < kAxes; ++n) {
        const base::ServoActuation actuation{.bridge_enabled = true,
                                             .duty = duties(axes[n], static_cast<int>(n), step)};
        if (step % 997 == 0) {
          const double torque = 1e-3 * (static_cast<double>(n) - 5.0);
          axes[n].set_external_torque(torque);
          batch.set_external_torque(n, torque);
        }
        auto& signals = batch.signals()[n / kLanes];
        for (std::size_t k = 0; k < 3; ++k) {
          signals.duty[k][n % kLanes] = actuation.duty[k];
        }
        axes[n].step(actuation, kStep);
      }
      batch.step();
      for (std::size_t n = 0; n < kAxes; ++n) {
        const ServoAxisState& expected = axes[n].state();
        ASSERT_EQ(batch.motor(n), expected.motor) << "axis " << n << ", step " << step;
        ASSERT_EQ(batch.supply_voltage(n), expected.supply.voltage) << step;
        const auto& signals = batch.signals()[n / kLanes];
        for (std::size_t k = 0; k < 3; ++k) {
          ASSERT_EQ(signals.phase_current[k][n % kLanes], axes[n].sensing().phase_current[k]);
        }
        lowest[n] = std::min(lowest[n], expected.motor.speed);
        chopped = chopped || expected.supply.chopper_conducts;
        stood = stood || expected.motor.speed == 0.0;
      }
    }
    // The run had reversals, standstill and braking in it.
    for (std::size_t n = 0; n < kAxes; ++n) {
      EXPECT_LT(lowest[n], -5.0);
    }
    EXPECT_TRUE(stood);
    EXPECT_TRUE(chopped);
  }
}

/// Motor and load of one axis of many that are not quite alike.
ServoAxisParameters different(std::size_t axis) {
  ServoAxisParameters parameters = drive();
  const double share = 0.1 * static_cast<double>(axis);
  parameters.motor.resistance *= 0.7 + share;
  parameters.motor.direct_inductance *= 1.4 - 0.5 * share;
  parameters.motor.quadrature_inductance = parameters.motor.direct_inductance;
  parameters.motor.flux_linkage *= 0.9 + 0.2 * share;
  parameters.motor.viscous_friction *= 0.5 + share;
  parameters.motor.coulomb_friction *= 1.5 - share;
  parameters.motor.static_friction = 1.3 * parameters.motor.coulomb_friction;
  parameters.load.inertia *= 1.0 + 3.0 * share;
  parameters.load.constant_torque = 1e-3 * (1.0 - share);
  return parameters;
}

TEST(ServoBatch, AnAxisWithAMotorOfItsOwnHasTheBitsOfAServoAxisWithThatMotor) {
  constexpr std::size_t kAxes = 11;
  constexpr std::size_t kLanes = ServoBatch<double>::kLanes;
  for (const base::InstructionSet set : sets()) {
    ServoBatch<double> batch(drive(), kAxes, kStep, set);
    std::vector<ServoAxis> axes;
    for (std::size_t n = 0; n < kAxes; ++n) {
      // The fourth keeps the motor of the batch.
      const ServoAxisParameters parameters = n == 3 ? drive() : different(n);
      axes.emplace_back(parameters);
      if (n != 3) {
        batch.set_plant(n, parameters.motor, parameters.load);
      }
    }
    for (int step = 0; step < 20'000; ++step) {
      for (std::size_t n = 0; n < kAxes; ++n) {
        const base::ServoActuation actuation{.bridge_enabled = true,
                                             .duty = duties(axes[n], static_cast<int>(n), step)};
        for (std::size_t k = 0; k < 3; ++k) {
          batch.signals()[n / kLanes].duty[k][n % kLanes] = actuation.duty[k];
        }
        axes[n].step(actuation, kStep);
      }
      batch.step();
      for (std::size_t n = 0; n < kAxes; ++n) {
        ASSERT_EQ(batch.motor(n), axes[n].state().motor) << "axis " << n << ", step " << step;
        ASSERT_EQ(batch.supply_voltage(n), axes[n].state().supply.voltage) << step;
      }
    }
    // They did differ.
    EXPECT_NE(batch.motor(0).speed, batch.motor(1).speed);
  }
}

TEST(ServoBatch, ARestartedAxisHasTheBitsOfOneThatIsNew) {
  constexpr std::size_t kAxes = 3;
  constexpr int kBefore = 777;  // no whole number of times that directions are computed anew
  ServoBatch<double> batch(drive(), kAxes, kStep);
  const auto drive_axis = [&batch](std::size_t n, const std::array<double, 3>& duty) {
    for (std::size_t k = 0; k < 3; ++k) {
      batch.signals()[0].duty[k][n] = duty[k];
    }
  };
  batch.set_external_torque(1, 0.02);
  for (int step = 0; step < kBefore; ++step) {
    drive_axis(1, {0.6, 0.4, 0.5});
    batch.step();
  }
  ASSERT_NE(batch.motor(1).speed, 0.0);
  const SynchronousMotorState other = batch.motor(2);

  ServoAxisParameters parameters = different(5);
  parameters.initial_revolutions = 0.3;
  parameters.supply_voltage = 20.0;
  ServoAxis fresh(parameters);
  ServoAxisState state = fresh.state();
  state.motor.speed = 50.0;
  fresh.restore(state);
  batch.set_plant(1, parameters.motor, parameters.load);
  batch.restart(1, 0.3, 50.0, 20.0);
  EXPECT_EQ(batch.motor(2), other) << "another axis was touched";
  EXPECT_EQ(batch.signals()[0].supply_voltage[1], 20.0);
  for (int step = 0; step < 3'000; ++step) {
    const std::array<double, 3> duty = duties(fresh, 1, step);
    drive_axis(1, duty);
    batch.step();
    fresh.step({.bridge_enabled = true, .duty = duty}, kStep);
    ASSERT_EQ(batch.motor(1), fresh.state().motor) << step;
    ASSERT_EQ(batch.supply_voltage(1), fresh.state().supply.voltage) << step;
  }
}

/// Hash of the motors of a closed-loop run with load steps, reversals and standstill.
template <typename Number>
std::uint64_t closed_loop_hash(base::InstructionSet set) {
  constexpr std::size_t kAxes = 16;
  const ServoAxisParameters parameters = drive();
  ServoBatch<Number> batch(parameters, kAxes, kStep, set);
  control::CurrentLoopBatch<Number> loops(
      control::current_loop_for(parameters.motor.resistance, parameters.motor.direct_inductance,
                                1e4, kStep.seconds()),
      kAxes, set);
  base::Random random(7);
  std::uint64_t hash = 0xCBF29CE484222325;
  for (int step = 0; step < 50'000; ++step) {
    if (step % 1000 == 0) {
      for (std::size_t n = 0; n < kAxes; ++n) {
        const double direct = random.uniform() - 0.5;
        loops.set_target(n, direct, 4.0 * random.uniform() - 2.0);
        batch.set_external_torque(n, 0.04 * random.uniform() - 0.02);
      }
    }
    loops.step(batch.signals());
    batch.step();
    for (std::size_t n = 0; n < kAxes; ++n) {
      const SynchronousMotorState state = batch.motor(n);
      for (const double value : {state.current.alpha, state.current.beta, state.speed,
                                 state.angle.angle, batch.supply_voltage(n)}) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001B3;
      }
    }
  }
  return hash;
}

TEST(ServoBatch, ClosedLoopsHaveTheSameBitsEverywhere) {
  for (const base::InstructionSet set : sets()) {
    EXPECT_EQ(closed_loop_hash<double>(set), 294715718967844143U) << static_cast<int>(set);
    EXPECT_EQ(closed_loop_hash<float>(set), 9144729810490906405U) << static_cast<int>(set);
  }
}

TEST(ServoBatch, FloatLanesFollowDoubleLanesWithinAnErrorOfTenThousandth) {
  const ServoAxisParameters parameters = drive();
  ServoBatch<double> exact(parameters, 1, kStep);
  ServoBatch<float> rough(parameters, 1, kStep);
  SynchronousMotorState state = exact.motor(0);
  state.speed = 100.0;
  exact.set_motor(0, state);
  rough.set_motor(0, state);
  double worst = 0.0;
  for (int step = 0; step < 5'000; ++step) {
    const double uq = 3.0 + 1e-3 * step;
    const base::SineCosine z = exact.motor(0).direction;
    const std::array<double, 3> phases = phase_values({-uq * z.sine, uq * z.cosine});
    for (std::size_t k = 0; k < 3; ++k) {
      exact.signals()[0].duty[k][0] = 0.5 + phases[k] / 24.0;
      rough.signals()[0].duty[k][0] = static_cast<float>(0.5 + phases[k] / 24.0);
    }
    exact.step();
    rough.step();
    worst = std::max(worst, std::fabs(exact.motor(0).current.alpha - rough.motor(0).current.alpha));
  }
  EXPECT_LT(worst / parameters.motor.rated_current, 3e-4);
}

}  // namespace
}  // namespace stator::plant
