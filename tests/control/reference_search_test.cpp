// The reference search modes 1 to 3 of the TMCM-142 on a carriage with switches.
#include "stator/control/motion_controller/reference_search.hpp"

#include <gtest/gtest.h>

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;

constexpr base::SimDuration kPeriod = 100_us;

/// A carriage whose normally closed switches open, that is pins go high, beyond their places.
/// Places are microsteps of the motor; it starts at 0.
struct Rail {
  std::int64_t left_end = -1'000'000;
  std::int64_t right_end = 1'000'000;
  std::int64_t cam_begin = 0;   ///< of a reference switch in series with the left one
  std::int64_t cam_end = 0;     ///< not in it
  std::int64_t hysteresis = 0;  ///< of the left switch: how far beyond its place it is released

  [[nodiscard]] bool left(std::int64_t place, bool pressed) const {
    return place <= left_end + (pressed ? hysteresis : 0) ||
           (place >= cam_begin && place < cam_end);
  }
  [[nodiscard]] bool right(std::int64_t place) const { return place >= right_end; }
};

class Search {
 public:
  explicit Search(const Rail& rail) : rail_(rail) {
    Settings settings;
    settings.ramp.maximum_velocity = 4'000'000;
    settings.switches.mode = switch_mode::kLeftActiveHigh | switch_mode::kRightActiveHigh;
    controller.configure(settings);
    step();
  }
  void step() {
    const std::int64_t place = controller.motor_microsteps();
    sensing.left_switch = rail_.left(place, sensing.left_switch);
    sensing.right_switch = rail_.right(place);
    sensing.encoder_count = place;
    controller.advance(sensing, kPeriod);
    search.advance(controller);
    rightmost = std::max(rightmost, place);
    leftmost = std::min(leftmost, place);
  }
  /// Periods until the search is over, at most 100 s.
  int run() {
    int periods = 0;
    while (search.active() && periods < 1'000'000) {
      step();
      ++periods;
    }
    return periods;
  }

  MotionController controller;
  ReferenceSearch search;
  base::AxisSensing sensing;
  std::int64_t rightmost = 0;
  std::int64_t leftmost = 0;

 private:
  Rail rail_;
};

/// Where 0 is, as a place.
std::int64_t zero_place(const Search& search) {
  return search.controller.motor_microsteps() - search.controller.position();
}

TEST(ReferenceSearch, Mode1FindsTheLeftSwitch) {
  Search bench({.left_end = -20'000});
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  EXPECT_EQ(bench.search.state(), SearchState::to_left_switch);
  bench.step();
  bench.step();
  EXPECT_LT(bench.controller.velocity(), 0) << "left first";
  EXPECT_LT(bench.run(), 900'000);
  // The switching points are seen within a period of the calibration speed: 1.5 microsteps.
  EXPECT_NEAR(static_cast<double>(zero_place(bench)), -20'000.0, 2.0);
  EXPECT_EQ(bench.controller.encoder_position(), bench.controller.position());
  EXPECT_EQ(bench.controller.target_position(), bench.controller.position());
  EXPECT_EQ(bench.controller.velocity(), 0);
  EXPECT_EQ(bench.search.state(), SearchState::inactive);
  EXPECT_EQ(bench.search.switch_distance(), 0);
  EXPECT_EQ(bench.rightmost, 0);
}

TEST(ReferenceSearch, ZeroIsTheCentreBetweenReleaseAndReentry) {
  // Released at -19199, pressed again at -20000: neither edge, nor where the motor came to rest.
  Search bench({.left_end = -20'000, .hysteresis = 800});
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  EXPECT_LT(bench.run(), 900'000);
  EXPECT_NEAR(static_cast<double>(zero_place(bench)), -19'600.0, 2.0);

  Search right({.left_end = -20'000, .right_end = 30'000, .hysteresis = 2'000});
  right.search.start(right.controller, {.mode = SearchMode::right_then_left_switch});
  EXPECT_LT(right.run(), 900'000);
  EXPECT_NEAR(static_cast<double>(zero_place(right)), -19'000.0, 2.0);
  EXPECT_NEAR(right.search.switch_distance(), 49'000, 7) << "from that centre";
}

TEST(ReferenceSearch, SpeedsAreThoseOfTheParametersOrOfTheirDefaults) {
  for (const bool named : {false, true}) {
    Search bench({.left_end = -200'000});
    bench.search.start(bench.controller, {.mode = SearchMode::left_switch,
                                          .search_speed = named ? 2'000'000U : 0U,
                                          .switch_speed = named ? 100'000U : 0U});
    std::int32_t fastest_left = 0;
    std::int32_t fastest_right = 0;
    std::int32_t reentry = 0;
    while (bench.search.active()) {
      bench.step();
      fastest_left = std::min(fastest_left, bench.controller.velocity());
      fastest_right = std::max(fastest_right, bench.controller.velocity());
      if (bench.search.state() == SearchState::reentering_left_switch) {
        reentry = std::min(reentry, bench.controller.velocity());
      }
    }
    EXPECT_EQ(fastest_left, named ? -2'000'000 : -4'000'000);
    EXPECT_EQ(fastest_right, named ? 100'000 : 1'000'000);
    EXPECT_EQ(reentry, named ? -100'000 : -1'000'000);
  }
}

TEST(ReferenceSearch, Mode2GoesRightThenLeftAndMeasuresTheDistance) {
  Search bench({.left_end = -20'000, .right_end = 30'000});
  bench.search.start(bench.controller, {.mode = SearchMode::right_then_left_switch});
  bench.step();
  bench.step();
  EXPECT_GT(bench.controller.velocity(), 0) << "right first";
  EXPECT_LT(bench.run(), 900'000);
  EXPECT_GE(bench.rightmost, 30'000);
  EXPECT_NEAR(static_cast<double>(zero_place(bench)), -20'000.0, 2.0);
  // The right switch is seen within a period of the search speed, 6 microsteps.
  EXPECT_NEAR(bench.search.switch_distance(), 50'000, 7);
}

TEST(ReferenceSearch, Mode3TakesTheFirstSwitchMetFromTheRight) {
  Search bench({.left_end = -20'000, .right_end = 30'000, .cam_begin = -5'500, .cam_end = -5'000});
  bench.search.start(bench.controller, {.mode = SearchMode::right_then_reference_switch});
  EXPECT_LT(bench.run(), 900'000);
  EXPECT_NEAR(static_cast<double>(zero_place(bench)), -5'000.0, 2.0);
  EXPECT_GT(bench.leftmost, -20'000) << "the left switch is not reached";
  EXPECT_NEAR(bench.search.switch_distance(), 35'000, 7);
}

TEST(ReferenceSearch, ACamThatBrakingPassesIsCrossedAgain) {
  Search bench({.cam_begin = -5'100, .cam_end = -5'000});
  // 59.6 kpps at 2910383 pps/s: 610 microsteps to rest.
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  EXPECT_LT(bench.run(), 900'000);
  EXPECT_LT(bench.leftmost, -5'500);
  EXPECT_NEAR(static_cast<double>(zero_place(bench)), -5'000.0, 2.0);
}

TEST(ReferenceSearch, StartsOnASwitchAlreadyActive) {
  Search bench({.left_end = 100});
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  EXPECT_LT(bench.run(), 900'000);
  EXPECT_NEAR(static_cast<double>(zero_place(bench)), 100.0, 2.0);
}

TEST(ReferenceSearch, AutomaticStopsChangeNothing) {
  std::int64_t places[2]{};
  int periods[2]{};
  for (const bool disabled : {false, true}) {
    Search bench({.left_end = -20'000, .right_end = 30'000});
    Settings settings = bench.controller.settings();
    settings.switches.left_disabled = settings.switches.right_disabled = disabled;
    settings.limits = {.right = 10, .left = -10, .right_enabled = true, .left_enabled = true};
    bench.controller.configure(settings);
    bench.search.start(bench.controller, {.mode = SearchMode::right_then_left_switch});
    periods[disabled ? 1 : 0] = bench.run();
    places[disabled ? 1 : 0] = zero_place(bench);
  }
  EXPECT_EQ(places[0], places[1]);
  EXPECT_EQ(periods[0], periods[1]);
  EXPECT_NEAR(static_cast<double>(places[0]), -20'000.0, 2.0);
}

TEST(ReferenceSearch, SwitchesStopTheMotorAgainAfterIt) {
  Search bench({.left_end = -2'000});
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  bench.run();
  ASSERT_TRUE(bench.controller.left_switch());
  const std::int32_t position = bench.controller.position();
  bench.controller.move_to(-1'000);
  for (int i = 0; i < 100; ++i) {
    bench.step();
  }
  EXPECT_EQ(bench.controller.position(), position);
}

TEST(ReferenceSearch, StopAbortsAndBrakes) {
  Search bench({.left_end = -2'000'000});
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  for (int i = 0; i < 2'000; ++i) {
    bench.step();
  }
  ASSERT_EQ(bench.controller.velocity(), -4'000'000);
  const std::int32_t position = bench.controller.position();
  bench.search.stop(bench.controller);
  EXPECT_FALSE(bench.search.active());
  bench.step();
  EXPECT_EQ(bench.controller.velocity(), -4'000'000 + 50'000 * 1'600 / 4'096) << "with AP 17";
  for (int i = 0; i < 2'000; ++i) {
    bench.step();
  }
  EXPECT_EQ(bench.controller.velocity(), 0);
  EXPECT_LT(bench.controller.position(), position) << "coordinates stay";
}

TEST(ReferenceSearch, EndsWhenTheEncodersDeviationStopsTheMotor) {
  Search bench({.left_end = -200'000});
  Settings settings = bench.controller.settings();
  settings.encoder.maximum_deviation = 500;
  settings.encoder.constant = 0;  // the shaft is blocked
  bench.controller.configure(settings);
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  EXPECT_LT(bench.run(), 10'000);
  EXPECT_EQ(bench.search.failure(), SearchFailure::deviation);
  EXPECT_EQ(bench.controller.velocity(), 0);
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  EXPECT_EQ(bench.search.failure(), SearchFailure::none);
}

TEST(ReferenceSearch, EndsWhenItsMotorIsNotDrivenAnyMore) {
  Search bench({.left_end = -200'000});
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch});
  for (int i = 0; i < 500; ++i) {
    bench.step();
  }
  bench.search.abandon(bench.controller);
  bench.controller.stop_undriven();
  const std::int32_t position = bench.controller.position();
  EXPECT_LT(bench.run(), 1);
  bench.step();
  EXPECT_EQ(bench.controller.position(), position) << "neither a ramp nor the coordinates";
  EXPECT_EQ(bench.search.failure(), SearchFailure::undriven);
}

TEST(ReferenceSearch, WithoutASpeedThereIsNone) {
  Search bench({.left_end = -200'000});
  Settings settings = bench.controller.settings();
  settings.ramp.maximum_velocity = 3;  // a quarter of it is 0
  bench.controller.configure(settings);
  bench.controller.rotate(1'000'000);
  bench.run();
  bench.search.start(bench.controller, {.mode = SearchMode::left_switch, .search_speed = 1'000});
  EXPECT_FALSE(bench.search.active());
  EXPECT_EQ(bench.search.failure(), SearchFailure::no_speed);
  EXPECT_EQ(bench.controller.target_velocity(), 0) << "it ends the motion under way";
}

TEST(ReferenceSearch, NamingThePositionAnewMovesNeitherTheReferenceNorTheDistance) {
  for (const SearchState when :
       {SearchState::to_left_switch, SearchState::braking_after_left_switch}) {
    Search bench({.left_end = -20'000, .right_end = 30'000});
    bench.search.start(bench.controller, {.mode = SearchMode::right_then_left_switch});
    while (bench.search.state() != when) {
      bench.step();
    }
    bench.controller.set_position(bench.controller.position() + 7'000);
    EXPECT_LT(bench.run(), 900'000);
    EXPECT_NEAR(static_cast<double>(zero_place(bench)), -20'000.0, 2.0);
    EXPECT_NEAR(bench.search.switch_distance(), 50'000, 7);
  }
}

}  // namespace
}  // namespace stator::control::motion_controller
