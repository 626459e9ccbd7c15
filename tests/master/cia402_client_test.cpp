// The master's moves of a CiA 402 drive, by process data and by SDO alone, with timeouts and
// faults.
#include "stator/master/cia402/cia402_client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/simulated_segment.hpp"

namespace stator::master {
namespace {

using test::SimulatedSegment;
using namespace base::literals;

TEST(DriveStateOf, EveryStatePatternIsRecognisedWhateverTheOtherBitsAre) {
  EXPECT_EQ(drive_state(0xFF90), DriveState::not_ready_to_switch_on);
  EXPECT_EQ(drive_state(0x0250), DriveState::switch_on_disabled);
  EXPECT_EQ(drive_state(0x0231), DriveState::ready_to_switch_on);
  EXPECT_EQ(drive_state(0x0233), DriveState::switched_on);
  EXPECT_EQ(drive_state(0x1637), DriveState::operation_enabled);
  EXPECT_EQ(drive_state(0x0217), DriveState::quick_stop_active);
  EXPECT_EQ(drive_state(0x021F), DriveState::fault_reaction_active);
  EXPECT_EQ(drive_state(0x0218), DriveState::fault);
  EXPECT_EQ(drive_state(0x0042), std::nullopt);
  EXPECT_EQ(to_text(DriveState::operation_enabled), "Operation enabled");
}

/// Axis 0 is in the process data, axis 1 is not; both must behave alike.
class Cia402ClientTest : public testing::TestWithParam<unsigned> {
 protected:
  void SetUp() override {
    ASSERT_TRUE(master.scan());
    ASSERT_TRUE(master.configure_process_data());
    ASSERT_TRUE(master.go_operational());
  }
  test::SimulatedDrive& drive() { return segment.slave(0).drives[GetParam()]; }

  static void expect_success(const Result<void>& result) {
    EXPECT_TRUE(result) << (result ? "" : result.error().text);
  }

  SimulatedSegment segment;
  Master master{segment};
  Cia402Client axis{master, 0, GetParam()};
};

std::string axis_name(const testing::TestParamInfo<unsigned>& parameter) {
  return parameter.param == 0 ? "MappedAxis" : "AxisBySdo";
}
INSTANTIATE_TEST_SUITE_P(Axes, Cia402ClientTest, testing::Values(0U, 1U), axis_name);

TEST_P(Cia402ClientTest, EnableWalksUpToOperationEnabledAndDisableBack) {
  EXPECT_EQ(*axis.state(), DriveState::switch_on_disabled);
  expect_success(axis.enable());
  EXPECT_EQ(*axis.state(), DriveState::operation_enabled);
  expect_success(axis.disable());
  EXPECT_EQ(*axis.state(), DriveState::switch_on_disabled);
}

TEST_P(Cia402ClientTest, SetModeWaitsForTheDisplay) {
  expect_success(axis.set_mode(OperationMode::profile_position));
  EXPECT_EQ(*axis.read<std::int8_t>(0x6061), 1);
}

TEST_P(Cia402ClientTest, AMoveEndsAtItsTarget) {
  expect_success(axis.set_mode(OperationMode::profile_position));
  expect_success(axis.enable());
  expect_success(axis.start_move({.target = -5000, .velocity = 1000}));
  EXPECT_FALSE(*axis.target_reached());
  expect_success(axis.wait_for_target(1_s));
  EXPECT_EQ(*axis.position_actual(), -5000);
  EXPECT_EQ(*axis.read<std::uint32_t>(0x6081), 1000U);
}

TEST_P(Cia402ClientTest, MovesFollowOneAnother) {
  expect_success(axis.enable());
  for (const std::int32_t target : {300, -300, 1200}) {
    expect_success(axis.start_move({.target = target}));
    expect_success(axis.wait_for_target(1_s));
    EXPECT_EQ(*axis.position_actual(), target);
  }
  expect_success(axis.start_move({.target = -200, .relative = true}));
  expect_success(axis.wait_for_target(1_s));
  EXPECT_EQ(*axis.position_actual(), 1000);
}

TEST_P(Cia402ClientTest, TheTargetHeldWhenEnablingIsThePresentPosition) {
  drive().set_position(777);
  ASSERT_TRUE(master.run_cycle());
  ASSERT_TRUE(master.run_cycle());
  expect_success(axis.enable());
  EXPECT_EQ(*axis.position_actual(), 777);
  if (GetParam() == 0) {
    EXPECT_EQ(base::load_le<std::int32_t>(master.outputs(0), 2), 777);
  }
}

TEST_P(Cia402ClientTest, ATargetNotReachedInTimeIsAnErrorWithTheStatusword) {
  expect_success(axis.enable());
  expect_success(axis.start_move({.target = 1'000'000}));
  const auto reached = axis.wait_for_target(20_ms);
  ASSERT_FALSE(reached);
  EXPECT_EQ(reached.error().code, ErrorCode::drive_timeout);
  EXPECT_THAT(reached.error().text,
              testing::AllOf(testing::HasSubstr("axis " + std::to_string(GetParam())),
                             testing::HasSubstr("target reached (bit 10)"),
                             testing::HasSubstr("0027h"), testing::HasSubstr("within 20 ms")));
}

TEST_P(Cia402ClientTest, AFaultIsReportedWithItsCodeAndCanBeReset) {
  expect_success(axis.enable());
  drive().fail(0x3220);
  const auto reached = axis.wait_for_target(1_s);
  ASSERT_FALSE(reached);
  EXPECT_EQ(reached.error().code, ErrorCode::drive_fault);
  EXPECT_EQ(reached.error().detail, 0x3220U);
  EXPECT_THAT(reached.error().text, testing::HasSubstr("3220h"));
  EXPECT_EQ(axis.enable().error().code, ErrorCode::drive_fault);

  expect_success(axis.reset_fault());
  EXPECT_EQ(*axis.state(), DriveState::switch_on_disabled);
  expect_success(axis.reset_fault());
  expect_success(axis.enable());
}

TEST_P(Cia402ClientTest, ADriveThatDoesNotReactRunsIntoTheTimeout) {
  drive().freeze();
  axis.set_response_timeout(20_ms);
  const auto enabled = axis.enable();
  ASSERT_FALSE(enabled);
  EXPECT_EQ(enabled.error().code, ErrorCode::drive_timeout);
  EXPECT_THAT(enabled.error().text, testing::HasSubstr("it is in Switch on disabled"));
  const auto mode = axis.set_mode(OperationMode::profile_velocity);
  ASSERT_FALSE(mode);
  EXPECT_THAT(mode.error().text, testing::HasSubstr("mode of operation 3, 6061h is 0"));
}

TEST_P(Cia402ClientTest, AMoveWithoutEnabledOperationIsRefused) {
  const auto moved = axis.start_move({.target = 10});
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().code, ErrorCode::argument);
  EXPECT_THAT(moved.error().text, testing::HasSubstr("Switch on disabled"));
}

TEST(Cia402Client, AxesMoveSideBySideWhileOneIsWaitedFor) {
  SimulatedSegment segment(2);
  Master master(segment);
  ASSERT_TRUE(master.scan());
  ASSERT_TRUE(master.configure_process_data());
  ASSERT_TRUE(master.go_operational());
  std::array axes{Cia402Client(master, 0, 0), Cia402Client(master, 0, 1),
                  Cia402Client(master, 1, 0)};
  for (Cia402Client& axis : axes) {
    ASSERT_TRUE(axis.enable());
  }
  for (Cia402Client& axis : axes) {
    ASSERT_TRUE(axis.start_move({.target = 20'000}));
  }
  ASSERT_TRUE(axes[2].wait_for_target(1_s));
  EXPECT_EQ(*axes[0].position_actual(), 20'000);
  EXPECT_EQ(*axes[1].position_actual(), 20'000);
}

TEST(Cia402Client, WorksBySdoAloneInPreOperational) {
  SimulatedSegment segment;
  Master master(segment);
  ASSERT_TRUE(master.scan());
  ASSERT_TRUE(master.start_mailbox(0));
  Cia402Client axis(master, 0);
  const auto enabled = axis.enable();
  ASSERT_TRUE(enabled) << enabled.error().text;
  EXPECT_EQ(*axis.state(), DriveState::operation_enabled);
}

}  // namespace
}  // namespace stator::master
