// A TMC8461 without a controller and a whole board at its pins, reached by process data alone.

#include "rack/io_board.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

namespace stator::rack {
namespace {

using namespace base::literals;

constexpr std::uint64_t kPwm100KHz = 999U | 7U << 16U | 7U << 20U;
constexpr std::uint64_t kStepsPerSecond3200 = 549'756;
constexpr std::uint64_t kEmergencyEnable = 1U << 23U;
constexpr std::uint64_t kContinuousSteps = 3;

void turn_axis(IoBoard& board) {
  board.put("ENC_CONST", 0x10000);
  board.put("SD_STEPLENGTH", 24);
  board.put("SD_CFG", kContinuousSteps);
  board.put("SD_CH0_STEPRATE", kStepsPerSecond3200);
}

void turn_fan(IoBoard& board) {
  board.put("PWM_CFG", kPwm100KHz);
  board.put("PWM1", 750);
  board.put("PWM2", 250);
}

TEST(IoBoard, StepperTurnsByStepAndDirectionAndTheEncoderCounts) {
  IoBoard board;
  turn_axis(board);
  board.cycles(2000);
  const std::int32_t steps = board.get_signed("SD_CH0_STEPCOUNT");
  EXPECT_NEAR(steps, 6400, 10);
  EXPECT_NEAR(std::abs(board.get_signed("X_ENC")), 8000, 20);
  board.put("SD_CH0_STEPRATE", 0);
  board.cycles(300);
  EXPECT_NEAR(std::abs(board.signal("axis.position")), std::abs(steps) / 3200.0, 0.01);
  EXPECT_EQ(std::abs(board.get_signed("X_ENC")), std::abs(board.signal("encoder.count")));
  // Back again.
  board.put("SD_CH0_STEPRATE", std::uint64_t{0x100000000} - kStepsPerSecond3200);
  board.cycles(2000);
  board.put("SD_CH0_STEPRATE", 0);
  board.cycles(300);
  EXPECT_NEAR(board.signal("axis.position"), 0.0, 0.01);
  EXPECT_LT(std::abs(board.get_signed("X_ENC")), 20);
}

TEST(IoBoard, PwmTurnsTheMotorInBothDirections) {
  IoBoard board;
  turn_fan(board);
  board.cycles(500);
  const double forward = board.signal("fan.speed");
  EXPECT_GT(forward, 3000.0);
  board.put("PWM1", 250);
  board.put("PWM2", 750);
  board.cycles(500);
  EXPECT_NEAR(board.signal("fan.speed"), -forward, 5.0);
}

TEST(IoBoard, SwitchesAreReadAndLampsLit) {
  IoBoard board;
  board.cycles(2);
  EXPECT_EQ(board.get("GPI") & 3U, 0U);
  board.input("door.closed", 1.0);
  board.cycles(3);
  EXPECT_EQ(board.get("GPI") & 3U, 1U);
  board.input("start.press", 1.0);
  board.cycles(3);
  EXPECT_EQ(board.get("GPI") & 3U, 3U);
  board.cycles(300);
  EXPECT_EQ(board.get("GPI") & 3U, 1U) << "a push button opens by itself";
  board.put("GPIO_CONFIG", 3);
  board.put("GPO", 1);
  board.cycles(2);
  EXPECT_EQ(board.signal("lamp.brightness"), 1.0);
  EXPECT_EQ(board.signal("mfc_hv7"), 0.0);
}

TEST(IoBoard, SpiDriverMovesItsMotorAndTheAdcMeasuresTheConverter) {
  IoBoard board;
  board.put("SPI_TIME", 2);
  EXPECT_EQ(board.spi(0, 0xE0080, 20) & 0xFFU, 0x81U) << "it stands";
  board.spi(0, 0x901B4, 20);
  board.spi(0, 0xD001F, 20);
  // Full steps by coil currents: (+,0), (0,+), (-,0), (0,-).
  constexpr std::array<std::uint64_t, 4> kWave{248ULL << 9U, 248, 1ULL << 17U | 248ULL << 9U,
                                               1ULL << 8U | 248};
  for (std::size_t k = 0; k <= 40; ++k) {
    board.spi(0, kWave[k % 4], 20);
    board.cycles(40);
  }
  EXPECT_NEAR(board.signal("driver.position"), 40.0 / 200.0, 0.005);
  board.put("DAC_VAL", 0x8000);
  board.cycles(150);
  EXPECT_NEAR(static_cast<double>(board.spi(1, 0x060000, 24) & 0xFFFU), 2048.0, 4.0);
  board.put("DAC_VAL", 0x1000);
  board.cycles(150);
  EXPECT_NEAR(static_cast<double>(board.spi(1, 0x060000, 24) & 0xFFFU), 256.0, 4.0);
}

TEST(IoBoard, I2cMemoryIsWrittenAndRead) {
  IoBoard board;
  board.put("I2C_TIMEBASE", 10);
  const auto write = [&board](std::initializer_list<unsigned> bytes) {
    EXPECT_EQ(board.i2c(0x20), 0x01U);
    board.put("I2C_ADDRESS", 0xA0);
    EXPECT_EQ(board.i2c(0x08), 0x34U);
    for (const unsigned byte : bytes) {
      board.put("I2C_DATA_W", byte);
      EXPECT_EQ(board.i2c(0x04), 0x30U);
    }
  };
  write({0x12, 0x34, 0xCA, 0xFE});
  board.i2c(0x10);
  board.cycles(6);
  write({0x12, 0x34});
  EXPECT_EQ(board.i2c(0x20), 0x02U);
  board.put("I2C_ADDRESS", 0xA1);
  EXPECT_EQ(board.i2c(0x08), 0x2CU);
  board.i2c(0x02);
  EXPECT_EQ(board.get("I2C_DATA_R"), 0xCAU);
  board.i2c(0x01);
  EXPECT_EQ(board.get("I2C_DATA_R"), 0xFEU);
  EXPECT_EQ(board.i2c(0x10), 0x00U);
  // The thermometer shares the bus: 21.5 degrees are 2Bh half degrees.
  board.i2c(0x20);
  board.put("I2C_ADDRESS", 0x91);
  EXPECT_EQ(board.i2c(0x08), 0x2CU);
  board.i2c(0x02);
  EXPECT_EQ(board.get("I2C_DATA_R"), 0x15U);
  board.i2c(0x01);
  EXPECT_EQ(board.get("I2C_DATA_R"), 0x80U);
  board.i2c(0x10);
}

TEST(IoBoard, EmergencyPutsEveryOutputIntoItsSafeState) {
  IoBoard board;
  turn_axis(board);
  turn_fan(board);
  board.put("GPIO_CONFIG", 3);
  board.put("GPO", 0x0002'0001);  // safe: the valve instead of the lamp
  board.put("MFCIO_IRQ_CFG", kEmergencyEnable);
  board.cycles(500);
  ASSERT_GT(board.signal("fan.speed"), 3000.0);
  ASSERT_EQ(board.signal("lamp.brightness"), 1.0);
  board.input("mfc_nes", 0.0);
  board.cycles(2);
  EXPECT_EQ(board.get("MFCIO_IRQ_FLAGS") & kEmergencyEnable, kEmergencyEnable);
  EXPECT_EQ(board.signal("mfc_irq"), 1.0);
  const std::int32_t frozen = board.get_signed("SD_CH0_STEPCOUNT");
  board.input("mfc_nes", 1.0);
  board.cycles(500);
  EXPECT_EQ(board.get_signed("SD_CH0_STEPCOUNT"), frozen) << "it must be cleared actively";
  EXPECT_EQ(board.signal("lamp.brightness"), 0.0);
  EXPECT_EQ(board.signal("mfc_hv7"), 1.0);
  for (const char* gate : {"mfcio05", "mfcio06", "mfcio07", "mfcio08"}) {
    EXPECT_EQ(board.signal(gate), 0.0) << gate;
  }
  EXPECT_NEAR(board.signal("axis.speed"), 0.0, 1.0);
  EXPECT_LT(board.signal("fan.speed"), 3000.0);
  // Cleared by the master: all goes on.
  board.put("MFCIO_IRQ_CFG", 0);
  board.cycles(2);
  board.put("MFCIO_IRQ_CFG", kEmergencyEnable);
  board.cycles(500);
  EXPECT_NE(board.get_signed("SD_CH0_STEPCOUNT"), frozen);
  EXPECT_EQ(board.signal("lamp.brightness"), 1.0);
  EXPECT_GT(board.signal("fan.speed"), 3000.0);
}

TEST(IoBoard, WatchdogPutsOutputsIntoTheSafeStateWhenTheMasterIsSilent) {
  IoBoard board;
  turn_axis(board);
  turn_fan(board);
  board.put("GPIO_CONFIG", 3);
  board.put("GPO", 1);
  // 10 ms without a frame: gates, STEP and lamp low, the valve on.
  constexpr std::uint64_t kLines = 0xC001F8;
  board.put("WD_OUT_MASK_POL", kLines << 32U | 0x800000);
  board.put("WD_OE_POL", kLines);
  board.put("WD_CFG", 8);
  board.put("WD_TIME", 250'000);
  board.cycles(500);
  ASSERT_EQ(board.signal("lamp.brightness"), 1.0);
  ASSERT_EQ(board.signal("mfc_hv7"), 0.0);
  const double speed = board.signal("fan.speed");
  ASSERT_GT(speed, 3000.0);
  board.silence(11_ms);
  EXPECT_EQ(board.signal("lamp.brightness"), 0.0);
  EXPECT_EQ(board.signal("mfc_hv7"), 1.0);
  board.silence(50_ms);
  const double rest = board.signal("axis.position");
  board.silence(500_ms);
  EXPECT_NEAR(board.signal("axis.position"), rest, 1e-3) << "no step leaves the chip";
  EXPECT_LT(board.signal("fan.speed"), 0.9 * speed);
  // The master is back, and with its first cycle everything goes on.
  board.cycles(500);
  EXPECT_EQ(board.signal("lamp.brightness"), 1.0);
  EXPECT_EQ(board.signal("mfc_hv7"), 0.0);
  EXPECT_NE(board.signal("axis.position"), rest);
  EXPECT_GT(board.get("WD_MAX"), 0U);
}

TEST(IoBoard, LeavingOperationalReleasesEveryOutput) {
  IoBoard board;
  turn_fan(board);
  board.put("GPIO_CONFIG", 3);
  board.put("GPO", 1);
  board.cycles(10);
  ASSERT_EQ(board.signal("lamp.brightness"), 1.0);
  ASSERT_TRUE(board.master.request_state(0, ethercat::AlState::safe_operational));
  EXPECT_EQ(board.signal("mfcio05"), 0.5) << "it floats";
  EXPECT_EQ(board.signal("mfc_hv6"), 0.5);
}

}  // namespace
}  // namespace stator::rack
