// A board at the pins of the chip's I/O block.

#include <gtest/gtest.h>

#include "board/chip.hpp"
#include "board/vcd_file.hpp"

namespace stator::board {
namespace {

using namespace mfc::register_number;
using mfc::Signal;

PeripheralConfiguration on_spi(const char* name, const PeripheralType& type) {
  return part(name, type,
              {{"sck", kSckLine}, {"mosi", kMosiLine}, {"miso", kMisoLine}, {"cs", kCsLine}});
}

TEST(BlockPins, ServesSpiByWordsAndByEdgesAlike) {
  for (const auto* type : {&kSpiAdc, &kSpiEeprom, &kShiftRegister, &kSpiStepperDriver}) {
    Collector collector;
    LogicTrace trace(1U << kMisoLine, {}, 4096, collector.sink());
    Chip by_words(kSpiConnections, {on_spi("it", *type)});
    Chip by_edges(kSpiConnections, {on_spi("it", *type)}, &trace);
    EXPECT_TRUE(by_words.pins.serves(*by_words.board->find("it")->spi()));
    EXPECT_FALSE(by_edges.pins.serves(*by_edges.board->find("it")->spi()));
    std::uint64_t random = 7;
    for (int round = 0; round < 300; ++round) {
      random = random * 6364136223846793005U + 1442695040888963407U;
      const unsigned bits = 1 + static_cast<unsigned>((random >> 40U) % 64);
      const std::uint64_t word = (random ^ (random >> 29U)) >> (64 - bits);
      const bool keep = (random >> 20U) % 4 == 0;
      ASSERT_EQ(by_words.spi(word, bits, keep), by_edges.spi(word, bits, keep))
          << type->name << " round " << round << " bits " << bits;
    }
  }
}

TEST(BlockPins, AdcMeasuresTheSameByWordsAndByEdgesInEveryMode) {
  // A voltage that moves within a datagram, so that codes tell when the sample was taken.
  const auto parts = [] {
    PeripheralConfiguration adc = on_spi("adc", kSpiAdc);
    adc.connect("channel0", "filter");
    adc.connect("channel5", "pot");
    return std::vector<PeripheralConfiguration>{
        part("filter", kRcFilter, {{"line", 7}}, {{"resistance", 1000}, {"capacitance", 10}}),
        part("pot", kPotentiometer, {}, {{"position", 0.3}}), std::move(adc)};
  };
  const std::initializer_list<std::pair<unsigned, Signal>> connections{{kSckLine, Signal::sck},
                                                                       {kMosiLine, Signal::sdo},
                                                                       {kMisoLine, Signal::sdi},
                                                                       {kCsLine, Signal::cs0},
                                                                       {7, Signal::dac0}};
  Collector collector;
  LogicTrace trace(1U << kMisoLine, {}, 4096, collector.sink());
  Chip by_words(connections, parts());
  Chip by_edges(connections, parts(), &trace);
  EXPECT_TRUE(by_words.pins.serves(*by_words.board->find("adc")->spi()));
  EXPECT_FALSE(by_edges.pins.serves(*by_edges.board->find("adc")->spi()));
  std::array<std::uint64_t, 4> measured{};  // by mode, datagrams with a code
  std::uint64_t random = 3;
  for (unsigned round = 0; round < 800; ++round) {
    random = random * 6364136223846793005U + 1442695040888963407U;
    // SCK does not change its rest within a datagram.
    const unsigned mode = round / 8 % 4;
    const unsigned time = static_cast<unsigned>((random >> 50U) % 40);
    const bool lsb_first = (random >> 47U) % 8 == 0;
    const bool keep = mode != 2 && round % 8 != 7 && (random >> 43U) % 4 == 0;
    // Start, single or pair, channel 0, 1, 4 or 5, behind 0 to 7 zeros; then as many clocks as
    // come.
    const unsigned bits = 18 + static_cast<unsigned>((random >> 37U) % 24);
    const std::uint64_t header = 0x10U | ((random >> 30U) & 0xDU);
    const std::uint64_t word = header << (bits - 5 - (random >> 33U) % 8);
    const unsigned dac = static_cast<unsigned>(random >> 14U) & 0xFFFFU;
    const auto transfer = [&](Chip& chip) {
      chip.set(kDacVal, dac);
      chip.set(kSpiTime, time);
      chip.set(kSpiLength, bits - 1);
      chip.set(kSpiConf, (keep ? 8U : 0U) | (lsb_first ? 0x10U : 0U) |
                             (mode % 2 == 1 ? 0x20U : 0U) | (mode >= 2 ? 0x40U : 0U));
      chip.set(kSpiTxData, word);
      chip.wait(base::SimDuration(80 * (2 + std::int64_t{time}) * (bits + 2)));
      EXPECT_EQ(chip.get(kSpiStatus) & 1U, 1U) << "complete";
      return chip.get(kSpiRxData) & ((std::uint64_t{1} << bits) - 1);
    };
    const std::uint64_t expected = transfer(by_edges);
    ASSERT_EQ(transfer(by_words), expected)
        << "round " << round << " mode " << mode << " bits " << bits << " LSB first " << lsb_first;
    ASSERT_EQ(by_words.signal("adc.code"), by_edges.signal("adc.code")) << "round " << round;
    measured[mode] += expected != 0 ? 1U : 0U;
  }
  for (const std::uint64_t datagrams : measured) {
    EXPECT_GT(datagrams, 50U) << "the comparison is of codes and not of nothing";
  }
}

TEST(BlockPins, ClocksASlaveFromGeneralPurposeOutputs) {
  // The lines carry GPO0..2 and GPI0: the host makes the edges.
  Chip chip({{kSckLine, Signal::gpo0},
             {kMosiLine, Signal::gpo1},
             {kCsLine, Signal::gpo2},
             {kMisoLine, Signal::gpi0}},
            {on_spi("chain", kShiftRegister)});
  EXPECT_FALSE(chip.pins.serves(*chip.board->find("chain")->spi()));
  chip.set(kGpioConfig, 7);
  chip.set(kGpo, 4);
  const auto send = [&chip](unsigned byte) {
    unsigned received = 0;
    chip.set(kGpo, 0);
    for (unsigned k = 8; k-- > 0;) {
      const unsigned bit = (byte >> k) & 1U;
      chip.set(kGpo, bit << 1U);
      chip.wait(1_us);
      received = received << 1U | static_cast<unsigned>(chip.get(kGpi) & 1U);
      chip.set(kGpo, bit << 1U | 1U);
      chip.wait(1_us);
      chip.set(kGpo, bit << 1U);
    }
    chip.set(kGpo, 4);
    chip.wait(1_us);
    return received;
  };
  EXPECT_EQ(send(0xA5), 0x00U);
  EXPECT_EQ(send(0x3C), 0xA5U);
  EXPECT_EQ(chip.signal("chain.output2"), 1.0);
  EXPECT_EQ(chip.signal("chain.output0"), 0.0);
}

TEST(BlockPins, ReadsTheMemoryOfTheDocumentsExample) {
  Chip chip({{kSclLine, Signal::scl}, {kSdaLine, Signal::sda}},
            {part("eeprom", kI2cEeprom, {{"scl", kSclLine}, {"sda", kSdaLine}})});
  chip.set(kI2cTimebase, 1);
  const auto write = [&chip](std::initializer_list<unsigned> bytes) {
    EXPECT_EQ(chip.i2c(0x20), 0x01U);
    chip.set(kI2cAddress, 0xA0);
    EXPECT_EQ(chip.i2c(0x08), 0x34U);
    for (const unsigned byte : bytes) {
      chip.set(kI2cDataW, byte);
      EXPECT_EQ(chip.i2c(0x04), 0x30U);
    }
  };
  write({0x12, 0x34, 0xCA, 0xFE});
  chip.i2c(0x10);
  chip.wait(6_ms);
  write({0x12, 0x34});
  EXPECT_EQ(chip.i2c(0x20), 0x02U);
  chip.set(kI2cAddress, 0xA1);
  EXPECT_EQ(chip.i2c(0x08), 0x2CU);
  chip.i2c(0x02);
  EXPECT_EQ(chip.get(kI2cDataR) & 0xFFU, 0xCAU);
  chip.i2c(0x01);
  EXPECT_EQ(chip.get(kI2cDataR) & 0xFFU, 0xFEU);
  EXPECT_EQ(chip.i2c(0x10), 0x00U);
}

TEST(BlockPins, StepMotorAndEncoderUnitAgree) {
  Chip chip({{8, Signal::s0}, {9, Signal::d0}, {10, Signal::a}, {11, Signal::b}, {12, Signal::n}},
            {part("motor", kStepDirMotor, {{"step", 8}, {"dir", 9}}, {{"microsteps", 16}}),
             part("encoder", kEncoder, {{"a", 10}, {"b", 11}, {"n", 12}},
                  {{"counts_per_revolution", 4000}}, {{"shaft", "motor"}})});
  chip.set(kSdSteplength, 24);
  chip.set(kSdCfg, 1);  // finite
  chip.set(kSdCh0Steptarget, 6400);
  chip.set(kSdCh0Steprate, 549'756);  // 3200 steps per second
  chip.wait(2'300_ms);
  EXPECT_EQ(chip.get(kSdCh0Stepcount) & 0xFFFFFFFFU, 6400U);
  EXPECT_EQ(chip.signal("motor.steps"), 6400.0);
  EXPECT_NEAR(chip.signal("motor.position"), 2.0, 0.001);
  const auto counted = static_cast<std::int32_t>(chip.get(kPositionRead));
  EXPECT_NEAR(std::abs(counted), 8000, 4);
  EXPECT_EQ(std::abs(counted), static_cast<std::int32_t>(chip.signal("encoder.count")));
}

TEST(BlockPins, PwmTurnsAMotorInBothDirections) {
  Chip chip({{16, Signal::hs0}, {17, Signal::ls0}, {18, Signal::hs1}, {19, Signal::ls1}},
            {part("motor", kBridgeMotor,
                  {{"a_high", 16}, {"a_low", 17}, {"b_high", 18}, {"b_low", 19}})});
  chip.set(kPwmCfg, 999U | 7U << 16U | 7U << 20U);
  chip.set(kPwm1, 750);
  chip.set(kPwm2, 250);
  chip.wait(500_ms);
  const double forward = chip.signal("motor.speed");
  EXPECT_NEAR(forward, 3240.0, 60.0);
  chip.set(kPwm1, 250);
  chip.set(kPwm2, 750);
  chip.wait(500_ms);
  EXPECT_NEAR(chip.signal("motor.speed"), -forward, 1.0);
  // Emergency: the gates are off, the motor coasts down.
  chip.set(kMfcioIrqCfg, 1U << 23U);
  chip.block.set_emergency_pin(false);
  chip.wait(20'000_ms);
  EXPECT_EQ(chip.signal("motor.speed"), 0.0);
}

TEST(BlockPins, ConverterAndFilterMakeAVoltageForTheAdc) {
  Chip chip({{kSckLine, Signal::sck},
             {kMosiLine, Signal::sdo},
             {kMisoLine, Signal::sdi},
             {kCsLine, Signal::cs0},
             {7, Signal::dac0}},
            {part("filter", kRcFilter, {{"line", 7}}, {{"resistance", 1000}, {"capacitance", 100}}),
             part("adc", kSpiAdc,
                  {{"sck", kSckLine}, {"mosi", kMosiLine}, {"miso", kMisoLine}, {"cs", kCsLine}},
                  {}, {{"channel0", "filter"}})});
  chip.set(kDacVal, 0x8000);
  chip.wait(5_ms);
  EXPECT_NEAR(chip.signal("filter.voltage"), 1.65, 1e-6);
  EXPECT_EQ(chip.spi(0x060000, 24) & 0xFFFU, 2048U);
  chip.set(kDacVal, 0x1000);
  chip.wait(5_ms);
  EXPECT_EQ(chip.spi(0x060000, 24) & 0xFFFU, 256U);
}

TEST(BlockPins, ShortAtAHighVoltagePinReachesItsStatus) {
  Chip chip({{16, Signal::gpo0}}, {part("valve", kLoad, {{"line", 16}})});
  chip.set(kGpioConfig, 1);
  chip.set(kGpo, 1);
  chip.wait(1_ms);
  EXPECT_EQ(chip.get(kHvAnaStatus) & 0xFFFF00U, 0U);
  chip.input("valve.short", 1.0);
  chip.wait(1_ms);
  EXPECT_NE(chip.get(kHvAnaStatus) & 0x00FF00U, 0U);
}

TEST(BlockPins, SwitchReachesTheInputRegister) {
  Chip chip({{6, Signal::gpi4}}, {part("s", kSwitch, {{"line", 6}}, {{"bounce_time", 500}})});
  EXPECT_EQ(chip.get(kGpi) & 0x10U, 0U);
  chip.input("s.closed", 1.0);
  chip.wait(1_ms);
  EXPECT_EQ(chip.get(kGpi) & 0x10U, 0x10U);
}

TEST(BlockPins, IdleBoardHasNothingToDo) {
  Chip chip({{8, Signal::s0}, {9, Signal::d0}, {16, Signal::hs0}, {7, Signal::dac0}},
            {part("motor", kStepDirMotor, {{"step", 8}, {"dir", 9}}),
             part("led", kLed, {{"line", 16}}), part("filter", kRcFilter, {{"line", 7}})});
  chip.set(kPwmCfg, 999U | 7U << 16U);
  chip.set(kPwm1, 500);
  chip.set(kDacVal, 1234);
  chip.wait(2'000_ms);
  EXPECT_EQ(chip.board->next_event(), base::SimTime::never());
  EXPECT_DOUBLE_EQ(chip.signal("led.brightness"), 0.5);
}

}  // namespace
}  // namespace stator::board
