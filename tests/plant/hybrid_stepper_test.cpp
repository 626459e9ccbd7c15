// The hybrid stepper's equations against analytic solutions, energy, and steps 64 times finer.
#include "stator/plant/motors/hybrid_stepper.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

constexpr double kStep = 50e-6;

StepperMotorParameters frictionless() {
  StepperMotorParameters motor = *find_stepper_motor("QSH5718-55-30-098");
  motor.viscous_friction = 0.0;
  motor.coulomb_friction = 0.0;
  motor.static_friction = 0.0;
  return motor;
}

/// Largest deviation of the phase current from U/R (1 - exp(-t R / L)) over 20 ms, in A.
double error_of_locked_rotor(const HybridStepper& stepper, bool brake_engaged) {
  const double resistance = stepper.motor().resistance;
  const double inductance = stepper.motor().inductance;
  HybridStepperState state;
  HybridStepperInput input;
  input.voltage = {2.0, -1.0};
  input.brake_engaged = brake_engaged;
  double worst = 0.0;
  for (int n = 1; n <= 400; ++n) {
    stepper.step(state, input, kStep);
    const double rise = 1.0 - std::exp(-n * kStep * resistance / inductance);
    worst = std::max({worst, std::fabs(state.current[0] - 2.0 / resistance * rise),
                      std::fabs(state.current[1] + 1.0 / resistance * rise)});
  }
  return worst;
}

TEST(HybridStepper, LockedRotorCurrentRisesExponentially) {
  MechanicalLoad flywheel;
  flywheel.inertia = 1e9;
  EXPECT_LT(error_of_locked_rotor(HybridStepper(frictionless(), flywheel), false), 1e-6);
}

TEST(HybridStepper, CurrentOfARotorHeldByItsBrakeRisesExponentially) {
  MechanicalLoad braked;
  braked.brake_torque = 5.0;
  EXPECT_LT(error_of_locked_rotor(HybridStepper(frictionless(), braked), true), 1e-6);
}

TEST(HybridStepper, CoastDownFollowsViscousAndCoulombFrictionAndRestsAtExactlyZero) {
  StepperMotorParameters motor = frictionless();
  motor.detent_torque = 0.0;
  motor.viscous_friction = 1e-4;
  motor.coulomb_friction = 5e-3;
  motor.static_friction = 5e-3;
  const HybridStepper stepper(motor, {});
  const double b = motor.viscous_friction;
  const double c = motor.coulomb_friction;
  const double j = stepper.inertia();
  const double start = 60.0;
  const double stop_time = j / b * std::log(1.0 + b * start / c);

  HybridStepperState state;
  state.speed = start;
  HybridStepperInput input;
  input.open = {true, true};
  double time = 0.0;
  double worst = 0.0;
  while (time + kStep < stop_time) {
    stepper.step(state, input, kStep);
    time += kStep;
    worst = std::max(worst,
                     std::fabs(state.speed - ((start + c / b) * std::exp(-b * time / j) - c / b)));
  }
  EXPECT_LT(worst, 1e-4 * start);
  stepper.step(state, input, kStep);
  EXPECT_EQ(state.speed, 0.0) << "stop time " << stop_time;
  const HybridStepperState rest = state;
  for (int i = 0; i < 1'000; ++i) {
    stepper.step(state, input, kStep);
  }
  EXPECT_EQ(state.angle, rest.angle);
  EXPECT_EQ(state.speed, 0.0);
}

TEST(HybridStepper, StaticFrictionHoldsUntilItIsExceeded) {
  StepperMotorParameters motor = frictionless();
  motor.detent_torque = 0.0;
  motor.coulomb_friction = 5e-3;
  motor.static_friction = 8e-3;
  const HybridStepper stepper(motor, {});
  HybridStepperState state;
  HybridStepperInput input;
  input.open = {true, true};
  input.torque = 7.9e-3;
  stepper.step(state, input, kStep);
  EXPECT_EQ(state.speed, 0.0);
  input.torque = 8.5e-3;
  stepper.step(state, input, kStep);
  EXPECT_GT(state.speed, 0.0);
  // Once moving, friction falls to its Coulomb part: less torque suffices.
  for (int i = 0; i < 1'000; ++i) {
    stepper.step(state, input, kStep);
  }
  input.torque = 6e-3;
  const double before = state.speed;
  stepper.step(state, input, kStep);
  EXPECT_GT(state.speed, before);
}

TEST(HybridStepper, SmallOscillationHasTheResonanceFrequencyOfTheFormula) {
  for (const StepperMotorSheet& sheet : stepper_motor_sheets()) {
    StepperMotorParameters motor = parameters_of(sheet);
    motor.viscous_friction = motor.coulomb_friction = motor.static_friction = 0.0;
    motor.detent_torque = 0.0;
    MechanicalLoad load;
    load.inertia = 1e-5;
    const HybridStepper stepper(motor, load);
    const double amplitude = std::sqrt(2.0) * motor.rated_current;
    HybridStepperState state;
    state.angle = turned({}, 0.02);
    HybridStepperInput input;
    input.open = {true, true};  // an ideal current source: no back-EMF damps the swing
    state.current = {amplitude, 0.0};
    int crossings = 0;
    int first = 0;
    int last = 0;
    for (int n = 1; n <= 20'000; ++n) {
      const double before = state.speed;
      stepper.step(state, input, kStep);
      if (before < 0.0 && state.speed >= 0.0) {
        first = crossings == 0 ? n : first;
        last = n;
        ++crossings;
      }
    }
    const double measured = (crossings - 1) / ((last - first) * kStep);
    const double formula =
        std::sqrt(motor.pole_pairs * motor.holding_torque() / stepper.inertia()) / base::kTwoPi;
    EXPECT_NEAR(measured, formula, 0.02 * formula) << sheet.name;
  }
}

/// Work done on and by the machine between two moments, J.
struct EnergyBook {
  double electrical = 0.0;  ///< taken up at the terminals
  double spent = 0.0;       ///< copper, friction, load
  double through = 0.0;     ///< sum of |electrical power|
};

constexpr double kAuditStep = 20e-6;

/// Adds one step; power is integrated by Simpson's rule over two half steps.
void audit_step(const HybridStepper& stepper, HybridStepperState& state,
                const HybridStepperInput& input, EnergyBook& book) {
  const StepperMotorParameters& motor = stepper.motor();
  const auto electrical = [&](const HybridStepperState& s) {
    return input.voltage[0] * s.current[0] + input.voltage[1] * s.current[1];
  };
  const auto spent = [&](const HybridStepperState& s) {
    const double ratio = s.speed / motor.stribeck_speed;
    const double friction =
        motor.coulomb_friction +
        (motor.static_friction - motor.coulomb_friction) / (1.0 + ratio * ratio);
    return motor.resistance * (s.current[0] * s.current[0] + s.current[1] * s.current[1]) +
           motor.viscous_friction * s.speed * s.speed + friction * std::fabs(s.speed) -
           stepper.load_torque(s, input.torque) * s.speed;
  };
  HybridStepperState middle = state;
  stepper.step(middle, input, 0.5 * kAuditStep);
  HybridStepperState end = middle;
  stepper.step(end, input, 0.5 * kAuditStep);
  const double weight = kAuditStep / 6.0;
  book.electrical += weight * (electrical(state) + 4.0 * electrical(middle) + electrical(end));
  book.spent += weight * (spent(state) + 4.0 * spent(middle) + spent(end));
  book.through += kAuditStep * std::fabs(electrical(middle));
  state = end;
}

double stored_energy(const HybridStepper& stepper, const HybridStepperState& state) {
  const StepperMotorParameters& motor = stepper.motor();
  return 0.5 * motor.inductance *
             (state.current[0] * state.current[0] + state.current[1] * state.current[1]) +
         0.5 * stepper.inertia() * state.speed * state.speed -
         motor.detent_torque / (4.0 * motor.pole_pairs) * std::cos(4.0 * state.angle.angle);
}

TEST(HybridStepper, EnergyIsAccountedForToAMillionthOfTheThroughput) {
  MechanicalLoad load;
  load.inertia = 1e-5;
  load.constant_torque = -0.05;
  load.unbalance_torque = 0.02;
  const HybridStepper stepper(*find_stepper_motor("QSH5718-55-30-098"), load);
  HybridStepperState state;
  state.speed = 10.0;
  state.angle = turned({}, 0.3);
  HybridStepperInput input;
  EnergyBook book;
  const double before = stored_energy(stepper, state);
  for (int n = 0; n < 50'000; ++n) {
    // A voltage vector that stays ahead of the rotor, with steps, and a generating phase at the
    // end.
    const double amplitude = n / 5'000 % 2 == 0 ? 8.0 : 5.0;
    const base::SineCosine direction = base::sine_cosine(state.angle.angle + 1.6);
    input.voltage = {amplitude * direction.cosine, amplitude * direction.sine};
    input.torque = n > 30'000 ? 0.15 : 0.0;
    audit_step(stepper, state, input, book);
    ASSERT_GT(state.speed, 0.0) << "the audit's quadrature needs a motion that does not stop";
    ASSERT_LE(stepper.fastest_rate(state) * kAuditStep, 0.33)
        << "the step is too long for this speed";
  }
  const double residual = book.electrical - book.spent - (stored_energy(stepper, state) - before);
  EXPECT_LT(std::fabs(residual), 1e-6 * book.through)
      << "electrical " << book.electrical << " J, spent " << book.spent << " J";
}

TEST(HybridStepper, AgreesWithSteps64TimesFinerToTenThousandths) {
  MechanicalLoad load;
  load.inertia = 1e-4;
  load.viscous_friction = 2e-3;
  load.constant_torque = -0.1;
  const HybridStepper stepper(*find_stepper_motor("QSH5718-55-30-098"), load);
  HybridStepperState coarse;
  coarse.speed = 20.0;
  HybridStepperState fine = coarse;
  HybridStepperInput input;
  ElectricalAngle field;
  double worst_current = 0.0;
  double worst_speed = 0.0;
  for (int n = 0; n < 5'000; ++n) {
    field = turned(field, (20.0 + 0.004 * n) * 50 * kStep);  // up to 6 rev/s
    const base::SineCosine direction = base::sine_cosine(field.angle + 1.3);
    const double amplitude = 10.0 + 0.003 * n;
    input.voltage = {amplitude * direction.cosine, amplitude * direction.sine};
    stepper.step(coarse, input, kStep);
    for (int k = 0; k < 64; ++k) {
      stepper.step(fine, input, kStep / 64.0);
    }
    ASSERT_GT(fine.speed, 0.0) << "dry friction at a reversal is treated to first order only";
    worst_current = std::max(worst_current, std::fabs(coarse.current[0] - fine.current[0]));
    worst_speed = std::max(worst_speed, std::fabs(coarse.speed - fine.speed));
  }
  EXPECT_GT(fine.speed, 30.0) << "the motor must have followed for the comparison to mean much";
  EXPECT_LT(worst_current, 1e-4 * 3.0);
  EXPECT_LT(worst_speed, 1e-4 * 40.0);
}

TEST(HybridStepper, ErrorFallsWithTheFourthPowerOfTheStep) {
  const HybridStepper stepper(frictionless(), {});
  const auto end_of_run = [&](int divisions) {
    HybridStepperState state;
    state.speed = 30.0;
    HybridStepperInput input;
    input.voltage = {5.0, 3.0};
    for (int n = 0; n < 100 * divisions; ++n) {
      stepper.step(state, input, kStep / divisions);
    }
    return state.current[0];
  };
  const double reference = end_of_run(64);
  const double one = std::fabs(end_of_run(1) - reference);
  const double half = std::fabs(end_of_run(2) - reference);
  EXPECT_GT(one / half, 12.0);
  EXPECT_LT(one / half, 20.0);
}

TEST(HybridStepper, AngleKeepsItsResolutionFarFromZero) {
  const HybridStepper stepper(frictionless(), {});
  HybridStepperState near_zero;
  near_zero.speed = 5.0;
  HybridStepperState far = near_zero;
  far.angle.periods = 50'000'000'000;
  HybridStepperInput input;
  input.voltage = {3.0, 1.0};
  for (int n = 0; n < 1'000; ++n) {
    stepper.step(near_zero, input, kStep);
    stepper.step(far, input, kStep);
  }
  EXPECT_EQ(near_zero.angle.angle, far.angle.angle);
  EXPECT_EQ(near_zero.speed, far.speed);
}

TEST(HybridStepper, RevolutionsAndAngleAreInverse) {
  const HybridStepper stepper(frictionless(), {});
  for (const double revolutions : {0.0, 0.123, -0.001, 17.77, -1234.5}) {
    HybridStepperState state;
    state.angle = stepper.angle_at(revolutions);
    EXPECT_GE(state.angle.angle, 0.0);
    EXPECT_LT(state.angle.angle, base::kTwoPi);
    EXPECT_NEAR(stepper.revolutions(state), revolutions, 1e-12);
  }
}

}  // namespace
}  // namespace stator::plant
