// What a master sees of faults around a TMC8670, and that all is well after them. The axis moves
// far at 600 1/min, commutated by its encoder.

#include <string>

#include "rack/surroundings_rows.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;

constexpr const char* kRack = R"(
[[segment]]
[[segment.device]]
type = "tmc8670"
name = "drive"
[segment.device.objects]
"2030:01" = 1453
"2030:02" = 786
"2030:03" = 1453
"2030:04" = 786
"2030:05" = 6400
"2030:06" = 80
"2030:07" = 300
"2031:01" = 12000
"2040:01" = 28000
"2040:02" = 27000
"6072" = 2000
"6073" = 2000
"6075" = 2450
"6076" = 125
"6081" = 2000
"6083" = 20000
"6084" = 20000
"6085" = 50000
[segment.device.axis]
load.inertia = 2e-5
load.brake_torque = 5.0
left_switch.pressed_to = -1e4
left_switch.normally_closed = true
right_switch.pressed_from = 1e4
right_switch.normally_closed = true
home_switch.pressed_from = 1e4
home_switch.normally_closed = true
encoder_2.counts_per_revolution = 4096
)";

constexpr std::int32_t kRevolution = 65'536;
constexpr unsigned kByEncoder = 3;  // 2020h:01
constexpr unsigned kByHalls = 5;
constexpr std::uint8_t kShaftByEncoder = 9;  // 2020h:02 and :03
constexpr std::uint16_t kSpeed = 600;        ///< 1/min

class Drive : public CoeDriveBench {
 public:
  explicit Drive(unsigned commutation = kByEncoder)
      : CoeDriveBench(kRack), commutation_(commutation) {}

  void start_motion() {
    start();
    write<std::uint8_t>(0x2020, static_cast<std::uint8_t>(commutation_), 1);
    if (commutation_ == kByHalls) {
      write<std::uint8_t>(0x2012, 1, 2);                // interpolated
      write<std::uint8_t>(0x2020, kShaftByEncoder, 2);  // velocity
      write<std::uint8_t>(0x2020, kShaftByEncoder, 3);  // position
    }
    write<std::uint32_t>(0x6065, 20'000);
    write<std::uint32_t>(0x6081, kSpeed);
    go_on();
  }
  void go_on() {
    if (stopped()) {
      control(0);
      control(0x80);
      pass(5_ms);
      enable(1);
    }
    move(1'000);
  }
  /// So many revolutions on, at once.
  void move(std::int32_t revolutions) {
    target_ += revolutions * kRevolution;
    write<std::int32_t>(0x607A, target_);
    control(0x2F);
    control(0x3F);
    pass(500_ms);
  }
  void enable(std::int8_t mode) {
    write<std::int8_t>(0x6060, mode);
    for (const unsigned controlword : {6U, 7U, 15U}) {
      control(controlword);
      pass(5_ms);
    }
  }
  bool stopped() { return !is_enabled(statusword()); }
  std::int32_t position() { return read<std::int32_t>(0x6064); }
  /// 1/min by the positions of a quarter of a second.
  double speed() {
    const std::int32_t before = position();
    pass(250_ms);
    return static_cast<double>(position() - before) / kRevolution * 240.0;
  }
  bool is_healthy() {
    EXPECT_NEAR(speed(), kSpeed, 30.0);
    EXPECT_NEAR(signal("drive.axis0.shaft_speed") * 60.0, kSpeed, 30.0);
    EXPECT_EQ(read<std::uint8_t>(0x1001), 0);
    return !stopped();
  }

 private:
  unsigned commutation_;
  std::int32_t target_ = 0;
};

class HallDrive : public Drive {
 public:
  HallDrive() : Drive(kByHalls) {}
};

using Row = SurroundingsRow<Drive>;

template <unsigned code>
void has_error_code(Drive& b) {
  EXPECT_EQ(b.read<std::uint16_t>(0x603F), code);
}
constexpr auto kFollowingError = has_error_code<0x8611>;

void runs(Drive& b) {
  EXPECT_NEAR(b.speed(), kSpeed, 60.0);
}

void stands(Drive& b) {
  EXPECT_NEAR(b.speed(), 0.0, 1.0);
}

int torque_ripple(Drive& b) {
  return ripple_of(b, [&b] { return b.read<std::int16_t>(0x6077); });
}
int velocity_ripple(Drive& b) {
  return ripple_of(b, [&b] { return b.read<std::int32_t>(0x606C); });
}

/// Homing on an index that does not come: it runs on.
void never_comes_home(Drive& b) {
  b.write<std::int8_t>(0x6060, 6);
  b.write<std::int8_t>(0x6098, 34);
  b.control(0x0F);
  b.pass(200_ms);  // the motor comes to rest, and homing is the mode
  b.control(0x1F);
  b.pass(20_s);
  EXPECT_EQ(b.statusword() & 0x1000U, 0U) << "homing attained";
  EXPECT_GT(std::abs(b.speed()), 1.0);
  b.control(0);  // afterwards the axis is enabled anew
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"MotorStall", "kind = 'motor-stall'", {{0x8611, 0}}, true, kFollowingError},
      {"AxisJammed",
       "kind = 'axis-jammed'\nfrom = 0\nto = 1",
       {{0x8611, 0}},
       true,
       kFollowingError},
      {"FrictionRise", "kind = 'friction-rise'\ntorque = 2", {{0x8611, 0}}, true, kFollowingError},
      {"FrictionRiseBelowTheLimit",
       "kind = 'friction-rise'\ntorque = 0.1",
       {},
       false,
       [](Drive& b) {
         runs(b);
         EXPECT_GT(b.read<std::int16_t>(0x6077), 500) << "0.1 % of 125 mN m";
       }},
      // It drives the motor backwards, and what braking against it feeds the brake chopper takes.
      {"LoadStep", "kind = 'load-step'\ntorque = -0.7", {{0x8611, 0}}, true, kFollowingError},
      {"LoadInertia",
       "kind = 'load-inertia'\ninertia = 0.01",
       {},
       false,
       [](Drive& b) {
         runs(b);
         b.move(-1'000);
         EXPECT_TRUE(b.stopped()) << "the ramp is too steep now";
         kFollowingError(b);
       }},
      {"PhaseLoss",
       "kind = 'phase-loss'\nphase = 'v'",
       {},
       false,
       [](Drive& b) {
         runs(b);
         EXPECT_NEAR(b.signal("drive.axis0.current_v"), 0.0, 1e-9);
       }},
      {"PhaseShort", "kind = 'phase-short'\nphase = 'u'", {{0x8611, 0}}, true, kFollowingError},
      {"PhaseShortHighSide",
       "kind = 'phase-short'\nphase = 'high-side'",
       {{0x8611, 0}},
       true,
       kFollowingError},
      {"EncoderGlitch",
       "kind = 'encoder-glitch'\ncounts = 30000",
       {{0x8611, 0}},
       true,
       kFollowingError,
       1_s,
       true},
      // The commutation counted on it, and is searched anew.
      {"EncoderLoss", "kind = 'encoder-loss'", {{0x8611, 0}}, true, kFollowingError, 1_s, true},
      {"EncoderLossOfAChannel",
       "kind = 'encoder-loss'\nchannel = 'a'",
       {{0x8611, 0}},
       true,
       kFollowingError,
       1_s,
       true},
      {"EncoderLossOfTheIndex",
       "kind = 'encoder-loss'\nchannel = 'index'",
       {},
       false,
       never_comes_home},
      {"EncoderSlip",
       "kind = 'encoder-slip'\nslip = 0.2",
       {{0x8611, 0}},
       true,
       kFollowingError,
       1_s,
       true},
      {"EncoderNoise",
       "kind = 'encoder-noise'\ncounts = 20",
       {},
       false,
       [](Drive& b) {
         runs(b);
         const int ripple = velocity_ripple(b);
         EXPECT_GT(ripple, 20);
       }},
      {"HallFaultWithoutUse",
       "kind = 'hall-fault'",
       {},
       false,
       [](Drive& b) {
         runs(b);
         for (int n = 0; n < 50; ++n) {
           b.pass(1_ms);
           EXPECT_EQ(static_cast<unsigned>(b.signal("drive.axis0.halls")) & 1U, 0U);
         }
       }},
      {"SupplySag", "kind = 'supply-sag'\nvolts = 20", {{0x3220, 0}}, true, has_error_code<0x3220>},
      {"SupplyOvervoltage",
       "kind = 'supply-overvoltage'\nvolts = 40",
       {{0x3210, 0}},
       true,
       has_error_code<0x3210>},
      {"SupplyResistance",
       "kind = 'supply-resistance'\nohms = 40",
       {},
       false,
       [](Drive& b) {
         runs(b);
         const auto load = b.inject("kind = 'load-step'\ndevice = 'drive'\ntorque = -0.2");
         b.pass(500_ms);
         EXPECT_EQ(b.told(), (std::vector<Told>{{0x3220, 0}})) << "under load only";
         b.clear(load);
       }},
      {"Heat",
       "kind = 'heat'\nwatts = 50\nplace = 'motor'",
       {},
       false,
       [](Drive& b) {
         runs(b);  // it has no thermometer
         EXPECT_GT(b.signal("drive.axis0.winding_temperature"), 60.0);
       },
       30_s},
      {"SwitchStuckPressed",
       "kind = 'switch-stuck'\nswitch = 'right'",
       {{0xFF01, 3}},
       false,
       stands},
      {"BrakeStuckClosed", "kind = 'brake-stuck'", {{0x8611, 0}}, true, kFollowingError},
      {"BrakeDrag", "kind = 'brake-drag'\ntorque = 5", {{0x8611, 0}}, true, kFollowingError},
      {"CurrentNoise",
       "kind = 'current-noise'\nsize = 100",
       {},
       false,
       [](Drive& b) {
         runs(b);
         const int ripple = torque_ripple(b);
         const auto quiet = b.inject("kind = 'current-noise'\nsize = 0\ndevice = 'drive'");
         EXPECT_GT(ripple, 2 * torque_ripple(b));
         b.clear(quiet);
       }},
  };
  return kRows;
}

/// With halls that commutate.
const std::vector<SurroundingsRow<HallDrive>>& hall_rows() {
  static const std::vector<SurroundingsRow<HallDrive>> kRows{
      {"StuckLow", "kind = 'hall-fault'", {{0x7310, 0}}, true, has_error_code<0x7310>},
      {"StuckHigh",
       "kind = 'hall-fault'\nsensor = 3\nmode = 'high'",
       {{0x7310, 0}},
       true,
       has_error_code<0x7310>},
      {"Swapped",
       "kind = 'hall-fault'\nmode = 'swapped'",
       {},
       false,
       [](Drive& b) {
         runs(b);
         EXPECT_GT(torque_ripple(b), 300) << "the other loops keep it going, by the encoder";
       }},
  };
  return kRows;
}

class Tmc8670Surroundings : public testing::TestWithParam<Row> {};
class Tmc8670HallFaults : public testing::TestWithParam<SurroundingsRow<HallDrive>> {};

TEST_P(Tmc8670Surroundings, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

TEST_P(Tmc8670HallFaults, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, Tmc8670Surroundings, testing::ValuesIn(rows_to_run(rows())),
                         RowName());
INSTANTIATE_TEST_SUITE_P(All, Tmc8670HallFaults, testing::ValuesIn(rows_to_run(hall_rows())),
                         RowName());

}  // namespace

std::vector<CoveredFault> covered_tmc8670() {
  std::vector<CoveredFault> covered = covered_by("tmc8670", rows());
  std::ranges::copy(covered_by("tmc8670", hall_rows()), std::back_inserter(covered));
  return covered;
}

}  // namespace stator::tests
