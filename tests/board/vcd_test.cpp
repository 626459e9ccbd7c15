// Traces of pins as VCD text (IEEE 1364), with SPI words and I2C bytes decoded.
#include "stator/board/lines/vcd.hpp"

#include <gtest/gtest.h>

#include "board/bench.hpp"
#include "board/vcd_file.hpp"

namespace stator::board {
namespace {

TEST(Vcd, IsTheTextOfTheStandard) {
  Collector collector;
  LogicTrace trace(1U << 2 | 1U << 17, {}, 4, collector.sink());
  trace.begin(base::SimTime(), 2, false);
  trace.begin(base::SimTime(), 17, true);
  trace.change(base::SimTime(40_ns), 2, true);
  trace.change(base::SimTime(40_ns), 17, false);
  trace.change(base::SimTime(50_ns), 17, false);  // no change
  trace.change(base::SimTime(1'000'000_ns), 2, false);
  trace.flush();
  VcdFormat format("board", trace, names());
  std::string text = format.header();
  format.append(text, collector.records);
  EXPECT_EQ(text,
            "$timescale 1 ns $end\n"
            "$scope module board $end\n"
            "$var wire 1 # MFCIO02 $end\n"
            "$var wire 1 2 MFC_HV1 $end\n"
            "$upscope $end\n"
            "$enddefinitions $end\n"
            "#0\n0#\n12\n"
            "#40\n1#\n02\n"
            "#1000000\n0#\n");
}

TEST(LogicTrace, GivesAwayFullBlocksInOrder) {
  Collector collector;
  LogicTrace trace(1, {}, 3, collector.sink());
  for (int k = 0; k < 7; ++k) {
    trace.change(base::SimTime(base::SimDuration(10 * k)), 0, k % 2 == 0);
  }
  EXPECT_EQ(collector.records.size(), 6U);
  trace.flush();
  ASSERT_EQ(collector.records.size(), 7U);
  for (int k = 0; k < 7; ++k) {
    EXPECT_EQ(collector.records[static_cast<std::size_t>(k)].time.nanoseconds(), 10 * k);
  }
}

TEST(LogicTrace, DecodesSpiWords) {
  Collector collector;
  LogicTrace trace(
      0, {.spi_sck = kSckLine, .spi_mosi = kMosiLine, .spi_miso = kMisoLine, .spi_cs = kCsLine},
      100, collector.sink());
  Bench bench({part("adc", kSpiAdc,
                    {{"sck", kSckLine}, {"mosi", kMosiLine}, {"miso", kMisoLine}, {"cs", kCsLine}},
                    {{"reference_voltage", 4.096}})});
  bench.board.trace(trace);
  bench.input("adc.channel0", 2.748);
  bench.select(false);
  const std::uint64_t answer = bench.spi(0x06'00'00, 24);
  trace.flush();
  VcdFormat format("board", trace, names());
  std::string text;
  format.append(text, collector.records);
  EXPECT_EQ(answer, 0xABCU);
  EXPECT_NE(text.find("s060000>000ABC 9\n"), std::string::npos) << text;
  EXPECT_NE(format.header().find("$var string 1 9 spi $end"), std::string::npos);
}

TEST(LogicTrace, DecodesI2cBytes) {
  Collector collector;
  LogicTrace trace(0, {.i2c_scl = kSclLine, .i2c_sda = kSdaLine}, 1000, collector.sink());
  Bench bench({part("port", kI2cPortExpander, {{"scl", kSclLine}, {"sda", kSdaLine}})});
  bench.board.trace(trace);
  bench.i2c_start();
  bench.i2c_write(0x40);
  bench.i2c_write(0xA5);
  bench.i2c_start();
  bench.i2c_write(0x44);
  bench.i2c_stop();
  trace.flush();
  VcdFormat format("board", trace, names());
  std::string text;
  for (const TraceRecord& record : collector.records) {
    if (record.channel == kI2cChannel) {
      format.append(text, std::span(&record, 1));
    }
  }
  std::string words;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at) {
    if (text[at + 1] == 's') {
      words += text.substr(at + 2, text.find(' ', at) - at - 2) + ' ';
    }
  }
  EXPECT_EQ(words, "start 40+ack A5+ack start 44+nack stop ");
}

}  // namespace
}  // namespace stator::board
