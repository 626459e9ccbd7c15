#include "stator/mfc/units/spi_master.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/csv_file.hpp"
#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using base::SimTime;
using testing::at;
using testing::Edge;
using testing::RecordingSink;

// SPI_CONF.
constexpr std::uint16_t kKeepSelected = 1U << 3;
constexpr std::uint16_t kLsbFirst = 1U << 4;
constexpr std::uint16_t kPhase = 1U << 5;
constexpr std::uint16_t kPolarity = 1U << 6;
constexpr std::uint16_t kSingle = 1U << 15;
constexpr std::uint16_t trigger(unsigned code) {
  return static_cast<std::uint16_t>(code << 8);
}

/// Notes what it is told and answers with `reply`.
class NotingSlave : public SpiSlave {
 public:
  void select(SimTime time) override { selected.push_back(time.nanoseconds()); }
  std::uint64_t exchange(const SpiTransfer& transfer) override {
    transfers.push_back(transfer);
    return reply;
  }
  void deselect(SimTime time) override { deselected.push_back(time.nanoseconds()); }

  std::uint64_t reply = 0;
  std::vector<std::int64_t> selected, deselected;
  std::vector<SpiTransfer> transfers;
};

struct Bench {
  RecordingSink sink;
  SpiMaster unit;

  Bench() {
    unit.watch({Signal::sck, Signal::sdo, Signal::sdi, Signal::cs0, Signal::cs1, Signal::cs2,
                Signal::cs3});
  }
  void configure(unsigned configuration, unsigned bits, unsigned time) {
    unit.write_configuration(static_cast<std::uint16_t>(configuration), sink);
    unit.write_length(static_cast<std::uint8_t>(bits - 1));
    unit.write_time(static_cast<std::uint8_t>(time));
  }
  /// Sends and goes on until the transfer has ended.
  void send(std::uint64_t data) {
    unit.write_data(data, true, sink);
    finish();
  }
  void finish() {
    while (unit.next_event() != SimTime::never()) {
      unit.advance(unit.next_event(), sink);
    }
  }
};

/// Bits on `data` at the edges of SCK to `sampling_level`, in order.
std::vector<bool> sampled(const RecordingSink& sink, Signal data, bool sampling_level) {
  bool level = false;
  std::vector<bool> bits;
  for (const Edge& edge : sink.edges) {
    if (edge.signal == data) {
      level = edge.level;
    } else if (edge.signal == Signal::sck && edge.level == sampling_level) {
      bits.push_back(level);
    }
  }
  return bits;
}

std::vector<bool> wire(std::uint64_t data, unsigned bits, bool lsb_first) {
  std::vector<bool> result;
  for (unsigned i = 0; i < bits; ++i) {
    result.push_back((data >> (lsb_first ? i : bits - 1 - i) & 1) != 0);
  }
  return result;
}

TEST(SpiMasterUnit, ModesChangeAndSampleOnTheEdgesOfTheTable) {
  for (const auto& row : testing::document_table("spi_master_modes.csv")) {
    Bench bench;
    NotingSlave slave;
    slave.reply = 0x35;
    bench.unit.attach(0, &slave);
    bench.configure((row.at("clock_phase") == "1" ? kPhase : 0U) |
                        (row.at("clock_polarity") == "1" ? kPolarity : 0U),
                    8, 0);
    bench.sink.clear();
    bench.send(0xA6);
    const bool rising = row.at("miso_sample") == "rising";
    EXPECT_EQ(sampled(bench.sink, Signal::sdo, rising), wire(0xA6, 8, false)) << row.at("spi_mode");
    EXPECT_EQ(sampled(bench.sink, Signal::sdi, rising), wire(0x35, 8, false)) << row.at("spi_mode");
    EXPECT_EQ(bench.unit.received_data(), 0x35U);
    // Data change on the other edges, and with phase 0 at the selection too.
    for (const Edge& edge : bench.sink.edges) {
      if (edge.signal == Signal::sdo && edge.time > 0) {
        const auto clock =
            std::find_if(bench.sink.edges.begin(), bench.sink.edges.end(), [&](const Edge& other) {
              return other.signal == Signal::sck && other.time == edge.time;
            });
        ASSERT_NE(clock, bench.sink.edges.end());
        EXPECT_EQ(clock->level, row.at("mosi_change") == "rising");
      }
    }
    EXPECT_EQ(bench.unit.level(Signal::sck), row.at("clock_polarity") == "1");
  }
}

TEST(SpiMasterUnit, EveryEdgeComesAtTheFormulasTime) {
  for (const unsigned time : {0U, 2U, 255U}) {
    for (const unsigned bits : {1U, 20U, 64U}) {
      for (const unsigned mode : {0U, unsigned{kPhase}, unsigned{kPolarity}}) {
        Bench bench;
        bench.configure(mode, bits, time);
        bench.unit.advance(at(4000), bench.sink);
        bench.sink.clear();
        bench.send(0x5555'5555'5555'5555);
        const std::int64_t half = (4 + 2 * time) * 40 / 2;
        const auto clocks = bench.sink.of(Signal::sck);
        ASSERT_EQ(clocks.size(), 2 * bits);
        for (std::size_t i = 0; i < clocks.size(); ++i) {
          EXPECT_EQ(clocks[i].time, 4000 + half * static_cast<std::int64_t>(i + 1));
        }
        const std::int64_t end = 4000 + half * (2 * bits + 1);
        EXPECT_EQ(bench.sink.of(Signal::cs0),
                  (std::vector<Edge>{{4000, Signal::cs0, false}, {end, Signal::cs0, true}}));
        EXPECT_EQ(bench.sink.first(IrqSource::spi_new_data), end);
      }
    }
  }
}

TEST(SpiMasterUnit, ClockRatesAreThoseOfTheDocument) {
  Bench bench;
  NotingSlave slave;
  bench.unit.attach(0, &slave);
  for (const auto& [time, period] : {std::pair{0U, 160}, {2U, 320}, {255U, 20'560}}) {
    bench.configure(0, 8, time);
    bench.send(0);
    EXPECT_EQ(slave.transfers.back().clock_period.nanoseconds(), period);
  }
}

TEST(SpiMasterUnit, SendsTheDriverConfigurationOfTheExample) {
  // SPI-1 to SPI-4: 20 bits 0xEF010 in mode 3.
  Bench bench;
  bench.configure(0x0060, 0x13 + 1, 2);
  bench.sink.clear();
  bench.send(0x00000000000EF010);
  EXPECT_EQ(sampled(bench.sink, Signal::sdo, true), wire(0xEF010, 20, false));
}

TEST(SpiMasterUnit, KeepsTheSelectLowBetweenTwoHalvesOfADatagram) {
  // SPI-5 to SPI-9, with the length of A-46.
  Bench bench;
  NotingSlave slave;
  bench.unit.attach(0, &slave);
  bench.configure(0x0068, 0x27 + 1, 0);
  bench.sink.clear();
  bench.send(0x5555AAAA55);
  EXPECT_FALSE(bench.unit.level(Signal::cs0));
  bench.unit.write_configuration(0x0060, bench.sink);
  EXPECT_FALSE(bench.unit.level(Signal::cs0));
  bench.send(0x55AAAA55AA);
  EXPECT_TRUE(bench.unit.level(Signal::cs0));
  auto expected = wire(0x5555AAAA55, 40, false);
  const auto second = wire(0x55AAAA55AA, 40, false);
  expected.insert(expected.end(), second.begin(), second.end());
  EXPECT_EQ(sampled(bench.sink, Signal::sdo, true), expected);
  EXPECT_EQ(bench.sink.of(Signal::cs0).size(), 2U);
  EXPECT_EQ(slave.selected.size(), 1U);
  EXPECT_EQ(slave.deselected.size(), 1U);
  EXPECT_EQ(slave.transfers.size(), 2U);
}

TEST(SpiMasterUnit, TheLengthAsPrintedSends41Bits) {
  Bench bench;
  bench.configure(0x0060, 0x28 + 1, 0);
  bench.sink.clear();
  bench.send(0x5555AAAA55);
  const auto bits = sampled(bench.sink, Signal::sdo, true);
  EXPECT_EQ(bits.size(), 41U);
  EXPECT_FALSE(bits[0]);
  EXPECT_EQ(bits, wire(0x5555AAAA55, 41, false));
}

TEST(SpiMasterUnit, AnotherSelectEndsAHeldDatagram) {
  Bench bench;
  bench.configure(kKeepSelected, 8, 0);
  bench.send(1);
  const std::int64_t end = std::int64_t{80} * 17;
  bench.unit.write_configuration(2, bench.sink);
  bench.send(1);
  ASSERT_EQ(bench.sink.of(Signal::cs0).size(), 2U);
  ASSERT_EQ(bench.sink.of(Signal::cs2).size(), 2U);
  EXPECT_EQ(bench.sink.of(Signal::cs0).back(), (Edge{end, Signal::cs0, true}));
  EXPECT_EQ(bench.sink.of(Signal::cs2).front(), (Edge{end, Signal::cs2, false}));
}

TEST(SpiMasterUnit, EachSelectHasItsSlave) {
  for (unsigned line = 0; line < 4; ++line) {
    Bench bench;
    std::array<NotingSlave, 4> slaves;
    for (std::size_t i = 0; i < 4; ++i) {
      slaves[i].reply = 0x10 + i;
      bench.unit.attach(i, &slaves[i]);
    }
    bench.configure(line, 8, 0);
    bench.send(0x99);
    EXPECT_EQ(bench.unit.received_data(), 0x10 + line);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(slaves[i].transfers.size(), i == line ? 1U : 0U);
    }
    EXPECT_EQ(bench.sink.of(offset(Signal::cs0, line)).size(), 2U);
  }
}

TEST(SpiMasterUnit, TransfersOfAnySettingArriveOnBothSides) {
  base::Random random(31);
  for (int i = 0; i < 2000; ++i) {
    Bench bench;
    NotingSlave slave;
    const unsigned bits = 1 + static_cast<unsigned>(random.below(64));
    const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    slave.reply = random.next() & mask;
    const auto modes = static_cast<unsigned>(random.next()) & (kLsbFirst | kPhase | kPolarity);
    const bool watched = random.below(2) == 0;
    if (!watched) {
      bench.unit.watch({});
    }
    bench.unit.attach(0, &slave);
    bench.configure(modes, bits, static_cast<unsigned>(random.below(256)));
    bench.sink.clear();
    const std::uint64_t data = random.next();
    bench.send(data);
    const bool lsb_first = (modes & kLsbFirst) != 0;
    EXPECT_EQ(wire(slave.transfers[0].sent, bits, false), wire(data, bits, lsb_first));
    EXPECT_EQ(slave.transfers[0].sent & ~mask, 0U);
    EXPECT_EQ(wire(bench.unit.received_data(), bits, lsb_first), wire(slave.reply, bits, false));
    EXPECT_EQ(bench.unit.received_data() & ~mask, 0U);
    EXPECT_EQ(slave.deselected[0],
              slave.transfers[0].clock_period.nanoseconds() / 2 * (2 * bits + 1));
    if (watched) {
      const bool rising = ((modes & kPhase) != 0) == ((modes & kPolarity) != 0);
      EXPECT_EQ(sampled(bench.sink, Signal::sdo, rising), wire(data, bits, lsb_first));
    } else {
      EXPECT_TRUE(bench.sink.edges.empty());
    }
  }
}

TEST(SpiMasterUnit, WithoutASlaveItSamplesThePin) {
  Bench bench;
  bench.configure(0, 8, 0);
  bench.unit.write_data(0, true, bench.sink);
  // Sampled at 80, 240, ...: high from 399 to 799, when bits 3 to 5 are sampled.
  bench.unit.advance(at(399), bench.sink);
  bench.unit.input(true);
  bench.unit.advance(at(799), bench.sink);
  bench.unit.input(false);
  bench.finish();
  EXPECT_EQ(bench.unit.received_data(), 0b00111000U);
}

TEST(SpiMasterUnit, StartsOnlyWhenTheHighestByteIsWritten) {
  Bench bench;
  bench.configure(0, 16, 0);
  bench.unit.write_data(0x12, false, bench.sink);
  EXPECT_EQ(bench.unit.status(), 1);
  EXPECT_EQ(bench.unit.next_event(), SimTime::never());
  bench.unit.write_data(0x3412, true, bench.sink);
  EXPECT_EQ(bench.unit.status(), 0);
  bench.finish();
  EXPECT_EQ(bench.unit.status(), 1);
}

TEST(SpiMasterUnit, StartsAtTheMarksOfItsTrigger) {
  const std::vector<std::vector<IrqSource>> expected{
      {},
      {IrqSource::pwm_zero_pulse},
      {IrqSource::pwm_center_pulse},
      {IrqSource::pwm_a_pulse},
      {IrqSource::pwm_b_pulse},
      {IrqSource::pwm_a_pulse, IrqSource::pwm_b_pulse},
      {},
      {}};
  for (unsigned code = 0; code < 8; ++code) {
    IrqSet awaited = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      Bench bench;
      bench.configure(trigger(code), 8, 0);
      const IrqSource mark = offset(IrqSource::pwm_zero_pulse, i);
      awaited = bench.unit.awaited_marks();
      bench.unit.pwm_mark(mark, bench.sink);
      const auto& marks = expected[code];
      const bool starts = std::find(marks.begin(), marks.end(), mark) != marks.end();
      EXPECT_EQ(bench.unit.status(), starts ? 0 : 1) << code << ' ' << i;
      EXPECT_EQ((awaited & irq_bit(mark)) != 0, starts);
    }
    Bench bench;
    bench.configure(trigger(code), 8, 0);
    bench.unit.write_data(1, true, bench.sink);
    EXPECT_EQ(bench.unit.status(), code == 0 ? 0 : 1);
  }
}

TEST(SpiMasterUnit, SingleTriggerStartsOnceForEachWrite) {
  Bench bench;
  bench.configure(trigger(7), 8, 0);
  EXPECT_EQ(bench.unit.status(), 1);
  for (unsigned i = 1; i <= 2; ++i) {
    bench.unit.write_configuration(trigger(7) | kSingle, bench.sink);
    EXPECT_EQ(bench.unit.status(), 0);
    bench.finish();
    EXPECT_EQ(bench.sink.count(IrqSource::spi_new_data), i);
  }
  bench.unit.write_configuration(kSingle | trigger(3), bench.sink);
  EXPECT_EQ(bench.unit.status(), 1);
}

TEST(SpiMasterUnit, TriggersDuringATransferAreIgnored) {
  Bench bench;
  bench.configure(0, 8, 0);
  bench.unit.write_data(0xAA, true, bench.sink);
  bench.unit.advance(at(500), bench.sink);
  bench.unit.write_data(0x55, true, bench.sink);
  bench.finish();
  EXPECT_EQ(bench.sink.count(IrqSource::spi_new_data), 1U);
  EXPECT_EQ(sampled(bench.sink, Signal::sdo, true), wire(0xAA, 8, false));
}

TEST(SpiMasterUnit, ConfigurationWrittenDuringATransferWaitsForTheNext) {
  Bench bench;
  bench.configure(0, 8, 0);
  bench.unit.write_data(0xAA, true, bench.sink);
  bench.unit.advance(at(500), bench.sink);
  bench.configure(kPolarity | kPhase | 1, 16, 9);
  bench.finish();
  EXPECT_EQ(bench.sink.of(Signal::cs0).back(), (Edge{std::int64_t{80} * 17, Signal::cs0, true}));
  EXPECT_EQ(sampled(bench.sink, Signal::sdo, true).size(), 8U + 1U) << "and SCK rises to its rest";
  EXPECT_TRUE(bench.unit.level(Signal::sck));
  bench.sink.clear();
  bench.send(0x1234);
  EXPECT_EQ(bench.sink.of(Signal::cs1).size(), 2U);
  EXPECT_EQ(sampled(bench.sink, Signal::sdo, true), wire(0x1234, 16, false));
}

TEST(SpiMasterUnit, StopsOncePerTransferUnlessWatched) {
  Bench bench;
  bench.unit.watch({Signal::cs0});
  bench.configure(0, 64, 0);
  bench.unit.write_data(0xAA, true, bench.sink);
  EXPECT_EQ(testing::run(bench.unit, at(1'000'000'000), bench.sink), 1U);
  EXPECT_EQ(bench.sink.edges.size(), 2U);
}

}  // namespace
}  // namespace stator::mfc
