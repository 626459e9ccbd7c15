// Encoder interface: resolution, direction, initial position, N-channel latch.

#include <array>
#include <cmath>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

class Tmcm3315Encoder : public Tmcm3315Module {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration;
    configuration.axes[0].encoder.index_position = 10'000;  // a quarter of a revolution
    configuration.axes[1].encoder.counts_per_revolution = 14'400;
    configuration.axes[2].encoder.counts_per_revolution = 0;
    return configuration;
  }
  Tmcm3315Encoder() : Tmcm3315Module(configuration()) {}

  void run_at(unsigned motor, std::int32_t velocity) {
    set_profile(motor, 0, 512'000);
    enable(motor, 3);
    write<std::int32_t>(of_motor(motor, 0x60FF), velocity);
  }
};

TEST_F(Tmcm3315Encoder, AResolutionThatIsNoPowerOfTwoIsScaledWithoutDrift) {
  go_operational();
  use_encoder(1, 14'400);
  set_profile(1, 512'000, 2'560'000);
  enable(1, 1);
  start_move(1, 51'200 * 37);
  bus_->pass(5_s);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6864), 51'200 * 37, 4) << "3.6 microsteps per count";
  start_move(1, 0);
  bus_->pass(5_s);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x6864), 0, 4);
}

TEST_F(Tmcm3315Encoder, ResolutionIsThatOfTheObjectNotOfTheDisc) {
  go_operational();
  use_encoder(0, 10'000);  // lines instead of counts
  run_at(0, 51'200);
  bus_->pass(600_ms);
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x606C), 4 * 51'200, 4000);
}

TEST_F(Tmcm3315Encoder, NeedsTheSensorSelectedAndItsResolutionToGiveThePosition) {
  // Of a disc with 40000 counts, whose resolution is 1 until somebody writes another.
  struct Case {
    bool selected;
    bool resolved;
  };
  constexpr std::int32_t kQuarter = 12'800;
  for (const Case& c :
       {Case{false, false}, Case{false, true}, Case{true, false}, Case{true, true}}) {
    SCOPED_TRACE(testing::Message() << "606Ah = " << (c.selected ? 0 : -1) << ", 608Fh:01 "
                                    << (c.resolved ? "written" : "left at 1"));
    renew(configuration());
    go_operational();
    EXPECT_EQ(bus_->upload<std::int16_t>(0x606A), -1);
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x608F, 1), 1U);
    if (c.selected) {
      write<std::int16_t>(0x606A, 0);
    }
    if (c.resolved) {
      write<std::uint32_t>(0x608F, 40'000, 1);
    }
    // With next to no current the motor falls behind, and only the encoder knows.
    write<std::uint8_t>(0x2003, 0);
    write<std::uint8_t>(0x2004, 0);
    set_profile(0, 51'200, 512'000);
    enable(0, 1);
    start_move(0, kQuarter);
    bus_->pass(2_s);
    EXPECT_LT(shaft_microsteps(), kQuarter / 2.0);
    EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), kQuarter);
    const auto shown = bus_->upload<std::int32_t>(0x6064);
    EXPECT_EQ(shown, bus_->upload<std::int32_t>(0x6063));
    if (!c.selected) {
      EXPECT_EQ(shown, kQuarter) << "the motor's steps, counted";
    } else {
      EXPECT_NE(shown, kQuarter);
    }

    write<std::uint8_t>(0x2003, 128);
    start_move(0, 2 * kQuarter);
    bus_->pass(2_s);
    const double turned = shaft_microsteps();
    const auto after = bus_->upload<std::int32_t>(0x6064);
    if (c.selected && c.resolved) {
      EXPECT_NEAR(after, turned, 3.0) << "where the shaft is";
    } else if (c.selected) {
      EXPECT_GT(std::abs(after - turned), 51'200.0) << "each count taken for a revolution";
    } else {
      EXPECT_EQ(after, 2 * kQuarter);
    }
  }
}

TEST_F(Tmcm3315Encoder, TheLatchHoldsBothPositionsAtTheNullPulse) {
  go_operational();
  use_encoder(0, 40'000);
  write<std::uint8_t>(0x200F, 1, 1);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 1) << "armed";
  EXPECT_EQ(bus_->upload<std::int32_t>(0x200F, 2), 0);
  run_at(0, 20'000);
  bus_->pass(500_ms);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 1) << "not passed yet";
  bus_->pass(500_ms);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 0) << "cleared by the event";
  EXPECT_EQ(bus_->upload<std::int32_t>(0x200F, 3), 12'800) << "count 10000, exactly";
  EXPECT_NEAR(bus_->upload<std::int32_t>(0x200F, 2), 12'800, 100)
      << "the shaft swings about the set-point by less than half a full step";
  bus_->pass(5_s);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x200F, 3), 12'800) << "held until armed again";
  write<std::uint8_t>(0x200F, 1, 1);
  bus_->pass(3_s);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 0);
  const std::int32_t latched = bus_->upload<std::int32_t>(0x200F, 3);
  EXPECT_GT(latched, 51'200);
  EXPECT_EQ((latched - 12'800) % 51'200, 0) << "a later turn";
}

TEST_F(Tmcm3315Encoder, TheLatchFollowsAPositionNamedAnew) {
  go_operational();
  use_encoder(0, 40'000);
  enable(0, 6);
  write<std::int8_t>(0x6098, 35);
  control(0, 31);
  control(0, 15);
  run_at(0, -20'000);
  write<std::uint8_t>(0x200F, 1, 1);
  bus_->pass(3_s);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 0);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x200F, 3), 12'800 - 51'200) << "in negative direction";
}

TEST_F(Tmcm3315Encoder, TheLatchNeedsAnEncoder) {
  go_operational();
  write<std::uint8_t>(0x200F, 1, 1);
  run_at(0, 51'200);
  bus_->pass(4_s);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 1) << "606Ah = -1";
  write<std::int32_t>(0x60FF, 0);
  bus_->pass(1_s);
  control(0, 0);
  use_encoder(0, 40'000);
  run_at(0, 51'200);
  bus_->pass(2_s);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x200F, 1), 0);

  write<std::uint8_t>(0x240F, 1, 1);  // motor 2 has no encoder at all
  use_encoder(2, 40'000);
  run_at(2, 51'200);
  bus_->pass(3_s);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x240F, 1), 1);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x7064), 0);
}

TEST_F(Tmcm3315Encoder, TheLatchCanBeDisarmed) {
  go_operational();
  use_encoder(0, 40'000);
  write<std::uint8_t>(0x200F, 1, 1);
  bus_->pass(2_ms);
  write<std::uint8_t>(0x200F, 0, 1);
  run_at(0, 51'200);
  bus_->pass(3_s);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x200F, 3), 0);
}

}  // namespace
}  // namespace stator::devices
