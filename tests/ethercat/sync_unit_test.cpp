// SYNC0 and SYNC1: start, cycles, activation, pulse length, acknowledgement, pulses under a
// drifting clock.
#include "stator/ethercat/units/sync_unit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ethercat/dc_bus.hpp"
#include "stator/base/random.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::SimTime;
using testing::DcBoard;
using testing::DcBus;
using testing::little_endian;
using testing::number;
using testing::zeros;

constexpr unsigned kSync0 = 0;
constexpr unsigned kSync1 = 1;
constexpr std::uint32_t kMillisecond = 1'000'000;

/// System times of the next `count` edges, found by going from one to the next.
std::vector<std::uint64_t> edges(DcBus& bus, unsigned output, std::size_t count) {
  std::vector<std::uint64_t> times;
  while (times.size() < count) {
    const SimTime edge = bus.slave().next_sync_edge(output);
    if (edge == SimTime::never()) {
      break;
    }
    times.push_back(bus.slave().system_time(edge));
    bus.wait(edge - bus.now());
  }
  return times;
}

TEST(SyncUnit, Sync0_ComesAtStartTimeAndEveryCycleAfterIt) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + 100 * kMillisecond;
  bus.start_sync(start, kMillisecond);
  EXPECT_EQ(bus.get(0x0984, 1), 0x01U) << "first pulse pending";
  EXPECT_EQ(bus.get(0x0990, 8), start);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
  EXPECT_EQ(
      edges(bus, kSync0, 4),
      (std::vector<std::uint64_t>{start, start + 1'000'000, start + 2'000'000, start + 3'000'000}));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 4U);
  EXPECT_EQ(bus.get(0x0984, 1), 0U);
  EXPECT_EQ(bus.get(0x0990, 8), start + 4 * kMillisecond) << "read: the next pulse";
}

TEST(SyncUnit, PulsesNobodyLookedAt_AreAccountedForAtOnce) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, 125'000);
  EXPECT_EQ(bus.slave().next_deadline(), SimTime::never()) << "no deadline while nobody asks";
  bus.wait_until(start + std::uint64_t{3'600'000'000'000} + 1);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 3'600'000'000'000U / 125'000 + 1);
  EXPECT_EQ(bus.slave().next_deadline(), SimTime::never());
}

TEST(SyncUnit, CycleTimeZero_GivesASinglePulse) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, 0, 200'000, 7);
  EXPECT_EQ(edges(bus, kSync0, 3), std::vector<std::uint64_t>{start});
  bus.wait(SimDuration(1'000'000'000));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 1U);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync1), 1U);
}

TEST(SyncUnit, Sync1_FollowsEverySync0ByLessThanACycle) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond, 250'000, 7);
  EXPECT_EQ(bus.get(0x0984, 1), 0x03U);
  EXPECT_EQ(bus.get(0x0998, 8), start + 250'000);
  EXPECT_EQ(edges(bus, kSync1, 3),
            (std::vector<std::uint64_t>{start + 250'000, start + 1'250'000, start + 2'250'000}));
  EXPECT_EQ(bus.get(0x0998, 8), start + 3'250'000);
}

TEST(SyncUnit, Sync1_WithDelayZeroComesTogetherWithSync0) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond, 0, 7);
  EXPECT_EQ(edges(bus, kSync1, 2), (std::vector<std::uint64_t>{start, start + kMillisecond}));
}

TEST(SyncUnit, Sync1_LongerThanACycleRepeatsWithAMultipleOfIt) {
  struct Case {
    std::uint32_t delay;
    std::uint32_t period;
  };
  for (const Case& c :
       {Case{1'000'000, 1'000'000}, Case{1'000'001, 2'000'000}, Case{1'300'000, 2'000'000},
        Case{2'000'000, 2'000'000}, Case{2'500'000, 3'000'000}}) {
    DcBus bus;
    const std::uint64_t start = bus.system_time() + kMillisecond;
    bus.start_sync(start, kMillisecond, c.delay, 7);
    const std::uint64_t first = start + c.delay;
    EXPECT_EQ(edges(bus, kSync1, 3),
              (std::vector<std::uint64_t>{first, first + c.period, first + 2 * c.period}))
        << "delay " << c.delay;
  }
}

TEST(SyncUnit, EepromLoadedWhilePulsesRun_MapsThemToAlEventsFromThenOn) {
  DcBus bus;
  bus.start_sync(bus.system_time() + kMillisecond, kMillisecond);
  bus.wait(SimDuration(2 * kMillisecond));
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kDcSync0, 0U);
  bus.slave().load_sii(testing::dc_sii({.sync_latch = 0x6E, .pulse_length = 0}));
  bus.wait(SimDuration(2 * kMillisecond));
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kDcSync0, al_event::kDcSync0);
}

TEST(SyncUnit, OnlyTheOutputsSwitchedOnGivePulses) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond, 0, 5);
  bus.wait_until(start + 10 * kMillisecond);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync1), 11U);
  bus.set(0x0981, 3, 1);
  EXPECT_EQ(bus.slave().next_sync_edge(kSync1), SimTime::never());
  EXPECT_NE(bus.slave().next_sync_edge(kSync0), SimTime::never()) << "the grid goes on";
}

TEST(SyncUnit, NothingRunsWithoutTheActivationBit) {
  DcBus bus;
  bus.start_sync(bus.system_time() + kMillisecond, kMillisecond, 0, 6);
  bus.wait(SimDuration(10'000'000));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
  EXPECT_EQ(bus.get(0x0984, 1), 0U);
}

TEST(SyncUnit, Deactivation_EndsPulsesAndAllowsANewStart) {
  DcBus bus;
  bus.start_sync(bus.system_time() + kMillisecond, kMillisecond);
  bus.wait(SimDuration(5'000'000));
  bus.set(0x0981, 0, 1);
  const std::uint64_t before = bus.slave().sync_pulse_count(kSync0);
  bus.wait(SimDuration(50'000'000));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), before);
  const std::uint64_t start = bus.system_time() + 7 * kMillisecond;
  bus.start_sync(start, 2 * kMillisecond);
  EXPECT_EQ(edges(bus, kSync0, 2), (std::vector<std::uint64_t>{start, start + 2 * kMillisecond}));
}

TEST(SyncUnit, StartTime_IsLockedWhileActive) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + 10 * kMillisecond;
  bus.start_sync(start, kMillisecond);
  EXPECT_EQ(bus.set(0x0990, start + 5, 8), 0U);
  EXPECT_EQ(bus.get(0x0990, 8), start);
}

TEST(SyncUnit, NewCycleTime_IsValidBehindTheNextPulse) {
  DcBus bus;
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond);
  bus.wait_until(start + 2'300'000);
  bus.set(0x09A0, 400'000, 4);
  EXPECT_EQ(edges(bus, kSync0, 3),
            (std::vector<std::uint64_t>{start + 3'000'000, start + 3'400'000, start + 3'800'000}));
}

TEST(SyncUnit, StartTimeInThePast_GivesNoPulseAndIsTold) {
  class Log final : public base::EventSink {
   public:
    void on_event(const base::Event& event) override { last = base::to_sentence(event); }
    std::string last;
  } log;
  DcBus bus;
  bus.slave().set_event_reporter(base::EventReporter(&log, 0));
  bus.wait(SimDuration(50'000'000));
  bus.start_sync(bus.system_time() - 1'000'000, kMillisecond);
  EXPECT_THAT(log.last, ::testing::HasSubstr("the start is past and no SYNC0 will come"));
  bus.wait(SimDuration(1'000'000'000));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
  EXPECT_EQ(bus.get(0x0984, 1), 0x05U) << "still pending, was not in the near future";
}

TEST(SyncUnit, PlausibilityCheck_StartsAtOnceOutsideTheNearFuture) {
  // Worked example: bits 5 and 6, 1 s ahead waits, 3 s ahead is more than 2^31 ns.
  DcBus soon;
  const std::uint64_t start = soon.system_time() + 1'000'000'000;
  soon.start_sync(start, kMillisecond, 0, 0x63);
  EXPECT_EQ(soon.get(0x0984, 1) & 0x04U, 0U);
  EXPECT_EQ(edges(soon, kSync0, 1), std::vector<std::uint64_t>{start});

  DcBus late;
  late.start_sync(late.system_time() + 3'000'000'000, kMillisecond, 0, 0x63);
  EXPECT_EQ(late.slave().sync_pulse_count(kSync0), 1U) << "at the moment of activation";
  EXPECT_EQ(late.get(0x0984, 1), 0x04U);

  DcBus past;
  past.wait(SimDuration(50'000'000));
  past.start_sync(past.system_time() - 1'000'000, kMillisecond, 0, 0x23);
  EXPECT_EQ(past.slave().sync_pulse_count(kSync0), 1U);

  DcBus wide;  // bit 6 = 0: half of 64 bits are near
  const std::uint64_t later = wide.system_time() + 3'000'000'000;
  wide.start_sync(later, kMillisecond, 0, 0x23);
  EXPECT_EQ(wide.get(0x0984, 1), 0x01U);
  EXPECT_EQ(edges(wide, kSync0, 1), std::vector<std::uint64_t>{later});
}

TEST(SyncUnit, AutoActivation_StartsWhenTheStartTimeIsWritten) {
  DcBus bus;
  bus.set(0x09A0, kMillisecond, 4);
  bus.set(0x0981, 0x0A, 1);
  bus.wait(SimDuration(5'000'000));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
  const std::uint64_t start = bus.system_time() + kMillisecond;
  // Both halves in datagrams of their own: one frame counts as one write.
  bus.with(Command::apwr, physical_address(0, 0x0990), little_endian(start, 4))
      .with(Command::apwr, physical_address(0, 0x0994), little_endian(start >> 32, 4))
      .send();
  EXPECT_EQ(bus.get(0x0981, 1), 0x0BU) << "bit 0 set by itself";
  EXPECT_EQ(edges(bus, kSync0, 1), std::vector<std::uint64_t>{start});
}

TEST(SyncUnit, LowerHalfOfTheStartTime_IsExtendedFromTheSystemTime) {
  for (const unsigned activation : {0x12U, 0x0AU}) {
    DcBus bus;
    // Just below a wrap of the lower half, so that the start lies behind it.
    bus.set(0x0920, 0x1'FFF0'0000, 8);
    bus.set(0x09A0, kMillisecond, 4);
    bus.set(0x0981, activation, 1);
    const std::uint64_t start = bus.system_time() + 5 * kMillisecond;
    ASSERT_EQ(start >> 32, 2U);
    bus.set(0x0990, start & 0xFFFFFFFF, 4);
    bus.set(0x0981, activation | 1U, 1);
    EXPECT_EQ(bus.get(0x0990, 8), start) << "activation " << activation;
  }
}

TEST(SyncUnit, DebugPulse_IsOnePingAndReadsZero) {
  DcBus bus;
  bus.set(0x0981, 0x84, 1);
  EXPECT_TRUE(bus.slave().sync_output(kSync1));
  EXPECT_FALSE(bus.slave().sync_output(kSync0));
  EXPECT_EQ(bus.get(0x0981, 1), 0x04U);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync1), 1U);
}

TEST(SyncUnit, PulseLength_ComesFromTheEeprom) {
  DcBus bus({.pulse_length = 2'000});
  EXPECT_EQ(bus.get(0x0982, 2), 2'000U);
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond);
  bus.wait_until(start - 1);
  EXPECT_FALSE(bus.slave().sync_output(kSync0));
  bus.wait_until(start);
  EXPECT_TRUE(bus.slave().sync_output(kSync0));
  bus.wait_until(start + 19'999);
  EXPECT_TRUE(bus.slave().sync_output(kSync0));
  EXPECT_EQ(testing::host_read(bus.slave(), 0x098E, 1), testing::bytes({1}));
  bus.wait_until(start + 20'000);
  EXPECT_FALSE(bus.slave().sync_output(kSync0));
  EXPECT_EQ(testing::host_read(bus.slave(), 0x098E, 1), testing::bytes({0}));
}

TEST(SyncUnit, SwitchedOffByTheEeprom_GivesNoPulses) {
  DcBus bus({.esc_configuration = 0x08});
  bus.start_sync(bus.system_time() + kMillisecond, kMillisecond);
  bus.wait(SimDuration(10'000'000));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 0U);
}

TEST(SyncUnit, OnlyTheControllingSideWrites) {
  DcBus bus;
  SlaveController& slave = bus.slave();
  const auto host_writes = [&](std::uint16_t address, std::uint64_t value, std::size_t length) {
    testing::host_write(slave, address, little_endian(value, length));
  };
  host_writes(0x09A0, 5, 4);
  host_writes(0x0981, 3, 1);
  host_writes(0x0990, 7, 8);
  EXPECT_EQ(bus.get(0x09A0, 4), 0U);
  EXPECT_EQ(bus.get(0x0981, 1), 0U);
  EXPECT_EQ(bus.get(0x0990, 8), 0U);
  host_writes(0x0980, 1, 1);
  EXPECT_EQ(bus.get(0x0980, 1), 0U) << "sides are the master's choice";
  EXPECT_EQ(bus.set(0x0980, 0xFF, 1), 1U);
  EXPECT_EQ(bus.get(0x0980, 1), 0x31U);
  EXPECT_EQ(bus.set(0x09A0, 5, 4), 0U);
  EXPECT_EQ(bus.set(0x0981, 3, 1), 0U);
  EXPECT_EQ(bus.set(0x0990, 5, 8), 0U);
  const std::uint64_t start = slave.system_time(slave.now()) + kMillisecond;
  host_writes(0x0990, start, 8);
  host_writes(0x09A0, kMillisecond, 4);
  host_writes(0x0981, 3, 1);
  EXPECT_EQ(edges(bus, kSync0, 1), std::vector<std::uint64_t>{start});
}

TEST(SyncUnit, RegistersAreZeroAfterReset) {
  DcBus bus({.pulse_length = 0});
  bus.start_sync(bus.system_time() + kMillisecond, kMillisecond, 5, 7);
  bus.set(0x0980, 0x30, 1);
  bus.wait(SimDuration(5'000'000));
  bus.slave().power_on_reset();
  for (std::uint16_t address = 0x0980; address < 0x0A00; ++address) {
    EXPECT_EQ(bus.get(address, 1), 0U) << std::hex << address;
  }
  EXPECT_EQ(bus.slave().next_sync_edge(kSync0), SimTime::never());
}

// 0x0151 bits 3 and 7 map both outputs to the AL event request, pulse length 0.
constexpr DcBoard kAcknowledged{.sync_latch = 0xEE, .pulse_length = 0};

TEST(SyncEvents, InAcknowledgeModeTheHostIsToldInTimeAndEndsTheSignal) {
  DcBus bus(kAcknowledged);
  SlaveController& slave = bus.slave();
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond, 100'000, 7);
  const SimTime deadline = slave.next_deadline();
  EXPECT_EQ(slave.system_time(deadline), start);
  bus.wait(deadline - bus.now());
  EXPECT_EQ(slave.al_event_request(), al_event::kDcSync0);
  EXPECT_TRUE(slave.host_interrupt());
  testing::host_write(slave, 0x0204, zeros(4));
  EXPECT_FALSE(slave.host_interrupt()) << "masked by 0x0204";
  bus.wait_until(start + 100'000);
  EXPECT_EQ(slave.al_event_request(), al_event::kDcSync0 | al_event::kDcSync1);
  EXPECT_EQ(number(testing::host_read(slave, 0x0220, 4)), 0x0CU);
  EXPECT_EQ(bus.get(0x098E, 2), 0x0101U) << "the bus sees the states and acknowledges nothing";
  EXPECT_TRUE(slave.sync_output(kSync0));
  EXPECT_EQ(number(testing::host_read(slave, 0x098E, 1)), 1U);
  EXPECT_EQ(slave.al_event_request(), al_event::kDcSync1);
  EXPECT_FALSE(slave.sync_output(kSync0));
  testing::host_read(slave, 0x098F, 1);
  EXPECT_EQ(slave.al_event_request(), 0U);
  bus.wait_until(start + kMillisecond);
  EXPECT_EQ(slave.al_event_request(), al_event::kDcSync0) << "and again with the next pulse";
}

TEST(SyncEvents, PulsesThatCameWhileOneWasPending_AreCountedWithoutDeadlines) {
  DcBus bus({.sync_latch = 0x0E, .pulse_length = 0});
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond);
  bus.wait_until(start);
  EXPECT_EQ(bus.slave().next_deadline(), SimTime::never()) << "told already";
  bus.wait_until(start + 5'500'000);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 6U);
  testing::host_read(bus.slave(), 0x098E, 1);
  EXPECT_EQ(bus.slave().system_time(bus.slave().next_deadline()), start + 6'000'000);
}

TEST(SyncEvents, AreNotRaisedUnlessMappedAndInAcknowledgeMode) {
  for (const DcBoard& board : {DcBoard{.sync_latch = 0x66, .pulse_length = 0},
                               DcBoard{.sync_latch = 0xEE, .pulse_length = 1000}}) {
    DcBus bus(board);
    const std::uint64_t start = bus.system_time() + kMillisecond;
    bus.start_sync(start, kMillisecond, 0, 7);
    bus.wait_until(start);
    EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 1U);
    EXPECT_EQ(bus.slave().al_event_request(), 0U);
  }
}

TEST(SyncEvents, InAcknowledgeByWriteModeOnlyAWriteAcknowledges) {
  SlaveControllerConfiguration chip;
  chip.acknowledge_by_write = true;
  DcBus bus(kAcknowledged, chip);
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond);
  bus.wait_until(start);
  testing::host_read(bus.slave(), 0x098E, 1);
  EXPECT_EQ(bus.slave().al_event_request(), al_event::kDcSync0);
  testing::host_write(bus.slave(), 0x098E, zeros(1));
  EXPECT_EQ(bus.slave().al_event_request(), 0U);
  EXPECT_EQ(bus.set(0x098E, 0, 1), 0U) << "not for the bus";
}

TEST(SyncEvents, AnAcknowledgingWriteCoversThePulsesBeforeIt) {
  SlaveControllerConfiguration chip;
  chip.acknowledge_by_write = true;
  DcBus bus({.sync_latch = 0x0E, .pulse_length = 0}, chip);
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond);
  bus.wait_until(start + 5'500'000);
  testing::host_write(bus.slave(), 0x098E, zeros(1));
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 6U);
  EXPECT_EQ(bus.slave().system_time(bus.slave().next_deadline()), start + 6'000'000);
}

TEST(SyncEvents, ComeWithTheDeadlineWhileTheClockIsBeingPulled) {
  // The reference runs 80 ppm faster than this slave: each comparison moves the next pulse.
  SlaveControllerConfiguration slow;
  slow.clock_deviation_ppb = -80'000;
  DcBus bus({.sync_latch = 0x0E, .pulse_length = 0}, slow);
  SlaveController& slave = bus.slave();
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, 250'000);
  std::uint64_t pulses = 0;
  for (int cycle = 0; cycle < 200; ++cycle) {
    bus.set(0x0910, static_cast<std::uint64_t>(bus.now().nanoseconds() + 10'000), 4);
    const SimTime deadline = slave.next_deadline();
    bus.wait(deadline - bus.now());
    ASSERT_EQ(slave.al_event_request(), al_event::kDcSync0) << "cycle " << cycle;
    ASSERT_GE(slave.system_time(deadline), start + pulses * 250'000);
    ASSERT_LT(slave.system_time(deadline - SimDuration(1)), start + pulses * 250'000);
    testing::host_read(slave, 0x098E, 1);
    ++pulses;
  }
}

/// Edges must lie at start + n * cycle of the system time, whatever happens to the clock, and none
/// may be lost or come twice while the clock only drifts and is pulled.
TEST(SyncProperties, EdgesLieOnTheirGridAcrossDriftAndCorrection) {
  base::Random random(20'240'611);
  for (int run = 0; run < 300; ++run) {
    SlaveControllerConfiguration chip;
    chip.clock_deviation_ppb = static_cast<std::int32_t>(random.next() % 200'001) - 100'000;
    DcBus bus({}, chip);
    SlaveController& slave = bus.slave();
    bus.set(0x0920, random.next() >> 2, 8);
    bus.set(0x0928, random.next() % 5'000, 4);
    bus.set(0x0930, 0x80 + random.next() % 0x3F80, 2);
    bus.set(0x0934, random.next() & 0x0F0F, 2);
    const std::uint64_t cycle = 20'000 + random.next() % 4'000'000;
    const std::uint64_t start = bus.system_time() + 1'000'000 + random.next() % 10'000'000;
    bus.start_sync(start, static_cast<std::uint32_t>(cycle));
    const std::uint64_t reference =
        bus.system_time() - static_cast<std::uint64_t>(bus.now().nanoseconds());
    for (std::uint64_t n = 0; n < 30; ++n) {
      if (random.next() % 2 == 0) {
        const std::uint64_t noise = random.next() % 2'000;
        bus.set(0x0910, reference + static_cast<std::uint64_t>(bus.now().nanoseconds()) + noise, 4);
      }
      const SimTime edge = slave.next_sync_edge(kSync0);
      const std::uint64_t counted = slave.sync_pulse_count(kSync0);
      ASSERT_GT(edge, bus.now());
      ASSERT_GE(slave.system_time(edge), start + counted * cycle) << "run " << run;
      ASSERT_LT(slave.system_time(edge - SimDuration(1)), start + counted * cycle) << "run " << run;
      bus.wait(edge - bus.now());
      ASSERT_EQ(slave.sync_pulse_count(kSync0), counted + 1) << "run " << run;
    }
  }
}

TEST(SyncProperties, OffsetChanges_KeepTheGridAndSkipWhatWasJumpedOver) {
  base::Random random(7);
  for (int run = 0; run < 300; ++run) {
    DcBus bus;
    SlaveController& slave = bus.slave();
    const std::uint64_t base_offset = std::uint64_t{1} << 50;
    bus.set(0x0920, base_offset, 8);
    const std::uint64_t cycle = 50'000 + random.next() % 1'000'000;
    const std::uint64_t start = bus.system_time() + 500'000;
    bus.start_sync(start, static_cast<std::uint32_t>(cycle));
    bus.wait_until(start + 10 * cycle + 1'000);
    const std::uint64_t before = slave.sync_pulse_count(kSync0);
    bus.set(0x0920, base_offset + random.next() % 100'000'000, 8);
    EXPECT_LE(slave.sync_pulse_count(kSync0), before + 2) << "a jump gives one pulse at most";
    for (int n = 0; n < 5; ++n) {
      const SimTime edge = slave.next_sync_edge(kSync0);
      ASSERT_EQ((slave.system_time(edge) - start) % cycle, 0U) << "run " << run;
      ASSERT_LE(edge - bus.now(), SimDuration(static_cast<std::int64_t>(cycle)));
      bus.wait(edge - bus.now());
    }
  }
}

TEST(SyncProperties, OffsetBack_RepeatsNoPulse) {
  DcBus bus;
  bus.set(0x0920, 1'000'000'000, 8);
  const std::uint64_t start = bus.system_time() + kMillisecond;
  bus.start_sync(start, kMillisecond);
  bus.wait_until(start + 10 * kMillisecond + 500'000);
  bus.set(0x0920, 1'000'000'000 - 5 * kMillisecond, 8);
  EXPECT_EQ(bus.slave().sync_pulse_count(kSync0), 11U);
  EXPECT_EQ(edges(bus, kSync0, 1), std::vector<std::uint64_t>{start + 11 * kMillisecond});
}

}  // namespace
}  // namespace stator::ethercat
