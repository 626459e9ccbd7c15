// Watchdogs of process data and of the host: times, dividers, triggers, counters.
#include "stator/ethercat/units/watchdog.hpp"

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::literals::operator""_ms;
using base::literals::operator""_us;
using testing::bytes;
using testing::host_read;
using testing::number;
using testing::TestBus;

class ProcessDataWatchdog : public ::testing::Test {
 protected:
  ProcessDataWatchdog() { bus.set_sync_manager(0, 2, {0x1100, 2, 0x64}); }
  bool expired_event() const {
    return (slave.al_event_request() & al_event::kProcessDataWatchdog) != 0;
  }
  TestBus bus;
  SlaveController& slave = bus.slave();
};

TEST_F(ProcessDataWatchdog, ExpiresAfter100msOfSilenceWithoutAnyFrame) {
  bus.write(0, 0x1100, bytes({1, 2}));
  const base::SimTime written = bus.now();
  EXPECT_LE(slave.next_deadline(), written + 101_ms);
  bus.wait(99_ms);
  EXPECT_FALSE(expired_event());
  bus.wait(2_ms);
  EXPECT_TRUE(expired_event());
  EXPECT_EQ(number(bus.read(0, 0x0440, 2).data), 0U);
  EXPECT_EQ(number(bus.read(0, 0x0442, 1).data), 1U);
  EXPECT_EQ(slave.next_deadline(), base::SimTime::never()) << "expires once";
  host_read(slave, 0x0440, 1);
  EXPECT_FALSE(expired_event()) << "acknowledged by the host";
}

TEST_F(ProcessDataWatchdog, DoesNotRunBeforeTheFirstWrite) {
  bus.wait(500_ms);
  EXPECT_FALSE(expired_event());
  EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 0U) << "not triggered yet";
}

TEST_F(ProcessDataWatchdog, EachCompleteWriteTriggersIt) {
  for (int cycle = 0; cycle < 20; ++cycle) {
    bus.write(0, 0x1100, bytes({1, 2}));
    bus.wait(50_ms);
    EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 1U);
  }
  EXPECT_FALSE(expired_event());
  bus.write(0, 0x1100, bytes({1}));
  bus.wait(60_ms);
  EXPECT_TRUE(expired_event()) << "an incomplete write does not count";
}

TEST_F(ProcessDataWatchdog, WithoutTheTriggerBit_WritesDoNotStartIt) {
  bus.set_sync_manager(0, 2, {0x1100, 2, 0x24});
  bus.write(0, 0x1100, bytes({1, 2}));
  EXPECT_EQ(slave.next_deadline(), base::SimTime::never());
}

TEST_F(ProcessDataWatchdog, TimeAndDividerAreTheMasters) {
  bus.write(0, 0x0420, bytes({10, 0}));  // 10 x 100 us
  bus.write(0, 0x1100, bytes({1, 2}));
  bus.wait(900_us);
  EXPECT_FALSE(expired_event());
  bus.wait(200_us);
  EXPECT_TRUE(expired_event());
  bus.write(0, 0x0420, bytes({0, 0}));
  bus.write(0, 0x1100, bytes({1, 2}));
  host_read(slave, 0x0440, 1);
  bus.wait(500_ms);
  EXPECT_FALSE(expired_event()) << "0 switches it off";
  EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 1U) << "and reads as not expired";
}

TEST_F(ProcessDataWatchdog, TriggeredThroughAnFmmu) {
  bus.set_fmmu(0, 0, {0x10000, 2, 0x1100, 2});
  bus.transfer(Command::lrw, 0x10000, bytes({1, 2}));
  EXPECT_EQ(number(bus.read(0, 0x0440, 1).data), 1U);
}

TEST_F(ProcessDataWatchdog, CountersClearTogether) {
  bus.write(0, 0x1100, bytes({1, 2}));
  bus.wait(200_ms);
  EXPECT_EQ(bus.write(0, 0x0443, bytes({9})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x0442, 2).data), 0U);
}

TEST(HostWatchdog, SupervisesAHostThatStoppedPolling) {
  TestBus bus;
  const auto alive = [&] { return (number(bus.read(0, 0x0110, 2).data) & 0x02U) != 0; };
  bus.wait(500_ms);
  EXPECT_TRUE(alive());
  bus.slave().set_host_polling(false);
  bus.wait(99_ms);
  EXPECT_TRUE(alive());
  bus.wait(10_ms);
  EXPECT_FALSE(alive());
  EXPECT_EQ(number(bus.read(0, 0x0443, 1).data), 1U);
  host_read(bus.slave(), 0x0220, 4);
  EXPECT_TRUE(alive()) << "any access revives it";
}

}  // namespace
}  // namespace stator::ethercat
