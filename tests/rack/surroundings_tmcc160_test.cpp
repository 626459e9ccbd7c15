// What a master sees of faults around a TMCC160, and that all is well after them: 1000 1/min in
// velocity mode by the sensors it leaves its box with.

#include "rack/surroundings_rows.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;

constexpr const char* kRack = R"(
[[bus]]
[[bus.device]]
type = "tmcc160"
name = "drive"
[bus.device.axis]
load.brake_torque = 5.0
left_switch.pressed_to = -1e4
right_switch.pressed_from = 1e4
)";

constexpr std::int32_t kSpeed = 1'000;  ///< 1/min

// 2055h.
constexpr unsigned kByHalls = 6;
constexpr unsigned kByEncoder = 7;

// Bits of 200Dh.
constexpr unsigned kOverVoltage = 0x04;
constexpr unsigned kHallError = 0x20;

class Drive : public CanopenDriveBench {
 public:
  explicit Drive(unsigned commutation = kByHalls)
      : CanopenDriveBench(kRack), commutation_(commutation) {}

  void start_motion() {
    start();
    write<std::uint8_t>(0x2055, static_cast<std::uint8_t>(commutation_));
    go_on();
    pass(1_s);
  }
  void go_on() {
    if (stopped()) {
      control(0);
      control(0x80);
      pass(5_ms);
      write<std::int8_t>(0x6060, 3);
      for (const unsigned controlword : {6U, 7U, 15U}) {
        control(controlword);
        pass(3_ms);
      }
    }
    write<std::int32_t>(0x60FF, kSpeed);
    pass(1_s);
  }
  bool stopped() { return !is_enabled(statusword()); }
  std::int32_t speed() { return read<std::int32_t>(0x606C); }
  std::int32_t current() { return read<std::int32_t>(0x2030, 1); }
  unsigned flags() { return read<std::uint32_t>(0x200D); }
  bool is_healthy() {
    EXPECT_NEAR(speed(), kSpeed, 60);
    EXPECT_NEAR(signal("drive.axis0.shaft_speed") * 60.0, kSpeed, 60.0);
    EXPECT_EQ(read<std::uint8_t>(0x1001), 0);
    EXPECT_EQ(flags() & 0x3FU, 0U);
    return !stopped();
  }

 private:
  unsigned commutation_;
};

class EncoderDrive : public Drive {
 public:
  EncoderDrive() : Drive(kByEncoder) {}
};

using Row = SurroundingsRow<Drive>;

void runs(Drive& b) {
  EXPECT_NEAR(b.speed(), kSpeed, 100);
}
void stands(Drive& b) {
  EXPECT_NEAR(b.speed(), 0, 20);
}
/// With all the current it may have (2020h:01).
void pushes(Drive& b) {
  stands(b);
  EXPECT_NEAR(b.current(), 4'000, 100);
}
/// In Fault, of which no emergency tells.
void is_in_fault(Drive& b) {
  EXPECT_EQ(b.statusword() & 0x4FU, 0x08U);
}
/// With all three sensors low, a state that does not exist.
void has_hall_error(Drive& b) {
  const auto second = b.inject("kind = 'hall-fault'\nsensor = 2\ndevice = 'drive'");
  const auto third = b.inject("kind = 'hall-fault'\nsensor = 3\ndevice = 'drive'");
  b.pass(10_ms);
  is_in_fault(b);
  EXPECT_EQ(b.flags() & kHallError, kHallError);
  b.clear(second);
  b.clear(third);
}
int current_ripple(Drive& b) {
  return ripple_of(b, [&b] { return b.current(); });
}
void counts(Drive& b, bool expected) {
  const auto before = b.read<std::int16_t>(0x2080, 1);
  bool moved = false;
  for (int n = 0; n < 20; ++n) {
    b.pass(1_ms);
    moved = moved || std::abs(b.read<std::int16_t>(0x2080, 1) - before) > 2'000;
  }
  EXPECT_EQ(moved, expected) << "2080h:01, the angle of the encoder";
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"MotorStall", "kind = 'motor-stall'", {}, false, pushes},
      {"AxisJammed", "kind = 'axis-jammed'\nfrom = 0\nto = 1", {}, false, pushes},
      {"FrictionRise", "kind = 'friction-rise'\ntorque = 5", {}, false, pushes},
      {"LoadStep",
       "kind = 'load-step'\ntorque = -0.05",
       {},
       false,
       [](Drive& b) {
         runs(b);
         EXPECT_GT(b.current(), 1'000) << "about 100 without load";
       }},
      {"LoadInertia",
       "kind = 'load-inertia'\ninertia = 3e-3",
       {},
       false,
       [](Drive& b) {
         runs(b);
         b.write<std::int32_t>(0x60FF, 3 * kSpeed);
         b.pass(1'500_ms);
         EXPECT_LT(b.speed(), 2 * kSpeed) << "it takes longer";
       }},
      {"PhaseLoss",
       "kind = 'phase-loss'\nphase = 'u'",
       {},
       false,
       [](Drive& b) {
         runs(b);
         for (int n = 0; n < 20; ++n) {
           b.pass(1_ms);
           EXPECT_NEAR(b.signal("drive.axis0.phase_current_u"), 0.0, 1e-6);
         }
       }},
      {"PhaseShortU", "kind = 'phase-short'\nphase = 'u'", {{0x2312, 0}}, true},
      {"PhaseShortV", "kind = 'phase-short'\nphase = 'v'", {{0x2311, 0}}, true},
      {"PhaseShortHighSide", "kind = 'phase-short'\nphase = 'high-side'", {{0x2310, 0}}, true},
      {"EncoderLossWithoutUse",
       "kind = 'encoder-loss'",
       {},
       false,
       [](Drive& b) {
         runs(b);
         counts(b, false);
       }},
      {"HallFault", "kind = 'hall-fault'", {}, true, has_hall_error},
      {"HallFaultHigh", "kind = 'hall-fault'\nmode = 'high'\nsensor = 2", {}, true, is_in_fault},
      {"HallsSwapped", "kind = 'hall-fault'\nmode = 'swapped'", {}, true, is_in_fault},
      {"SupplySag",
       "kind = 'supply-sag'\nvolts = 18",
       {{0xFF00, 0}},
       true,
       [](Drive& b) { EXPECT_NEAR(b.read<std::uint32_t>(0x200E), 60, 2); }},
      {"SupplyOvervoltage",
       "kind = 'supply-overvoltage'\nvolts = 8",
       {},
       true,
       [](Drive& b) {
         EXPECT_EQ(b.flags() & kOverVoltage, kOverVoltage);
         EXPECT_NEAR(b.read<std::uint32_t>(0x200E), 320, 2);
       }},
      {"SupplyResistance",
       "kind = 'supply-resistance'\nohms = 20",
       {},
       false,
       [](Drive& b) { EXPECT_LT(b.read<std::uint32_t>(0x200E), 239U); }},
      {"OverTemperature",
       "kind = 'over-temperature'\nkelvin = 150",
       {{0x4310, 1}, {0x4310, 2}},
       true,
       [](Drive& b) { EXPECT_GT(b.read<std::int32_t>(0x200F), 120); }},
      {"Heat", "kind = 'heat'\nwatts = 40", {{0x4310, 1}, {0x4310, 2}}, true, nullptr, 100_s},
      {"SwitchStuckPressed",
       "kind = 'switch-stuck'\nswitch = 'right'",
       {{0xFF01, 3}},
       false,
       [](Drive& b) {
         b.pass(1_s);
         stands(b);
       }},
      {"BrakeStuckClosed", "kind = 'brake-stuck'", {}, false, pushes},
      {"BrakeDrag", "kind = 'brake-drag'\ntorque = 5", {}, false, pushes},
      {"CurrentNoise",
       "kind = 'current-noise'\nsize = 0.5",
       {},
       false,
       [](Drive& b) {
         runs(b);
         const int ripple = current_ripple(b);
         const auto quiet = b.inject("kind = 'current-noise'\nsize = 0\ndevice = 'drive'");
         EXPECT_GT(ripple, 3 * current_ripple(b));
         b.clear(quiet);
       }},
      {"AnalogNoise",
       "kind = 'analog-noise'\ncounts = 5",
       {},
       false,
       [](Drive& b) {
         b.inject("kind = 'set'\ndevice = 'drive'\ninput = 'analog_input_0'\nvalue = 2");
         const auto [lowest, highest] =
             extremes_of(b, [&b] { return b.read<std::uint32_t>(0x270E, 1); });
         EXPECT_LE(lowest, 2U);
         EXPECT_GE(highest, 4U);
         EXPECT_LE(highest, 7U);
       }},
  };
  return kRows;
}

/// With an encoder that commutates.
const std::vector<SurroundingsRow<EncoderDrive>>& encoder_rows() {
  static const std::vector<SurroundingsRow<EncoderDrive>> kRows{
      {"Glitch",
       "kind = 'encoder-glitch'\ncounts = 200",
       {},
       false,
       [](Drive& b) {
         const int apart = b.read<std::int16_t>(0x2080, 1) - b.read<std::int16_t>(0x2070, 1);
         EXPECT_GT(std::abs(static_cast<std::int16_t>(apart)), 6'000);
       },
       1_s,
       true},
      {"Loss", "kind = 'encoder-loss'", {}, false, pushes, 1_s, true},
      {"LossOfAChannel", "kind = 'encoder-loss'\nchannel = 'a'", {}, false, pushes, 1_s, true},
      {"LossOfTheIndex", "kind = 'encoder-loss'\nchannel = 'index'", {}, false, runs},
      {"Slip", "kind = 'encoder-slip'\nslip = 0.2", {}, false, stands, 1_s, true},
      {"Noise",
       "kind = 'encoder-noise'\ncounts = 20",
       {},
       false,
       [](Drive& b) {
         runs(b);
         b.write<std::int32_t>(0x60FF, 0);
         b.pass(1_s);
         const int ripple = ripple_of(b, [&b] { return b.read<std::int32_t>(0x6064); });
         EXPECT_GT(ripple, 20);
       }},
  };
  return kRows;
}

class Tmcc160Surroundings : public testing::TestWithParam<Row> {};
class Tmcc160EncoderFaults : public testing::TestWithParam<SurroundingsRow<EncoderDrive>> {};

TEST_P(Tmcc160Surroundings, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

TEST_P(Tmcc160EncoderFaults, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, Tmcc160Surroundings, testing::ValuesIn(rows_to_run(rows())),
                         RowName());
INSTANTIATE_TEST_SUITE_P(All, Tmcc160EncoderFaults, testing::ValuesIn(rows_to_run(encoder_rows())),
                         RowName());

}  // namespace

std::vector<CoveredFault> covered_tmcc160() {
  std::vector<CoveredFault> covered = covered_by("tmcc160", rows());
  std::ranges::copy(covered_by("tmcc160", encoder_rows()), std::back_inserter(covered));
  return covered;
}

}  // namespace stator::tests
