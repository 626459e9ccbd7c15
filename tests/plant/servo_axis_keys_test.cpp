#include "stator/plant/keys/servo_axis_keys.hpp"

#include <string>

#include <gtest/gtest.h>

#include "stator/formats/toml/toml.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/reader.hpp"

namespace stator::plant {
namespace {

/// What a table makes of the parameters, with all that is wrong with it.
struct AxisOfTable {
  ServoAxisParameters parameters;
  settings::Problems problems;
};

AxisOfTable axis_of(const char* text) {
  AxisOfTable axis;
  const auto tree = formats::parse_toml(text, "rack.toml");
  EXPECT_TRUE(tree.has_value());
  if (tree) {
    const settings::Reading reading{axis.problems};
    settings::Reader reader(reading, "[[bus.device.axis]] number 1", *tree);
    settings::read_section(kServoAxisKeys, reader, axis.parameters);
  }
  return axis;
}

ServoAxisParameters parsed(const char* text) {
  const AxisOfTable axis = axis_of(text);
  EXPECT_TRUE(axis.problems.list.empty());
  return axis.parameters;
}

std::string refusal(const char* text) {
  const AxisOfTable axis = axis_of(text);
  return axis.problems.list.empty() ? "accepted" : axis.problems.list.front().text();
}

TEST(ServoAxisKeys, EmptyTableIsTheUsualMotorOnItsCapacitor) {
  const ServoAxisParameters parameters = parsed("");
  EXPECT_EQ(parameters.motor.rated_current, 3.47);
  EXPECT_EQ(parameters.supply.capacitance, 470e-6);
  EXPECT_EQ(parameters.encoder.counts_per_revolution, 4096);
}

TEST(ServoAxisKeys, KeysOfMotorSensorsAndSurroundingsReachTheirPlaces) {
  const ServoAxisParameters parameters = parsed(R"(
    motor = "EC45-flat-70W"
    motor_data = { resistance = 0.3, trapezoidal_share = 0.5, flat_top = 90, cogging_torque = 0.001 }
    supply_voltage = 36
    supply = { brake_chopper_resistance = 5 }
    load = { inertia = 1e-4, end_stop_maximum = 2 }
    inverter = { dead_time = 2e-7 }
    halls = { inverted = true, offset = 30, h2_error = -3 }
    encoder = { counts_per_revolution = 2000 }
    current_sensing = { gain_v = 1.01, noise = 0.02 }
    left_switch = { pressed_to = -1 }
  )");
  EXPECT_EQ(parameters.motor.pole_pairs, 8);
  EXPECT_EQ(parameters.motor.resistance, 0.3);
  EXPECT_EQ(parameters.motor.back_emf.trapezoidal_share, 0.5);
  EXPECT_NEAR(parameters.motor.back_emf.flat_top, 1.5708, 1e-4);
  EXPECT_EQ(parameters.motor.cogging[0].amplitude, 0.001);
  EXPECT_EQ(parameters.supply_voltage, 36.0);
  EXPECT_EQ(parameters.supply.chopper_resistance, 5.0);
  EXPECT_EQ(parameters.load.inertia, 1e-4);
  EXPECT_EQ(parameters.load.end_stop_maximum, 2.0);
  EXPECT_EQ(parameters.inverter.dead_time, 2e-7);
  EXPECT_TRUE(parameters.halls.inverted);
  EXPECT_NEAR(parameters.halls.offset, 0.523599, 1e-6);
  EXPECT_NEAR(parameters.halls.placement_error[1], -0.05236, 1e-5);
  EXPECT_EQ(parameters.encoder.counts_per_revolution, 2000);
  EXPECT_EQ(parameters.current_sensing.gain[1], 1.01);
  EXPECT_EQ(parameters.current_sensing.noise, 0.02);
  EXPECT_TRUE(parameters.left_switch.fitted);
}

TEST(ServoAxisKeys, RefusalsNameTheKeyAndWhatIsPossible) {
  EXPECT_NE(refusal(R"(motor = "QBL4208-61")").find("did you mean \"QBL4208-61-04-013\""),
            std::string::npos);
  EXPECT_NE(refusal("halls = { hysterese = 2 }").find("hysterese"), std::string::npos);
  EXPECT_NE(refusal("motor_data = { static_friction = 0 }").find("coulomb_friction"),
            std::string::npos);
  EXPECT_NE(refusal("inverter = { dead_time = 1e-5 }").find("a tenth of the PWM period"),
            std::string::npos);
  EXPECT_EQ(refusal("inverter = { dead_time = 5e-6, pwm_frequency = 20e3 }"), "accepted");
  EXPECT_NE(refusal("brake = { output = 0 }").find("load.brake_torque"), std::string::npos);
}

}  // namespace
}  // namespace stator::plant
