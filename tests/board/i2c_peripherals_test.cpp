// Peripherals on I2C: EEPROM, temperature sensor and port expander, alone and together on one bus.
#include <gtest/gtest.h>

#include "board/bench.hpp"
#include "board/keeper_double.hpp"

namespace stator::board {
namespace {

PeripheralConfiguration on_i2c(const char* name, const PeripheralType& type) {
  return part(name, type, {{"scl", kSclLine}, {"sda", kSdaLine}});
}

TEST(I2cEeprom, ReadsAtTheAddressWrittenBeforeARepeatedStart) {
  Bench bench({on_i2c("eeprom", kI2cEeprom)});
  bench.i2c_start();
  EXPECT_TRUE(bench.i2c_write(0xA0));
  for (const unsigned data : {0x12U, 0x34U, 0xBEU, 0xEFU}) {
    EXPECT_TRUE(bench.i2c_write(static_cast<std::uint8_t>(data)));
  }
  bench.i2c_stop();
  bench.i2c_start();
  EXPECT_FALSE(bench.i2c_write(0xA0)) << "it is busy with programming";
  bench.i2c_stop();
  bench.wait(5_ms);
  bench.i2c_start();
  EXPECT_TRUE(bench.i2c_write(0xA0));
  EXPECT_TRUE(bench.i2c_write(0x12));
  EXPECT_TRUE(bench.i2c_write(0x34));
  bench.i2c_start();
  EXPECT_TRUE(bench.i2c_write(0xA1));
  EXPECT_EQ(bench.i2c_read(true), 0xBE);
  EXPECT_EQ(bench.i2c_read(false), 0xEF);
  bench.i2c_stop();
  EXPECT_EQ(bench.signal("eeprom.writes"), 1.0);
}

TEST(I2cEeprom, DoesNotAcknowledgeUntilItsContentIsKept) {
  Bench bench({on_i2c("eeprom", kI2cEeprom)});
  KeeperDouble keeper(bench.board);
  const auto answers = [&] {
    bench.i2c_start();
    const bool acknowledged = bench.i2c_write(0xA0);
    bench.i2c_stop();
    return acknowledged;
  };
  const auto write = [&](std::uint8_t data) {
    bench.i2c_start();
    for (const unsigned each : {0xA0U, 0x12U, 0x34U, unsigned{data}}) {
      EXPECT_TRUE(bench.i2c_write(static_cast<std::uint8_t>(each)));
    }
    bench.i2c_stop();
  };
  write(0xBE);
  bench.wait(50_ms);
  EXPECT_FALSE(answers());
  keeper.finish(true);
  EXPECT_TRUE(answers());
  write(0x11);
  keeper.finish(false);
  EXPECT_FALSE(answers()) << "as long as the real one is busy";
  bench.wait(5_ms);
  EXPECT_TRUE(answers());
  EXPECT_EQ(keeper.content->content()[0x1234], std::byte{0xBE}) << "the old content";
}

TEST(Board, NamesThePartsThatKeepContent) {
  Bench bench({on_i2c("sensor", kI2cTemperatureSensor), on_i2c("eeprom", kI2cEeprom)});
  const std::vector<KeptPart> parts = bench.board.kept_parts();
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].name, "eeprom");
  EXPECT_EQ(parts[0].content->content().size(), 8192U + 1U);
}

TEST(I2cEeprom, LeavesOtherAddressesAlone) {
  Bench bench({on_i2c("eeprom", kI2cEeprom)});
  bench.i2c_start();
  EXPECT_FALSE(bench.i2c_write(0xA2));
  EXPECT_FALSE(bench.i2c_write(0x00));
  bench.i2c_stop();
}

TEST(I2cBus, CarriesSeveralPeripherals) {
  Bench bench({on_i2c("eeprom", kI2cEeprom), on_i2c("sensor", kI2cTemperatureSensor),
               on_i2c("port", kI2cPortExpander)});
  bench.input("sensor.temperature", 37.5);
  bench.i2c_start();
  EXPECT_TRUE(bench.i2c_write(0x91));
  EXPECT_EQ(bench.i2c_read(true), 37);
  EXPECT_EQ(bench.i2c_read(false), 0x80);
  bench.i2c_stop();
  bench.i2c_start();
  EXPECT_TRUE(bench.i2c_write(0x40));
  EXPECT_TRUE(bench.i2c_write(0x0F));
  bench.i2c_stop();
  EXPECT_EQ(bench.signal("port.p0"), 1.0);
  EXPECT_EQ(bench.signal("port.p7"), 0.0);
  EXPECT_EQ(bench.board.conflicts(), 0U);
}

TEST(TemperatureSensor, CountsHalfKelvinsInTwosComplement) {
  Bench bench({on_i2c("sensor", kI2cTemperatureSensor)});
  bench.input("sensor.temperature", -25.3);
  bench.i2c_start();
  bench.i2c_write(0x91);
  EXPECT_EQ(bench.i2c_read(true), 0xE6);  // -25.5
  EXPECT_EQ(bench.i2c_read(false), 0x80);
  bench.i2c_stop();
}

TEST(TemperatureSensor, PullsOsLowFromTheLimitDownToTheHysteresis) {
  auto sensor = on_i2c("sensor", kI2cTemperatureSensor);
  sensor.wire("os", 9);
  Bench bench({sensor});
  bench.i2c_start();  // limit 40.5
  for (const unsigned data : {0x90U, 0x03U, 40U, 0x80U}) {
    bench.i2c_write(static_cast<std::uint8_t>(data));
  }
  bench.i2c_start();  // hysteresis 30
  for (const unsigned data : {0x90U, 0x02U, 30U, 0x00U}) {
    bench.i2c_write(static_cast<std::uint8_t>(data));
  }
  bench.i2c_stop();
  const auto os_at = [&bench](double celsius) {
    bench.input("sensor.temperature", celsius);
    return bench.pins.level(9);
  };
  EXPECT_TRUE(os_at(40.4));
  EXPECT_FALSE(os_at(40.5));
  EXPECT_FALSE(os_at(30.0));
  EXPECT_TRUE(os_at(29.5));
}

TEST(PortExpander, ReadsLinesThatTheOutsidePullsDown) {
  auto port = on_i2c("port", kI2cPortExpander);
  port.wire("int", 9);
  Bench bench({port});
  EXPECT_TRUE(bench.pins.level(9));
  bench.input("port.p3", 0.0);
  EXPECT_FALSE(bench.pins.level(9)) << "the interrupt tells of a change";
  bench.i2c_start();
  EXPECT_TRUE(bench.i2c_write(0x41));
  EXPECT_EQ(bench.i2c_read(false), 0xF7);
  bench.i2c_stop();
  EXPECT_TRUE(bench.pins.level(9));
}

}  // namespace
}  // namespace stator::board
