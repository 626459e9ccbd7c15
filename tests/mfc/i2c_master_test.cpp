// The I2C master's commands, status codes and edges, with slaves that stretch the clock or do not
// answer.
#include "stator/mfc/units/i2c_master.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/csv_file.hpp"
#include "mfc/i2c_bench.hpp"
#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using base::SimDuration;
using base::SimTime;
using testing::at;
using Bench = testing::I2cBench;
using testing::Edge;
using testing::kReceiveAck;
using testing::kReceiveNack;
using testing::kSendAddress;
using testing::kSendData;
using testing::kStart;
using testing::kStop;
using testing::Memory;
using testing::on_the_wire;

TEST(I2cMasterUnit, ReadsTheMemoryOfTheExample) {
  Bench bench;
  bench.memory.bytes[0x1234] = 0xC3;
  bench.memory.bytes[0x1235] = 0x5A;
  bench.command(kStart);
  EXPECT_EQ(bench.unit.status(), 0x01);
  EXPECT_EQ(bench.address(0xA0), 0x34);
  EXPECT_EQ(bench.data(0x12), 0x30);
  EXPECT_EQ(bench.data(0x34), 0x30);
  bench.command(kStart);
  EXPECT_EQ(bench.unit.status(), 0x02);
  EXPECT_EQ(bench.address(0xA1), 0x2C);
  bench.command(kReceiveAck);
  EXPECT_EQ(bench.unit.status(), 0x28);
  EXPECT_EQ(bench.unit.received_data(), 0xC3);
  bench.command(kReceiveNack);
  EXPECT_EQ(bench.unit.status(), 0x48);
  EXPECT_EQ(bench.unit.received_data(), 0x5A);
  bench.command(kStop);
  EXPECT_EQ(bench.unit.status(), 0x00);
  EXPECT_EQ(on_the_wire(bench.sink.edges),
            "S 101000000 000100100 001101000 S 101000010 110000110 010110101 P ");
  EXPECT_EQ(bench.memory.log, "SwSrANP");
}

TEST(I2cMasterUnit, WritesBytes) {
  Bench bench;
  bench.command(kStart);
  bench.address(0xA0);
  for (const auto byte : std::initializer_list<std::uint8_t>{0x00, 0x10, 0x11, 0x22}) {
    EXPECT_EQ(bench.data(byte), 0x30);
  }
  bench.command(kStop);
  EXPECT_EQ(bench.memory.bytes[0x10], 0x11);
  EXPECT_EQ(bench.memory.bytes[0x11], 0x22);
}

TEST(I2cMasterUnit, StatusCodesAreThoseOfTheTable) {
  std::vector<std::string> seen;
  const auto note = [&](std::uint8_t status) {
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    seen.push_back(std::string("0x") + kDigits[status >> 4] + kDigits[status & 15]);
  };
  Bench bench;
  note(bench.unit.status());
  bench.command(kStart);
  note(bench.unit.status());
  bench.command(kStart);
  note(bench.unit.status());
  note(bench.address(0xA0));
  bench.command(kStart);
  note(bench.address(0xA1));
  bench.command(kStart);
  note(bench.address(0xB0));
  bench.command(kStart);
  note(bench.address(0xB1));
  // Somebody holds SDA low while a 1 is sent.
  bench.command(kStart);
  bench.unit.input(Signal::sda, false);
  note(bench.address(0xA0));
  bench.unit.input(Signal::sda, true);
  bench.command(kStop);
  EXPECT_EQ(bench.unit.status(), 0);
  bench.unit.set_receive_codes(I2cMaster::ReceiveCodes::as_printed);
  bench.command(kStart);
  bench.address(0xA1);
  bench.command(kReceiveAck);
  note(bench.unit.status());
  bench.command(kReceiveNack);
  note(bench.unit.status());
  bench.command(kStart);
  bench.address(0xA0);
  note(bench.data(0x00));
  note(bench.data(0xEE));
  bench.unit.input(Signal::sda, false);
  note(bench.data(0x80));
  bench.unit.input(Signal::sda, true);
  bench.command(kStop);
  bench.command(kSendData);
  note(bench.unit.status());
  const auto table = testing::document_table("i2c_status.csv");
  ASSERT_EQ(seen.size(), table.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    EXPECT_EQ(seen[i], table[i].at("status_byte")) << table[i].at("meaning");
  }
}

TEST(I2cMasterUnit, CommandsLastTheirBits) {
  for (const auto timebase : std::initializer_list<std::uint8_t>{1, 10, 255}) {
    Bench bench;
    bench.unit.write_timebase(timebase);
    const SimDuration bit = 1_us * timebase;
    EXPECT_EQ(bench.command(kStart), bit);
    EXPECT_EQ(bench.command(kStart), SimDuration(bit.nanoseconds() * 3 / 2));
    bench.unit.write_address(0xA1);
    EXPECT_EQ(bench.command(kSendAddress), bit * 9);
    EXPECT_EQ(bench.command(kReceiveNack), bit * 9);
    EXPECT_EQ(bench.command(kStop), SimDuration(bit.nanoseconds() * 3 / 2));
  }
}

TEST(I2cMasterUnit, EdgesComeAtTheirQuartersOfABit) {
  Bench bench;  // 10 us per bit
  bench.command(kStart);
  EXPECT_EQ(bench.sink.edges,
            (std::vector<Edge>{{5000, Signal::sda, false}, {10'000, Signal::scl, false}}));
  bench.sink.clear();
  bench.address(0xA0);
  const auto clocks = bench.sink.of(Signal::scl);
  ASSERT_EQ(clocks.size(), 18U);
  for (std::size_t i = 0; i < clocks.size(); ++i) {
    EXPECT_EQ(clocks[i].time, 10'000 + 5000 * static_cast<std::int64_t>(i + 1));
  }
  EXPECT_EQ(bench.sink.of(Signal::sda)[0], (Edge{12'500, Signal::sda, true}));
  bench.sink.clear();
  bench.command(kStop);
  EXPECT_EQ(bench.sink.edges, (std::vector<Edge>{{102'500, Signal::sda, false},
                                                 {105'000, Signal::scl, true},
                                                 {110'000, Signal::sda, true}}));
}

TEST(I2cMasterUnit, SlavesAreAskedWhenTheLastBitHasEnded) {
  for (const bool watched : {true, false}) {
    Bench bench;
    bench.unit.watch(watched ? SignalSet{Signal::scl, Signal::sda} : SignalSet{});
    bench.command(kStart);
    bench.address(0xA0);
    EXPECT_EQ(bench.memory.asked_at, at(10'000 + 80'000));
  }
}

TEST(I2cMasterUnit, WhatOthersDoToTheLinesDoesNotHurryIt) {
  Bench bench;
  bench.command(kStart);
  bench.unit.write_address(0xA0);
  bench.unit.write_control(kSendAddress);
  bench.unit.advance(at(16'000), bench.sink);  // SCL is high
  for (const bool level : {false, true}) {
    bench.unit.input(Signal::sda, level);
    bench.unit.input(Signal::scl, level);
  }
  bench.now = at(16'000);
  EXPECT_EQ(bench.command(0), 84_us);
  EXPECT_EQ(bench.unit.status(), 0x34);
}

TEST(I2cMasterUnit, RepeatedStartReleasesSdaBeforeScl) {
  Bench bench;
  bench.command(kStart);
  bench.sink.clear();
  bench.command(kStart);
  EXPECT_EQ(bench.sink.edges, (std::vector<Edge>{{12'500, Signal::sda, true},
                                                 {15'000, Signal::scl, true},
                                                 {20'000, Signal::sda, false},
                                                 {25'000, Signal::scl, false}}));
}

TEST(I2cMasterUnit, WithoutTimebaseItIsSwitchedOff) {
  Bench bench;
  bench.unit.write_timebase(0);
  bench.command(kStart);
  EXPECT_EQ(bench.unit.status(), 0);
  EXPECT_TRUE(bench.sink.edges.empty());
}

TEST(I2cMasterUnit, SeveralCommandsAtOnceAreRefused) {
  for (unsigned command = 0; command < 256; ++command) {
    Bench bench;
    bench.unit.write_control(static_cast<std::uint8_t>(command));
    const unsigned bits = command & 0x3F;
    const bool several = (bits & (bits - 1)) != 0 && bits != 0;
    EXPECT_EQ(bench.unit.busy(), bits == kStart) << command;
    if (several) {
      EXPECT_EQ(bench.unit.status(), 0xFF) << command;
    }
  }
}

TEST(I2cMasterUnit, CommandBit7OfTheExampleDoesNothing) {
  Bench bench;
  bench.command(kStart);
  bench.command(0x80);
  EXPECT_EQ(bench.unit.status(), 0x01);
  EXPECT_EQ(bench.unit.control(), 0x80);
}

TEST(I2cMasterUnit, CommandsOutOfTurnNeedAStop) {
  Bench bench;
  bench.command(kStart);
  bench.command(kReceiveAck);  // the example forgets the read address
  EXPECT_EQ(bench.unit.status(), 0xFF);
  EXPECT_EQ(bench.address(0xA0), 0xFF);
  bench.command(kStop);
  EXPECT_EQ(bench.unit.status(), 0x00);
  bench.command(kStart);
  EXPECT_EQ(bench.address(0xA0), 0x34);
}

TEST(I2cMasterUnit, CommandsWhileOneRunsAreIgnored) {
  Bench bench;
  bench.unit.write_control(kStart);
  bench.unit.advance(at(7000), bench.sink);
  bench.unit.write_control(kStop);
  bench.now = at(7000);
  bench.command(0);
  EXPECT_EQ(bench.unit.status(), 0x01);
}

TEST(I2cMasterUnit, StatusShowsNoAcknowledgeWhileAByteIsOnItsWay) {
  Bench bench;
  bench.command(kStart);
  bench.address(0xA0);
  bench.unit.write_control(kSendData);
  EXPECT_EQ(bench.unit.status(), 0x10);
  EXPECT_TRUE(bench.unit.busy());
}

TEST(I2cMasterUnit, EndsOfBytesAreInterrupts) {
  Bench bench;
  bench.command(kStart);
  EXPECT_TRUE(bench.sink.interrupts.empty());
  bench.address(0xA1);
  EXPECT_EQ(bench.sink.count(IrqSource::i2c_tx_complete), 1U);
  EXPECT_EQ(bench.sink.first(IrqSource::i2c_tx_complete), 100'000);
  EXPECT_EQ(bench.sink.count(IrqSource::i2c_new_data_or_tx_complete), 1U);
  EXPECT_EQ(bench.sink.count(IrqSource::i2c_new_data), 0U);
  bench.command(kReceiveNack);
  EXPECT_EQ(bench.sink.count(IrqSource::i2c_new_data), 1U);
  EXPECT_EQ(bench.sink.count(IrqSource::i2c_new_data_or_tx_complete), 2U);
  bench.command(kStop);
  EXPECT_EQ(bench.sink.interrupts.size(), 4U);
}

TEST(I2cMasterUnit, SlavesStretchTheClock) {
  for (const bool watched : {true, false}) {
    Bench bench;
    bench.unit.watch(watched ? SignalSet{Signal::scl, Signal::sda} : SignalSet{});
    bench.memory.bytes[0] = 0x69;
    bench.command(kStart);
    bench.memory.stretch = 30_us;
    bench.unit.write_address(0xA1);
    // 25 us longer: half a bit of the 30 us is low anyway.
    EXPECT_EQ(bench.command(kSendAddress), 90_us + 25_us);
    EXPECT_EQ(bench.command(kReceiveAck), 90_us + 25_us);
    EXPECT_EQ(bench.unit.received_data(), 0x69);
    bench.memory.stretch = 4_us;
    EXPECT_EQ(bench.command(kReceiveNack), 90_us);
    if (watched) {
      EXPECT_EQ(on_the_wire(bench.sink.edges).substr(0, 12), "S 101000010 ");
    }
  }
}

TEST(I2cMasterUnit, WaitsWhileSclIsHeldLowFromOutside) {
  Bench bench;
  bench.command(kStart);
  bench.unit.input(Signal::scl, false);
  bench.unit.write_address(0xA0);
  EXPECT_EQ(bench.command(kSendAddress), 5_us) << "up to the first release of SCL";
  EXPECT_TRUE(bench.unit.busy());
  EXPECT_TRUE(bench.unit.level(Signal::scl));
  EXPECT_FALSE(bench.unit.line(Signal::scl));
  bench.now = at(1'000'000);
  bench.unit.advance(bench.now, bench.sink);
  bench.unit.input(Signal::scl, true);
  EXPECT_EQ(bench.command(0), 85_us);
  EXPECT_EQ(bench.unit.status(), 0x34);
}

TEST(I2cMasterUnit, StartOnABusThatIsHeldLowFails) {
  Bench bench;
  bench.unit.input(Signal::sda, false);
  bench.command(kStart);
  EXPECT_EQ(bench.unit.status(), 0xFF);
  EXPECT_TRUE(bench.sink.edges.empty());
}

TEST(I2cMasterUnit, SeveralSlavesShareTheBus) {
  Bench bench;
  Memory other(0x51);
  ASSERT_TRUE(bench.unit.attach(other));
  bench.memory.bytes[0] = 0x0F;
  other.bytes[0] = 0xF1;
  for (const auto& [address, value] : {std::pair{0xA1, 0x0F}, {0xA3, 0xF1}}) {
    bench.command(kStart);
    EXPECT_EQ(bench.address(static_cast<std::uint8_t>(address)), 0x2C);
    bench.command(kReceiveNack);
    EXPECT_EQ(bench.unit.received_data(), value);
    bench.command(kStop);
  }
  for (std::size_t i = 2; i < I2cMaster::kSlaves; ++i) {
    EXPECT_TRUE(bench.unit.attach(other));
  }
  EXPECT_FALSE(bench.unit.attach(other));
}

TEST(I2cMasterUnit, BytesOfAnyValueAreTheSameOnBothSidesAndOnTheWire) {
  base::Random random(24);
  Bench bench;
  for (int i = 0; i < 300; ++i) {
    bench.unit.write_timebase(static_cast<std::uint8_t>(1 + random.below(255)));
    bench.memory.stretch = SimDuration(static_cast<std::int64_t>(random.below(100'000)));
    const auto value = static_cast<std::uint8_t>(random.next());
    const auto place = static_cast<std::uint8_t>(random.next() & 0x7F);
    const bool watched = random.below(2) == 0;
    bench.unit.watch(watched ? SignalSet{Signal::scl, Signal::sda} : SignalSet{});
    bench.sink.edges.clear();
    bench.memory.bytes[place] = value;
    bench.command(kStart);
    bench.address(0xA0);
    bench.data(0);
    bench.data(place);
    bench.command(kStart);
    bench.address(0xA1);
    bench.command(kReceiveNack);
    EXPECT_EQ(bench.unit.received_data(), value);
    bench.command(kStop);
    EXPECT_EQ(bench.unit.status(), 0);
    if (watched) {
      std::string bits;
      for (int bit = 7; bit >= 0; --bit) {
        bits += (value >> bit & 1) != 0 ? '1' : '0';
      }
      const std::string wire = on_the_wire(bench.sink.edges);
      EXPECT_EQ(wire.substr(wire.size() - 12), bits + "1 P ");
    }
  }
}

TEST(I2cMasterUnit, StopsTwicePerByteUnlessWatchedAndNeverWhenIdle) {
  Bench bench;
  bench.unit.watch({});
  EXPECT_EQ(testing::run(bench.unit, SimTime(1_s), bench.sink), 0U);
  bench.now = SimTime(1_s);
  bench.command(kStart);
  bench.unit.write_address(0xA0);
  bench.unit.write_control(kSendAddress);
  EXPECT_EQ(testing::run(bench.unit, SimTime(2_s), bench.sink), 2U);
  EXPECT_EQ(bench.unit.status(), 0x34);
}

}  // namespace
}  // namespace stator::mfc
