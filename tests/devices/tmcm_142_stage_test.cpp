// Power stage, inputs and outputs, shutdown pin and switches of the TMCM-142.

#include <cmath>

#include <gtest/gtest.h>

#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "tmcm_142_module.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

constexpr int kShutdownPin = 80;
constexpr int kDigital = 0;  // banks of GIO
constexpr int kAnalog = 1;
constexpr int kOutput = 2;

struct Tmcm142Stage : testing::Test {
  Tmcm142Module module;
  std::int32_t gio(int port, int bank) {
    const tmcl::HostAnswer answer = module.execute(Command::get_input, port, bank);
    EXPECT_EQ(answer.status, Status::success) << port << " in bank " << bank;
    return answer.value;
  }
  void rotate(int pulses_per_second) {
    ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
    ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 4'000'000), Status::success);
    ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, pulses_per_second).status,
              Status::success);
  }
  [[nodiscard]] double amperes() {
    return std::hypot(module.signal("axis0.coil_current_a"), module.signal("axis0.coil_current_b"));
  }
};

TEST_F(Tmcm142Stage, TheLoadValueFallsWithTheLoad) {
  rotate(1'024'000);  // 5 rev/s
  module.run(1_s);
  const std::int32_t idle = module.gap(actual_load_value);
  EXPECT_EQ(idle, 7);
  module.set("axis0.load_torque", -0.4);
  module.run(500_ms);
  const std::int32_t loaded = module.gap(actual_load_value);
  EXPECT_LT(loaded, 6);
  EXPECT_NEAR(module.signal("axis0.shaft_speed"), 5.0, 0.5) << "not stalled";
  module.set("axis0.load_torque", -3.0);
  module.run(500_ms);
  EXPECT_LE(module.gap(actual_load_value), 1);
  EXPECT_EQ(module.gap(actual_speed), 1'024'000) << "no stop on stall (A45)";
}

TEST_F(Tmcm142Stage, AShortIsAnErrorForAsLongAsItLasts) {
  rotate(102'400);
  module.run(100_ms);
  EXPECT_EQ(module.gap(driver_status), 0);
  module.set("axis0.short_a", 1.0);
  module.run(20_ms);
  for (int i = 0; i < 200; ++i) {
    module.run(100_us);
    ASSERT_EQ(module.gap(driver_status), 1) << "while the stage tries again, too";
  }
  EXPECT_EQ(module.signal("alarm"), 1.0);
  EXPECT_TRUE(module.raised(tmcl::ErrorFlag::external_alarm));
  EXPECT_EQ(module.events.count("shorted"), 1);
  module.set("axis0.short_a", 0.0);
  module.run(20_ms);
  EXPECT_EQ(module.gap(driver_status), 0);
  EXPECT_EQ(module.signal("alarm"), 0.0);
  EXPECT_GT(amperes(), 1.0);
}

TEST_F(Tmcm142Stage, WorksWithinItsRangeOfSupplyOnly) {
  for (const double voltage : {17.0, 80.0}) {
    module.set("axis0.supply_voltage", voltage);
    module.run(20_ms);
    EXPECT_EQ(module.gap(driver_status), 1) << voltage;
    EXPECT_LT(amperes(), 0.01) << voltage;
    module.set("axis0.supply_voltage", 48.0);
    module.run(20_ms);
    EXPECT_EQ(module.gap(driver_status), 0) << voltage;
    EXPECT_GT(amperes(), 0.5) << voltage;
  }
  EXPECT_EQ(module.events.count("below 18 V"), 1);
  EXPECT_EQ(module.events.count("above 78.5 V"), 1);
}

TEST_F(Tmcm142Stage, WarnsOfHeatAndThenSwitchesOff) {
  ASSERT_EQ(module.sap(max_current, 15), Status::success);
  ASSERT_EQ(module.sap(standby_current, 15), Status::success);
  module.set("axis0.ambient_temperature", 140.0);
  bool warned_before = false;
  for (int i = 0; i < 2'000 && (module.gap(driver_status) & 1) == 0; ++i) {
    warned_before = warned_before || module.gap(driver_status) == 2;
    module.run(500_ms);
  }
  EXPECT_TRUE(warned_before);
  EXPECT_EQ(module.gap(driver_status), 3);
  module.run(20_ms);
  EXPECT_LT(amperes(), 0.01);
  EXPECT_EQ(module.events.count("too hot"), 1);
}

// L6166-L6168: without mixed decay a running motor gets at least what the chopper's shortest pulse
// feeds: 0.7 us * 16 MHz / divider * U / R.
TEST_F(Tmcm142Stage, WithoutMixedDecayTheCurrentStaysAboveAMinimum) {
  const auto smallest = [&] {
    double minimum = 100.0;
    for (int i = 0; i < 2'000; ++i) {
      module.run(100_us);
      minimum = std::min(minimum, std::fabs(module.signal("axis0.coil_current_a")));
    }
    return minimum;
  };
  rotate(20'480);
  module.run(300_ms);
  EXPECT_LT(smallest(), 0.05);
  ASSERT_EQ(module.sap(mixed_decay_run, 0), Status::success);
  module.run(300_ms);
  double steady = 100.0;  // zero crossings are passed within two periods
  int below = 0;
  const double expected = 0.7e-6 * 16e6 / 444 * 24.0 / 0.8;
  for (int i = 0; i < 2'000; ++i) {
    module.run(100_us);
    const double current = std::fabs(module.signal("axis0.coil_current_a"));
    below += current < 0.9 * expected ? 1 : 0;
    steady = current >= 0.9 * expected ? std::min(steady, current) : steady;
  }
  EXPECT_LT(below, 60);
  EXPECT_NEAR(steady, expected, 0.1 * expected);
  ASSERT_EQ(module.sap(chopper_clock_divider, 818), Status::success);
  module.run(100_ms);
  EXPECT_EQ(module.gap(chopper_clock_divider), 818);
}

// The same for a motor that stands (parameter 22): near a zero crossing the weaker coil gets more
// than its microstep asks for, so the shaft stands beside it.
TEST_F(Tmcm142Stage, WithoutMixedDecayInStandbyTheShaftStandsBesideItsMicrostep) {
  constexpr int kMicrosteps = 16;                              // of 1024 in a full step
  constexpr double kFriction = 1e-4;                           // rev, what it holds up
  ASSERT_EQ(module.sap(standby_current, 8), Status::success);  // the current of a running motor
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, kMicrosteps).status, Status::success);
  ASSERT_TRUE(module.run_to_target(10_s));
  module.run(1_s);
  const auto weaker = [&] {
    return std::min(std::fabs(module.signal("axis0.coil_current_a")),
                    std::fabs(module.signal("axis0.coil_current_b")));
  };
  const auto position = [&] { return module.signal("axis0.shaft_position"); };
  const double current = 7.0 * 8 / 15;
  const double full_step = std::acos(-1.0) / 2;
  const double angle = full_step * kMicrosteps / 1024;
  EXPECT_NEAR(weaker(), current * std::sin(angle), 0.02);
  EXPECT_NEAR(position(), angle / full_step / 200, kFriction);
  const double minimum = 0.7e-6 * 16e6 / 444 * 24.0 / 0.8;
  ASSERT_EQ(module.sap(mixed_decay_standby, 0), Status::success);
  module.run(1_s);
  EXPECT_NEAR(weaker(), minimum, 0.02);
  const double turned = std::atan(minimum / (current * std::cos(angle))) / full_step / 200;
  ASSERT_GT(turned, 6e-4);
  EXPECT_NEAR(position(), turned, kFriction);
  ASSERT_EQ(module.sap(mixed_decay_standby, 1), Status::success);
  module.run(1_s);
  EXPECT_NEAR(weaker(), current * std::sin(angle), 0.02);
  EXPECT_NEAR(position(), angle / full_step / 200, kFriction);
}

TEST_F(Tmcm142Stage, TheChoicesForRunningAndStandingMotorAreTwo) {
  rotate(20'480);
  const auto smallest = [&] {
    double minimum = 100.0;
    for (int i = 0; i < 1'000; ++i) {
      module.run(100_us);
      minimum = std::min(minimum, std::fabs(module.signal("axis0.coil_current_a")));
    }
    return minimum;
  };
  ASSERT_EQ(module.sap(mixed_decay_standby, 0), Status::success);
  module.run(300_ms);
  EXPECT_LT(smallest(), 0.05) << "the motor runs";
}

TEST_F(Tmcm142Stage, InputsAreReadAsLevelsAndByTheConverter) {
  for (int port = 0; port < 9; ++port) {
    EXPECT_EQ(gio(port, kDigital), 0) << port;
  }
  module.set("input1", 2.5);
  module.set("input2", 5.0);
  EXPECT_EQ(gio(1, kDigital), 1);
  EXPECT_EQ(gio(1, kAnalog), 512);
  EXPECT_EQ(gio(2, kAnalog), 1023);
  EXPECT_EQ(gio(0, kAnalog), 0);
  for (const int port : {3, 4, 5, 6, 7, 8}) {
    module.set("input" + std::to_string(port), 1.0);
    EXPECT_EQ(gio(port, kDigital), 1) << port;
  }
  EXPECT_EQ(gio(255, kDigital), 0b1'1111'1110);
  module.set("input8", 0.0);
  module.set("axis0.home_switch", 1.0);
  module.run(1_ms);
  EXPECT_EQ(gio(8, kDigital), 1) << "the home switch is at IN_8";
  EXPECT_EQ(module.execute(Command::get_input, 3, kAnalog).status, Status::wrong_type);
  EXPECT_EQ(module.execute(Command::get_input, 9, kDigital).status, Status::wrong_type);
}

TEST(Tmcm142Options, ChangeWhatTheDocumentLeavesOpen) {
  Tmcm142Configuration configuration;
  configuration.options = {
      .writable_encoder_position = true, .eight_input_bits = true, .opto_bias = false};
  Tmcm142Module module(configuration);
  module.set("input6", 1.0);
  module.set("input7", 1.0);
  module.set("input8", 1.0);
  EXPECT_EQ(module.execute(Command::get_input, 255, 0).value, 0b0100'0000)
      << "no current flows through the opto-couplers";
  EXPECT_EQ(module.sap(encoder_position, 1'000), Status::success);
  EXPECT_EQ(module.gap(encoder_position), 1'000);
  Tmcm142Module strict;
  EXPECT_EQ(strict.sap(encoder_position, 1'000), Status::wrong_type);
}

TEST_F(Tmcm142Stage, OutputsAreSetAndReadBack) {
  for (const int port : {0, 1, 2, 7}) {
    EXPECT_EQ(module.execute(Command::set_output, port, kOutput, 1).status, Status::success);
    EXPECT_EQ(gio(port, kOutput), 1);
    EXPECT_EQ(module.signal("output" + std::to_string(port)), 1.0);
  }
  EXPECT_EQ(module.execute(Command::set_output, 3, kOutput, 1).status, Status::wrong_type);
  EXPECT_EQ(module.execute(Command::set_output, 255, kOutput, 0b0000'0010).status, Status::success);
  EXPECT_EQ(module.signal("output0"), 0.0);
  EXPECT_EQ(module.signal("output1"), 1.0);
  module.power_cycle();
  EXPECT_EQ(module.signal("output1"), 0.0);
}

TEST_F(Tmcm142Stage, TheShutdownPinTakesThePowerAway) {
  rotate(204'800);
  module.run(500_ms);
  module.set("shutdown", 1.0);
  module.run(50_ms);
  EXPECT_GT(amperes(), 1.0) << "the pin has no function as delivered";
  ASSERT_EQ(module.sgp(kShutdownPin, 1), Status::success);
  module.run(50_ms);
  EXPECT_EQ(module.gap(actual_speed), 0);
  EXPECT_LT(amperes(), 0.01);
  EXPECT_TRUE(module.raised(tmcl::ErrorFlag::shutdown));
  EXPECT_EQ(module.events.count("shutdown pin is active"), 1);
  module.set("shutdown", 0.0);
  module.run(50_ms);
  EXPECT_GT(amperes(), 0.5) << "power comes back, the motor stands";
  EXPECT_EQ(module.gap(actual_speed), 0);
  ASSERT_EQ(module.sgp(kShutdownPin, 2), Status::success);
  module.run(50_ms);
  EXPECT_LT(amperes(), 0.01) << "low active";
}

TEST_F(Tmcm142Stage, AClosedContactIsALowPinAndAnActiveSwitch) {
  rotate(102'400);
  module.run(200_ms);
  module.set("axis0.right_switch", 1.0);
  module.run(10_ms);
  EXPECT_EQ(module.gap(right_limit_switch_status), 1);
  EXPECT_EQ(module.gap(left_limit_switch_status), 0);
  EXPECT_EQ(module.gap(switch_status) & 0x33, 0x22);
  EXPECT_EQ(module.gap(actual_speed), 0);
  EXPECT_TRUE(module.raised(tmcl::ErrorFlag::position));
  EXPECT_EQ(module.events.count("limit switch"), 1);
  ASSERT_EQ(module.sap(switch_mode, 1 << 3), Status::success);
  module.run(10_ms);
  EXPECT_EQ(module.gap(right_limit_switch_status), 0) << "the other polarity";
}

class Tmcm142WaitForALimitSwitch : public Tmcm142Stage {
 protected:
  /// WAIT LIMSW, 0, `ticks`, then output 1 goes on.
  void start(std::int32_t ticks) {
    module.device->tmcl().load_program(
        std::vector<tmcl::Instruction>{{.command = 27, .type = 3, .value = ticks},
                                       {.command = 14, .type = 1, .motor = kOutput, .value = 1},
                                       {.command = 28}});
    module.device->tmcl().start_program(module.now);
  }
  [[nodiscard]] bool through() { return module.signal("output1") == 1.0; }
};

TEST_F(Tmcm142WaitForALimitSwitch, EndsWithEitherOfThemAndWithNothingElse) {
  for (const char* const name : {"axis0.left_switch", "axis0.right_switch"}) {
    SCOPED_TRACE(name);
    module.set("axis0.home_switch", 1.0);
    start(0);
    module.run(2_s);
    EXPECT_FALSE(through()) << "neither is pressed, and 0 is no time-out";
    module.set(name, 1.0);
    module.run(2_ms);
    EXPECT_TRUE(through());
    EXPECT_FALSE(module.raised(tmcl::ErrorFlag::timeout));
    module.set(name, 0.0);
    module.run(2_ms);
    ASSERT_EQ(module.execute(Command::set_output, 1, kOutput, 0).status, Status::success);
  }
}

TEST_F(Tmcm142WaitForALimitSwitch, EndsWithItsTimeOutToo) {
  start(50);  // of 10 ms
  module.run(490_ms);
  EXPECT_FALSE(through());
  EXPECT_FALSE(module.raised(tmcl::ErrorFlag::timeout));
  module.run(12_ms);
  EXPECT_TRUE(through());
  EXPECT_TRUE(module.raised(tmcl::ErrorFlag::timeout));
}

TEST(Tmcm142Search, FindsTheLeftSwitchAndMeasuresTheDistanceBetweenBoth) {
  for (const int mode : {1, 2, 3}) {
    Tmcm142Configuration configuration;
    configuration.axis.left_switch = plant::PositionSwitch::left_at(-1.0);
    configuration.axis.right_switch = plant::PositionSwitch::right_at(2.0);
    Tmcm142Module module(configuration);
    ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
    ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 2'000'000), Status::success);
    ASSERT_EQ(module.sap(reference_search_mode, mode), Status::success);
    ASSERT_EQ(module.sap(reference_search_speed, 409'600), Status::success);
    ASSERT_EQ(module.sap(reference_switch_speed, 20'480), Status::success);
    ASSERT_EQ(module.execute(Command::reference_search, 0, 0).status, Status::success);
    const auto state = [&] { return module.execute(Command::reference_search, 2, 0).value; };
    EXPECT_GT(state(), 0);
    for (int i = 0; i < 60'000 && state() != 0; ++i) {
      module.run(1_ms);
    }
    ASSERT_EQ(state(), 0) << mode;
    module.run(500_ms);
    EXPECT_NEAR(module.signal("axis0.shaft_position") - module.gap(actual_position) / 204'800.0,
                -1.0, 2e-3)
        << mode;
    if (mode != 1) {
      EXPECT_NEAR(module.gap(end_switch_distance) / 204'800.0, 3.0, 5e-3) << mode;
    }
    EXPECT_EQ(module.gap(target_position), module.gap(actual_position));
    EXPECT_FALSE(module.raised(tmcl::ErrorFlag::position)) << "the switches belong to the search";
  }
}

TEST(Tmcm142Search, EndsWithAMotionCommand) {
  Tmcm142Module module;
  ASSERT_EQ(module.execute(Command::reference_search, 0, 0).status, Status::success);
  module.run(50_ms);
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 100).status, Status::success);
  EXPECT_EQ(module.execute(Command::reference_search, 2, 0).value, 0);
  ASSERT_TRUE(module.run_to_target(10_s));
}

}  // namespace
}  // namespace stator::tests
