// The EtherCAT state machine of the module: which changes there are, what works in which state, and
// what becomes of running motors.

#include <array>
#include <cstddef>
#include <cstdint>

#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

constexpr std::uint16_t kErrorIndication = 0x10;
constexpr std::array kStates{AlState::init, AlState::pre_operational, AlState::bootstrap,
                             AlState::safe_operational, AlState::operational};

class Tmcm3315States : public Tmcm3315Module {
 protected:
  std::uint16_t al_status() { return base::load_le<std::uint16_t>(bus_->read(0x0130, 2)); }
  std::uint16_t al_status_code() { return base::load_le<std::uint16_t>(bus_->read(0x0134, 2)); }

  /// A fresh module in `state`; all sync managers are set as the next states need them.
  void start_in(AlState state) {
    renew();
    bus_->bring_to(state == AlState::operational ? state : AlState::safe_operational);
    if (state == AlState::bootstrap) {
      bus_->request(AlState::init);
    }
    if (state != AlState::safe_operational && state != AlState::operational) {
      bus_->request(state);
    }
    ASSERT_EQ(al_status(), static_cast<std::uint16_t>(state));
  }

  /// All three axes run at 50000 pps in profile velocity, commanded by process data.
  void run_all_axes() {
    bus_->bring_to(AlState::operational);
    for (unsigned motor = 0; motor < 3; ++motor) {
      set_profile(motor, 0, 1'000'000);
      write<std::uint32_t>(of_motor(motor, 0x6085), 200'000);
      write<std::int8_t>(of_motor(motor, 0x6060), 3);
    }
    for (const int controlword : {6, 7, 15}) {
      command_all(static_cast<std::uint16_t>(controlword), 50'000);
    }
    bus_->pass_cyclically(100_ms);
    for (unsigned motor = 0; motor < 3; ++motor) {
      ASSERT_EQ(velocity(motor), 50'000.0);
    }
  }
  void command_all(std::uint16_t controlword, std::int32_t velocity) {
    for (std::size_t motor = 0; motor < 3; ++motor) {
      base::store_le(bus_->outputs, 10 * motor, controlword);
      base::store_le(bus_->outputs, 10 * motor + 6, velocity);
    }
    bus_->exchange();
  }
  double velocity(unsigned motor) { return device_->axis(motor).axis().motion().velocity(); }
  PowerState power_state(unsigned motor) { return device_->axis(motor).axis().power_state(); }
};

bool documented(AlState from, AlState to) {
  using enum AlState;
  switch (from) {
    case init:
      return to == pre_operational || to == bootstrap;
    case pre_operational:
      return to == init || to == safe_operational;
    case bootstrap:
      return to == init;
    case safe_operational:
      return to == init || to == pre_operational || to == operational;
    case operational:
      return to != bootstrap;
  }
  return false;
}

TEST_F(Tmcm3315States, PowerOnLeavesTheModuleInInit) {
  EXPECT_EQ(al_status(), 0x0001);
  EXPECT_EQ(power_state(0), PowerState::switch_on_disabled) << "transitions 0 and 1 by themselves";
}

TEST_F(Tmcm3315States, TheTransitionsOfTheFigureExistAndNoOthers) {
  for (const AlState from : kStates) {
    for (const AlState to : kStates) {
      if (from == to) {
        continue;
      }
      start_in(from);
      const std::uint16_t answer = bus_->request(to);
      const auto change = std::string(to_text(from)) + " to " + std::string(to_text(to));
      if (documented(from, to)) {
        EXPECT_EQ(answer, static_cast<std::uint16_t>(to)) << change;
        EXPECT_EQ(al_status_code(), 0) << change;
      } else {
        EXPECT_EQ(answer, static_cast<std::uint16_t>(from) | kErrorIndication) << change;
        EXPECT_EQ(al_status_code(), 0x0011) << change << ": invalid requested state change";
      }
    }
  }
}

TEST_F(Tmcm3315States, ProcessDataRestInPreOperationalWhereSdosWork) {
  start_in(AlState::pre_operational);
  base::store_le(bus_->outputs, 0, std::uint16_t{6});
  bus_->exchange();
  bus_->pass(5_ms);
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x6040), 0) << "outputs are not taken";
  control(1, 6);
  EXPECT_EQ(statusword(1) & 0x006F, 0x0021);
  bus_->exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 10) & 0x006F, 0x0060)
      << "inputs are not refreshed";
}

TEST_F(Tmcm3315States, InputsAreValidInSafeOperationalWhereOutputsAreNotTaken) {
  start_in(AlState::safe_operational);
  base::store_le(bus_->outputs, 0, std::uint16_t{6});
  bus_->exchange();
  bus_->pass(5_ms);
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x6040), 0);
  control(1, 6);
  bus_->pass(2_ms);
  bus_->exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 10) & 0x006F, 0x0021);
  EXPECT_EQ(bus_->request(AlState::operational), 0x0008);
  bus_->exchange();
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x6040), 6) << "and now they are";
}

TEST_F(Tmcm3315States, TheMotorsStandInSafeOperationalWhateverIsCommanded) {
  start_in(AlState::safe_operational);
  set_profile(0, 0, 1'000'000);
  write<std::int32_t>(0x60FF, 50'000);
  enable(0, 3);
  bus_->pass(100_ms);
  EXPECT_EQ(statusword() & 0x424F, 0x0003) << "Switched on, not remote, standing";
  EXPECT_EQ(velocity(0), 0.0);
}

TEST_F(Tmcm3315States, EveryWayOutOfOperationalStopsEveryMotorOnTheQuickStopRamp) {
  for (const AlState to : {AlState::safe_operational, AlState::pre_operational, AlState::init}) {
    start_in(AlState::init);
    run_all_axes();
    ASSERT_EQ(bus_->request(to), static_cast<std::uint16_t>(to));
    bus_->pass(100_ms);
    for (unsigned motor = 0; motor < 3; ++motor) {
      EXPECT_NEAR(velocity(motor), 30'000.0, 500.0) << to_text(to).view() << ": 6085h = 200000";
      EXPECT_EQ(power_state(motor), PowerState::quick_stop_active);
    }
    bus_->pass(200_ms);
    for (unsigned motor = 0; motor < 3; ++motor) {
      EXPECT_EQ(velocity(motor), 0.0) << to_text(to).view();
      EXPECT_EQ(power_state(motor), PowerState::switch_on_disabled);
    }
  }
}

TEST_F(Tmcm3315States, LosingTheProcessDataAloneStopsTheMotorsToo) {
  run_all_axes();
  for (int i = 0; i < 150; ++i) {  // the mailbox is still served
    static_cast<void>(statusword());
    bus_->pass(1_ms);
  }
  EXPECT_EQ(al_status(), 0x0014);
  EXPECT_EQ(al_status_code(), 0x001B) << "sync manager watchdog";
  bus_->pass(300_ms);
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(power_state(motor), PowerState::switch_on_disabled);
  }
}

TEST_F(Tmcm3315States, AFrameEvery90MillisecondsKeepsTheMotorsRunning) {
  run_all_axes();
  for (int i = 0; i < 10; ++i) {
    bus_->pass(90_ms);
    bus_->exchange();
  }
  EXPECT_EQ(al_status(), 0x0008);
  EXPECT_EQ(velocity(2), 50'000.0);
}

TEST_F(Tmcm3315States, AMasterThatComesBackMustEnableTheDrivesAnew) {
  run_all_axes();
  bus_->pass(1_s);
  ASSERT_EQ(al_status(), 0x0014);
  bus_->write(0x0120, {std::byte{0x14}, std::byte{0}});  // error acknowledged
  bus_->exchange();
  ASSERT_EQ(bus_->request(AlState::operational), 0x0008);
  bus_->pass_cyclically(200_ms);  // still commands 15 and 50000
  EXPECT_EQ(power_state(0), PowerState::switch_on_disabled);
  EXPECT_EQ(velocity(0), 0.0);
  for (const int controlword : {6, 7, 15}) {
    command_all(static_cast<std::uint16_t>(controlword), 50'000);
  }
  bus_->pass_cyclically(100_ms);
  EXPECT_EQ(velocity(0), 50'000.0);
}

}  // namespace
}  // namespace stator::devices
