// Homing of the real motor on switches and index pulses.

#include <cmath>
#include <vector>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

constexpr double kLeftLimit = -1.6;  // revolutions of the shaft
constexpr double kRightLimit = 1.7;
constexpr double kHomeFrom = 0.30;
constexpr double kHomeTo = 0.45;
constexpr std::int64_t kIndexCount = 5000;  // of each revolution: -1.875, -0.875, 0.125, 1.125 ...
constexpr double kIndex = 0.125;

/// Motor 1 has switches and end stops behind them, and starts where a test wants it.
class Tmcm3315Homing : public Tmcm3315Module {
 protected:
  static Tmcm3315Configuration configuration(double start) {
    Tmcm3315Configuration configuration;
    plant::StepperAxisParameters& axis = configuration.axes[1];
    axis.initial_revolutions = start;
    axis.left_switch = plant::PositionSwitch::left_at(kLeftLimit);
    axis.right_switch = plant::PositionSwitch::right_at(kRightLimit);
    axis.home_switch = plant::PositionSwitch::home_between(kHomeFrom, kHomeTo);
    axis.encoder.index_position = kIndexCount;
    axis.load.end_stop_minimum = kLeftLimit - 0.2;
    axis.load.end_stop_maximum = kRightLimit + 0.2;
    return configuration;
  }
  /// A new module whose motor 1 stands at `start`.
  void power_up(const Tmcm3315Configuration& configuration) {
    renew(configuration);
    go_operational();
    write<std::uint8_t>(of_motor(1, 0x2003), 170);
  }
  void power_up(double start) { power_up(configuration(start)); }

  void set_up_homing(int method) {
    write<std::int8_t>(of_motor(1, 0x6098), static_cast<std::int8_t>(method));
    write<std::uint32_t>(of_motor(1, 0x6099), 50'000, 1);
    write<std::uint32_t>(of_motor(1, 0x6099), 10'000, 2);
    write<std::uint32_t>(of_motor(1, 0x609A), 500'000);
  }
  void home(int method) {
    set_up_homing(method);
    enable(1, 6);
    control(1, 31);
    for (int i = 0; i < 400 && (statusword(1) & 0x1000) == 0; ++i) {
      bus_->pass(100_ms);
    }
    bus_->pass(100_ms);
  }
  std::int32_t actual() { return bus_->upload<std::int32_t>(of_motor(1, 0x6064)); }
  std::int32_t demand() { return bus_->upload<std::int32_t>(of_motor(1, 0x6062)); }
  /// Microsteps from home as the objects have it to home as `revolutions` say; 0 is perfect.
  double deviation(double revolutions) {
    return shaft_microsteps(1) - actual() - revolutions * kMicrostepsPerRevolution;
  }
};

TEST_F(Tmcm3315Homing, EverySwitchMethodFindsItsEdgeFromEveryRegion) {
  struct Case {
    int method;
    double home;
  };
  for (const Case& c :
       {Case{17, kLeftLimit}, Case{18, kRightLimit}, Case{19, kHomeFrom}, Case{21, kHomeTo}}) {
    for (const double start : {-1.65, -1.0, 0.375, 1.0, 1.75}) {
      power_up(start);
      home(c.method);
      EXPECT_EQ(statusword(1) & 0x1400, 0x1400) << c.method << " from " << start;
      // Open loop: the shaft follows the set-point within friction and detent.
      EXPECT_NEAR(deviation(c.home), 0.0, 12.0) << c.method << " from " << start;
      EXPECT_EQ(actual(), 0);
      EXPECT_EQ(demand(), 0);
      EXPECT_NEAR(shaft_microsteps(1), c.home * kMicrostepsPerRevolution, 12.0)
          << "the motor stands there";
      EXPECT_TRUE(bus_->take_emergencies().empty());
    }
  }
}

TEST_F(Tmcm3315Homing, EveryIndexMethodIsExactToTheCount) {
  struct Case {
    int method;
    double start;
    double home;
  };
  for (const Case& c :
       {Case{1, 0.0, kIndex - 1.0}, Case{1, -1.65, kIndex - 1.0}, Case{2, 0.0, kIndex + 1.0},
        Case{2, 1.75, kIndex + 1.0}, Case{3, 0.0, kIndex}, Case{3, 0.375, kIndex},
        Case{5, 1.5, kIndex + 1.0}, Case{5, 0.375, kIndex + 1.0}, Case{33, 0.0, kIndex - 1.0},
        Case{34, 0.0, kIndex}, Case{34, 0.2, kIndex + 1.0}}) {
    power_up(c.start);
    use_encoder(1);
    home(c.method);
    EXPECT_EQ(statusword(1) & 0x1400, 0x1400) << c.method << " from " << c.start;
    // 6064h must be the scaled distance of the encoder from the mark, whatever the shaft does.
    const auto marks = static_cast<std::int64_t>(std::llround(c.home - kIndex));
    const std::int64_t from_mark =
        device_->axis(1).plant().state().encoder.absolute - (kIndexCount + marks * 40'000);
    EXPECT_EQ(actual(), std::llround(static_cast<double>(from_mark) * 1.28))
        << c.method << " from " << c.start;
    EXPECT_NEAR(actual(), 0, 12);
    EXPECT_NEAR(demand(), 0, 12);
  }
}

TEST_F(Tmcm3315Homing, AnEncoderCountingBackwardsFindsTheSameIndex) {
  Tmcm3315Configuration reversed = configuration(0.0);
  reversed.axes[1].encoder.reversed = true;
  power_up(reversed);
  write<std::uint8_t>(of_motor(1, 0x200B), 1, 2);
  use_encoder(1);
  home(34);
  EXPECT_NEAR(shaft_microsteps(1), kIndex * kMicrostepsPerRevolution, 12.0);
  EXPECT_NEAR(actual(), 0, 12);
}

TEST_F(Tmcm3315Homing, PolarityOfTheNullChannelMustFitTheEncoder) {
  Tmcm3315Configuration active_low = configuration(0.0);
  active_low.axes[1].encoder.index_active_low = true;
  for (const bool fits : {true, false}) {
    power_up(active_low);
    write<std::uint8_t>(of_motor(1, 0x200B), fits ? 1 : 0, 1);
    use_encoder(1);
    home(34);
    const std::int64_t from_mark = device_->axis(1).plant().state().encoder.absolute - kIndexCount;
    // With the wrong one the pulse ends where it seems to begin: a count further on.
    const auto latched = static_cast<double>(from_mark - (fits ? 0 : 1));
    EXPECT_EQ(actual(), std::llround(latched * 1.28));
  }
}

TEST_F(Tmcm3315Homing, TheOffsetShiftsZeroAndIsDisplayed) {
  power_up(0.0);
  write<std::int32_t>(of_motor(1, 0x607C), 2000);
  EXPECT_EQ(bus_->upload<std::int32_t>(of_motor(1, 0x2100)), 2000);
  home(19);
  EXPECT_EQ(actual(), -2000);
  EXPECT_EQ(demand(), -2000);
  set_profile(1, 50'000, 500'000);
  enable(1, 1);
  start_move(1, 0);
  bus_->pass(2_s);
  EXPECT_NEAR(shaft_microsteps(1), kHomeFrom * kMicrostepsPerRevolution + 2000.0, 12.0)
      << "zero lies the offset beyond home";
}

TEST_F(Tmcm3315Homing, AnAbsoluteMoveAfterHomingIsCountedFromHome) {
  std::vector<double> ends;
  for (const double start : {0.0, 1.2345}) {
    power_up(start);
    home(19);
    set_profile(1, 50'000, 500'000);
    enable(1, 1);
    start_move(1, -25'600);
    bus_->pass(3_s);
    ends.push_back(shaft_microsteps(1));
  }
  EXPECT_NEAR(ends[0], ends[1], 12.0) << "wherever the motor was switched on";
}

TEST_F(Tmcm3315Homing, SwitchesMayBeDeactivatedAndInverted) {
  Tmcm3315Configuration closed = configuration(0.0);
  closed.axes[1].left_switch.normally_closed = true;
  closed.axes[1].right_switch.normally_closed = true;
  closed.axes[1].home_switch.normally_closed = true;
  power_up(closed);
  write<std::uint32_t>(of_motor(1, 0x2005), 0x2C);  // all inverted
  home(19);
  EXPECT_NEAR(deviation(kHomeFrom), 0.0, 12.0);

  power_up(0.0);
  write<std::uint32_t>(of_motor(1, 0x2005), 0x10);  // no home switch
  set_up_homing(19);
  enable(1, 6);
  control(1, 31);
  bus_->pass(10_s);
  EXPECT_EQ(statusword(1) & 0x1400, 0) << "back and forth between the limit switches";
  EXPECT_EQ(statusword(1) & 0x4000, 0x4000);
  EXPECT_EQ(bus_->upload<std::uint32_t>(of_motor(1, 0x60FD)) & 4U, 0U);
  device_->axis(1).plant().press_home_switch(true);
  bus_->pass(2_ms);
  EXPECT_EQ(bus_->upload<std::uint32_t>(of_motor(1, 0x60FD)) & 4U, 4U)
      << "60FDh shows the input all the same";
  EXPECT_EQ(statusword(1) & 0x1400, 0);
}

TEST_F(Tmcm3315Homing, TheSignOfTheOffsetIsAChoiceOfTheConfiguration) {
  Tmcm3315Configuration other = configuration(0.0);
  other.home_offset_is_position = true;
  power_up(other);
  write<std::int32_t>(of_motor(1, 0x607C), 2000);
  home(19);
  EXPECT_EQ(actual(), 2000);
}

TEST_F(Tmcm3315Homing, LosingOperationalOnTheWayStopsTheMotor) {
  power_up(-1.0);
  set_up_homing(19);
  enable(1, 6);
  control(1, 31);
  bus_->pass(200_ms);
  bus_->request(AlState::safe_operational);
  bus_->pass(2_s);
  EXPECT_EQ(signal("axis1.shaft_speed"), 0.0);
  EXPECT_EQ(statusword(1) & 0x144F, 0x0440) << "Switch on disabled, homing stopped";
}

TEST_F(Tmcm3315Homing, AnOpenInputThatReadsHighBlocksUntilTheSwitchesAreDeactivated) {
  Tmcm3315Configuration open;
  open.axes[1].left_switch.level_if_not_fitted = true;
  open.axes[1].right_switch.level_if_not_fitted = true;
  power_up(open);
  set_profile(1, 51'200, 512'000);
  enable(1, 1);
  start_move(1, 10'000);
  bus_->pass(1_s);
  EXPECT_EQ(demand(), 0);
  control(1, 0);
  write<std::uint32_t>(of_motor(1, 0x2005), 3);
  enable(1, 1);
  start_move(1, 10'000);
  bus_->pass(1_s);
  EXPECT_EQ(demand(), 10'000);
}

// Inputs: switches pressed by hand

TEST_F(Tmcm3315Homing, SwitchesAreInputsThatAHandPresses) {
  power_up(0.0);
  const auto inputs = [&](unsigned motor) {
    bus_->pass(2_ms);
    return bus_->upload<std::uint32_t>(of_motor(motor, 0x60FD)) & 7U;
  };
  for (const unsigned motor : {0U, 1U}) {  // without and with cams
    const std::string axis = "axis" + std::to_string(motor) + ".";
    unsigned bit = 1;
    for (const char* name : {"left_switch", "right_switch", "home_switch"}) {
      set_input(axis + name, 1.0);
      EXPECT_EQ(inputs(motor), bit) << axis << name;
      set_input(axis + name, 0.0);
      EXPECT_EQ(inputs(motor), 0U) << axis << name;
      bit <<= 1U;
    }
  }
}

}  // namespace
}  // namespace stator::devices
