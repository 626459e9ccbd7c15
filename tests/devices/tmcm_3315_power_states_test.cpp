// The power state machine of each axis as a master commands and sees it: every command pattern in
// every state and mode, stop and option codes, statusword and controlword bits.

#include <array>
#include <cstdint>
#include <vector>

#include "devices/tmcm_3315_damped_axis.hpp"
#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

constexpr std::array<std::int8_t, 6> kModes{1, 3, 6, 8, 9, 10};

enum class State : std::uint8_t { disabled, ready, switched_on, enabled, quick_stop, fault };
constexpr std::array kStates{State::disabled, State::ready,      State::switched_on,
                             State::enabled,  State::quick_stop, State::fault};
// Mask and value of the statusword by State, and its name.
struct StateCode {
  std::uint16_t mask;
  std::uint16_t value;
  const char* name;
};
constexpr std::array<StateCode, 6> kCodes{{{0x004F, 0x0040, "Switch on disabled"},
                                           {0x006F, 0x0021, "Ready to switch on"},
                                           {0x006F, 0x0023, "Switched on"},
                                           {0x006F, 0x0027, "Operation enabled"},
                                           {0x006F, 0x0007, "Quick stop active"},
                                           {0x004F, 0x0008, "Fault"}}};
constexpr const StateCode& code_of(State state) {
  return kCodes[static_cast<std::size_t>(state)];
}

/// Where the document's command table leads with 605Ah = 6; bit 7 rises where it is set.
State after(State from, unsigned controlword) {
  using enum State;
  const bool reset = (controlword & 0x80U) != 0;
  if (from == fault) {
    return reset ? disabled : fault;
  }
  if (reset) {
    return from;
  }
  if ((controlword & 0x02U) == 0) {
    return disabled;
  }
  if ((controlword & 0x04U) == 0) {
    return from == enabled || from == quick_stop ? quick_stop : disabled;
  }
  if ((controlword & 0x01U) == 0) {
    return from == quick_stop ? quick_stop : ready;
  }
  if (from == disabled) {
    return disabled;
  }
  if ((controlword & 0x08U) != 0) {
    return enabled;
  }
  return from == quick_stop ? quick_stop : switched_on;
}

class Tmcm3315PowerStates : public Tmcm3315Module {
 protected:
  Tmcm3315PowerStates() : Tmcm3315Module(damped_axis()) {
    go_operational();
    use_encoder();
    write<std::int16_t>(0x605A, 6);
    write<std::uint32_t>(0x6085, 10'000'000);
  }
  /// Brings axis 0 from anywhere into `state`, standing.
  void reach(State state) {
    control(0, 0x0000);
    control(0, 0x0080);
    control(0, 0x0000);
    bus_->pass(1_ms);
    if (state == State::disabled) {
      return;
    }
    write(0x607A, bus_->upload<std::int32_t>(0x6064));  // no journey in csp
    control(0, 0x0006);
    if (state != State::ready) {
      control(0, 0x0007);
    }
    if (state != State::ready && state != State::switched_on) {
      control(0, 0x000F);
    }
    if (state == State::quick_stop) {
      control(0, 0x0002);
    }
    if (state == State::fault) {
      bus_->pass(5_ms);
      write<std::uint32_t>(0x6065, 5);
      device_->axis(0).plant().set_external_torque(-0.2);
      bus_->pass(5_ms);
      device_->axis(0).plant().set_external_torque(0.0);
      write<std::uint32_t>(0x6065, 0);
    }
    bus_->pass(1_ms);
    ASSERT_EQ(statusword() & code_of(state).mask, code_of(state).value) << code_of(state).name;
  }
};

TEST_F(Tmcm3315PowerStates, EveryPatternInEveryStateAndModeLeadsWhereTheTableSays) {
  for (const std::int8_t mode : kModes) {
    reach(State::disabled);
    write<std::int8_t>(0x6060, mode);
    for (const State state : kStates) {
      for (unsigned pattern = 0; pattern < 32; ++pattern) {
        // Bits 3..0 and 7; then with every bit set that means nothing to the state machine.
        const unsigned command = (pattern & 0xFU) | (pattern & 0x10U) << 3U;
        for (const unsigned others : {0U, 0xFF70U}) {
          if (others != 0 && mode == 6) {
            continue;  // bit 4 starts a homing run
          }
          reach(state);
          const unsigned controlword = command | others;
          control(0, static_cast<std::uint16_t>(controlword));
          bus_->pass(2_ms);
          const StateCode& wanted = code_of(after(state, controlword));
          ASSERT_EQ(statusword() & wanted.mask, wanted.value)
              << "mode " << int{mode} << ", " << code_of(state).name << ", controlword " << std::hex
              << controlword << ": " << wanted.name << " expected";
        }
      }
    }
  }
}

TEST_F(Tmcm3315PowerStates, QuickStopOptions1And2EndInSwitchOnDisabledInEveryMode) {
  for (const std::int8_t mode : kModes) {
    for (const std::int16_t option : std::to_array<std::int16_t>({1, 2})) {
      reach(State::disabled);
      write<std::int8_t>(0x6060, mode);
      write<std::int16_t>(0x605A, option);
      reach(State::enabled);
      control(0, 0x0002);
      bus_->pass(2_ms);
      EXPECT_EQ(statusword() & 0x004F, 0x0040) << "mode " << int{mode} << " option " << option;
    }
  }
}

TEST_F(Tmcm3315PowerStates, ControlwordBitsWithoutMeaningAreReadBackAsWritten) {
  reach(State::enabled);
  for (const std::uint16_t controlword : std::to_array<std::uint16_t>({0xFC0F, 0xFE2F, 0x000F})) {
    control(0, controlword);
    EXPECT_EQ(bus_->upload<std::uint16_t>(0x6040), controlword);
    EXPECT_EQ(statusword() & 0x006F, 0x0027);
  }
}

TEST_F(Tmcm3315PowerStates, AxesHaveStateMachinesAndModesOfTheirOwn) {
  reach(State::enabled);
  write<std::int8_t>(0x6860, 8);
  control(1, 6);
  write<std::int8_t>(0x7060, 3);
  EXPECT_EQ(statusword(0) & 0x006F, 0x0027);
  EXPECT_EQ(statusword(1) & 0x006F, 0x0021);
  EXPECT_EQ(statusword(2) & 0x004F, 0x0040);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 0);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6861), 8);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x7061), 3);
}

TEST_F(Tmcm3315PowerStates, NoCurrentFlowsUnlessTheDriveFunctionIsEnabled) {
  for (const State state : kStates) {
    reach(state);
    bus_->pass(20_ms);
    const bool current = std::abs(signal("axis0.coil_current_a")) > 0.05 ||
                         std::abs(signal("axis0.coil_current_b")) > 0.05;
    EXPECT_EQ(current, state == State::enabled || state == State::quick_stop)
        << code_of(state).name;
  }
}

TEST_F(Tmcm3315PowerStates, AFaultWhileRunningPassesThroughFaultReactionActive) {
  reach(State::disabled);
  set_profile(0, 0, 1'000'000);
  write<std::uint32_t>(0x6085, 500'000);
  write<std::int8_t>(0x6060, 3);
  reach(State::enabled);
  write<std::int32_t>(0x60FF, 50'000);
  bus_->pass(200_ms);
  write<std::uint32_t>(0x6065, 1);
  bus_->pass(5_ms);
  device_->axis(0).plant().set_external_torque(-0.2);
  bus_->pass(10_ms);
  device_->axis(0).plant().set_external_torque(0.0);
  EXPECT_EQ(statusword() & 0x404F, 0x400F) << "Fault reaction active, still turning";
  control(0, 0x0080);
  EXPECT_EQ(statusword() & 0x004F, 0x000F) << "no reset yet";
  bus_->pass(150_ms);
  EXPECT_EQ(statusword() & 0x404F, 0x0008);
  write<std::uint32_t>(0x6065, 0);
  bus_->pass(2_ms);
  control(0, 0x0080);
  EXPECT_EQ(statusword() & 0x004F, 0x0008) << "the level of bit 7 resets nothing";
  control(0, 0x0000);
  control(0, 0x0080);
  EXPECT_EQ(statusword() & 0x004F, 0x0040);
}

}  // namespace
}  // namespace stator::devices
