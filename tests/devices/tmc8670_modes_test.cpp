// Every mode of operation turns the motor behind the chip.

#include <cmath>

#include "devices/tmc8670_chip.hpp"

namespace stator::devices {
namespace {

constexpr double kIncrements = 65'536.0;
constexpr double kRatedPeak = 2.45 * 1.4142135623730951;  // A

class Tmc8670Modes : public Tmc8670Chip {
 protected:
  Tmc8670Modes() { go_operational(); }
};

TEST_F(Tmc8670Modes, ProfilePositionReachesItsTarget) {
  enable(1);
  write<std::int32_t>(0x607A, 5 * 65'536);
  control(0x1F);
  bus_->pass(1_s);
  EXPECT_NEAR(signal("axis0.shaft_position"), 5.0, 0.002);
  EXPECT_NEAR(read<std::int32_t>(0x6064), 5 * kIncrements, 100.0);
  EXPECT_NE(statusword() & 0x0400, 0) << "target reached";
}

TEST_F(Tmc8670Modes, ProfileVelocityTurnsAtItsSpeed) {
  enable(3);
  write<std::int32_t>(0x60FF, 1500);
  bus_->pass(500_ms);
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, 1500.0, 15.0);
  EXPECT_NEAR(read<std::int32_t>(0x606C), 1500, 15);
  write<std::int32_t>(0x60FF, -600);
  bus_->pass(500_ms);
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, -600.0, 15.0);
}

TEST_F(Tmc8670Modes, TorqueMakesTheCurrentItAsksFor) {
  enable(4);
  set_input("axis0.jamming_torque", 1.0);
  write<std::uint32_t>(0x6087, 10'000);
  write<std::int16_t>(0x6071, 500);
  bus_->pass(300_ms);
  EXPECT_NEAR(signal("axis0.quadrature_current"), 0.5 * kRatedPeak, 0.05);
  EXPECT_NEAR(read<std::int16_t>(0x6077), 500, 15);
}

TEST_F(Tmc8670Modes, HomingOnTheIndexPulsePutsZeroThere) {
  write<std::int8_t>(0x6098, 34);
  enable(6);
  control(0x1F);
  bus_->pass(8_s);
  EXPECT_NE(statusword() & 0x1000, 0) << "homing attained";
  const double turned = signal("axis0.shaft_position");
  EXPECT_NEAR(read<std::int32_t>(0x6064), (turned - std::round(turned)) * kIncrements, 100.0);
}

TEST_F(Tmc8670Modes, CyclicPositionFollowsItsSetPoints) {
  enable(8);
  for (int k = 1; k <= 500; ++k) {
    base::store_le(bus_->outputs, 0, std::uint16_t{15});
    base::store_le(bus_->outputs, 2, std::uint8_t{8});
    base::store_le(bus_->outputs, 3, std::int32_t{500 * k});
    bus_->exchange();
    bus_->pass(1_ms - 20_us);
  }
  bus_->pass(200_ms);
  EXPECT_NEAR(signal("axis0.shaft_position") * kIncrements, 250'000.0, 100.0);
}

TEST_F(Tmc8670Modes, CyclicVelocityAndTorqueAreFollowedAtOnce) {
  enable(9);
  write<std::int32_t>(0x60FF, 800);
  bus_->pass(200_ms);
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, 800.0, 10.0);
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(200_ms);
  write<std::int8_t>(0x6060, 10);
  bus_->pass(10_ms);
  set_input("axis0.jamming_torque", 1.0);
  write<std::int16_t>(0x6071, -300);
  bus_->pass(20_ms);
  EXPECT_NEAR(signal("axis0.quadrature_current"), -0.3 * kRatedPeak, 0.05);
}

TEST_F(Tmc8670Modes, LeavingOperationalStopsAndDisablesTheDrive) {
  enable(3);
  write<std::int32_t>(0x60FF, 1500);
  bus_->pass(500_ms);
  EXPECT_EQ(signal("axis0.enable_out"), 1.0);
  EXPECT_EQ(bus_->request(AlState::safe_operational), 0x04);
  bus_->pass(500_ms);
  EXPECT_EQ(signal("axis0.enable_out"), 0.0) << "ENABLE_OUT follows the drive";
  EXPECT_NEAR(signal("axis0.shaft_speed"), 0.0, 0.1);
}

}  // namespace
}  // namespace stator::devices
