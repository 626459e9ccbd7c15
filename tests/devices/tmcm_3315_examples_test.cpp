// Worked examples of the document.

#include <algorithm>
#include <array>

#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

TEST_F(Tmcm3315Module, ProfilePositionExampleRunsAsWritten) {
  go_operational();
  set_profile(0, 51'200, 51'200);
  write<std::uint32_t>(0x2005, 3);
  write<std::int8_t>(0x6060, 1);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 1);
  control(0, 6);
  EXPECT_EQ(statusword() & 0x006F, 0x0021);
  control(0, 7);
  EXPECT_EQ(statusword() & 0x006F, 0x0023);
  control(0, 15);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::int32_t>(0x607A, 500'000);
  bus_->pass(10_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 0) << "no motion yet";
  control(0, 31);
  const base::SimTime start = bus_->now();
  bus_->pass(5_ms);
  EXPECT_EQ(statusword() & 0x5000, 0x5000) << "set-point in process, motor rotates";
  control(0, 15);
  EXPECT_EQ(statusword() & 0x5000, 0x4000);
  // 51200 pps with 51200 pps/s: 10.765625 s.
  bus_->pass(base::SimDuration(10'764'000'000) - (bus_->now() - start));
  EXPECT_EQ(statusword() & 0x0400, 0) << "not there yet";
  bus_->pass(3_ms);
  EXPECT_EQ(statusword() & 0x0400, 0x0400);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6064), 500'000);
}

TEST_F(Tmcm3315Module, ProfileVelocityExampleRunsAsWritten) {
  go_operational();
  set_profile(0, 0, 51'200);
  write<std::uint32_t>(0x2005, 3);
  enable(0, 3);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::int32_t>(0x60FF, 100'000);
  bus_->pass(1_s);
  EXPECT_EQ(statusword() & 0x4400, 0x4000);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x606C), 51'200, 100);
  bus_->pass(954_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x606C), 100'000) << "after 1.953125 s";
  EXPECT_EQ(statusword() & 0x0400, 0x0400);
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(2_s);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x606C), 0);
  EXPECT_EQ(statusword() & 0x4000, 0);
}

TEST_F(Tmcm3315Module, HomingExampleRunsAsWritten) {
  go_operational();
  write<std::uint32_t>(0x609A, 500'000);  // the example leaves it 0: no motion
  write<std::int8_t>(0x6060, 6);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 6);
  control(0, 6);
  EXPECT_EQ(statusword() & 0x006F, 0x0021);
  control(0, 7);
  EXPECT_EQ(statusword() & 0x006F, 0x0023);
  control(0, 15);
  EXPECT_EQ(statusword() & 0x006F, 0x0027);
  write<std::int8_t>(0x6098, 19);
  write<std::uint32_t>(0x6099, 50'000, 1);
  write<std::uint32_t>(0x6099, 10'000, 2);
  control(0, 31);
  bus_->pass(500_ms);
  EXPECT_EQ(statusword() & 0x5400, 0x4000) << "searching";
  EXPECT_EQ(signal("axis0.velocity_demand"), 50'000.0);
  set_input("axis0.home_switch", 1.0);
  bus_->pass(500_ms);
  EXPECT_EQ(signal("axis0.velocity_demand"), -10'000.0) << "leaving the switch";
  const double released = shaft_microsteps();
  set_input("axis0.home_switch", 0.0);
  bus_->pass(100_ms);
  EXPECT_EQ(statusword() & 0x5400, 0x1400) << "on home";
  EXPECT_NEAR(shaft_microsteps(), released, 12.0);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6064), 0);
  control(0, 15);
  EXPECT_EQ(statusword() & 0x146F, 0x1427);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 6) << "the mode stays";
}

TEST_F(Tmcm3315Module, IdentityReadsAsTheDocumentPrintsIt) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1000), 0xFFFC0192U);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1001), 0U);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1018, 0), 3U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 1), 0x286U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 2), 3315U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 3), 0x00010009U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1A00, 2), 0x60640020U);
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x1C12, 1), 0x1600U);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x6085), 51'200U);
  EXPECT_EQ(bus_->upload<std::int16_t>(0x606A), -1);
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x6502), 0x3A5U);
}

TEST_F(Tmcm3315Module, DefaultProcessImageLiesAsTheExampleShows) {
  bus_->bring_to(AlState::operational);
  const std::array<unsigned, 30> image{0x0F, 0x00, 0x20, 0xA1, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00,
                                       0x06, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
                                       0x0F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x60, 0x79, 0xFE, 0xFF};
  std::ranges::transform(image, bus_->outputs.begin(),
                         [](unsigned byte) { return static_cast<std::byte>(byte); });
  bus_->exchange();
  EXPECT_EQ(device_->dictionary().find(0x6040, 0)->value(), 15U);
  EXPECT_EQ(device_->dictionary().find(0x607A, 0)->signed_value(), 500'000);
  EXPECT_EQ(device_->dictionary().find(0x6840, 0)->value(), 6U);
  EXPECT_EQ(device_->dictionary().find(0x7040, 0)->value(), 15U);
  EXPECT_EQ(device_->dictionary().find(0x70FF, 0)->signed_value(), -100'000);
  EXPECT_EQ(device_->axis(1).axis().power_state(), PowerState::ready_to_switch_on);
  bus_->exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus_->inputs, 10) & 0x006F, 0x0021)
      << "the answer is in the next inputs";
}

}  // namespace
}  // namespace stator::devices
