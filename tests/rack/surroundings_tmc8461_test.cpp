// What a master sees of faults on the board of a TMC8461, by its process data, and that all is well
// after them: a stepper motor by step and direction with an encoder, a fan, a driver behind SPI, a
// switch.

#include <cmath>

#include "rack/io_board.hpp"
#include "rack/surroundings_rows.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;

constexpr std::uint64_t kContinuousSteps = 3;
constexpr std::uint64_t kStepsPerSecond3200 = 549'756;  ///< one revolution per second
constexpr std::uint64_t kPwm100KHz = 999U | 7U << 16U | 7U << 20U;
constexpr int kCounts = 4'000;  ///< of the encoder, a revolution

class Board : public rack::IoBoard {
 public:
  static constexpr const char* kDevice = "io";

  void start_motion() {
    if (now() > base::SimTime(1_s)) {
      bring_to_operational(1);
    }
    put("ENC_CONST", 0x10000);
    put("SD_STEPLENGTH", 24);
    put("SD_CFG", kContinuousSteps);
    put("SD_CH0_STEPRATE", kStepsPerSecond3200);
    put("PWM_CFG", kPwm100KHz);
    put("PWM1", 750);
    put("PWM2", 250);
    pass(1_s);
  }
  void go_on() { pass(1_s); }
  void pass(base::SimDuration duration) { cycles(static_cast<unsigned>(duration / 1_ms)); }
  std::vector<Told> told() { return {}; }  // it has no mailbox
  bool stopped() { return false; }
  /// Edges in a second.
  int counted(base::SimDuration time = 1_s) {
    const std::int32_t before = get_signed("X_ENC");
    pass(time);
    return std::abs(get_signed("X_ENC") - before);
  }
  /// Edges the encoder is ahead of the steps; they begin together.
  int deviation() {
    return std::abs(get_signed("X_ENC")) - std::abs(get_signed("SD_CH0_STEPCOUNT")) * 5 / 4;
  }
  int stepped() {
    const std::int32_t before = get_signed("SD_CH0_STEPCOUNT");
    pass(1_s);
    return std::abs(get_signed("SD_CH0_STEPCOUNT") - before);
  }
  bool is_healthy() {
    EXPECT_NEAR(counted(), kCounts, 40);
    EXPECT_NEAR(stepped(), 3'200, 10);
    fan_speed_ = fan_speed_ == 0.0 ? signal("fan.speed") : fan_speed_;
    EXPECT_GT(fan_speed_, 3'000.0);
    EXPECT_NEAR(signal("fan.speed"), fan_speed_, 0.02 * fan_speed_);
    EXPECT_EQ(get("GPI") & 1U, 0U);
    put("SPI_TIME", 2);
    EXPECT_EQ(spi(0, 0xE0080, 20) & 6U, 0U) << "the driver is not hot";
    return true;
  }
  /// 1/min, of the sound fan.
  [[nodiscard]] double fan_speed() const { return fan_speed_; }

 private:
  double fan_speed_ = 0.0;
};

/// Which the motor carries with both phases.
constexpr const char* kLoad =
    "kind = 'load-step'\ndevice = 'io'\nperipheral = 'axis'\ntorque = -0.3";

using Row = SurroundingsRow<Board>;

void stands(Board& b) {
  EXPECT_LE(b.counted(), 60);
  EXPECT_NEAR(b.stepped(), 3'200, 10) << "the chip knows nothing of it";
}
void runs(Board& b) {
  EXPECT_NEAR(b.counted(), kCounts, 100);
}
void fan_stands(Board& b) {
  EXPECT_LT(std::abs(b.signal("fan.speed")), 100.0) << "it has no encoder";
  runs(b);
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"MotorStall", "kind = 'motor-stall'\nperipheral = 'axis'", {}, false, stands},
      {"MotorStallOfTheFan", "kind = 'motor-stall'\nperipheral = 'fan'", {}, false, fan_stands},
      {"AxisJammed",
       "kind = 'axis-jammed'\nperipheral = 'axis'\nfrom = -0.1\nto = 0.1",
       {},
       false,
       stands},
      {"FrictionRise",
       "kind = 'friction-rise'\nperipheral = 'axis'\ntorque = 5",
       {},
       false,
       stands},
      {"LoadStep",
       "kind = 'load-step'\nperipheral = 'axis'\ntorque = 3",
       {},
       false,
       [](Board& b) { EXPECT_GT(b.counted(), 2 * kCounts) << "it pulls the motor along"; }},
      {"LoadInertia",
       "kind = 'load-inertia'\nperipheral = 'axis'\ninertia = 0.05",
       {},
       false,
       [](Board& b) {
         b.put("SD_CH0_STEPRATE", std::uint64_t{0x100000000} - kStepsPerSecond3200);
         EXPECT_GT(std::abs(b.counted() - kCounts), kCounts / 10) << "it does not follow";
         b.put("SD_CH0_STEPRATE", kStepsPerSecond3200);
       }},
      {"PhaseLoss",
       "kind = 'phase-loss'\nperipheral = 'axis'\nphase = 'a'",
       {},
       false,
       [](Board& b) {
         const auto load = b.inject(kLoad);
         b.pass(200_ms);
         EXPECT_GT(std::abs(b.counted() - kCounts), kCounts / 2) << "too little torque";
         b.clear(load);
       }},
      {"PhaseLossOfTheFan",
       "kind = 'phase-loss'\nperipheral = 'fan'\nphase = '0'",
       {},
       false,
       fan_stands},
      {"PhaseShort", "kind = 'phase-short'\nperipheral = 'axis'\nphase = 'a'", {}, false, stands},
      {"EncoderGlitch",
       "kind = 'encoder-glitch'\nperipheral = 'encoder'\ncounts = 700",
       {},
       false,
       [](Board& b) {
         runs(b);
         EXPECT_NEAR(std::abs(b.deviation()), 700, 40) << "and it stays";
       }},
      {"EncoderLoss", "kind = 'encoder-loss'\nperipheral = 'encoder'", {}, false, stands},
      {"EncoderLossOfAChannel",
       "kind = 'encoder-loss'\nperipheral = 'encoder'\nchannel = 'a'",
       {},
       false,
       stands},
      {"EncoderLossOfTheIndex",
       "kind = 'encoder-loss'\nperipheral = 'encoder'\nchannel = 'index'",
       {},
       false,
       [](Board& b) {
         runs(b);
         b.put("ENC_MODE", 0x4C);  // active high, whatever A and B, at its rising edge
         b.pass(10_ms);
         bool seen = false;
         for (int n = 0; n < 2'000; ++n) {
           b.pass(1_ms);
           seen = seen || (b.get("ENC_STATUS") & 1U) != 0;
         }
         EXPECT_FALSE(seen) << "N event";
       }},
      {"SupplySag", "kind = 'supply-sag'\nperipheral = 'fan'\nvolts = 24", {}, false, fan_stands},
      {"SupplyOvervoltage",
       "kind = 'supply-overvoltage'\nperipheral = 'fan'\nvolts = 12",
       {},
       false,
       [](Board& b) {
         runs(b);
         EXPECT_GT(b.signal("fan.speed"), 1.3 * b.fan_speed());
       }},
      {"SupplyResistance",
       "kind = 'supply-resistance'\nperipheral = 'fan'\nohms = 20",
       {},
       false,
       [](Board& b) {
         runs(b);
         EXPECT_LT(b.signal("fan.speed"), 0.97 * b.fan_speed());
       }},
      {"OverTemperature",
       "kind = 'over-temperature'\nperipheral = 'driver'\nkelvin = 150",
       {},
       false,
       [](Board& b) {
         b.put("SPI_TIME", 2);
         EXPECT_EQ(b.spi(0, 0xE0080, 20) & 6U, 6U) << "warning and switched off, in its status";
       }},
      {"Heat",
       "kind = 'heat'\nperipheral = 'driver'\nwatts = 100",
       {},
       false,
       [](Board& b) {
         b.put("SPI_TIME", 2);
         EXPECT_EQ(b.spi(0, 0xE0080, 20) & 6U, 6U);
       },
       2_s},
      {"SwitchStuckPressed",
       "kind = 'switch-stuck'\nperipheral = 'door'",
       {},
       false,
       [](Board& b) {
         EXPECT_EQ(b.get("GPI") & 1U, 1U);
         b.input("door.closed", 0.0);
         b.pass(5_ms);
         EXPECT_EQ(b.get("GPI") & 1U, 1U);
       }},
      {"SwitchStuckReleased",
       "kind = 'switch-stuck'\nperipheral = 'door'\nstate = 'released'",
       {},
       false,
       [](Board& b) {
         b.input("door.closed", 1.0);
         b.pass(5_ms);
         EXPECT_EQ(b.get("GPI") & 1U, 0U);
         b.input("door.closed", 0.0);
       }},
  };
  return kRows;
}

class Tmc8461Surroundings : public testing::TestWithParam<Row> {};

TEST_P(Tmc8461Surroundings, AreSeenAndGoAway) {
  expect_seen_and_gone(GetParam());
}

TEST(Tmc8461Board, CarriesALoadWithBothPhasesThatItDoesNotWithOne) {
  Board board;
  board.start_motion();
  board.inject(kLoad);
  board.pass(200_ms);
  runs(board);
}

INSTANTIATE_TEST_SUITE_P(All, Tmc8461Surroundings, testing::ValuesIn(rows_to_run(rows())),
                         RowName());

}  // namespace

std::vector<CoveredFault> covered_tmc8461() {
  return covered_by("tmc8461", rows());
}

}  // namespace stator::tests
