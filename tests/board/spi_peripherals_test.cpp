// Peripherals on SPI: ADC, DAC, EEPROM and shift register, by edges of the lines and by whole
// words.
#include <gtest/gtest.h>

#include "board/bench.hpp"
#include "board/keeper_double.hpp"

namespace stator::board {
namespace {

PeripheralConfiguration on_spi(
    const char* name, const PeripheralType& type,
    std::initializer_list<std::pair<const char*, double>> numbers = {},
    std::initializer_list<std::pair<const char*, const char*>> connections = {}) {
  return part(name, type,
              {{"sck", kSckLine}, {"mosi", kMosiLine}, {"miso", kMisoLine}, {"cs", kCsLine}},
              numbers, connections);
}

TEST(SpiAdc, AnswersInTheThreeBytesOfItsDataSheet) {
  Bench bench({on_spi("adc", kSpiAdc, {{"reference_voltage", 4.096}})});
  bench.input("adc.channel5", 1.234);
  // Five zeros, start, single, channel 5; null bit and code in the last 13 bits.
  EXPECT_EQ(bench.spi(0x07'40'00, 24) & 0x1FFFU, 1234U);
  EXPECT_EQ(bench.signal("adc.code"), 1234.0);
}

TEST(SpiAdc, MeasuresPairsAndClipsAtBothEnds) {
  Bench bench({on_spi("adc", kSpiAdc, {{"reference_voltage", 4.096}})});
  bench.input("adc.channel0", 1.0);
  bench.input("adc.channel1", 3.0);
  EXPECT_EQ(bench.spi(0x04'00'00, 24) & 0x1FFFU, 0U);     // 0 against 1
  EXPECT_EQ(bench.spi(0x04'40'00, 24) & 0x1FFFU, 2000U);  // 1 against 0
  bench.input("adc.channel1", 9.0);
  EXPECT_EQ(bench.spi(0x06'40'00, 24) & 0x1FFFU, 4095U);
}

TEST(SpiAdc, RepeatsTheCodeUpwardsWithFurtherClocks) {
  Bench bench({on_spi("adc", kSpiAdc, {{"reference_voltage", 4.096}})});
  bench.input("adc.channel0", 2.565);  // A05h: 1010 0000 0101
  // Behind B0 come B1..B11: 0 1 0 0 0 0 0 0 1 0 1, then zeros.
  EXPECT_EQ(bench.spi(std::uint64_t{0x060000} << 16U, 40) & 0xFFFFU, 0b0100000010100000U);
}

TEST(SpiAdc, MeasuresAPotentiometer) {
  Bench bench({part("pot", kPotentiometer, {}, {{"position", 0.25}}),
               on_spi("adc", kSpiAdc, {}, {{"channel2", "pot"}})});
  EXPECT_EQ(bench.spi(0x06'80'00, 24) & 0x1FFFU, 1024U);
  bench.input("pot.position", 0.75);
  EXPECT_EQ(bench.spi(0x06'80'00, 24) & 0x1FFFU, 3072U);
}

PeripheralConfiguration dac(std::initializer_list<std::pair<const char*, unsigned>> more = {}) {
  auto result = part("dac", kSpiDac, {{"sck", kSckLine}, {"mosi", kMosiLine}, {"cs", kCsLine}});
  for (const auto& [pin, line] : more) {
    result.wire(pin, line);
  }
  return result;
}

TEST(SpiDac, SetsItsOutputsWhenCsRises) {
  Bench bench({dac()});
  bench.spi(0x3400, 16);  // A, gain 1, active, 400h of 1000h
  bench.spi(0x9C00, 16);  // B, gain 2, active, C00h: 3.072 V
  EXPECT_DOUBLE_EQ(bench.signal("dac.voltage_a"), 0.512);
  EXPECT_DOUBLE_EQ(bench.signal("dac.voltage_b"), 3.072);
  bench.spi(0x2400, 16);  // A shut down
  EXPECT_DOUBLE_EQ(bench.signal("dac.voltage_a"), 0.0);
}

TEST(SpiDac, IgnoresDatagramsOfAnotherLength) {
  Bench bench({dac()});
  bench.spi(0x3400, 16);
  bench.spi(0x3FFF >> 1U, 15);
  bench.spi(0x3FFFU << 1U, 17);
  EXPECT_DOUBLE_EQ(bench.signal("dac.voltage_a"), 0.512);
}

TEST(SpiDac, WaitsForLdac) {
  Bench bench({dac({{"ldac", 9}})});
  bench.set(9, true);
  bench.spi(0x3400, 16);
  EXPECT_DOUBLE_EQ(bench.signal("dac.voltage_a"), 0.0);
  bench.set(9, false);
  EXPECT_DOUBLE_EQ(bench.signal("dac.voltage_a"), 0.512);
}

TEST(SpiEeprom, WritesAPageAndReadsItBack) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  bench.spi(0x06, 8);
  EXPECT_EQ(bench.spi(0x0500, 16) & 0xFFU, 0x02U);  // write enabled
  bench.spi(0x02'1234'CAFE, 40);
  EXPECT_EQ(bench.spi(0x0500, 16) & 0xFFU, 0x01U);         // in progress, enable used up
  EXPECT_EQ(bench.spi(0x03'1234'0000, 40) & 0xFFFFU, 0U);  // ignored while busy: not driven
  bench.wait(5_ms);
  EXPECT_EQ(bench.spi(0x0500, 16) & 0xFFU, 0x00U);
  EXPECT_EQ(bench.spi(0x03'1234'0000, 40) & 0xFFFFU, 0xCAFEU);
}

TEST(SpiEeprom, WrapsWithinThePage) {
  Bench bench({on_spi("eeprom", kSpiEeprom, {{"write_time", 0}})});
  bench.spi(0x06, 8);
  bench.spi(0x02'003F'1122, 40);
  EXPECT_EQ(bench.spi(0x03'003F'00, 32) & 0xFFU, 0x11U);
  EXPECT_EQ(bench.spi(0x03'0000'00, 32) & 0xFFU, 0x22U);
}

TEST(SpiEeprom, RefusesWritesThatAreNotEnabledProtectedOrIncomplete) {
  Bench bench({on_spi("eeprom", kSpiEeprom, {{"write_time", 0}})});
  bench.spi(0x02'0010'55, 32);
  EXPECT_EQ(bench.spi(0x03'0010'00, 32) & 0xFFU, 0xFFU);
  bench.spi(0x06, 8);
  bench.spi(0x02'0010'55ULL << 3U, 35);  // CS rises within a byte
  EXPECT_EQ(bench.spi(0x03'0010'00, 32) & 0xFFU, 0xFFU);
  bench.spi(0x01'0C, 16);  // protect all; still enabled
  bench.spi(0x06, 8);
  bench.spi(0x02'0010'55, 32);
  EXPECT_EQ(bench.spi(0x03'0010'00, 32) & 0xFFU, 0xFFU);
  EXPECT_EQ(bench.signal("eeprom.writes"), 1.0);
}

void write_cafe(Bench& bench) {
  bench.spi(0x06, 8);
  bench.spi(0x02'1234'CAFE, 40);
}

unsigned status(Bench& bench) {
  return bench.spi(0x0500, 16) & 0xFFU;
}

unsigned read_word(Bench& bench) {
  return bench.spi(0x03'1234'0000, 40) & 0xFFFFU;
}

TEST(SpiEeprom, IsBusyUntilItsContentIsKept) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  KeeperDouble keeper(bench.board);
  write_cafe(bench);
  EXPECT_EQ(keeper.orders, 1);
  bench.wait(50_ms);
  EXPECT_EQ(status(bench), 0x01U);
  EXPECT_EQ(read_word(bench), 0U) << "ignored while busy";
  EXPECT_EQ(keeper.content->content()[0x1234], std::byte{0xFF}) << "not yet";
  keeper.finish(true);
  EXPECT_EQ(status(bench), 0x00U);
  EXPECT_EQ(read_word(bench), 0xCAFEU);
  EXPECT_EQ(keeper.kept[0x1234], std::byte{0xCA});
  EXPECT_EQ(keeper.content->content()[0x1234], std::byte{0xCA});
}

TEST(SpiEeprom, IsBusyForItsWriteTimeHoweverQuickItIsKept) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  KeeperDouble keeper(bench.board);
  write_cafe(bench);
  keeper.finish(true);
  bench.wait(4_ms);
  EXPECT_EQ(status(bench), 0x01U);
  bench.wait(1_ms);
  EXPECT_EQ(status(bench), 0x00U);
}

TEST(SpiEeprom, HasItsOldContentWhereTheNewOneCannotBeKept) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  KeeperDouble keeper(bench.board);
  write_cafe(bench);
  keeper.finish(true);
  bench.wait(5_ms);
  bench.spi(0x06, 8);
  bench.spi(0x02'1234'1111, 40);
  keeper.finish(false);
  bench.wait(5_ms);
  EXPECT_EQ(read_word(bench), 0xCAFEU);
  bench.spi(0x06, 8);
  bench.spi(0x02'1234'2222, 40);
  keeper.finish(true);
  bench.wait(5_ms);
  EXPECT_EQ(read_word(bench), 0x2222U) << "and takes another one";
}

TEST(SpiEeprom, KeepsItsProtectionWithItsCells) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  KeeperDouble keeper(bench.board);
  write_cafe(bench);
  keeper.finish(true);
  bench.wait(5_ms);
  bench.spi(0x06, 8);
  bench.spi(0x01'0C, 16);
  keeper.finish(true);
  bench.wait(5_ms);
  EXPECT_EQ(status(bench), 0x0CU);

  Bench other({on_spi("eeprom", kSpiEeprom)});
  KeptContent* content = other.board.kept_parts().at(0).content;
  EXPECT_FALSE(content->load(std::span(keeper.kept).first(100)));
  EXPECT_TRUE(content->load(keeper.kept));
  EXPECT_EQ(status(other), 0x0CU);
  EXPECT_EQ(read_word(other), 0xCAFEU);
}

TEST(SpiEeprom, ThatIsKeptAtOnceTakesItsWriteTimeOnly) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  KeeperDouble keeper(bench.board);
  keeper.at_once = true;
  write_cafe(bench);
  bench.wait(5_ms);
  EXPECT_EQ(status(bench), 0x00U);
  EXPECT_EQ(read_word(bench), 0xCAFEU);
}

TEST(ShiftRegister, ShowsEightyBitsSentInTwoHalves) {
  Bench bench({on_spi("chain", kShiftRegister, {{"outputs", 80}})});
  bench.select(true);
  bench.clock(0x5555AAAA55, 40);
  EXPECT_EQ(bench.signal("chain.output0"), 0.0);  // nothing before CS rises
  bench.clock(0x55AAAA55AA, 40);
  bench.select(false);
  for (unsigned k = 0; k < 40; ++k) {
    EXPECT_EQ(bench.signal("chain.output" + std::to_string(k)),
              static_cast<double>((0x55AAAA55AAULL >> k) & 1U))
        << k;
    EXPECT_EQ(bench.signal("chain.output" + std::to_string(40 + k)),
              static_cast<double>((0x5555AAAA55ULL >> k) & 1U))
        << k;
  }
}

TEST(ShiftRegister, HandsOnWhatFallsOut) {
  Bench bench({on_spi("chain", kShiftRegister, {{"outputs", 8}})});
  bench.spi(0xA7, 8);
  EXPECT_EQ(bench.spi(0x1234, 16), 0xA712U);
}

TEST(SpiWire, LeavesTheLineToOthersWhileNotSelected) {
  Bench bench({on_spi("eeprom", kSpiEeprom)});
  EXPECT_EQ(bench.clock(0x0500, 16), 0U);
  bench.spi(0x06, 8);
  EXPECT_EQ(bench.spi(0x0500, 16) & 0xFFU, 0x02U);
}

TEST(SpiSlave, AnswersWordsAsItAnswersEdges) {
  // The same words, once from edges and once exchanged by a master.
  for (const auto* type : {&kSpiAdc, &kSpiEeprom, &kShiftRegister}) {
    Bench by_edges({on_spi("it", *type)});
    Bench by_words({on_spi("it", *type)});
    SpiSlave& slave = *by_words.board.find("it")->spi();
    std::uint64_t random = 1;
    for (int round = 0; round < 200; ++round) {
      random = random * 6364136223846793005U + 1442695040888963407U;
      const unsigned bits = 1 + static_cast<unsigned>((random >> 40U) % 64);
      const std::uint64_t word = (random ^ (random >> 29U)) >> (64 - bits);
      slave.select(by_words.board.time());
      const mfc::SpiTransfer transfer{.start = by_words.board.time(),
                                      .clock_period = 1_us,
                                      .bits = static_cast<std::uint8_t>(bits),
                                      .sent = word};
      const std::uint64_t expected = slave.exchange(transfer);
      slave.deselect(by_words.board.time());
      ASSERT_EQ(by_edges.spi(word, bits), expected) << type->name << " round " << round;
      by_words.board.advance(by_edges.board.time());
    }
  }
}

}  // namespace
}  // namespace stator::board
