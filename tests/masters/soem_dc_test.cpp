// What SOEM's configdc and dcsync send, and the FRMW of its cyclic exchange.

#include <vector>

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

constexpr std::uint64_t kHostTime = 800'000'000'000'000'000;  // ns since 2000, somewhere in 2025

class SoemDc : public ::testing::Test {
 protected:
  SoemDc() : bus(3), soem(bus) { soem.config_init(); }

  /// Read in one frame.
  std::vector<std::uint64_t> system_times() {
    for (std::size_t i = 0; i < bus.size(); ++i) {
      bus.with(Command::fprd, ethercat::physical_address(Soem::station(i), 0x0910), zeros(8));
    }
    std::vector<std::uint64_t> times;
    for (const Answer& answer : bus.send()) {
      EXPECT_EQ(answer.working_counter, 1U);
      times.push_back(number(answer.data));
    }
    return times;
  }

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemDc, AFourByteBroadcastLatchesTheReceiveTimesOfAllSlaves) {
  const Bytes before = bus.fprd(Soem::station(1), 0x0918, 8).data;
  EXPECT_EQ(bus.bwr(0x0900, zeros(4)).working_counter, 3U);
  EXPECT_GT(number(bus.fprd(Soem::station(1), 0x0918, 8).data), number(before));
  const auto port0 = number(bus.fprd(Soem::station(1), 0x0900, 4).data);
  EXPECT_EQ(port0, number(bus.fprd(Soem::station(1), 0x0918, 4).data))
      << "the processing unit lies behind port 0";
}

TEST_F(SoemDc, TheFirstPortToSeeTheFrameIsTheEntryPort) {
  bus.bwr(0x0900, zeros(4));
  for (std::size_t i = 0; i + 1 < bus.size(); ++i) {
    const Bytes times = bus.fprd(Soem::station(i), 0x0900, 8).data;
    EXPECT_LT(base::load_le<std::uint32_t>(times, 0), base::load_le<std::uint32_t>(times, 4)) << i;
  }
}

TEST_F(SoemDc, HalfTheDifferencesOfReceiveTimesIsTheRealPropagationDelay) {
  const auto clocks = soem.config_dc(kHostTime);
  constexpr std::uint32_t kPerSlave = 300 + 10;  // forwarding and cable, ns
  EXPECT_EQ(clocks[1].delay, kPerSlave);
  EXPECT_EQ(clocks[2].delay, 2 * kPerSlave);
  EXPECT_EQ(number(bus.fprd(Soem::station(2), 0x0928, 4).data), 2 * kPerSlave);
}

TEST_F(SoemDc, TheOffsetsGiveAllSlavesTheTimeOfTheHost) {
  soem.config_dc(kHostTime);
  for (const std::uint64_t system_time : system_times()) {
    EXPECT_GT(system_time, kHostTime);
    EXPECT_LT(system_time, kHostTime + 1'000'000);
  }
}

TEST_F(SoemDc, TheReferenceTimeBringsAllSlavesToTheSameTimeToTheNanosecond) {
  soem.config_dc(kHostTime);
  for (int cycle = 0; cycle < 100; ++cycle) {
    bus.frmw(Soem::station(0), 0x0910, 8);
    bus.pass(1_ms);
  }
  const auto times = system_times();
  EXPECT_EQ(times, std::vector<std::uint64_t>(3, times[0]));
}

TEST_F(SoemDc, TheSyncRegistersTakeWhatDcsyncWrites) {
  soem.config_dc(kHostTime);
  const std::uint16_t station = Soem::station(1);
  const auto write = [&](std::uint16_t address, std::uint64_t value, std::size_t length) {
    EXPECT_EQ(bus.fpwr(station, address, little_endian(value, length)).working_counter, 1U)
        << std::hex << address;
  };
  constexpr std::uint64_t kCycle = 1'000'000;
  write(0x0981, 0, 1);
  write(0x0980, 0, 1);
  const std::uint64_t time = number(bus.fprd(station, 0x0910, 8).data);
  const std::uint64_t start = (time + 100'000'000) / kCycle * kCycle + kCycle;
  write(0x0990, start, 8);
  write(0x09A0, kCycle, 4);
  EXPECT_EQ(number(bus.fprd(station, 0x09A0, 4).data), kCycle);
  write(0x0981, 3, 1);
  EXPECT_EQ(number(bus.fprd(station, 0x0981, 1).data), 3U);
  write(0x0981, 0, 1);
  write(0x09A4, kCycle / 2, 4);
  write(0x0981, 7, 1);
  EXPECT_EQ(number(bus.fprd(station, 0x09A4, 4).data), kCycle / 2);
}

TEST_F(SoemDc, EachCycleTheReferenceTimeReachesEverySlave) {
  soem.config_map();
  soem.config_dc(kHostTime);
  soem.to_operational();
  for (int cycle = 0; cycle < 100; ++cycle) {
    const auto answers = soem.exchange(zeros(soem.image_length()));
    ASSERT_EQ(answers[0].working_counter, soem.expected_working_counter());
    ASSERT_EQ(answers[1].working_counter, 3U) << "read at the first, written at the others";
    ASSERT_GT(number(answers[1].data), kHostTime);
    bus.pass(1_ms);
  }
  for (std::size_t i = 1; i < bus.size(); ++i) {
    EXPECT_EQ(number(bus.fprd(Soem::station(i), 0x092C, 4).data) & 0x7FFFFFFF, 0U) << i;
  }
}

TEST_F(SoemDc, ASlaveThatRunsFastIsKeptWithTheReference) {
  ethercat::SlaveControllerConfiguration fast;
  fast.clock_deviation_ppb = 20'000;
  bus.add_controller(fast);
  soem.set_addresses();
  soem.config_dc(kHostTime);
  bus.pass(100_ms);
  bus.frmw(Soem::station(0), 0x0910, 8);
  const auto before = number(bus.fprd(Soem::station(3), 0x092C, 4).data);
  EXPECT_GT(before, 100U);
  EXPECT_EQ(before & 0x80000000, 0U) << "bit 31 clear: it is ahead";
  for (int cycle = 0; cycle < 2000; ++cycle) {
    bus.frmw(Soem::station(0), 0x0910, 8);
    bus.pass(1_ms);
  }
  EXPECT_LT(number(bus.fprd(Soem::station(3), 0x092C, 4).data) & 0x7FFFFFFF, 100U);
}

}  // namespace
}  // namespace stator::tests
