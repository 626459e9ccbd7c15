// The objects of the ramp generator, as a master writes them.

#include <algorithm>
#include <array>
#include <cmath>

#include "devices/tmcm_3315_module.hpp"
#include "stator/control/ramp/ramp_generator.hpp"

namespace stator::devices {
namespace {

class Tmcm3315Ramp : public Tmcm3315Module {
 protected:
  Tmcm3315Ramp() { go_operational(); }

  const control::RampGenerator& ramp(unsigned motor = 0) {
    return device_->axis(motor).axis().motion().ramp();
  }
  /// Largest magnitudes of acceleration while the speed was below and above 2012h.
  struct Rates {
    double gained_below = 0.0;
    double gained_above = 0.0;
    double lost_above = 0.0;
    double lost_below = 0.0;
    double last_speed = 0.0;
  };
  Rates watch_move(double break_velocity) {
    Rates rates;
    for (int i = 0; i < 200'000 && !ramp().at_rest(); ++i) {
      const double speed = std::fabs(ramp().velocity());
      const double rate = std::fabs(ramp().acceleration());
      const bool below = speed < break_velocity * (1.0 - 1e-9);
      double* largest = nullptr;
      if (ramp().phase() == control::RampPhase::accelerating) {
        largest = below ? &rates.gained_below : &rates.gained_above;
      } else if (ramp().phase() == control::RampPhase::decelerating) {
        largest = below ? &rates.lost_below : &rates.lost_above;
      }
      if (largest != nullptr && std::fabs(speed - break_velocity) > 1.0) {
        *largest = std::max(*largest, rate);
      }
      rates.last_speed = speed;
      bus_->pass(50_us);
    }
    return rates;
  }
};

TEST_F(Tmcm3315Ramp, SixPointObjectsShapeAPositioningMove) {
  write<std::uint32_t>(0x6081, 40'000);
  write<std::uint32_t>(0x6082, 3'000);
  write<std::uint32_t>(0x6083, 400'000);
  write<std::uint32_t>(0x6084, 300'000);
  write<std::uint32_t>(0x2010, 2'000);
  write<std::uint32_t>(0x2011, 100'000);
  write<std::uint32_t>(0x2012, 10'000);
  write<std::uint32_t>(0x2013, 50'000);
  enable(0, 1);
  start_move(0, 20'000);
  EXPECT_GE(ramp().velocity(), 2'000.0);
  const Rates rates = watch_move(10'000.0);
  EXPECT_EQ(rates.gained_below, 100'000.0) << "2011h";
  EXPECT_EQ(rates.gained_above, 400'000.0) << "6083h";
  EXPECT_EQ(rates.lost_above, 300'000.0) << "6084h";
  EXPECT_EQ(rates.lost_below, 50'000.0) << "2013h";
  EXPECT_NEAR(rates.last_speed, 3'000.0, 5.0) << "6082h";
  bus_->pass(1_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 20'000);
  EXPECT_NEAR(shaft_microsteps(), 20'000.0, 100.0);
  write<std::uint32_t>(0x2014, 200'000);
  start_move(0, 0);
  EXPECT_EQ(watch_move(10'000.0).lost_below, 200'000.0) << "2014h";
  bus_->pass(1_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 0);
}

TEST_F(Tmcm3315Ramp, WithoutABreakVelocityTheRampIsATrapezoid) {
  set_profile(0, 40'000, 400'000);
  write<std::uint32_t>(0x2011, 100'000);
  write<std::uint32_t>(0x2013, 50'000);
  enable(0, 1);
  start_move(0, 20'000);
  const Rates rates = watch_move(10'000.0);
  EXPECT_EQ(rates.gained_below, 400'000.0);
  EXPECT_EQ(rates.lost_below, 400'000.0);
  EXPECT_LT(rates.last_speed, 25.0);
}

TEST_F(Tmcm3315Ramp, EachJerkActsAtItsCornerOfAnSShapedRamp) {
  write<std::uint32_t>(0x6081, 40'000);
  write<std::uint32_t>(0x6083, 400'000);
  write<std::uint32_t>(0x6084, 300'000);
  write<std::uint16_t>(0x6086, 1);
  const std::array<double, 4> jerks{4e6, 3e6, 2e6, 1e6};
  for (std::uint8_t i = 0; i < jerks.size(); ++i) {
    write<std::uint32_t>(0x60A4, static_cast<std::uint32_t>(jerks[i]),
                         static_cast<std::uint8_t>(i + 1));
  }
  write<std::uint8_t>(0x2015, 2);
  enable(0, 1);
  for (const std::int32_t target : {100'000, 0}) {
    start_move(0, target);
    std::array<double, 4> seen{};
    while (!ramp().at_rest()) {
      const double before = ramp().acceleration();
      const double speed = std::fabs(ramp().velocity());
      bus_->pass(50_us);
      const double change = std::fabs(ramp().acceleration()) - std::fabs(before);
      const bool gains = std::fabs(ramp().velocity()) > speed;
      const std::size_t corner = (gains ? 0U : 2U) + (change > 0.0 ? 0U : 1U);
      seen[corner] = std::max(seen[corner], std::fabs(change) / 50e-6);
    }
    for (std::size_t i = 0; i < jerks.size(); ++i) {
      EXPECT_NEAR(seen[i], 2.0 * jerks[i], 1e-6 * jerks[i]) << "jerk " << i + 1 << " of 60A4h";
    }
    bus_->pass(1_ms);
    EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), target);
  }
}

TEST_F(Tmcm3315Ramp, JerkTimesFactorIsClippedNotRefused) {
  set_profile(0, 40'000, 400'000);
  write<std::uint16_t>(0x6086, 1);
  write<std::uint32_t>(0x60A4, 2'147'483'647, 1);
  write<std::uint32_t>(0x60A4, 1'869'949'000, 2);
  write<std::uint8_t>(0x2015, 255);
  enable(0, 3);
  write<std::int32_t>(0x60FF, 1'000);
  EXPECT_EQ(ramp().limits().jerk[0], 476.837e9);
  EXPECT_EQ(ramp().limits().jerk[1], 476.836995e9);
}

TEST_F(Tmcm3315Ramp, EveryMotorHasItsOwnRamp) {
  for (unsigned motor = 0; motor < 3; ++motor) {
    set_profile(motor, 40'000, 400'000);
    write<std::uint32_t>(of_motor(motor, 0x2010), 100 * (motor + 1));
    enable(motor, 1);
    start_move(motor, 51'200);
  }
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(ramp(motor).limits().start_velocity, 100.0 * (motor + 1));
  }
}

TEST_F(Tmcm3315Ramp, InternalUnitsHoldForEveryObjectOfTheRamp) {
  write<std::uint8_t>(0x208C, 0);
  write<std::uint32_t>(0x6081, 256 * 40'000);
  write<std::uint32_t>(0x6082, 256 * 300);
  write<std::uint32_t>(0x6083, 4 * 400'000);
  write<std::uint32_t>(0x6084, 4 * 300'000);
  write<std::uint32_t>(0x2010, 256 * 200);
  write<std::uint32_t>(0x2011, 4 * 100'000);
  write<std::uint32_t>(0x2012, 256 * 10'000);
  write<std::uint32_t>(0x2013, 4 * 50'000);
  write<std::uint32_t>(0x2014, 4 * 70'000);
  write<std::uint32_t>(0x60A4, 5'000, 1);
  enable(0, 1);
  start_move(0, 10'000);
  EXPECT_EQ(ramp().limits(), (control::RampLimits{.velocity = 40'000.0,
                                                  .acceleration = 400'000.0,
                                                  .deceleration = 300'000.0,
                                                  .start_velocity = 200.0,
                                                  .start_acceleration = 100'000.0,
                                                  .break_velocity = 10'000.0,
                                                  .final_deceleration = 50'000.0,
                                                  .end_velocity = 300.0,
                                                  .stop_deceleration = 70'000.0,
                                                  .jerk = {5'000.0, 0.0, 0.0, 0.0}}));
}

TEST_F(Tmcm3315Ramp, ValuesThatFitTheObjectButNotTheGeneratorAreClipped) {
  set_profile(0, 0xFFFFFFFF, 0xFFFFFFFF);
  write<std::uint32_t>(0x2010, 268'435'455);
  write<std::uint32_t>(0x2011, 16'777'215);
  write<std::uint32_t>(0x2012, 16'777'215);
  write<std::uint32_t>(0x2014, 0xFFFFFFFF);
  enable(0, 1);
  start_move(0, 1'000);
  const control::RampLimits& limits = ramp().limits();
  EXPECT_EQ(limits.velocity, 8'388'607.0);
  EXPECT_EQ(limits.start_velocity, 8'388'607.0);
  EXPECT_EQ(limits.break_velocity, 8'388'607.0);
  EXPECT_EQ(limits.acceleration, 4'194'303.0);
  EXPECT_EQ(limits.start_acceleration, 4'194'303.0);
  EXPECT_EQ(limits.stop_deceleration, 4'194'303.0);
}

}  // namespace
}  // namespace stator::devices
