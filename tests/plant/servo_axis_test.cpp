#include "stator/plant/axes/servo_axis.hpp"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "plant/ideal_commutator.hpp"

namespace stator::plant {
namespace {

using namespace base::literals;

/// Runs `axis` for `milliseconds` with volts on the axes of its rotor.
void run(ServoAxis& axis, double milliseconds, double quadrature, double direct = 0.0,
         base::ServoActuation actuation = {.bridge_enabled = true}) {
  for (int n = 0; n < static_cast<int>(milliseconds * 20.0); ++n) {
    actuation.duty = commutated(axis, direct, quadrature);
    axis.step(actuation, 50_us);
  }
}

constexpr base::ServoActuation kOff{};

void coast(ServoAxis& axis, double milliseconds, const base::ServoActuation& actuation = kOff) {
  for (int n = 0; n < static_cast<int>(milliseconds * 20.0); ++n) {
    axis.step(actuation, 50_us);
  }
}

TEST(ServoAxis, WithoutLoadTheSpeedIsVoltageOverFlux) {
  const ServoAxisParameters parameters = textbook_axis();
  ServoAxis axis(parameters);
  run(axis, 500.0, 5.0);
  EXPECT_NEAR(axis.observe().speed, 5.0 / (4.0 * parameters.motor.flux_linkage), 0.05);
}

TEST(ServoAxis, ABlockedShaftGivesTheTorqueOfVoltageOverResistance) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.load.coulomb_friction = 10.0;
  ServoAxis axis(parameters);
  run(axis, 50.0, 1.0);
  const double current = 1.0 / parameters.motor.resistance;
  EXPECT_NEAR(axis.observe().quadrature_current, current, 1e-6);
  EXPECT_NEAR(axis.observe().electromagnetic_torque, parameters.motor.torque_constant() * current,
              1e-6);
  EXPECT_EQ(axis.observe().speed, 0.0);
}

TEST(ServoAxis, OnResistanceAddsToThatOfTheWinding) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.load.coulomb_friction = 10.0;
  parameters.inverter.on_resistance = 0.04;
  ServoAxis axis(parameters);
  run(axis, 50.0, 1.0);
  EXPECT_NEAR(axis.observe().quadrature_current, 1.0 / (parameters.motor.resistance + 0.04), 1e-6);
}

TEST(ServoAxis, DeadTimeTakesItsShareOfTheSupplyFromAPhaseThatCarriesCurrent) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.load.coulomb_friction = 10.0;
  parameters.motor.resistance = 0.4;
  parameters.inverter.dead_time = 100e-9;  // 1 % of a period
  parameters.inverter.diode_drop = 0.7;
  ServoAxis axis(parameters);
  run(axis, 50.0, 0.0, 2.0);  // the d axis: all into U, half of it out of V and W
  // U loses the drop, V and W gain it; less their mean that is 4/3 of it.
  const double drop = 0.01 * 24.0 + 0.02 * 0.7;
  EXPECT_NEAR(axis.observe().direct_current, (2.0 - 4.0 / 3.0 * drop) / 0.4, 1e-6);
}

TEST(ServoAxis, WithTheBridgeOffTheCurrentDiesInTheDiodesAndTheShaftCoasts) {
  ServoAxisParameters parameters = textbook_axis();
  ServoAxis axis(parameters);
  run(axis, 1.0, 10.0);
  ASSERT_GT(axis.observe().quadrature_current, 5.0);
  coast(axis, 2.0);
  EXPECT_EQ(axis.observe().quadrature_current, 0.0);
  EXPECT_EQ(axis.observe().direct_current, 0.0);
  const double speed = axis.observe().speed;
  coast(axis, 10.0);
  EXPECT_EQ(axis.observe().speed, speed);
}

TEST(ServoAxis, AnEmfAboveTheSupplyChargesTheCapacitorAndBrakes) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.supply = {.capacitance = 470e-6};
  ServoAxis axis(parameters);
  // A shaft driven from outside: 40 V between the lines.
  axis.set_external_torque(0.2);
  coast(axis, 60.0);
  const ServoAxisObservation seen = axis.observe();
  const double emf = std::sqrt(3.0) * 4.0 * parameters.motor.flux_linkage * seen.speed;
  ASSERT_GT(emf, 30.0);
  EXPECT_LT(seen.electromagnetic_torque, 0.0);
  EXPECT_GT(seen.supply_voltage, 25.0);
  EXPECT_LT(seen.supply_voltage, emf);
  EXPECT_LT(seen.supplied_energy, 0.0);
}

TEST(ServoAxis, RegeneratedEnergyRaisesTheVoltageAsTheCapacitorSays) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.supply = {.capacitance = 4700e-6};
  parameters.load.inertia = 50e-6;
  ServoAxis axis(parameters);
  run(axis, 600.0, 7.0);
  const double shaft_energy =
      0.5 * (parameters.motor.rotor_inertia + 50e-6) * std::pow(axis.observe().speed, 2);
  const double before = axis.observe().supply_voltage;
  const double supplied = axis.observe().supplied_energy;
  double copper = 0.0;
  for (int n = 0; n < 2000; ++n) {
    run(axis, 0.05, 4.0 * parameters.motor.flux_linkage * axis.observe().speed - 1.0);
    const ServoAxisObservation seen = axis.observe();
    copper += 50e-6 * 1.5 * parameters.motor.resistance *
              (seen.quadrature_current * seen.quadrature_current +
               seen.direct_current * seen.direct_current);
  }
  const double left =
      0.5 * (parameters.motor.rotor_inertia + 50e-6) * std::pow(axis.observe().speed, 2);
  const double returned = supplied - axis.observe().supplied_energy;
  EXPECT_NEAR(returned, shaft_energy - left - copper, 0.01 * returned);
  // dV = sqrt(V0^2 + 2 E / C) - V0
  EXPECT_NEAR(axis.observe().supply_voltage, std::sqrt(before * before + 2.0 * returned / 4700e-6),
              0.01);
  EXPECT_GT(axis.observe().supply_voltage, 25.0);
}

TEST(ServoAxis, BrakeChopperBurnsWhatABrakingMotorReturnsWhileTheDriveTellsIt) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.supply = {.capacitance = 470e-6, .chopper_resistance = 5.0};
  ServoAxis axis(parameters);
  axis.set_external_torque(0.15);
  coast(axis, 60.0);
  const double high = axis.sensing().supply_voltage;
  ASSERT_GT(high, 26.0);
  const base::ServoActuation chopper{.brake_chopper_on = true};
  axis.step(chopper, 50_us);
  EXPECT_TRUE(axis.state().supply.chopper_conducts);
  axis.set_external_torque(0.0);
  coast(axis, 20.0, chopper);
  EXPECT_LT(axis.sensing().supply_voltage, high - 2.0);
  coast(axis, 0.05);
  EXPECT_FALSE(axis.state().supply.chopper_conducts);
}

TEST(ServoAxis, AChopperTheSourceFeedsTooCarriesItsCurrent) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.supply = {.capacitance = 470e-6, .source_resistance = 0.5, .chopper_resistance = 11.5};
  ServoAxis axis(parameters);
  coast(axis, 50.0, {.brake_chopper_on = true});
  EXPECT_NEAR(axis.sensing().supply_voltage, 24.0 * 11.5 / 12.0, 1e-3);
}

TEST(ServoAxis, HallsAndEncoderTellWhereTheShaftIs) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.initial_revolutions = 0.1;
  ServoAxis axis(parameters);
  run(axis, 100.0, 3.0);
  const ServoAxisObservation seen = axis.observe();
  EXPECT_NEAR(static_cast<double>(axis.sensing().encoder_count),
              (seen.shaft_revolutions - 0.1) * 4096.0, 1.0);
  EXPECT_NEAR(axis.sensing().encoder_index_passages, std::floor(seen.shaft_revolutions), 0.0);
  constexpr std::array<unsigned, 6> kForward{1, 3, 2, 6, 4, 5};
  const auto sector = static_cast<std::size_t>(seen.electrical_angle * (6.0 / base::kTwoPi) + 0.5);
  const double in_sector =
      std::fabs(seen.electrical_angle - base::kPi / 3.0 * static_cast<double>(sector));
  if (in_sector < 0.45) {
    EXPECT_EQ(axis.sensing().halls, kForward[sector % 6]);
  }
}

TEST(ServoAxis, AMotorAgainstAnEndStopStallsAndTheStopBearsItsTorque) {
  ServoAxisParameters parameters = textbook_axis();
  parameters.load.end_stop_maximum = 0.5;
  parameters.load.coulomb_friction = 1e-3;
  parameters.motor.viscous_friction = 1e-5;
  ServoAxis axis(parameters);
  run(axis, 1000.0, 1.0);
  const ServoAxisObservation seen = axis.observe();
  EXPECT_NEAR(seen.speed, 0.0, 1e-9);
  EXPECT_NEAR(seen.shaft_revolutions, 0.5, 1e-3);
  const double stall = parameters.motor.torque_constant() / parameters.motor.resistance;
  EXPECT_NEAR(seen.quadrature_current, 1.0 / parameters.motor.resistance, 1e-6);
  EXPECT_NEAR(-seen.end_stop_torque, stall, 1.1e-3);
}

TEST(ServoAxis, WindingWarmsUpAndItsResistanceFollows) {
  ServoAxisParameters parameters;
  parameters.load.coulomb_friction = 10.0;
  ServoAxis axis(parameters);
  run(axis, 10'000.0, 4.0);
  const ServoAxisObservation seen = axis.observe();
  EXPECT_GT(seen.winding_temperature, 40.0);
  EXPECT_GT(seen.winding_temperature, seen.housing_temperature);
  EXPECT_GT(seen.driver_temperature, 25.0);
  const double resistance =
      parameters.motor.resistance * (1.0 + 0.00393 * (seen.winding_temperature - 25.0)) + 0.01;
  EXPECT_NEAR(seen.quadrature_current, 4.0 / resistance, 1e-3);
}

TEST(ServoAxis, EnergyFromTheSupplyEndsInHeatShaftAndCapacitor) {
  ServoAxisParameters parameters;
  parameters.motor.resistance_coefficient = 0.0;
  parameters.motor.cogging = {};
  parameters.motor.static_friction = parameters.motor.coulomb_friction;
  parameters.inverter.on_resistance = 0.02;
  ServoAxis axis(parameters);
  axis.set_external_torque(-0.03);
  double heat = 0.0;
  double work = 0.0;
  double from_source = 0.0;
  for (int n = 0; n < 20'000; ++n) {
    const ServoAxisObservation before = axis.observe();
    run(axis, 0.05, n < 10'000 ? 8.0 : 3.0);
    const ServoAxisObservation after = axis.observe();
    const auto mean = [&](auto quantity) { return 0.5 * (quantity(before) + quantity(after)); };
    heat += 50e-6 * mean([&](const ServoAxisObservation& seen) {
              const double square = seen.direct_current * seen.direct_current +
                                    seen.quadrature_current * seen.quadrature_current;
              return 1.5 * (parameters.motor.resistance + 0.02) * square +
                     parameters.motor.viscous_friction * seen.speed * seen.speed +
                     parameters.motor.coulomb_friction * std::fabs(seen.speed);
            });
    work += 50e-6 * mean([](const ServoAxisObservation& seen) { return 0.03 * seen.speed; });
    // The step's resistances act with the voltage at its end.
    from_source +=
        50e-6 * std::max(0.0, (24.0 - after.supply_voltage) / 0.05) * after.supply_voltage;
  }
  const ServoAxisObservation seen = axis.observe();
  const double shaft = 0.5 * parameters.motor.rotor_inertia * seen.speed * seen.speed;
  const double field = 0.75 * parameters.motor.direct_inductance *
                       (seen.direct_current * seen.direct_current +
                        seen.quadrature_current * seen.quadrature_current);
  EXPECT_NEAR(seen.supplied_energy, heat + work + shaft + field, 1e-3 * seen.supplied_energy);
  const double capacitor = 0.5 * 470e-6 * (seen.supply_voltage * seen.supply_voltage - 24.0 * 24.0);
  EXPECT_NEAR(from_source, seen.supplied_energy + capacitor, 5e-3 * seen.supplied_energy);
}

TEST(ServoAxis, AStandingShaftStaysExactlyWhereItIs) {
  ServoAxis axis(ServoAxisParameters{});
  coast(axis, 10.0);
  const ServoAxisState before = axis.state();
  coast(axis, 1000.0);
  EXPECT_EQ(axis.state().motor, before.motor);
  EXPECT_EQ(axis.sensing().encoder_count, 0);
  axis.set_external_torque(0.05);
  coast(axis, 10.0);
  EXPECT_GT(axis.observe().speed, 0.0);
}

TEST(ServoAxis, ASettledShaftStillCoolsDown) {
  ServoAxisParameters parameters;
  parameters.load.coulomb_friction = 10.0;
  ServoAxis axis(parameters);
  run(axis, 5000.0, 4.0);
  const double warm = axis.observe().winding_temperature;
  coast(axis, 20'000.0);
  EXPECT_LT(axis.observe().winding_temperature, warm - 3.0);
}

TEST(ServoAxis, HandAndCamPressSwitches) {
  ServoAxisParameters parameters;
  parameters.left_switch = PositionSwitch::left_at(-1.0);
  ServoAxis axis(parameters);
  EXPECT_FALSE(axis.sensing().left_switch);
  axis.press_left_switch(true);
  EXPECT_TRUE(axis.sensing().left_switch);
  axis.press_left_switch(false);
  coast(axis, 1.0);
  EXPECT_FALSE(axis.sensing().left_switch);
  axis.press_home_switch(true);  // nothing is connected: a hand holds a wire
  EXPECT_TRUE(axis.sensing().home_switch);
}

TEST(ServoAxis, ASnapshotContinuesToTheLastBit) {
  ServoAxisParameters parameters;
  parameters.current_sensing.noise = 0.01;
  ServoAxis axis(parameters);
  run(axis, 30.3, 6.0);
  ServoAxis copy(parameters);
  copy.restore(axis.state());
  run(axis, 25.0, -4.0);
  run(copy, 25.0, -4.0);
  EXPECT_EQ(axis.state().motor, copy.state().motor);
  EXPECT_EQ(axis.sensing().phase_current, copy.sensing().phase_current);
  EXPECT_EQ(axis.sensing().encoder_index_count, copy.sensing().encoder_index_count);
}

std::uint64_t fingerprint_of_a_run() {
  ServoAxisParameters parameters;
  parameters.motor.back_emf.trapezoidal_share = 0.3;
  parameters.motor.quadrature_inductance = 0.8e-3;
  parameters.inverter.dead_time = 100e-9;
  parameters.current_sensing = {.noise = 0.01, .resolution = 0.01};
  parameters.load.end_stop_maximum = 20.0;
  ServoAxis axis(parameters);
  std::uint64_t hash = 0;
  const auto mix = [&](double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x9E3779B97F4A7C15U;
    hash ^= hash >> 29;
  };
  for (int n = 0; n < 20'000; ++n) {
    base::ServoActuation actuation{.bridge_enabled = n % 5000 < 4000,
                                   .brake_chopper_on = n % 300 > 280};
    actuation.duty = commutated(axis, 0.5, n < 12'000 ? 9.0 : -9.0);
    axis.set_external_torque(n % 2000 < 1000 ? -0.05 : 0.08);
    axis.step(actuation, 50_us);
    mix(axis.sensing().phase_current[0]);
    mix(axis.state().motor.speed);
    mix(axis.sensing().supply_voltage);
  }
  return hash;
}

TEST(ServoAxis, SameRunIsTheSameToTheLastBitInEveryBuild) {
  const std::uint64_t hash = fingerprint_of_a_run();
  EXPECT_EQ(hash, fingerprint_of_a_run());
  EXPECT_EQ(hash, 1'220'097'915'906'196'336U) << "the model or its arithmetic has changed";
}

}  // namespace
}  // namespace stator::plant
