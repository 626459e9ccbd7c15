// Motors on a board: step/direction with stall and end stop, encoder, DC motor on a bridge,
// three-phase motor.
#include <cmath>

#include <gtest/gtest.h>

#include "board/bench.hpp"

namespace stator::board {
namespace {

constexpr Line kStepLine = 8;
constexpr Line kDirLine = 9;
constexpr Line kALine = 10;
constexpr Line kBLine = 11;
constexpr Line kNLine = 12;

PeripheralConfiguration stepper(
    std::initializer_list<std::pair<const char*, double>> numbers = {}) {
  return part("motor", kStepDirMotor, {{"step", kStepLine}, {"dir", kDirLine}}, numbers);
}

/// Steps at `rate` steps per second.
void make_steps(Bench& bench, int steps, double rate) {
  const auto half = base::SimDuration(static_cast<std::int64_t>(0.5e9 / rate));
  for (int k = 0; k < steps; ++k) {
    const base::SimTime rise = bench.board.time() + half;
    bench.pins.at(rise, kStepLine, true);
    bench.board.advance(rise);
    bench.pins.at(rise + half, kStepLine, false);
    bench.board.advance(rise + half);
  }
}

TEST(StepDirMotor, EndsWhereItsStepsSay) {
  for (const bool backward : {false, true}) {
    Bench bench({stepper({{"microsteps", 16}})});
    bench.set(kDirLine, backward);
    // 1600 microsteps of 1/16 are half a revolution, at half a revolution per second.
    make_steps(bench, 1600, 1600.0);
    bench.wait(300_ms);
    const double sign = backward ? -1.0 : 1.0;
    EXPECT_EQ(bench.signal("motor.steps"), sign * 1600.0);
    EXPECT_NEAR(bench.signal("motor.position"), sign * 0.5, 0.0005);
    EXPECT_EQ(bench.signal("motor.lost_steps"), 0.0);
  }
}

TEST(StepDirMotor, LosesWholeElectricalPeriodsWhenItStalls) {
  Bench bench({stepper({{"microsteps", 1}})});
  make_steps(bench, 400, 20'000.0);  // full steps at 100 rev/s from rest: no rotor follows
  bench.wait(500_ms);
  const double lost = bench.signal("motor.lost_steps");
  EXPECT_GT(lost, 100.0);
  EXPECT_EQ(std::fmod(lost, 4.0), 0.0);
  EXPECT_NEAR(bench.signal("motor.position"), (400.0 - lost) / 200.0, 0.002);
}

TEST(StepDirMotor, StopsAtAnEndStopWhileStepsGoOn) {
  Bench bench({stepper({{"microsteps", 16}, {"end_stop_maximum", 0.25}, {"current", 1.0}})});
  make_steps(bench, 1600, 3200.0);
  bench.wait(300_ms);
  EXPECT_LT(bench.signal("motor.position"), 0.28);
  EXPECT_GE(bench.signal("motor.lost_steps"), 40.0);
}

TEST(StepDirMotor, StallsWhenItsLoadIsTooHigh) {
  Bench bench({stepper({{"microsteps", 16}})});
  make_steps(bench, 800, 1600.0);
  EXPECT_EQ(bench.signal("motor.lost_steps"), 0.0);
  bench.input("motor.load_torque", -1.5);  // holding torque 0.65 Nm at 2 A
  make_steps(bench, 800, 1600.0);
  EXPECT_GT(bench.signal("motor.lost_steps"), 0.0);
}

TEST(StepDirMotor, SleepsWhenItHasSettled) {
  Bench bench({stepper()});
  bench.wait(2'000_ms);
  EXPECT_EQ(bench.board.next_event(), base::SimTime::never());
  make_steps(bench, 256, 10'000.0);
  EXPECT_LT(bench.board.next_event(), base::SimTime::never());
}

TEST(StepDirMotor, LetsGoWithoutEnable) {
  auto motor = stepper();
  motor.wire("enable", 13);
  Bench bench({motor});
  bench.set(13, false);
  bench.wait(10_ms);
  EXPECT_NEAR(bench.signal("motor.current_a"), 2.828, 0.02);
  bench.set(13, true);
  bench.wait(20_ms);
  EXPECT_EQ(bench.signal("motor.current_a"), 0.0);
}

TEST(StepDirMotor, WantsAPowerOfTwo) {
  EXPECT_THROW(Bench({stepper({{"microsteps", 10}})}), BoardError);
}

PeripheralConfiguration encoder(
    std::initializer_list<std::pair<const char*, double>> numbers = {}) {
  return part("encoder", kEncoder, {{"a", kALine}, {"b", kBLine}, {"n", kNLine}}, numbers,
              {{"shaft", "motor"}});
}

TEST(Encoder, CountsTheRevolutionsOfTheShaft) {
  Bench bench({stepper({{"microsteps", 16}}), encoder({{"counts_per_revolution", 4000}})});
  make_steps(bench, 6400, 3200.0);  // two revolutions
  bench.wait(300_ms);
  EXPECT_NEAR(bench.signal("encoder.count"), 8000.0, 2.0);
  // Edges of A and B together are what was counted, plus what the rotor swung.
  const auto edges = bench.pins.edges(kALine).size() + bench.pins.edges(kBLine).size();
  const auto count = static_cast<std::size_t>(bench.signal("encoder.count"));
  EXPECT_GE(edges, count);
  EXPECT_EQ((edges - count) % 2, 0U);
}

TEST(Encoder, HasEachEdgeAtItsMoment) {
  // A shaft that turns evenly, made by the test itself.
  class Turner final : public Peripheral {
   public:
    explicit Turner(const Settings& /*settings*/) {}
    Shaft* shaft() override { return &shaft_; }
    void begin(base::SimTime now) override { schedule(now); }
    void advance(base::SimTime now) override {
      // 25 revolutions per second, downwards in the second half of each 100 ms.
      const bool back = now.nanoseconds() % 100'000'000 >= 50'000'000;
      ShaftPosition to = shaft_.position();
      to.fraction += back ? -0.00125 : 0.00125;
      shaft_.move({now, 50_us, shaft_.position(), to});
      schedule(now + 50_us);
    }

   private:
    Shaft shaft_;
  };
  static constexpr PeripheralType kTurner{
      "turner", "", {}, {}, {}, [](const Settings& settings) -> std::unique_ptr<Peripheral> {
        return std::make_unique<Turner>(settings);
      }};
  Bench bench({part("motor", kTurner, {}),
               encoder({{"counts_per_revolution", 4000}, {"offset", 0.5}, {"index_position", 2}})});
  bench.wait(50_ms);
  // 100,000 edges per second; the first at half a count.
  const auto& a = bench.pins.edges(kALine);
  const auto& b = bench.pins.edges(kBLine);
  ASSERT_GE(a.size(), 2490U);
  for (std::size_t k = 0; k < 2490; ++k) {
    const double begin = 20'000.0 * static_cast<double>(k);
    EXPECT_NEAR(static_cast<double>(a[k].time.nanoseconds()), 5'000.0 + begin, 2.0) << k;
    EXPECT_NEAR(static_cast<double>(b[k].time.nanoseconds()), 15'000.0 + begin, 2.0) << k;
    EXPECT_EQ(a[k].level, k % 2 == 0);
  }
  // N at count 2, for one count.
  ASSERT_GE(bench.pins.edges(kNLine).size(), 2U);
  EXPECT_NEAR(static_cast<double>(bench.pins.edges(kNLine)[0].time.nanoseconds()), 15'000.0, 2.0);
  EXPECT_NEAR(static_cast<double>(bench.pins.edges(kNLine)[1].time.nanoseconds()), 25'000.0, 2.0);
  // And back: B leads A.
  const std::size_t forward_a = a.size();
  const std::size_t forward_b = b.size();
  bench.wait(50_ms);
  EXPECT_GT(a.size(), forward_a + 2490U);
  EXPECT_LT(b[forward_b].time, a[forward_a].time + 20_us);
  EXPECT_NEAR(bench.signal("encoder.count"), 0.0, 1.0);
}

TEST(Encoder, DrivesInvertedLinesOfItsOwn) {
  auto differential = encoder();
  differential.wire("an", 13);
  Bench bench({stepper({{"microsteps", 16}}), differential});
  EXPECT_NE(bench.pins.level(kALine), bench.pins.level(13));
  make_steps(bench, 100, 3200.0);
  EXPECT_EQ(bench.pins.edges(kALine).size(), bench.pins.edges(13).size() - 1);
}

TEST(Encoder, NeedsAShaft) {
  EXPECT_THROW(Bench({part("motor", kPotentiometer, {}), encoder()}), BoardError);
  EXPECT_THROW(Bench({encoder()}), BoardError);
}

PeripheralConfiguration dc_motor(
    std::initializer_list<std::pair<const char*, double>> numbers = {}) {
  return part("motor", kBridgeMotor, {{"a_high", 16}, {"a_low", 17}, {"b_high", 18}, {"b_low", 19}},
              numbers);
}

void set_duties(Bench& bench, std::initializer_list<double> duties) {
  Line line = 16;
  for (const double duty : duties) {
    bench.pins.put_mean(bench.board.time(), line++, duty);
  }
}

TEST(DcMotor, TurnsWithTheMeanVoltageOfTheBridge) {
  Bench bench({dc_motor()});
  set_duties(bench, {0.75, 0.25, 0.25, 0.75});  // 12 V of 24
  bench.wait(1'000_ms);
  // 12 V / 0.035 Vs less friction: 3 mNm are 86 mA at 0.7 ohm.
  const double expected = (12.0 - 0.7 * (3e-3 + 5e-6 * 340.0) / 0.035) / 0.035 * 60.0 / 6.2831853;
  EXPECT_NEAR(bench.signal("motor.speed"), expected, 0.005 * expected);
  set_duties(bench, {0.25, 0.75, 0.75, 0.25});
  bench.wait(1'000_ms);
  EXPECT_NEAR(bench.signal("motor.speed"), -expected, 0.005 * expected);
}

TEST(DcMotor, CoastsWhileNoTransistorIsOnAndThenSleeps) {
  Bench bench({dc_motor()});
  set_duties(bench, {1.0, 0.0, 0.0, 1.0});
  bench.wait(500_ms);
  const double speed = bench.signal("motor.speed");
  EXPECT_GT(speed, 5000.0);
  set_duties(bench, {0.0, 0.0, 0.0, 0.0});
  bench.wait(5_ms);
  EXPECT_NEAR(bench.signal("motor.current"), 0.0, 1e-9);
  EXPECT_GT(bench.signal("motor.speed"), 0.9 * speed);
  bench.wait(10'000_ms);
  EXPECT_EQ(bench.signal("motor.speed"), 0.0);
  EXPECT_EQ(bench.board.next_event(), base::SimTime::never());
}

TEST(DcMotor, RunsOneWayWithAChoppedHighSide) {
  // The high side of A chopped, the low side of B on: the diode of A carries the current on.
  Bench bench({dc_motor()});
  set_duties(bench, {0.5, 0.0, 0.0, 1.0});
  bench.wait(1'000_ms);
  EXPECT_NEAR(bench.signal("motor.speed"), 3240.0, 60.0);
}

TEST(ThreePhaseMotor, FollowsARotatingVoltage) {
  Bench bench({part("motor", kThreePhaseMotor, {{"u_high", 16}, {"v_high", 17}, {"w_high", 18}})});
  // 1 V amplitude at up to 20 electrical revolutions per second, in steps of a degree or so.
  double angle = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const double electrical_hertz = std::min(k / 500.0, 20.0);
    angle += 6.283185307 * electrical_hertz * 100e-6;
    for (unsigned phase = 0; phase < 3; ++phase) {
      bench.pins.put_mean(bench.board.time(), static_cast<Line>(16 + phase),
                          0.5 + 1.0 / 24.0 * std::cos(angle - 2.0943951 * phase));
    }
    bench.wait(100_us);
  }
  EXPECT_NEAR(bench.signal("motor.position"), angle / 6.283185307 / 4.0, 0.1);
  EXPECT_NEAR(bench.signal("motor.speed"), 300.0, 30.0);
}

}  // namespace
}  // namespace stator::board
