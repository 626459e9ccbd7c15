// The power state machine against the printed tables: every controlword in every state, and what
// happens while a transition takes its time.

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/drive/power/power_state_machine.hpp"

namespace stator::drive {
namespace {

using base::SimDuration;
using namespace base::literals;
using enum PowerState;

constexpr std::array kAllStates{
    not_ready_to_switch_on, switch_on_disabled, ready_to_switch_on,    switched_on,
    operation_enabled,      quick_stop_active,  fault_reaction_active, fault};

class PowerStateTable : public testing::Test {
 protected:
  /// Drives a fresh machine into `state`, at rest; the last controlword has bit 7 = 0.
  void start_in(PowerState state) {
    machine_ = PowerStateMachine({}, 0);
    input_.at_rest = true;
    input_.delays = {};
    if (state == not_ready_to_switch_on) {
      return;
    }
    machine_.update(input_);
    if (state != switch_on_disabled) {
      machine_.command(0x0006, input_);
    }
    if (state == switched_on) {
      machine_.command(0x0007, input_);
    } else if (state != switch_on_disabled && state != ready_to_switch_on) {
      machine_.command(0x000F, input_);
    }
    if (state == quick_stop_active) {
      machine_.command(0x0002, input_);
    } else if (state == fault || state == fault_reaction_active) {
      input_.at_rest = state == fault;
      machine_.raise_fault(input_);
      machine_.update(input_);
    }
    ASSERT_EQ(machine_.state(), state);
  }
  void pass(SimDuration duration) {
    input_.now += duration;
    machine_.update(input_);
  }

  PowerStateMachine machine_{{}, 0};
  PowerInput input_{.now = {}, .operation_permitted = true, .options = {}, .delays = {}};
};

struct CommandRow {
  const char* name;
  std::uint16_t mask;
  std::uint16_t match;
};

// Bits 7, 3, 2, 1, 0 as printed in each of the six mode chapters.
constexpr CommandRow kShutdown{"Shutdown", 0x0087, 0x0006};
constexpr CommandRow kSwitchOn{"Switch on, Disable operation", 0x008F, 0x0007};
constexpr CommandRow kEnableOperation{"Enable operation", 0x008F, 0x000F};
constexpr CommandRow kDisableVoltage{"Disable voltage", 0x0082, 0x0000};
constexpr CommandRow kQuickStop{"Quick stop", 0x0086, 0x0002};
constexpr CommandRow kFaultReset{"Fault reset", 0x0080, 0x0080};

struct TransitionRow {
  int number;
  PowerState from;
  PowerState to;
  const CommandRow* command;
};

// 605Ah = 6: Quick stop active stays and can be left to Operation enabled (transition 16).
// "3 and 4" is one row.
constexpr std::array<TransitionRow, 16> kTransitions{{
    {2, switch_on_disabled, ready_to_switch_on, &kShutdown},
    {3, ready_to_switch_on, switched_on, &kSwitchOn},
    {4, ready_to_switch_on, operation_enabled, &kEnableOperation},
    {4, switched_on, operation_enabled, &kEnableOperation},
    {5, operation_enabled, switched_on, &kSwitchOn},
    {6, switched_on, ready_to_switch_on, &kShutdown},
    {7, ready_to_switch_on, switch_on_disabled, &kDisableVoltage},
    {7, ready_to_switch_on, switch_on_disabled, &kQuickStop},
    {8, operation_enabled, ready_to_switch_on, &kShutdown},
    {9, operation_enabled, switch_on_disabled, &kDisableVoltage},
    {10, switched_on, switch_on_disabled, &kDisableVoltage},
    {10, switched_on, switch_on_disabled, &kQuickStop},
    {11, operation_enabled, quick_stop_active, &kQuickStop},
    {12, quick_stop_active, switch_on_disabled, &kDisableVoltage},
    {15, fault, switch_on_disabled, &kFaultReset},
    {16, quick_stop_active, operation_enabled, &kEnableOperation},
}};

PowerState after(PowerState from, std::uint16_t controlword) {
  for (const TransitionRow& row : kTransitions) {
    if (row.from == from && (controlword & row.command->mask) == row.command->match) {
      return row.to;
    }
  }
  return from;
}

TEST_F(PowerStateTable, EveryControlwordInEveryStateObeysTheTables) {
  input_.options.quick_stop = 6;
  for (const PowerState state : kAllStates) {
    int wrong = 0;
    for (unsigned word = 0; word <= 0xFFFF; ++word) {
      start_in(state);
      const auto controlword = static_cast<std::uint16_t>(word);
      machine_.command(controlword, input_);
      wrong += machine_.state() == after(state, controlword) ? 0 : 1;
    }
    EXPECT_EQ(wrong, 0) << "controlwords that lead elsewhere from " << to_text(state).view();
  }
}

TEST_F(PowerStateTable, StateBitsOfTheStatuswordAreThoseOfTheStateAlone) {
  for (const PowerState state : kAllStates) {
    EXPECT_EQ(statusword_of(state) & ~0x006F, 0) << to_text(state).view();
    EXPECT_EQ((statusword_of(state) & 0x0020) == 0, state == quick_stop_active)
        << to_text(state).view() << ": bit 5 is 0 while a quick stop is active, and then only";
  }
}

TEST_F(PowerStateTable, ACommandDuringADelayWaitsAndTheLastOneCounts) {
  start_in(switched_on);
  input_.delays = {.hold_current = 10_ms, .brake_release = 20_ms, .brake_apply = 0_ms};
  machine_.command(0x000F, input_);
  for (const std::uint16_t controlword : std::to_array<std::uint16_t>({0, 6, 2, 7})) {
    pass(5_ms);
    machine_.command(controlword, input_);
    EXPECT_EQ(machine_.state(), switched_on);
    EXPECT_TRUE(machine_.bridge_enabled()) << "the transition under way is completed";
    EXPECT_FALSE(machine_.drive_function_enabled());
  }
  pass(9_ms);
  EXPECT_TRUE(machine_.bridge_enabled());
  pass(1_ms);
  EXPECT_EQ(machine_.state(), switched_on) << "enabled, and disabled by the 7 that waited";
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStateTable, AFaultDuringADelayInterruptsIt) {
  for (const SimDuration when : {5_ms, 15_ms}) {  // building up current, releasing the brake
    start_in(switched_on);
    input_.delays = {.hold_current = 10_ms, .brake_release = 20_ms, .brake_apply = 0_ms};
    machine_.command(0x000F, input_);
    pass(when);
    machine_.raise_fault(input_);
    pass(1_ms);
    EXPECT_EQ(machine_.state(), fault);
    EXPECT_FALSE(machine_.bridge_enabled());
    EXPECT_FALSE(machine_.brake_released());
    pass(1_s);
    EXPECT_EQ(machine_.state(), fault) << "the delay does not go on";
    EXPECT_FALSE(machine_.bridge_enabled());
  }
}

TEST_F(PowerStateTable, AFaultDuringDisableOperationTakesTheQuickStopRamp) {
  start_in(operation_enabled);
  input_.at_rest = false;
  machine_.command(0x0007, input_);
  ASSERT_EQ(machine_.braking(), Braking::slow_down_ramp);
  machine_.raise_fault(input_);
  EXPECT_EQ(machine_.state(), fault_reaction_active);
  EXPECT_EQ(machine_.braking(), Braking::quick_stop_ramp);
  EXPECT_TRUE(machine_.bridge_enabled());
  input_.at_rest = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), fault);
}

TEST_F(PowerStateTable, AFaultDuringAQuickStopGoesOnBrakingIntoFault) {
  for (const int option : {1, 2, 5, 6}) {
    input_.options.quick_stop = option;
    start_in(operation_enabled);
    input_.at_rest = false;
    machine_.command(0x0002, input_);
    machine_.raise_fault(input_);
    EXPECT_EQ(machine_.state(), fault_reaction_active) << option;
    EXPECT_EQ(machine_.braking(), Braking::quick_stop_ramp) << option;
    EXPECT_TRUE(machine_.bridge_enabled()) << option;
    input_.at_rest = true;
    pass(1_ms);
    EXPECT_EQ(machine_.state(), fault) << option;
  }
}

TEST_F(PowerStateTable, CommandsWaitUntilTheFaultReactionIsOver) {
  start_in(fault_reaction_active);
  machine_.command(0x0080, input_);
  EXPECT_EQ(machine_.state(), fault_reaction_active);
  input_.at_rest = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), fault) << "the edge came too early";
  machine_.command(0x0000, input_);
  machine_.command(0x0080, input_);
  EXPECT_EQ(machine_.state(), switch_on_disabled);
}

TEST_F(PowerStateTable, AQuickStopWithOption5Or6CanBeTakenBackOnTheRamp) {
  for (const int option : {5, 6}) {
    input_.options.quick_stop = option;
    start_in(operation_enabled);
    input_.at_rest = false;
    machine_.command(0x0002, input_);
    pass(1_ms);
    machine_.command(0x000F, input_);
    EXPECT_TRUE(machine_.drive_function_enabled());
    EXPECT_EQ(machine_.braking(), Braking::none);
  }
}

TEST_F(PowerStateTable, LosingTheNetworkDuringADelayEndsInSwitchOnDisabled) {
  start_in(switched_on);
  input_.delays = {.hold_current = 10_ms, .brake_release = 20_ms, .brake_apply = 0_ms};
  machine_.command(0x000F, input_);
  pass(15_ms);
  machine_.network_left_operational(input_);
  pass(1_s);
  EXPECT_EQ(machine_.state(), switch_on_disabled);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStateTable, LosingTheNetworkOverridesWhatAQuickStopWouldLeave) {
  input_.options.quick_stop = 5;
  start_in(operation_enabled);
  input_.at_rest = false;
  machine_.command(0x0002, input_);
  ASSERT_EQ(machine_.braking(), Braking::slow_down_ramp);
  machine_.network_left_operational(input_);
  EXPECT_EQ(machine_.state(), quick_stop_active) << "the motor is not dropped while it turns";
  EXPECT_EQ(machine_.braking(), Braking::quick_stop_ramp);
  EXPECT_TRUE(machine_.bridge_enabled());
  input_.at_rest = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), switch_on_disabled);
  EXPECT_FALSE(machine_.bridge_enabled());
}

}  // namespace
}  // namespace stator::drive
