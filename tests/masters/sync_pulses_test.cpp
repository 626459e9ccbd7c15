// How masters start SYNC0 and SYNC1, and what they read of the pulses.

#include <gtest/gtest.h>

#include "masters/soem.hpp"

namespace stator::tests {
namespace {

constexpr std::uint64_t kHostTime = 800'000'000'000'000'000;
constexpr std::uint64_t kCycle = 1'000'000;
constexpr std::uint64_t kPropagation = 1'000;  // the bus sees system time less the delay

class SyncPulses : public ::testing::Test {
 protected:
  SyncPulses() : bus(2), soem(bus) {
    soem.config_init();
    soem.config_dc(kHostTime);
  }
  void write(std::uint16_t address, std::uint64_t value, std::size_t length) {
    EXPECT_EQ(bus.fpwr(station, address, little_endian(value, length)).working_counter, 1U)
        << std::hex << address;
  }
  std::uint64_t read(std::uint16_t address, std::size_t length) {
    return number(bus.fprd(station, address, length).data);
  }
  /// As dcsync: the first pulse 100 ms ahead at a whole number of cycles.
  std::uint64_t start_time() { return (read(0x0910, 8) + 100'000'000) / kCycle * kCycle + kCycle; }
  /// The next pulse lies ahead, less than a cycle away, in the grid of the start time.
  void expect_pulse_ahead(std::uint64_t start) {
    const auto answers =
        bus.with(Command::fprd, ethercat::physical_address(station, 0x0910), zeros(8))
            .with(Command::fprd, ethercat::physical_address(station, 0x0990), zeros(8))
            .send();
    const std::uint64_t now = number(answers[0].data);
    const std::uint64_t next = number(answers[1].data);
    ASSERT_GE(next, now);
    ASSERT_LE(next, now + kCycle + kPropagation);
    ASSERT_EQ((next - start) % kCycle, 0U);
  }

  DeviceBus bus;
  Soem soem;
  std::uint16_t station = Soem::station(1);
};

TEST_F(SyncPulses, SoemsDcsync0_TheNextPulseAdvancesInTheGridOfItsStart) {
  write(0x0981, 0, 1);
  write(0x0980, 0, 1);
  const std::uint64_t start = start_time();
  write(0x0990, start, 8);
  write(0x09A0, kCycle, 4);
  write(0x0981, 3, 1);
  EXPECT_EQ(read(0x0990, 8), start) << "nothing before the start";
  bus.pass(150_ms);
  for (int cycle = 0; cycle < 50; ++cycle) {
    ASSERT_NO_FATAL_FAILURE(expect_pulse_ahead(start));
    bus.pass(1_ms);
  }
}

TEST_F(SyncPulses, SoemsDcsync01_TheSecondPulseFollowsTheFirst) {
  write(0x0981, 0, 1);
  write(0x0980, 0, 1);
  const std::uint64_t start = start_time();
  write(0x0990, start, 8);
  write(0x09A0, kCycle, 4);
  write(0x09A4, kCycle / 2, 4);
  write(0x0981, 7, 1);
  bus.pass(150_ms);
  for (int cycle = 0; cycle < 20; ++cycle) {
    EXPECT_EQ((read(0x0998, 8) - start) % kCycle, kCycle / 2);
    bus.pass(1_ms);
  }
}

TEST_F(SyncPulses, IghsAssignActivateWordStartsThePulses) {
  write(0x0980, 0, 2);
  write(0x09A0, kCycle, 8);
  const std::uint64_t start = start_time();
  write(0x0990, start, 8);
  write(0x0980, 0x0300, 2);
  bus.pass(150_ms);
  ASSERT_NO_FATAL_FAILURE(expect_pulse_ahead(start));
}

TEST_F(SyncPulses, EthercrabsOrderStartsThePulses) {
  write(0x0981, 0, 1);
  const std::uint64_t start = start_time();
  write(0x0990, start, 8);
  write(0x09A0, kCycle, 8);
  write(0x0981, 3, 1);
  bus.pass(150_ms);
  ASSERT_NO_FATAL_FAILURE(expect_pulse_ahead(start));
}

TEST_F(SyncPulses, SwitchedOffTheNextPulseStandsStill) {
  const std::uint64_t start = start_time();
  write(0x0990, start, 8);
  write(0x09A0, kCycle, 4);
  write(0x0981, 3, 1);
  bus.pass(150_ms);
  ASSERT_NO_FATAL_FAILURE(expect_pulse_ahead(start));
  write(0x0981, 0, 1);
  const std::uint64_t last = read(0x0990, 8);
  bus.pass(50_ms);
  EXPECT_EQ(read(0x0990, 8), last);
}

}  // namespace
}  // namespace stator::tests
