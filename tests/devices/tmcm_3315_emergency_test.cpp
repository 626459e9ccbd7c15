// What the module tells by emergencies.

#include <vector>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

TEST_F(Tmcm3315Module, AFollowingErrorAndItsResetAreTold) {
  go_operational();
  write<std::int16_t>(0x706A, 0);
  write<std::uint32_t>(0x708F, 40'000, 1);
  write<std::uint32_t>(0x7065, 2000);
  set_profile(2, 51'200, 512'000);
  enable(2, 1);
  start_move(2, 200'000);
  bus_->pass(500_ms);
  EXPECT_TRUE(bus_->take_emergencies().empty());
  device_->axis(2).plant().set_external_torque(-3.0);
  bus_->pass(500_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x11, 0x86, 0x21, 0x00, 0x02, 0x00, 0x00, 0x00}}));
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1001), 0x21);
  EXPECT_EQ(statusword(2) & 0x0008, 0x0008);
  device_->axis(2).plant().set_external_torque(0.0);
  bus_->pass(2_s);
  EXPECT_EQ(statusword(2) & 0x004F, 0x0008);
  control(2, 0x80);
  EXPECT_EQ(statusword(2) & 0x004F, 0x0040);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x00, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00}}));
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1001), 0x00);
}

class Tmcm3315WithSwitches : public Tmcm3315Module {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration;
    configuration.axes[1].left_switch = plant::PositionSwitch::left_at(-1.0);
    configuration.axes[1].right_switch = plant::PositionSwitch::right_at(1.0);
    return configuration;
  }
  Tmcm3315WithSwitches() : Tmcm3315Module(configuration()) {}
};

TEST_F(Tmcm3315WithSwitches, TouchingALimitSwitchStopsAndIsTold) {
  go_operational();
  write<std::uint32_t>(0x2214, 2'000'000);
  set_profile(1, 0, 256'000);
  enable(1, 3);
  write<std::int32_t>(0x68FF, 51'200);
  bus_->pass(2_s);
  EXPECT_NEAR(shaft_microsteps(1), 51'200.0, 1500.0);
  EXPECT_EQ(statusword(1) & 0x486F, 0x0827) << "stands, limit active, still enabled";
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x68FD), 0x00000002U);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x03, 0x01, 0x00, 0x00, 0x00}}));
  write<std::int32_t>(0x68FF, -51'200);
  bus_->pass(4_s);
  EXPECT_NEAR(shaft_microsteps(1), -51'200.0, 1500.0);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x04, 0x01, 0x00, 0x00, 0x00}}));
}

TEST_F(Tmcm3315WithSwitches, ADeactivatedLimitSwitchDoesNothing) {
  go_operational();
  write<std::uint32_t>(0x2205, 3);
  set_profile(1, 0, 256'000);
  enable(1, 3);
  write<std::int32_t>(0x68FF, 51'200);
  bus_->pass(3_s);
  EXPECT_GT(shaft_microsteps(1), 100'000.0);
  EXPECT_TRUE(bus_->take_emergencies().empty());
}

TEST_F(Tmcm3315Module, LeavingTheSoftwareLimitsIsTold) {
  go_operational();
  write<std::int32_t>(0x607D, 1000, 1);  // the axis stands at 0, outside
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x02, 0x00, 0x00, 0x00, 0x00}}));
  write<std::int32_t>(0x607D, -2000, 1);
  write<std::int32_t>(0x607D, -1000, 2);
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x01, 0xFF, 0x81, 0x01, 0x00, 0x00, 0x00, 0x00}}));
}

TEST_F(Tmcm3315Module, ProcessDataThatCannotBeTakenIsToldOnceAndKeepsTheOldValue) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint8_t>(0x1C12, 0);
  write<std::uint8_t>(0x1600, 0);
  write<std::uint32_t>(0x1600, 0x60600008, 1);
  write<std::uint32_t>(0x1600, 0x607A0020, 2);
  write<std::uint8_t>(0x1600, 2);
  write<std::uint8_t>(0x1C12, 1);
  bus_->set_output_length(5);
  bus_->bring_to(AlState::operational);
  bus_->outputs[0] = std::byte{2};
  bus_->exchange();
  bus_->exchange();
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6060), 0);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x20, 0x63, 0x21, 0x00, 0xFF, 0x00, 0x00, 0x00}}));
  bus_->outputs[0] = std::byte{1};
  bus_->exchange();
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6060), 1);
  bus_->outputs[0] = std::byte{2};
  bus_->exchange();
  EXPECT_EQ(bus_->take_emergencies().size(), 1U) << "re-armed by the good value";
}

}  // namespace
}  // namespace stator::devices
