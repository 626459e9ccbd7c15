// What stops the motor of the TMCM-142, what is told then, and what begins afterwards.

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "tmcm_142_module.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::ErrorFlag;
using tmcl::Instruction;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

constexpr int kShutdownPin = 80;
constexpr double kWithinAFullStep = 1.0 / 200;  // revolutions

struct Tmcm142Stops : testing::Test {
  Tmcm142Stops() {
    EXPECT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
    EXPECT_EQ(module.sap(max_positioning_speed, 409'600), Status::success);
    EXPECT_EQ(module.sap(max_acceleration_and_deceleration, 2'000'000), Status::success);
  }
  void shut_down(bool active) {
    ASSERT_EQ(module.sgp(kShutdownPin, 1), Status::success);
    module.set("shutdown", active ? 1.0 : 0.0);
    module.run(1_ms);
  }
  Status move_to(std::int64_t position) {
    return module.execute(Command::move_to_position, 0, 0, position).status;
  }
  Status rotate(std::int64_t velocity) {
    return module.execute(Command::rotate_right, 0, 0, velocity).status;
  }
  void clear_flags() {
    module.device->tmcl().load_program(std::vector<Instruction>{{.command = 36}, {.command = 28}});
    module.device->tmcl().start_program(module.now);
    module.run(5_ms);
  }
  std::int32_t search_state() { return module.execute(Command::reference_search, 2, 0).value; }
  [[nodiscard]] double revolutions() { return module.signal("axis0.shaft_position"); }
  /// The shaft stands where parameter 1 says, and nothing is on its way.
  void expect_rest(std::int32_t position) {
    const double shaft = revolutions();
    module.run(500_ms);
    EXPECT_EQ(module.gap(actual_position), position);
    EXPECT_EQ(module.gap(actual_speed), 0);
    EXPECT_NEAR(revolutions(), shaft, kWithinAFullStep);
  }

  Tmcm142Module module;
};

TEST_F(Tmcm142Stops, WhileShutDownAMoveIsNeitherCountedNorReached) {
  shut_down(true);
  EXPECT_EQ(move_to(204'800), Status::success);
  module.run(3_s);
  EXPECT_EQ(module.gap(target_position), 204'800);
  EXPECT_EQ(module.gap(actual_position), 0);
  EXPECT_EQ(module.gap(position_reached), 0);
  EXPECT_FALSE(module.device->tmcl().targets_reached(1)) << "no event of command 138";
  shut_down(false);
  expect_rest(0);
  EXPECT_EQ(module.gap(position_reached), 0) << "nothing begins by itself";
  EXPECT_EQ(move_to(204'800), Status::success);
  ASSERT_TRUE(module.run_to_target(3_s));
  module.run(300_ms);
  EXPECT_NEAR(revolutions(), 1.0, 1e-3);
}

TEST_F(Tmcm142Stops, AProgramWaitsWhileShutDownAndFindsOutByItsFlag) {
  shut_down(true);
  clear_flags();
  EXPECT_FALSE(module.raised(ErrorFlag::shutdown));
  module.device->tmcl().load_program(
      std::vector<Instruction>{{.command = 4, .type = 0, .value = 204'800},         // MVP
                               {.command = 27, .type = 1, .value = 50},             // WAIT POS
                               {.command = 14, .type = 1, .motor = 2, .value = 1},  // SIO 1
                               {.command = 28}});
  module.device->tmcl().start_program(module.now);
  module.run(450_ms);
  EXPECT_EQ(module.signal("output1"), 0.0) << "it waits";
  EXPECT_TRUE(module.raised(ErrorFlag::shutdown)) << "raised anew by the command";
  EXPECT_FALSE(module.raised(ErrorFlag::timeout));
  module.run(100_ms);
  EXPECT_EQ(module.signal("output1"), 1.0);
  EXPECT_TRUE(module.raised(ErrorFlag::timeout));
}

TEST_F(Tmcm142Stops, EveryMotionEndsWithTheShutdownPinAndNoneBeginsWithItsRelease) {
  const auto start = [this](int motion) {
    switch (motion) {
      case 0:
        return move_to(module.gap(actual_position) + 2'048'000);
      case 1:
        return rotate(409'600);
      case 2:
        return module.execute(Command::rotate_left, 0, 0, 409'600).status;
      case 3:
        return module.sap(target_position, module.gap(actual_position) - 2'048'000);
      case 4:
        return module.sap(target_speed, -409'600);
      case 5:
        EXPECT_EQ(module.execute(Command::set_coordinate, 3, 0, 9'000'000).status, Status::success);
        return module.execute(Command::move_to_position, 2, 0, 3).status;
      case 6:
        return module.sap(ramp_mode, 0);  // to the target it has
      default:
        return module.execute(Command::reference_search, 0, 0).status;
    }
  };
  for (int motion = 0; motion < 8; ++motion) {
    SCOPED_TRACE(motion);
    EXPECT_EQ(start(motion), Status::success);
    module.run(400_ms);
    EXPECT_GT(std::abs(module.gap(actual_speed)), 100'000);
    shut_down(true);
    const std::int32_t position = module.gap(actual_position);
    EXPECT_EQ(module.gap(actual_speed), 0);
    module.run(1_s);
    EXPECT_EQ(start(motion), Status::success) << "and the same while it is active";
    module.run(1_s);
    EXPECT_EQ(module.gap(actual_position), position);
    EXPECT_EQ(module.gap(target_speed), 0);
    EXPECT_EQ(search_state(), 0);
    shut_down(false);
    module.run(200_ms);
    expect_rest(position);
  }
}

TEST_F(Tmcm142Stops, ASearchThatTheShutdownPinEndsHasFailed) {
  EXPECT_EQ(module.execute(Command::reference_search, 0, 0).status, Status::success);
  module.run(100_ms);
  EXPECT_FALSE(module.raised(ErrorFlag::position));
  shut_down(true);
  EXPECT_TRUE(module.raised(ErrorFlag::position));
  clear_flags();
  EXPECT_EQ(module.execute(Command::reference_search, 0, 0).status, Status::success);
  module.run(1_ms);
  EXPECT_TRUE(module.raised(ErrorFlag::position)) << "told of each search";
  EXPECT_TRUE(module.raised(ErrorFlag::shutdown));
  EXPECT_EQ(module.events.count("without a reference: the power stage is off"), 2);
}

TEST_F(Tmcm142Stops, StoppingIsNoMotionThatTheShutdownPinWouldEnd) {
  shut_down(true);
  clear_flags();
  EXPECT_EQ(module.execute(Command::motor_stop, 0, 0).status, Status::success);
  EXPECT_EQ(module.execute(Command::reference_search, 1, 0).status, Status::success);
  EXPECT_EQ(module.sap(actual_position, 4'711), Status::success);
  module.run(10_ms);
  EXPECT_FALSE(module.raised(ErrorFlag::shutdown));
  EXPECT_EQ(module.events.count("the motor stays"), 0);
  EXPECT_EQ(module.gap(actual_position), 4'711);
}

TEST_F(Tmcm142Stops, ADriverErrorEndsTheMotionInsteadOfCountingItOn) {
  for (const double voltage : {10.0, 80.0}) {
    SCOPED_TRACE(voltage);
    clear_flags();
    EXPECT_EQ(move_to(module.gap(actual_position) + 409'600), Status::success);
    module.run(300_ms);
    module.set("axis0.supply_voltage", voltage);
    module.run(5_ms);
    const std::int32_t position = module.gap(actual_position);
    EXPECT_EQ(module.gap(actual_speed), 0);
    EXPECT_TRUE(module.raised(ErrorFlag::external_alarm));
    module.run(2_s);
    EXPECT_EQ(module.gap(actual_position), position);
    EXPECT_EQ(module.gap(position_reached), 0);
    clear_flags();
    EXPECT_EQ(move_to(position + 204'800), Status::success);
    module.run(1_s);
    EXPECT_TRUE(module.raised(ErrorFlag::external_alarm)) << "told of each command";
    EXPECT_EQ(module.gap(actual_position), position);
    module.set("axis0.supply_voltage", 24.0);
    module.run(200_ms);
    expect_rest(position);
    EXPECT_EQ(module.gap(driver_status), 0);
    const double shaft = revolutions();
    EXPECT_EQ(move_to(position + 204'800), Status::success);
    ASSERT_TRUE(module.run_to_target(3_s));
    module.run(300_ms);
    EXPECT_NEAR(revolutions() - shaft, 1.0, kWithinAFullStep);
  }
  EXPECT_EQ(module.events.count("the motor stays"), 2);
}

TEST_F(Tmcm142Stops, AMotorTurnedByHandWhileShutDownIsNotFollowed) {
  ASSERT_EQ(module.sap(encoder_constant, 335'544), Status::success);  // 5.12 microsteps
  ASSERT_EQ(module.sap(pid_p_factor, 100'000), Status::success);
  ASSERT_EQ(module.sap(pid_dv_clipping, 400'000), Status::success);
  ASSERT_EQ(module.sap(maximum_encoder_deviation, 10'000), Status::success);
  ASSERT_EQ(module.sap(pid_mode, 1), Status::success);
  module.run(10_ms);
  shut_down(true);
  module.set("axis0.load_torque", 0.2);
  module.run(100_ms);
  module.set("axis0.load_torque", 0.0);
  module.run(1_s);
  ASSERT_GT(module.gap(encoder_position), 20'000) << "it was turned";
  EXPECT_EQ(module.gap(pid_vactual), 0);
  EXPECT_EQ(module.gap(error_flags), 0) << "nothing moved that could be stopped";
  shut_down(false);
  module.run(100_ms);
  expect_rest(0);
}

struct Tmcm142Deviation : Tmcm142Stops {
  Tmcm142Deviation() {
    EXPECT_EQ(module.sap(encoder_constant, 335'544), Status::success);  // 5.12 microsteps
    EXPECT_EQ(module.sap(maximum_encoder_deviation, 10'000), Status::success);
    EXPECT_EQ(rotate(102'400), Status::success);
    module.run(500_ms);
    module.set("axis0.load_torque", -5.0);
    module.run(300_ms);
    module.set("axis0.load_torque", 0.0);
    module.run(300_ms);
    EXPECT_GT(std::abs(module.gap(actual_position) - module.gap(encoder_position)), 10'000);
    EXPECT_EQ(module.gap(error_flags), 2);
    EXPECT_TRUE(module.raised(ErrorFlag::deviation));
  }
};

TEST_F(Tmcm142Deviation, EndsEachCommandAndTellsSoUntilPositionAndEncoderAgree) {
  EXPECT_EQ(module.events.count("write what 41 reads to parameter 1"), 1);
  const std::int32_t position = module.gap(actual_position);
  int told = 1;
  for (const bool positioning : {true, false}) {
    clear_flags();
    EXPECT_EQ(positioning ? move_to(position + 204'800) : rotate(204'800), Status::success);
    module.run(500_ms);
    EXPECT_EQ(module.gap(actual_position), position);
    EXPECT_EQ(module.gap(actual_speed), 0);
    EXPECT_EQ(module.gap(position_reached), 0);
    EXPECT_EQ(module.gap(error_flags), 2);
    EXPECT_TRUE(module.raised(ErrorFlag::deviation)) << "told of each command";
    EXPECT_EQ(module.events.count("motor stopped at"), ++told);
  }
  clear_flags();
  EXPECT_EQ(module.execute(Command::motor_stop, 0, 0).status, Status::success);
  module.run(10_ms);
  EXPECT_FALSE(module.raised(ErrorFlag::deviation)) << "there is nothing to stop";

  // What the text says.
  EXPECT_EQ(module.sap(actual_position, module.gap(encoder_position)), Status::success);
  module.run(100_ms);
  EXPECT_EQ(module.gap(actual_speed), 0) << "that is no motion command";
  const double shaft = revolutions();
  EXPECT_EQ(move_to(module.gap(actual_position) + 204'800), Status::success);
  ASSERT_TRUE(module.run_to_target(3_s));
  module.run(300_ms);
  EXPECT_NEAR(revolutions() - shaft, 1.0, 2 * kWithinAFullStep);
  EXPECT_EQ(module.gap(error_flags), 0);
}

TEST_F(Tmcm142Deviation, EndsEverySearchAndTellsSo) {
  for (int i = 0; i < 2; ++i) {
    clear_flags();
    EXPECT_EQ(module.execute(Command::reference_search, 0, 0).status, Status::success);
    module.run(10_ms);
    EXPECT_EQ(search_state(), 0);
    EXPECT_TRUE(module.raised(ErrorFlag::position)) << i;
    EXPECT_TRUE(module.raised(ErrorFlag::deviation)) << i;
  }
}

TEST_F(Tmcm142Stops, ASearchWithoutASpeedFailsInsteadOfWaitingForEver) {
  EXPECT_EQ(module.sap(max_positioning_speed, 0), Status::success);
  EXPECT_EQ(module.execute(Command::reference_search, 0, 0).status, Status::success);
  module.run(1_ms);
  EXPECT_EQ(search_state(), 0);
  EXPECT_TRUE(module.raised(ErrorFlag::position));
  EXPECT_EQ(module.events.count("its speed is 0"), 1);
}

}  // namespace
}  // namespace stator::tests
