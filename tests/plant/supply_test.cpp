// The supply of a power stage: source, capacitor, brake chopper.

#include "stator/plant/power/supply.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "plant/rotating_field.hpp"

namespace stator::plant {
namespace {

TEST(Supply, AnIdealSourceGivesItsVoltageWhateverIsTaken) {
  const Supply supply(SupplyParameters{});
  SupplyState state{.source = 36.0, .voltage = 24.0};
  supply.advance(state, 500.0, 50e-6);
  EXPECT_EQ(state.voltage, 36.0);
}

TEST(Supply, ALoadedSourceSagsByItsResistance) {
  const Supply supply({.capacitance = 470e-6, .source_resistance = 0.2});
  SupplyState state;
  for (int n = 0; n < 1000; ++n) {
    supply.advance(state, 48.0, 50e-6);
  }
  // V = Vs - Rs P / V
  EXPECT_NEAR(state.voltage, 0.5 * (24.0 + std::sqrt(24.0 * 24.0 - 4.0 * 0.2 * 48.0)), 1e-3);
}

TEST(Supply, ReturnedEnergyChargesTheCapacitor) {
  const Supply supply({.capacitance = 1e-3});
  SupplyState state;
  for (int n = 0; n < 20'000; ++n) {
    supply.advance(state, -1.0, 50e-6);  // 1 J in a second
  }
  EXPECT_NEAR(state.voltage, std::sqrt(24.0 * 24.0 + 2.0 * 1.0 / 1e-3), 0.05);
}

TEST(Supply, TheBrakeChopperKeepsTheVoltageAtItsLimit) {
  const Supply supply({.capacitance = 1e-3, .chopper_voltage = 28.0, .chopper_resistance = 10.0});
  SupplyState state;
  double highest = 0.0;
  for (int n = 0; n < 40'000; ++n) {
    supply.advance(state, -30.0, 50e-6);
    highest = std::fmax(highest, state.voltage);
  }
  EXPECT_LT(highest, 28.2);
  EXPECT_GT(highest, 28.0);
  EXPECT_GT(state.voltage, 26.8);
}

double highest_voltage_while_a_load_drives(double chopper_voltage) {
  StepperAxisParameters parameters;
  parameters.motor = *find_stepper_motor("QSH5718-55-30-098");
  parameters.motor.viscous_friction = 2e-3;
  parameters.supply = {.capacitance = 470e-6, .chopper_voltage = chopper_voltage};
  StepperAxis axis(parameters);
  RotatingField field(axis, 2.0);
  field.run(0.5, 8.0 * base::kTwoPi / 0.5);
  double highest = 0.0;
  for (int n = 0; n < 10'000; ++n) {
    axis.set_external_torque(0.3 * std::fmin(1.0, n / 4000.0));
    field.step();
    highest = std::fmax(highest, field.sensing().supply_voltage);
  }
  return highest;
}

TEST(Supply, ALoadThatDrivesTheMotorRaisesTheBusAndTheChopperLimitsIt) {
  EXPECT_GT(highest_voltage_while_a_load_drives(1e9), 35.0);
  const double limited = highest_voltage_while_a_load_drives(28.0);
  EXPECT_GT(limited, 28.0);
  EXPECT_LT(limited, 28.5);
}

}  // namespace
}  // namespace stator::plant
