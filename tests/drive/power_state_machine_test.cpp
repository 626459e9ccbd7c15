// Every controlword in every state of CiA 402's power drive state machine, with ramps, brake delays
// and faults.
#include "stator/drive/power/power_state_machine.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace stator::drive {
namespace {

using base::SimDuration;
using base::SimTime;
using namespace base::literals;
using enum PowerState;

class Recorder final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }
  std::vector<std::string> sentences;
};

constexpr std::array kAllStates{
    not_ready_to_switch_on, switch_on_disabled, ready_to_switch_on,    switched_on,
    operation_enabled,      quick_stop_active,  fault_reaction_active, fault};

class PowerStates : public testing::Test {
 protected:
  /// Drives a fresh machine into `state` and leaves no edge of bit 7 behind.
  PowerStateMachine& machine_in(PowerState state) {
    machine_ = PowerStateMachine(base::EventReporter(&events_, 0), 1);
    input_ = PowerInput{.now = SimTime(),
                        .operation_permitted = true,
                        .at_rest = true,
                        .fault_present = false,
                        .options = options_,
                        .delays = {}};
    if (state == not_ready_to_switch_on) {
      return machine_;
    }
    machine_.update(input_);
    switch (state) {
      case ready_to_switch_on:
        write(0x0006);
        break;
      case switched_on:
        write(0x0006);
        write(0x0007);
        break;
      case operation_enabled:
      case quick_stop_active:
      case fault_reaction_active:
      case fault:
        write(0x0006);
        write(0x000F);
        break;
      default:
        break;
    }
    if (state == quick_stop_active || state == fault_reaction_active) {
      input_.at_rest = false;
    }
    if (state == quick_stop_active) {
      write(0x0002);
    } else if (state == fault_reaction_active || state == fault) {
      machine_.raise_fault(input_);
      machine_.update(input_);
    }
    EXPECT_EQ(machine_.state(), state) << to_text(state).view();
    events_.sentences.clear();
    return machine_;
  }

  void write(std::uint16_t controlword) { machine_.command(controlword, input_); }
  void pass(SimDuration duration) {
    input_.now += duration;
    machine_.update(input_);
  }

  Recorder events_;
  PowerStateMachine machine_{base::EventReporter(&events_, 0), 1};
  PowerOptions options_;
  PowerInput input_;
};

// What the standard's command table says for bits 7, 3, 2, 1, 0, written out as a list of its own.
enum Pattern { kShutdown, kSwitchOn, kEnable, kDisableVoltage, kQuickStop, kNothing };

Pattern pattern_of(unsigned bits) {
  const bool b7 = (bits & 0x80) != 0;
  const bool b3 = (bits & 0x08) != 0;
  const bool b2 = (bits & 0x04) != 0;
  const bool b1 = (bits & 0x02) != 0;
  const bool b0 = (bits & 0x01) != 0;
  if (b7) {
    return kNothing;
  }
  if (!b1) {
    return kDisableVoltage;
  }
  if (!b2) {
    return kQuickStop;
  }
  if (!b0) {
    return kShutdown;
  }
  return b3 ? kEnable : kSwitchOn;
}

// State after the command, motor at rest, no delays; 605Ah = 2. Rows as kAllStates.
constexpr PowerState kAfter[8][6] = {
    // Shutdown, Switch on, Enable operation, Disable voltage, Quick stop, nothing
    {not_ready_to_switch_on, not_ready_to_switch_on, not_ready_to_switch_on, not_ready_to_switch_on,
     not_ready_to_switch_on, not_ready_to_switch_on},
    {ready_to_switch_on, switch_on_disabled, switch_on_disabled, switch_on_disabled,
     switch_on_disabled, switch_on_disabled},
    {ready_to_switch_on, switched_on, operation_enabled, switch_on_disabled, switch_on_disabled,
     ready_to_switch_on},
    {ready_to_switch_on, switched_on, operation_enabled, switch_on_disabled, switch_on_disabled,
     switched_on},
    {ready_to_switch_on, switched_on, operation_enabled, switch_on_disabled, quick_stop_active,
     operation_enabled},
    {quick_stop_active, quick_stop_active, quick_stop_active, switch_on_disabled, quick_stop_active,
     quick_stop_active},
    {fault_reaction_active, fault_reaction_active, fault_reaction_active, fault_reaction_active,
     fault_reaction_active, fault_reaction_active},
    {fault, fault, fault, fault, fault, switch_on_disabled},  // bit 7 rises in the last column
};

TEST_F(PowerStates, EveryPatternInEveryStateLeadsWhereTheStandardSays) {
  for (std::size_t row = 0; row < kAllStates.size(); ++row) {
    for (unsigned low = 0; low < 16; ++low) {
      for (const unsigned bit7 : {0U, 0x80U}) {
        PowerStateMachine& machine = machine_in(kAllStates[row]);
        write(static_cast<std::uint16_t>(bit7 | low));
        EXPECT_EQ(to_text(machine.state()), to_text(kAfter[row][pattern_of(bit7 | low)]))
            << to_text(kAllStates[row]).view() << " controlword " << std::hex << (bit7 | low);
      }
    }
  }
}

TEST_F(PowerStates, OnlyCommandsThatCannotBeObeyedRaiseAnEvent) {
  struct Case {
    PowerState state;
    std::uint16_t controlword;
    const char* sentence;
  };
  const std::array cases{
      Case{switch_on_disabled, 0x000F,
           "axis 1: controlword 000Fh refused: Enable operation is not possible in Switch on "
           "disabled; the drive takes Shutdown (0006h)"},
      Case{switch_on_disabled, 0x0007,
           "axis 1: controlword 0007h refused: Switch on is not possible in Switch on disabled; "
           "the drive takes Shutdown (0006h)"},
      Case{fault, 0x0006,
           "axis 1: controlword 0006h refused: Shutdown is not possible in Fault; the drive takes "
           "Fault reset (a rising edge of bit 7)"},
      Case{quick_stop_active, 0x0007,
           "axis 1: controlword 0007h refused: Switch on is not possible in Quick stop active; the "
           "drive takes Disable voltage (0000h), after 605Ah = 5 or 6 also Enable operation "
           "(000Fh)"},
      Case{switch_on_disabled, 0x0000, nullptr},
      Case{switch_on_disabled, 0x0002, nullptr},
      Case{ready_to_switch_on, 0x0006, nullptr},
      Case{operation_enabled, 0x000F, nullptr},
      Case{operation_enabled, 0x001F, nullptr},
      Case{fault, 0x0000, nullptr},
      Case{fault, 0x0080, nullptr},
  };
  for (const Case& c : cases) {
    machine_in(c.state);
    write(c.controlword);
    if (c.sentence == nullptr) {
      EXPECT_TRUE(events_.sentences.empty()) << events_.sentences.front();
    } else {
      ASSERT_EQ(events_.sentences.size(), 1U) << c.sentence;
      EXPECT_EQ(events_.sentences.front(), c.sentence);
    }
  }
}

TEST_F(PowerStates, StatuswordCodesMatchTheirMasks) {
  struct Code {
    PowerState state;
    std::uint16_t mask;
    std::uint16_t match;
  };
  constexpr std::array kCodes{
      Code{not_ready_to_switch_on, 0x004F, 0x0000}, Code{switch_on_disabled, 0x004F, 0x0040},
      Code{ready_to_switch_on, 0x006F, 0x0021},     Code{switched_on, 0x006F, 0x0023},
      Code{operation_enabled, 0x006F, 0x0027},      Code{quick_stop_active, 0x006F, 0x0007},
      Code{fault_reaction_active, 0x004F, 0x000F},  Code{fault, 0x004F, 0x0008}};
  for (const Code& code : kCodes) {
    EXPECT_EQ(statusword_of(code.state) & code.mask, code.match) << to_text(code.state).view();
  }
}

TEST_F(PowerStates, StartsInNotReadyAndGoesToSwitchOnDisabledByItself) {
  EXPECT_EQ(machine_in(not_ready_to_switch_on).state(), not_ready_to_switch_on);
  pass(1_ms);
  EXPECT_EQ(machine_.state(), switch_on_disabled);
}

TEST_F(PowerStates, QuickStopOptions1And2EndInSwitchOnDisabledAfterTheRamp) {
  for (const int option : {1, 2}) {
    options_.quick_stop = option;
    machine_in(operation_enabled);
    input_.at_rest = false;
    write(0x0002);
    EXPECT_EQ(machine_.state(), quick_stop_active);
    EXPECT_EQ(machine_.braking(), option == 1 ? Braking::slow_down_ramp : Braking::quick_stop_ramp);
    pass(10_ms);
    EXPECT_EQ(machine_.state(), quick_stop_active) << "still on the ramp";
    EXPECT_TRUE(machine_.bridge_enabled());
    write(0x000F);
    EXPECT_EQ(machine_.state(), quick_stop_active) << "no way back with this option";
    input_.at_rest = true;
    pass(1_ms);
    EXPECT_EQ(machine_.state(), switch_on_disabled);
    EXPECT_FALSE(machine_.bridge_enabled());
  }
}

TEST_F(PowerStates, QuickStopOptions5And6StayAndMayBeResumed) {
  for (const int option : {5, 6}) {
    options_.quick_stop = option;
    machine_in(operation_enabled);
    input_.at_rest = false;
    write(0x0002);
    EXPECT_EQ(machine_.braking(), option == 5 ? Braking::slow_down_ramp : Braking::quick_stop_ramp);
    input_.at_rest = true;
    pass(1_s);
    EXPECT_EQ(machine_.state(), quick_stop_active);
    EXPECT_TRUE(machine_.bridge_enabled());
    write(0x000F);
    EXPECT_EQ(machine_.state(), operation_enabled);
    EXPECT_TRUE(machine_.drive_function_enabled());
    EXPECT_EQ(machine_.braking(), Braking::none);
  }
}

TEST_F(PowerStates, DisableOperationBrakesBeforeItLeaves) {
  machine_in(operation_enabled);
  input_.at_rest = false;
  write(0x0007);
  EXPECT_EQ(machine_.state(), operation_enabled);
  EXPECT_FALSE(machine_.drive_function_enabled());
  EXPECT_EQ(machine_.braking(), Braking::slow_down_ramp);
  write(0x0006);
  EXPECT_EQ(machine_.state(), operation_enabled) << "the command before is completed first";
  input_.at_rest = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), ready_to_switch_on) << "then the held-back Shutdown acts";
}

TEST_F(PowerStates, DisableVoltageAndQuickStopDoNotWaitForTheRampOfAnotherTransition) {
  for (const std::uint16_t leaving : std::to_array<std::uint16_t>({0x0007, 0x0006})) {
    machine_in(operation_enabled);
    input_.options.shutdown = 1;
    input_.at_rest = false;
    write(leaving);
    ASSERT_TRUE(machine_.bridge_enabled());
    write(0x0002);
    EXPECT_EQ(machine_.state(), quick_stop_active);
    EXPECT_EQ(machine_.braking(), Braking::quick_stop_ramp);

    machine_in(operation_enabled);
    input_.at_rest = false;
    write(leaving);
    write(0x0000);
    EXPECT_EQ(machine_.state(), switch_on_disabled);
    EXPECT_FALSE(machine_.bridge_enabled());
  }
}

TEST_F(PowerStates, AFaultReactionOf0LetsTheMotorCoast) {
  machine_in(operation_enabled);
  input_.at_rest = false;
  input_.options.fault_reaction = 0;
  input_.delays.brake_apply = 5_ms;
  machine_.raise_fault(input_);
  EXPECT_EQ(machine_.state(), fault_reaction_active) << "until the brake holds";
  EXPECT_FALSE(machine_.brake_released());
  pass(5_ms);
  EXPECT_EQ(machine_.state(), fault);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, ShutdownAndDisableVoltageSwitchTheBridgeOffAtOnce) {
  for (const std::uint16_t controlword : std::to_array<std::uint16_t>({0x0006, 0x0000})) {
    machine_in(operation_enabled);
    input_.at_rest = false;
    write(controlword);
    EXPECT_EQ(machine_.state(), controlword == 0 ? switch_on_disabled : ready_to_switch_on);
    EXPECT_FALSE(machine_.bridge_enabled());
    EXPECT_EQ(machine_.braking(), Braking::at_once);
  }
}

TEST_F(PowerStates, BrakeDelaysHoldTheTransitionBack) {
  machine_in(switched_on);
  input_.delays = {.hold_current = 10_ms, .brake_release = 20_ms, .brake_apply = 5_ms};
  write(0x000F);
  EXPECT_TRUE(machine_.bridge_enabled());
  EXPECT_FALSE(machine_.brake_released());
  pass(10_ms);
  EXPECT_TRUE(machine_.brake_released());
  EXPECT_EQ(machine_.state(), switched_on);
  pass(19_ms);
  EXPECT_EQ(machine_.state(), switched_on);
  pass(1_ms);
  EXPECT_EQ(machine_.state(), operation_enabled);

  write(0x0007);
  EXPECT_FALSE(machine_.brake_released());
  EXPECT_TRUE(machine_.bridge_enabled()) << "the motor holds until the brake has closed";
  pass(5_ms);
  EXPECT_EQ(machine_.state(), switched_on);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, ACommandDuringTheEnableDelayWaitsForItsEnd) {
  machine_in(switched_on);
  input_.delays.brake_release = 20_ms;
  write(0x000F);
  write(0x0006);
  EXPECT_EQ(machine_.state(), switched_on);
  EXPECT_TRUE(machine_.bridge_enabled());
  pass(20_ms);
  EXPECT_EQ(machine_.state(), ready_to_switch_on);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, AFaultLeadsFromEveryStateToFault) {
  for (const PowerState state : kAllStates) {
    machine_in(state);
    input_.at_rest = true;
    machine_.raise_fault(input_);
    pass(1_ms);
    EXPECT_EQ(machine_.state(), fault) << to_text(state).view();
    EXPECT_FALSE(machine_.bridge_enabled()) << to_text(state).view();
  }
}

TEST_F(PowerStates, BrakeDelaysHoldTheBridgeHoweverItIsDisabled) {
  for (const int command : {0x0006, 0x0000, 0x0007, 0x0002}) {
    SCOPED_TRACE(command);
    machine_in(operation_enabled);
    input_.delays.brake_apply = 5_ms;
    write(static_cast<std::uint16_t>(command));
    pass(0_ms);
    EXPECT_FALSE(machine_.brake_released());
    EXPECT_FALSE(machine_.drive_function_enabled());
    EXPECT_TRUE(machine_.bridge_enabled()) << "the motor holds until the brake has closed";
    pass(4_ms);
    EXPECT_TRUE(machine_.bridge_enabled());
    pass(1_ms);
    EXPECT_FALSE(machine_.bridge_enabled());
  }
}

TEST_F(PowerStates, AFaultWhileTheBrakeOpens_ClosesItAgainBeforeTheBridgeGoesOff) {
  machine_in(switched_on);
  input_.delays = {.hold_current = {}, .brake_release = 20_ms, .brake_apply = 5_ms};
  write(0x000F);
  ASSERT_TRUE(machine_.brake_released());
  machine_.raise_fault(input_);
  pass(1_ms);
  EXPECT_FALSE(machine_.brake_released());
  EXPECT_TRUE(machine_.bridge_enabled());
  EXPECT_EQ(machine_.state(), fault_reaction_active);
  pass(5_ms);
  EXPECT_EQ(machine_.state(), fault);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, AFaultThatTakesThePowerAppliesTheBrakeAndDoesNotWait) {
  machine_in(operation_enabled);
  input_.delays.brake_apply = 5_ms;
  machine_.raise_fault(input_, true);
  EXPECT_FALSE(machine_.brake_released());
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, AFaultWhileRunningBrakesOnTheQuickStopRamp) {
  machine_in(operation_enabled);
  input_.at_rest = false;
  machine_.raise_fault(input_);
  pass(1_ms);
  EXPECT_EQ(machine_.state(), fault_reaction_active);
  EXPECT_EQ(machine_.braking(), Braking::quick_stop_ramp);
  EXPECT_TRUE(machine_.bridge_enabled());
  input_.at_rest = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), fault);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, APowerOffFaultTakesNoRamp) {
  machine_in(operation_enabled);
  input_.at_rest = false;
  machine_.raise_fault(input_, true);
  EXPECT_EQ(machine_.state(), fault_reaction_active);
  EXPECT_FALSE(machine_.bridge_enabled());
}

TEST_F(PowerStates, FaultResetNeedsARisingEdge) {
  machine_in(operation_enabled);
  write(0x008F);
  machine_.raise_fault(input_);
  pass(1_ms);
  write(0x008F);
  EXPECT_EQ(machine_.state(), fault) << "bit 7 was 1 before";
  write(0x0000);
  write(0x0080);
  EXPECT_EQ(machine_.state(), switch_on_disabled);
  EXPECT_EQ(machine_.fault_resets(), 1U);
}

TEST_F(PowerStates, FaultResetIsRefusedWhileTheCausePersists) {
  machine_in(fault);
  input_.fault_present = true;
  write(0x0080);
  EXPECT_EQ(machine_.state(), fault);
  ASSERT_EQ(events_.sentences.size(), 1U);
  input_.fault_present = false;
  write(0x0000);
  write(0x0080);
  EXPECT_EQ(machine_.state(), switch_on_disabled);
}

TEST_F(PowerStates, EnableOperationWaitsForTheNetwork) {
  machine_in(switch_on_disabled);
  input_.operation_permitted = false;
  write(0x0006);
  write(0x0007);
  write(0x000F);
  EXPECT_EQ(machine_.state(), switched_on);
  EXPECT_FALSE(machine_.bridge_enabled());
  ASSERT_EQ(events_.sentences.size(), 1U);
  EXPECT_NE(events_.sentences.front().find("held back"), std::string::npos);
  input_.operation_permitted = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), operation_enabled);
}

TEST_F(PowerStates, LosingTheNetworkStopsTheMotorAndDisablesTheDrive) {
  machine_in(operation_enabled);
  input_.at_rest = false;
  input_.operation_permitted = false;
  machine_.network_left_operational(input_);
  EXPECT_EQ(machine_.state(), quick_stop_active);
  EXPECT_EQ(machine_.braking(), Braking::quick_stop_ramp);
  input_.at_rest = true;
  pass(1_ms);
  EXPECT_EQ(machine_.state(), switch_on_disabled);

  for (const PowerState state : {ready_to_switch_on, switched_on}) {
    machine_in(state);
    machine_.network_left_operational(input_);
    EXPECT_EQ(machine_.state(), switch_on_disabled);
  }
  machine_in(fault);
  machine_.network_left_operational(input_);
  EXPECT_EQ(machine_.state(), fault);
}

TEST_F(PowerStates, TheWorkedCodingVectorsHold) {
  struct Vector {
    PowerState before;
    std::uint16_t controlword;
    std::uint16_t mask;
    std::uint16_t after;
    int quick_stop_option;
  };
  constexpr std::array kVectors{
      Vector{switched_on, 0x0000, 0x004F, 0x0040, 2},
      Vector{switch_on_disabled, 0x0006, 0x006F, 0x0021, 2},
      Vector{ready_to_switch_on, 0x0007, 0x006F, 0x0023, 2},
      Vector{switched_on, 0x000F, 0x006F, 0x0027, 2},
      Vector{ready_to_switch_on, 0x000F, 0x006F, 0x0027, 2},
      Vector{operation_enabled, 0x0007, 0x006F, 0x0023, 2},
      Vector{operation_enabled, 0x0006, 0x006F, 0x0021, 2},
      Vector{switched_on, 0x0006, 0x006F, 0x0021, 2},
      Vector{operation_enabled, 0x0002, 0x006F, 0x0007, 2},
      Vector{quick_stop_active, 0x000F, 0x006F, 0x0027, 6},
      Vector{operation_enabled, 0x0000, 0x004F, 0x0040, 2},
      Vector{fault, 0x0080, 0x004F, 0x0040, 2},
  };
  for (const Vector& v : kVectors) {
    options_.quick_stop = v.quick_stop_option;
    machine_in(v.before);
    write(v.controlword);
    EXPECT_EQ(statusword_of(machine_.state()) & v.mask, v.after)
        << to_text(v.before).view() << " controlword " << v.controlword;
  }
}

TEST_F(PowerStates, AResetWithoutAFaultIsNothingToTell) {
  machine_in(operation_enabled);
  write(0x008F);
  EXPECT_EQ(machine_.state(), operation_enabled);
  EXPECT_TRUE(events_.sentences.empty());
}

}  // namespace
}  // namespace stator::drive
