// What a master sees of faults around a TMCM-3315, and that all is well after them. The axis turns
// at one revolution per second; its positions are the encoder's.

#include <cmath>

#include "rack/surroundings_rows.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;

constexpr const char* kRack = R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "drive"
[[segment.device.axis]]
load.brake_torque = 5.0
left_switch.pressed_to = -1e4
right_switch.pressed_from = 1e4
home_switch.pressed_from = 15
)";

constexpr std::int32_t kRevolution = 51'200;  ///< in microsteps, also by the encoder

// Bits of 2102h.
constexpr unsigned kShortA = 0x01;
constexpr unsigned kShortB = 0x02;
constexpr unsigned kOpenLoadA = 0x04;
constexpr unsigned kOpenLoadB = 0x08;
constexpr unsigned kShortHighSide = 0x10;
constexpr unsigned kUndervoltage = 0x20;
constexpr unsigned kOverTemperature = 0xC0;  // with its warning

class Drive : public CoeDriveBench {
 public:
  Drive() : CoeDriveBench(kRack) {}

  void start_motion() {
    start();
    write<std::int16_t>(0x606A, 0);  // positions of the encoder ...
    write<std::uint32_t>(0x608F, 40'000, 1);
    write<std::uint8_t>(0x200C, 255, 2);  // the brake is fed to release it
    write<std::uint32_t>(0x6065, 4'000);
    write<std::uint32_t>(0x6083, 512'000);
    write<std::uint32_t>(0x6084, 512'000);
    go_on();
  }
  void go_on() {
    if (stopped()) {
      control(0);
      control(0x80);
      write<std::int32_t>(0x60FF, 0);
      write<std::int8_t>(0x6060, 3);
      for (const unsigned controlword : {6U, 7U, 15U}) {
        control(controlword);
      }
    }
    turn(kRevolution);
  }
  void turn(std::int32_t velocity) {
    write<std::int32_t>(0x60FF, velocity);
    pass(1_s);
  }
  bool stopped() { return !is_enabled(statusword()); }
  std::int32_t position() { return read<std::int32_t>(0x6064); }
  unsigned flags() { return read<std::uint8_t>(0x2102); }
  unsigned load() { return read<std::uint16_t>(0x2101); }
  /// Microsteps in a quarter of a second.
  std::int32_t moved() {
    const std::int32_t before = position();
    pass(250_ms);
    return position() - before;
  }
  bool is_healthy() {
    const std::int32_t before = position();
    const double shaft = signal("drive.axis0.shaft_position");
    pass(1_s);
    EXPECT_NEAR(position() - before, kRevolution, kRevolution / 20);
    EXPECT_NEAR(signal("drive.axis0.shaft_position") - shaft, 1.0, 0.05);
    EXPECT_EQ(read<std::uint8_t>(0x1001), 0);
    EXPECT_EQ(flags(), 0U);
    return !stopped();
  }
};

using Row = SurroundingsRow<Drive>;

void stands(Drive& b) {
  EXPECT_NEAR(b.moved(), 0, 200);
}
void runs(Drive& b) {
  EXPECT_NEAR(b.moved(), kRevolution / 4, kRevolution / 40);
}
template <unsigned bits>
void shows(Drive& b) {
  EXPECT_EQ(b.flags() & bits, bits) << std::hex << b.flags();
}

/// Homing that never finds what it looks for: it runs on.
template <std::int8_t method>
void never_comes_home(Drive& b) {
  b.turn(0);
  b.write<std::int8_t>(0x6060, 6);
  b.write<std::int8_t>(0x6098, method);
  b.write<std::uint32_t>(0x6099, kRevolution, 1);
  b.write<std::uint32_t>(0x609A, 512'000);
  b.write<std::uint32_t>(0x6099, kRevolution / 5, 2);
  b.control(0x1F);
  b.pass(30_s);
  EXPECT_EQ(b.statusword() & 0x1000U, 0U) << "homing attained";
  EXPECT_GT(b.moved(), 1'000);
  b.control(0x0F);
  b.write<std::int8_t>(0x6060, 3);
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"MotorStall", "kind = 'motor-stall'", {{0x8611, 0}}, true, stands},
      {"AxisJammed", "kind = 'axis-jammed'\nfrom = -1\nto = 1", {{0x8611, 0}}, true, stands},
      {"FrictionRise", "kind = 'friction-rise'\ntorque = 5", {{0x8611, 0}}, true, stands},
      {"LoadStep", "kind = 'load-step'\ntorque = -4", {{0x8611, 0}}, true},
      {"LoadStepBelowPullOut",
       "kind = 'load-step'\ntorque = -0.2\nover = '100ms'",
       {},
       false,
       [](Drive& b) {
         runs(b);
         const unsigned loaded = b.load();
         const auto less = b.inject("kind = 'load-step'\ndevice = 'drive'\ntorque = 0");
         b.pass(500_ms);
         EXPECT_LT(loaded, b.load()) << "StallGuard's value falls with the load";
         b.clear(less);
       }},
      {"LoadInertia",
       "kind = 'load-inertia'\ninertia = 0.05",
       {},
       false,
       [](Drive& b) {
         runs(b);
         b.turn(-kRevolution);
         EXPECT_TRUE(b.stopped()) << "the ramp is too steep now";
         EXPECT_EQ(b.told(), (std::vector<Told>{{0x8611, 0}}));
       }},
      {"PhaseLossA",
       "kind = 'phase-loss'\nphase = 'a'",
       {{0x1000, 1}, {0x8611, 0}},
       true,
       [](Drive& b) { shows<kOpenLoadA>(b); }},
      {"PhaseLossB",
       "kind = 'phase-loss'\nphase = 'b'",
       {{0x1000, 2}, {0x8611, 0}},
       true,
       [](Drive& b) { shows<kOpenLoadB>(b); }},
      {"PhaseShortA", "kind = 'phase-short'\nphase = 'a'", {{0x2312, 0}}, true, shows<kShortA>},
      {"PhaseShortB", "kind = 'phase-short'\nphase = 'b'", {{0x2311, 0}}, true, shows<kShortB>},
      {"PhaseShortHighSide",
       "kind = 'phase-short'\nphase = 'high-side'",
       {{0x2310, 0}},
       true,
       shows<kShortHighSide>},
      {"EncoderGlitch", "kind = 'encoder-glitch'\ncounts = 5000", {{0x8611, 0}}, true},
      {"EncoderLoss", "kind = 'encoder-loss'", {{0x8611, 0}}, true, stands},
      {"EncoderLossOfAChannel",
       "kind = 'encoder-loss'\nchannel = 'b'",
       {{0x8611, 0}},
       true,
       stands},
      {"EncoderLossOfTheIndex",
       "kind = 'encoder-loss'\nchannel = 'index'",
       {},
       false,
       never_comes_home<34>},
      {"EncoderSlip", "kind = 'encoder-slip'\nslip = 0.3", {{0x8611, 0}}, true},
      {"EncoderNoise",
       "kind = 'encoder-noise'\ncounts = 500",
       {},
       false,
       [](Drive& b) {
         b.turn(0);
         const std::int32_t ripple = ripple_of(b, [&b] { return b.position(); });
         EXPECT_GT(ripple, 400) << "at rest";
         EXPECT_LE(ripple, 1'290) << "500 counts are 640 microsteps";
       }},
      {"SupplySag", "kind = 'supply-sag'\nvolts = 18", {{0xFF00, 0}}, true, shows<kUndervoltage>},
      {"SupplyOvervoltage",
       "kind = 'supply-overvoltage'\nvolts = 20",
       {},
       false,
       [](Drive& b) {
         runs(b);  // the product does not watch for it
         EXPECT_NEAR(b.signal("drive.axis0.supply_voltage"), 44.0, 0.1);
       }},
      {"SupplyResistance",
       "kind = 'supply-resistance'\nohms = 50",
       {},
       false,
       [](Drive& b) {
         runs(b);
         EXPECT_LT(b.signal("drive.axis0.supply_voltage"), 23.5);
       }},
      {"SupplyResistanceTooLarge", "kind = 'supply-resistance'\nohms = 100", {{0xFF00, 0}}, true},
      {"OverTemperature",
       "kind = 'over-temperature'\nkelvin = 150",
       {{0x4310, 1}, {0x4310, 2}},
       true,
       shows<kOverTemperature>},
      {"Heat",
       "kind = 'heat'\nwatts = 20",
       {{0x4310, 1}, {0x4310, 2}},
       true,
       shows<kOverTemperature>,
       200_s},
      {"SwitchStuckPressed",
       "kind = 'switch-stuck'\nswitch = 'right'",
       {{0xFF01, 3}},
       false,
       stands},
      {"SwitchStuckReleased",
       "kind = 'switch-stuck'\nswitch = 'home'\nstate = 'released'",
       {},
       false,
       never_comes_home<19>},
      {"BrakeStuckClosed", "kind = 'brake-stuck'", {{0x8611, 0}}, true, stands},
      {"BrakeStuckOpen",
       "kind = 'brake-stuck'\nstate = 'open'",
       {},
       false,
       [](Drive& b) {
         b.turn(0);
         b.control(0);  // disable voltage: power off, brake applied
         b.pass(1_s);
         const std::int32_t before = b.position();
         const auto weight = b.inject("kind = 'load-step'\ndevice = 'drive'\ntorque = -0.5");
         b.pass(200_ms);
         EXPECT_LT(b.position(), before - kRevolution) << "the weight falls";
         b.clear(weight);
       }},
      {"BrakeDrag", "kind = 'brake-drag'\ntorque = 5", {{0x8611, 0}}, true, stands},
      {"AnalogNoise",
       "kind = 'analog-noise'\ncounts = 50",
       {},
       false,
       [](Drive& b) {
         b.inject("kind = 'set'\ndevice = 'drive'\ninput = 'analog_input1'\nvalue = 1000");
         b.pass(10_ms);
         const auto [lowest, highest] =
             extremes_of(b, [&b] { return b.read<std::uint32_t>(0x270E, 2); });
         EXPECT_GE(lowest, 950U);
         EXPECT_LE(highest, 1'050U);
         EXPECT_GE(highest - lowest, 50U);
       }},
  };
  return kRows;
}

class Tmcm3315Surroundings : public testing::TestWithParam<Row> {};

TEST_P(Tmcm3315Surroundings, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, Tmcm3315Surroundings, testing::ValuesIn(rows_to_run(rows())),
                         RowName());

}  // namespace

std::vector<CoveredFault> covered_tmcm_3315() {
  return covered_by("tmcm-3315", rows());
}

}  // namespace stator::tests
