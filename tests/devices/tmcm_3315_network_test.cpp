// Network states, inputs and outputs, refusals.

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

TEST_F(Tmcm3315Module, OperationIsEnabledOnlyInOperational) {
  bus_->bring_to(AlState::pre_operational);
  bus_->pass(1_ms);
  enable(0, 1);
  EXPECT_EQ(statusword() & 0x006F, 0x0023) << "held in Switched on";
  bus_->write(0x0420, {std::byte{0}, std::byte{0}});
  bus_->bring_to(AlState::safe_operational);
  EXPECT_EQ(statusword() & 0x026F, 0x0023);
  bus_->request(AlState::operational);
  bus_->pass(2_ms);
  EXPECT_EQ(statusword() & 0x026F, 0x0227) << "goes on, and is remote controlled";
}

TEST_F(Tmcm3315Module, LosingTheMasterStopsEveryMotorAndDisablesTheDrives) {
  bus_->bring_to(AlState::operational);
  for (unsigned motor = 0; motor < 3; ++motor) {
    write<std::uint32_t>(of_motor(motor, 0x6083), 200'000);
    write<std::uint32_t>(of_motor(motor, 0x6084), 200'000);
    write<std::int8_t>(of_motor(motor, 0x6060), 3);
  }
  for (const int controlword : {6, 7, 15}) {
    for (std::size_t motor = 0; motor < 3; ++motor) {
      base::store_le(bus_->outputs, 10 * motor, static_cast<std::uint16_t>(controlword));
      base::store_le(bus_->outputs, 10 * motor + 6, std::int32_t{50'000});
    }
    bus_->exchange();
  }
  bus_->pass_cyclically(1_s);
  EXPECT_NEAR(signal("axis2.velocity_demand"), 50'000.0, 1e-6);
  bus_->pass(150_ms);  // no frames: the watchdog of 100 ms expires
  EXPECT_EQ(device_->stack().state(), AlState::safe_operational);
  EXPECT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::sync_manager_watchdog);
  EXPECT_LT(signal("axis0.velocity_demand"), 50'000.0) << "on the ramp of 6085h";
  EXPECT_GT(signal("axis0.velocity_demand"), 0.0);
  bus_->pass(1_s);
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(device_->axis(motor).axis().power_state(), PowerState::switch_on_disabled);
    EXPECT_EQ(device_->axis(motor).axis().motion().velocity(), 0.0);
  }
}

TEST_F(Tmcm3315Module, SetPointsOfBeforeTheWatchdogMoveNothingInTheNextOperational) {
  bus_->bring_to(AlState::pre_operational);
  write<std::int8_t>(0x6060, 3);
  set_profile(0, 50'000, 500'000);
  bus_->bring_to(AlState::operational);
  base::store_le(bus_->outputs, 6, std::int32_t{50'000});
  for (const int controlword : {6, 7, 15}) {
    base::store_le(bus_->outputs, 0, static_cast<std::uint16_t>(controlword));
    bus_->pass_cyclically(10_ms);
  }
  bus_->pass_cyclically(300_ms);
  ASSERT_NEAR(signal("axis0.velocity_demand"), 50'000.0, 5.0);
  bus_->pass(2_s);
  ASSERT_EQ(device_->stack().status_code(), ethercat::AlStatusCode::sync_manager_watchdog);
  ASSERT_EQ(signal("axis0.velocity_demand"), 0.0);

  write<std::uint16_t>(0x6040, 6);
  write<std::uint16_t>(0x6040, 7);
  bus_->write(0x0120, {std::byte{0x18}, std::byte{0}});
  ASSERT_EQ(device_->stack().state(), AlState::operational);
  for (int k = 0; k < 90; ++k) {
    bus_->pass(1_ms);
    ASSERT_EQ(signal("axis0.velocity_demand"), 0.0) << k << " ms";
  }
  EXPECT_NE(statusword(0) & 0x006F, 0x0027) << "Operation enabled";
}

TEST_F(Tmcm3315Module, SomeObjectsAreWritableInSwitchOnDisabledOnlyAxisByAxis) {
  go_operational();
  enable(0, 1);
  const std::array<std::uint16_t, 2> bytes_of_axis0{0x200B, 0x200C};
  EXPECT_EQ(bus_->download<std::uint32_t>(0x2005, 0, 3), kDeviceStateAbort);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x208C, 0, 0), kDeviceStateAbort);
  for (const std::uint16_t index : bytes_of_axis0) {
    EXPECT_EQ(bus_->download<std::uint8_t>(index, 1, 1), kDeviceStateAbort);
  }
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x2005), 0U) << "always readable";
  EXPECT_EQ(bus_->download<std::uint32_t>(0x2205, 0, 3), 0U) << "axis 1 is not enabled";
  control(0, 0);
  EXPECT_EQ(bus_->download<std::uint32_t>(0x2005, 0, 3), 0U);
}

TEST_F(Tmcm3315Module, AResetOfTheControllerRestartsTheFirmware) {
  go_operational();
  set_profile(0, 51'200, 51'200);
  enable(0, 1);
  for (const char key : {'R', 'E', 'S'}) {
    bus_->write(0x0040, {static_cast<std::byte>(key)});
  }
  EXPECT_EQ(device_->stack().state(), AlState::init);
  EXPECT_EQ(device_->dictionary().find(0x6081, 0)->value(), 0U) << "settings are volatile";
  EXPECT_EQ(device_->dictionary().find(0x1018, 2)->value(), 3315U);
  bus_->pass(1_ms);
  EXPECT_EQ(device_->axis(0).axis().power_state(), PowerState::switch_on_disabled);
}

TEST_F(Tmcm3315Module, InputsAreShownInTheirBits) {
  go_operational();
  device_->set_digital_input(0, true);
  device_->set_digital_input(3, true);
  device_->set_analog_input(2, 20'000);
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x2702), 0x00090000U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x60FD), 0x00090000U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x270E, 3), 20'000U);
  write<std::uint32_t>(0x2205, 0x2C);  // axis 1: all three inverted
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x68FD), 0x00090007U);
}

TEST_F(Tmcm3315Module, OutputsNeedTheirMaskAndOperational) {
  go_operational();
  write<std::uint32_t>(0x2703, 0x000F0000, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), 0U) << "mask 0 blocks all";
  write<std::uint32_t>(0x2703, 0x00050000, 2);
  bus_->pass(2_ms);
  EXPECT_EQ(device_->digital_outputs(), 0x00050000U);
  bus_->request(AlState::safe_operational);
  EXPECT_EQ(device_->digital_outputs(), 0U);
}

TEST_F(Tmcm3315Module, TheReservedPositioningOptionIsRefused) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x60F2, 0, 3), 0x06090030U);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x60F2, 0, 2), 0U);
}

TEST_F(Tmcm3315Module, EverySignalHasANameOfItsOwn) {
  std::vector<std::string> names;
  for (const product::Signal& signal : device_->signals()) {
    names.push_back(signal.name);
  }
  EXPECT_GE(names.size(), 51U);
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

}  // namespace
}  // namespace stator::devices
