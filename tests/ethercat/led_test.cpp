#include "stator/ethercat/units/led.hpp"

#include <string>

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_ms;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;

/// A character for each 50 ms, sampled in the middle.
std::string pattern(LedCode code, unsigned samples) {
  std::string shown;
  for (unsigned i = 0; i < samples; ++i) {
    shown += led_lit(code, 25_ms + 50_ms * i) ? '#' : '.';
  }
  return shown;
}

TEST(LedPatterns, AreThoseOfTheIndicatorSpecification) {
  EXPECT_EQ(pattern(LedCode::off, 8), "........");
  EXPECT_EQ(pattern(LedCode::on, 8), "########");
  EXPECT_EQ(pattern(LedCode::flickering, 8), "#.#.#.#.");
  EXPECT_EQ(pattern(LedCode::blinking, 16), "####....####....");
  EXPECT_EQ(pattern(LedCode::single_flash, 28), "####" + std::string(20, '.') + "####");
  EXPECT_EQ(pattern(LedCode::double_flash, 36), "####....####" + std::string(20, '.') + "####");
  EXPECT_EQ(pattern(static_cast<LedCode>(3), 40), "####....####....####" + std::string(20, '.'));
}

TEST(LedPatterns, FlashAsOftenAsTheirCodeSaysAndThenPauseForASecond) {
  for (unsigned code = 1; code <= 12; ++code) {
    std::string train;
    for (unsigned flash = 0; flash < code; ++flash) {
      train += flash == 0 ? "####" : "....####";  // 200 ms on, 200 ms off
    }
    train += std::string(20, '.');
    EXPECT_EQ(pattern(static_cast<LedCode>(code), static_cast<unsigned>(2 * train.size())),
              train + train)
        << "code " << code;
  }
}

TEST(Leds, ErrorLedShowsEachCodeThatIsWrittenToIt) {
  TestBus bus;
  for (unsigned code = 0; code <= 15; ++code) {
    bus.write(0, 0x0139, bytes({0x10 | code}));
    EXPECT_EQ(number(bus.read(0, 0x0139, 1).data), 0x10 | code);
    EXPECT_EQ(static_cast<unsigned>(bus.slave().error_led()), code);
    EXPECT_EQ(bus.slave().run_led(), LedCode::off) << "the other LED stays, code " << code;
    host_write(bus.slave(), 0x0139, bytes({0x10 | (15 - code)}));
    EXPECT_EQ(static_cast<unsigned>(bus.slave().error_led()), 15 - code) << "the host may, too";
  }
  bus.write(0, 0x0139, bytes({0x0C}));
  EXPECT_EQ(bus.slave().error_led(), LedCode::off) << "without bit 4 the state counts again";
}

TEST(Leds, RunLedFollowsTheState) {
  TestBus bus;
  const std::pair<unsigned, unsigned> kStates[] = {{1, 0}, {2, 13}, {3, 14}, {4, 1}, {8, 15}};
  for (const auto& [state, code] : kStates) {
    host_write(bus.slave(), 0x0130, bytes({state, 0}));
    EXPECT_EQ(number(bus.read(0, 0x0138, 1).data), code) << "state " << state;
    EXPECT_EQ(static_cast<unsigned>(bus.slave().run_led()), code) << "state " << state;
  }
}

TEST(Leds, Override_HoldsUntilTheStateChanges) {
  TestBus bus;
  EXPECT_EQ(bus.write(0, 0x0138, bytes({0xFF})).working_counter, 1U);
  EXPECT_EQ(number(host_read(bus.slave(), 0x0138, 1)), 0x1FU);
  EXPECT_EQ(bus.slave().run_led(), LedCode::on);
  host_write(bus.slave(), 0x0130, bytes({2, 0}));
  EXPECT_EQ(number(bus.read(0, 0x0138, 1).data), 13U);
  host_write(bus.slave(), 0x0138, bytes({0x12}));
  EXPECT_EQ(bus.slave().run_led(), LedCode::double_flash) << "the host may override too";
}

TEST(Leds, ErrorOverride_HoldsUntilANewError) {
  TestBus bus;
  bus.write(0, 0x0139, bytes({0x1E}));
  host_write(bus.slave(), 0x0130, bytes({2, 0}));
  EXPECT_EQ(number(bus.read(0, 0x0139, 1).data), 0x1EU) << "a state change is no error";
  host_write(bus.slave(), 0x0134, bytes({0x1B, 0}));
  host_write(bus.slave(), 0x0130, bytes({0x12, 0}));
  EXPECT_EQ(number(bus.read(0, 0x0139, 1).data), 2U) << "double flash: watchdog";
  host_write(bus.slave(), 0x0134, bytes({0x1D, 0}));
  EXPECT_EQ(bus.slave().error_led(), LedCode::blinking) << "wrong output configuration";
  host_write(bus.slave(), 0x0134, bytes({0x01, 0}));
  EXPECT_EQ(bus.slave().error_led(), LedCode::single_flash) << "unspecified, by the device";
  host_write(bus.slave(), 0x0130, bytes({0x02, 0}));
  EXPECT_EQ(bus.slave().error_led(), LedCode::off);
}

TEST(Leds, DeadHostAndMissingEepromShowOnTheErrorLed) {
  TestBus bus;
  bus.write(0, 0x0139, bytes({0x11}));
  bus.slave().set_host_polling(false);
  bus.wait(150_ms);
  EXPECT_EQ(number(bus.read(0, 0x0139, 1).data), 15U) << "and the override is over";
  const SlaveController bare{SlaveControllerConfiguration{}};
  EXPECT_EQ(bare.error_led(), LedCode::flickering);
}

TEST(Leds, ReadThroughAnFmmu_ShowTheLightToo) {
  TestBus bus;
  host_write(bus.slave(), 0x0130, bytes({2, 0}));
  bus.set_fmmu(0, 0, {.logical = 0, .length = 1, .physical = 0x0138, .type = 1});
  EXPECT_EQ(number(bus.transfer(Command::lrd, 0, testing::zeros(1)).data), 13U);
}

}  // namespace
}  // namespace stator::ethercat
