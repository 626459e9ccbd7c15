// What a host sees of faults around a TMCM-142, by telegrams, and that all is well after them. The
// module turns right at 102,400 pulses per second.

#include <algorithm>

#include "rack/surroundings_rows.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using enum devices::tmcm_142::AxisParameter;

constexpr const char* kRack = R"(
[[device]]
type = "tmcm-142"
name = "drive"
rs485 = "pty:field"
writable_encoder_position = true
[device.axis]
left_switch.pressed_to = -1e4
right_switch.pressed_from = 1e4
home_switch.pressed_from = 1e4
)";

constexpr std::int32_t kSpeed = 102'400;  ///< half a revolution per second
constexpr std::int32_t kDriverError = 1;  // bits of parameter 26
constexpr std::int32_t kPrewarning = 2;
constexpr std::int32_t kDeviation = 2;  // bit of parameter 207

class Module : public TmclModuleBench {
 public:
  Module() : TmclModuleBench(kRack) {}

  void start_motion() {
    pass(500_ms);
    set(unit_conversion_mode, 1);
    set(encoder_constant, 335'544);  // 5.12 microsteps
    set(maximum_encoder_deviation, 20'000);
    turn();
  }
  /// The host gives both positions the same value and goes on.
  void go_on() {
    static_cast<void>(get(error_flags));
    execute(Command::motor_stop, 0);
    pass(500_ms);
    set(encoder_position, 0);
    set(actual_position, 0);
    turn();
  }
  void turn(std::int32_t speed = kSpeed) {
    EXPECT_EQ(execute(Command::rotate_right, 0, speed).status, tmcl::Status::success);
    pass(1_s);
  }
  std::vector<Told> told() { return {}; }  // nothing comes unasked
  bool stopped() { return get(actual_speed) == 0; }
  bool is_healthy() {
    const std::int32_t before = get(encoder_position);
    const double shaft = signal("drive.axis0.shaft_position");
    pass(2_s);
    // An answer takes some more milliseconds.
    EXPECT_NEAR(get(encoder_position) - before, 2 * kSpeed, 10'000);
    EXPECT_NEAR(signal("drive.axis0.shaft_position") - shaft, 1.0, 0.05);
    EXPECT_EQ(get(driver_status), 0);
    EXPECT_EQ(get(error_flags), 0);
    return get(actual_speed) == kSpeed;
  }
  void set(devices::tmcm_142::AxisParameter parameter, std::int64_t value) {
    set_parameter(static_cast<int>(parameter), value);
  }
  std::int32_t get(devices::tmcm_142::AxisParameter parameter) {
    return this->parameter(static_cast<int>(parameter));
  }
};

using Row = SurroundingsRow<Module>;

template <std::int32_t status>
void has_driver_status(Module& b) {
  EXPECT_EQ(b.get(driver_status), status);
}
/// It has stopped by itself, and says so once.
void has_deviated(Module& b) {
  EXPECT_EQ(b.get(error_flags) & kDeviation, kDeviation);
  EXPECT_EQ(b.get(error_flags), 0) << "cleared by reading";
  has_driver_status<0>(b);
}
/// The stage was off: the counter has stopped, and what the shaft does then is no deviation.
void has_stopped(Module& b) {
  EXPECT_TRUE(b.stopped());
  EXPECT_EQ(b.get(error_flags), 0);
}
/// The power stage is off.
void has_failed(Module& b) {
  EXPECT_EQ(b.get(driver_status) & kDriverError, kDriverError);
  has_stopped(b);
  EXPECT_NEAR(b.get(actual_position), b.get(encoder_position), 20'000);
}
void runs(Module& b) {
  EXPECT_EQ(b.get(actual_speed), kSpeed);
  EXPECT_EQ(b.get(error_flags), 0);
  has_driver_status<0>(b);
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"MotorStall", "kind = 'motor-stall'", {}, true, has_deviated},
      {"AxisJammed", "kind = 'axis-jammed'\nfrom = 0\nto = 1", {}, true, has_deviated},
      {"FrictionRise", "kind = 'friction-rise'\ntorque = 8", {}, true, has_deviated},
      {"LoadStep", "kind = 'load-step'\ntorque = -5", {}, true, has_deviated},
      {"LoadInertia",
       "kind = 'load-inertia'\ninertia = 0.2",
       {},
       false,
       [](Module& b) {
         runs(b);
         b.execute(Command::rotate_left, 0, kSpeed);
         b.pass(1_s);
         has_deviated(b);  // the ramp is too steep now
       }},
      {"PhaseLoss", "kind = 'phase-loss'\nphase = 'a'", {}, true, has_deviated},
      {"PhaseShortA", "kind = 'phase-short'\nphase = 'a'", {}, true, has_failed},
      {"PhaseShortHighSide", "kind = 'phase-short'\nphase = 'high-side'", {}, true, has_failed},
      {"EncoderGlitch", "kind = 'encoder-glitch'\ncounts = -5000", {}, true, has_deviated},
      {"EncoderLoss", "kind = 'encoder-loss'", {}, true, has_deviated},
      {"EncoderLossOfAChannel", "kind = 'encoder-loss'\nchannel = 'b'", {}, true, has_deviated},
      {"EncoderLossOfTheIndex",
       "kind = 'encoder-loss'\nchannel = 'index'",
       {},
       false,
       [](Module& b) {
         runs(b);
         b.set(encoder_mode, 0x48 | 0x04);  // active high, whatever A and B, at its rising edge
         b.get(encoder_status);
         b.pass(5_s);
         EXPECT_EQ(b.get(encoder_status), 0) << "no null event";
         b.set(encoder_mode, 0);
       }},
      {"EncoderSlip", "kind = 'encoder-slip'\nslip = 0.5", {}, true, has_deviated},
      {"EncoderNoise",
       "kind = 'encoder-noise'\ncounts = 100",
       {},
       false,
       [](Module& b) {
         runs(b);
         b.execute(Command::motor_stop, 0);
         b.pass(1_s);
         const auto [lowest, highest] = extremes_of(b, [&b] { return b.get(encoder_position); });
         EXPECT_GT(highest - lowest, 500) << "microsteps at rest; 1 count is 5.12";
         EXPECT_LE(highest - lowest, 1'030);
       }},
      {"SupplySag", "kind = 'supply-sag'\nvolts = 15", {}, true, has_failed},
      {"SupplyOvervoltage", "kind = 'supply-overvoltage'\nvolts = 60", {}, true, has_failed},
      // The stage goes off and on with what is left of the supply.
      {"SupplyResistance", "kind = 'supply-resistance'\nohms = 100", {}, true, has_stopped},
      {"OverTemperature",
       "kind = 'over-temperature'\nkelvin = 105",
       {},
       false,
       has_driver_status<kPrewarning>},
      {"OverTemperatureThatSwitchesOff",
       "kind = 'over-temperature'\nkelvin = 150",
       {},
       true,
       has_failed},
      {"Heat", "kind = 'heat'\nwatts = 20", {}, true, has_failed, 200_s},
      {"SwitchStuckPressed",
       "kind = 'switch-stuck'\nswitch = 'right'",
       {},
       true,
       [](Module& b) {
         EXPECT_EQ(b.get(right_limit_switch_status), 1);
         b.turn();
         EXPECT_TRUE(b.stopped()) << "refused";
         EXPECT_EQ(b.get(error_flags), 0);
       }},
      {"AnalogNoise",
       "kind = 'analog-noise'\ncounts = 5",
       {},
       false,
       [](Module& b) {
         b.inject("kind = 'set'\ndevice = 'drive'\ninput = 'input0'\nvalue = 2.5");
         b.pass(10_ms);
         const auto [lowest, highest] =
             extremes_of(b, [&b] { return b.execute(Command::get_input, 0, 0, 1).value; });
         EXPECT_GE(lowest, 507);
         EXPECT_LE(highest, 517);
         EXPECT_GE(highest - lowest, 6);
       }},
  };
  return kRows;
}

class Tmcm142Surroundings : public testing::TestWithParam<Row> {};

TEST_P(Tmcm142Surroundings, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

INSTANTIATE_TEST_SUITE_P(All, Tmcm142Surroundings, testing::ValuesIn(rows_to_run(rows())),
                         RowName());

}  // namespace

std::vector<CoveredFault> covered_tmcm_142() {
  return covered_by("tmcm-142", rows());
}

}  // namespace stator::tests
