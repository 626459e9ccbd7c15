// How known masters set up and run distributed clocks, datagram by datagram.

#include <gtest/gtest.h>

#include "ethercat/dc_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::SimTime;
using testing::Answer;
using testing::Bytes;
using testing::bytes;
using testing::little_endian;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr std::uint32_t kCycle = 1'000'000;

/// Four slaves in line with clocks of their own; the third has no distributed clocks.
class DcMasters : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kClocks[] = {0, 1, 3};
  static constexpr std::uint16_t kReference = 0;
  static constexpr std::uint16_t kWithout = 2;

  DcMasters() : bus(0) {
    for (const std::int32_t deviation : {5'000, -30'000, 0, 45'000}) {
      SlaveControllerConfiguration chip;
      chip.clock_deviation_ppb = deviation;
      if (deviation == 0) {
        chip.features = ControllerFeature::user_ram;
      }
      bus.add(chip, SimDuration(70)).load_sii(testing::dc_sii({}));
      bus.wait(SimDuration(1'234'567));
    }
    for (std::uint16_t i = 0; i < 4; ++i) {
      bus.write(i, 0x0010, little_endian(station(i), 2));
    }
  }
  static std::uint16_t station(std::uint16_t slave) {
    return static_cast<std::uint16_t>(0x1001 + slave);
  }
  Answer fprd(std::uint16_t slave, std::uint16_t address, std::size_t length) {
    return bus.transfer(Command::fprd, physical_address(station(slave), address), zeros(length));
  }
  unsigned fpwr(std::uint16_t slave, std::uint16_t address, const Bytes& data) {
    return bus.transfer(Command::fpwr, physical_address(station(slave), address), data)
        .working_counter;
  }
  std::uint64_t get(std::uint16_t slave, std::uint16_t address, std::size_t length) {
    return number(fprd(slave, address, length).data);
  }
  /// Receive times of a line: the delay is half the difference of the waits of two neighbours.
  std::vector<std::uint32_t> delays() {
    std::vector<std::uint32_t> result;
    std::uint32_t wait_before = 0;
    for (const std::uint16_t slave : kClocks) {
      const auto port0 = static_cast<std::uint32_t>(get(slave, 0x0900, 4));
      const auto port1 = static_cast<std::uint32_t>(get(slave, 0x0904, 4));
      const std::uint32_t wait = slave == 3 ? 0 : port1 - port0;
      result.push_back(result.empty() ? 0 : result.back() + (wait_before - wait) / 2);
      wait_before = wait;
    }
    return result;
  }
  /// One cycle of 1 ms with the reference's time in `length` bytes.
  unsigned cycle(Command command, std::uint16_t address, std::size_t length) {
    bus.wait(SimDuration(kCycle - 10'000));
    return bus.transfer(command, physical_address(address, 0x0910), zeros(length)).working_counter;
  }
  /// All slaves with SYNC0 give it together, within `tolerance` ns of simulated time.
  void expect_sync0_together(std::int64_t tolerance, unsigned output = 0) {
    std::int64_t earliest = SimTime::never().nanoseconds();
    std::int64_t latest = 0;
    for (const std::uint16_t slave : kClocks) {
      const std::int64_t edge = bus.slave(slave).next_sync_edge(output).nanoseconds();
      earliest = std::min(earliest, edge);
      latest = std::max(latest, edge);
    }
    EXPECT_LT(latest, (bus.now() + SimDuration(2 * kCycle)).nanoseconds());
    EXPECT_LE(latest - earliest, tolerance);
  }

  TestBus bus;
};

TEST_F(DcMasters, Soem_ConfiguresClocksAndSync0) {
  EXPECT_EQ(bus.broadcast_write(0x0981, zeros(1)).working_counter, 3U);
  bus.broadcast_write(0x0910, zeros(4));
  bus.broadcast_write(0x0930, bytes({0x00, 0x10}));
  bus.broadcast_write(0x0934, bytes({0x00, 0x0C}));
  EXPECT_EQ(get(0, 0x0008, 2) & 0x04U, 0x04U);
  EXPECT_EQ(get(kWithout, 0x0008, 2) & 0x04U, 0U);

  EXPECT_EQ(bus.broadcast_write(0x0900, zeros(4)).working_counter, 3U);
  const std::vector<std::uint32_t> measured = delays();
  const std::uint64_t host_time = 750'000'000'000'000'000;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const std::uint64_t unit = get(kClocks[i], 0x0918, 8);
    EXPECT_EQ(fpwr(kClocks[i], 0x0920, little_endian(host_time - unit, 8)), 1U);
    EXPECT_EQ(fpwr(kClocks[i], 0x0928, little_endian(measured[i], 4)), 1U);
  }
  for (const std::uint16_t slave : kClocks) {
    fpwr(slave, 0x0981, zeros(1));
    fpwr(slave, 0x0980, zeros(1));
    const std::uint64_t now = get(slave, 0x0910, 8);
    EXPECT_EQ(fpwr(slave, 0x0990, little_endian((now + 100'000'000) / kCycle * kCycle, 8)), 1U);
    EXPECT_EQ(fpwr(slave, 0x09A0, little_endian(kCycle, 4)), 1U);
    EXPECT_EQ(fpwr(slave, 0x09A4, zeros(4)), 1U);
    EXPECT_EQ(fpwr(slave, 0x0981, bytes({3})), 1U);
    EXPECT_EQ(get(slave, 0x0984, 1), 1U);
  }
  for (int i = 0; i < 4'000; ++i) {
    ASSERT_EQ(cycle(Command::frmw, station(kReference), 8), 3U);
  }
  expect_sync0_together(200);
  EXPECT_GT(bus.slave(3).sync_pulse_count(0), 3'800U);
}

TEST_F(DcMasters, Igh_ConfiguresClocksAndSync0) {
  EXPECT_EQ(bus.broadcast_write(0x0900, zeros(1)).working_counter, 3U);
  for (std::uint16_t slave = 0; slave < 4; ++slave) {
    const bool has_clock = slave != kWithout;
    EXPECT_EQ(bus.read(slave, 0x0900, 16).working_counter, has_clock ? 1U : 0U);
    EXPECT_EQ(fprd(slave, 0x0910, 8).working_counter, has_clock ? 1U : 0U);
    EXPECT_EQ(fprd(slave, 0x0910, 4).working_counter, has_clock ? 1U : 0U);
    fpwr(slave, 0x0980, zeros(2));
  }
  const std::vector<std::uint32_t> measured = delays();
  const auto application_time = [&] {
    return static_cast<std::uint64_t>(bus.now().nanoseconds()) + 700'000'000'000'000'000;
  };
  for (std::size_t i = 0; i < measured.size(); ++i) {
    // System time, offset and delay in one read of 28 bytes.
    const Answer clock = fprd(kClocks[i], 0x0910, 28);
    ASSERT_EQ(clock.working_counter, 1U);
    const std::uint64_t system_time = number(std::span(clock.data).first(8));
    const std::uint64_t offset = number(std::span(clock.data).subspan(16, 8));
    Bytes settings = little_endian(application_time() - system_time + offset, 8);
    const Bytes delay = little_endian(measured[i], 4);
    settings.insert(settings.end(), delay.begin(), delay.end());
    EXPECT_EQ(fpwr(kClocks[i], 0x0920, settings), 1U);
    EXPECT_EQ(fpwr(kClocks[i], 0x0930, bytes({0x00, 0x10})), 1U);
  }
  const auto run = [&](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      bus.wait(SimDuration(kCycle - 10'000));
      bus.with(Command::fpwr, physical_address(station(kReference), 0x0910),
               little_endian(application_time() + 10'000, 4))
          .with(Command::frmw, physical_address(station(kReference), 0x0910), zeros(4))
          .with(Command::brd, physical_address(0, 0x092C), zeros(4));
      const std::vector<Answer> answers = bus.send();
      EXPECT_EQ(answers[0].working_counter, 1U);
      EXPECT_EQ(answers[1].working_counter, 3U);
      EXPECT_EQ(answers[2].working_counter, 3U);
    }
  };
  run(3'000);
  for (const std::uint16_t slave : kClocks) {
    EXPECT_LE(get(slave, 0x092C, 4) & 0x7FFFFFFFU, 10'000U) << "settled, it would wait for 5 s";
    Bytes cycles = little_endian(kCycle, 8);
    EXPECT_EQ(fpwr(slave, 0x09A0, cycles), 1U);
    const std::uint64_t start = (application_time() + 100'000'000) / kCycle * kCycle + 250'000;
    EXPECT_EQ(fpwr(slave, 0x0990, little_endian(start, 8)), 1U);
    EXPECT_EQ(fpwr(slave, 0x0980, bytes({0x00, 0x03})), 1U) << "AssignActivate 0x0300";
    EXPECT_EQ(get(slave, 0x0981, 1), 3U);
  }
  run(1'000);
  expect_sync0_together(300);
  const SimTime edge = bus.slave(3).next_sync_edge(0);
  EXPECT_NEAR(static_cast<double>((edge.nanoseconds() + 700'000'000'000'000'000) % kCycle),
              250'000.0, 300.0)
      << "in phase with the application time";
}

TEST_F(DcMasters, Ethercrab_CountsClocksAndSettlesThemBeforePreOperational) {
  for (const auto& [address, length] :
       std::initializer_list<std::pair<std::uint16_t, std::size_t>>{{0x0910, 8},
                                                                    {0x0920, 8},
                                                                    {0x0928, 4},
                                                                    {0x0981, 1},
                                                                    {0x0990, 8},
                                                                    {0x09A0, 4},
                                                                    {0x09A4, 4}}) {
    EXPECT_EQ(bus.broadcast_write(address, zeros(length)).working_counter, 3U)
        << std::hex << address;
  }
  bus.broadcast_write(0x092C, zeros(4));
  EXPECT_EQ(bus.broadcast_write(0x0934, bytes({0x00, 0x0C})).working_counter, 3U);
  EXPECT_EQ(bus.broadcast_write(0x0930, bytes({0x00, 0x10})).working_counter, 3U);
  EXPECT_EQ(bus.broadcast_write(0x0900, zeros(4)).working_counter, 3U) << "exactly the DC slaves";
  const std::vector<std::uint32_t> measured = delays();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Answer ports = fprd(kClocks[i], 0x0900, 16);
    EXPECT_EQ(ports.working_counter, 1U);
    const std::uint64_t unit = get(kClocks[i], 0x0918, 8);
    EXPECT_EQ(number(std::span(ports.data).first(4)), unit & 0xFFFFFFFF);
    const std::uint64_t offset = std::uint64_t{1} << 60;
    EXPECT_EQ(fpwr(kClocks[i], 0x0920, little_endian(offset - unit, 8)), 1U);
    EXPECT_EQ(fpwr(kClocks[i], 0x0928, little_endian(measured[i], 4)), 1U);
  }
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(bus.transfer(Command::frmw, physical_address(station(kReference), 0x0910), zeros(8))
                  .working_counter,
              3U);
  }
  for (const std::uint16_t slave : kClocks) {
    fpwr(slave, 0x0981, zeros(1));
    const std::uint64_t now = get(slave, 0x0910, 8);
    const std::uint64_t start = (now + 100'000'000) / kCycle * kCycle;
    EXPECT_EQ(fpwr(slave, 0x0990, little_endian(start, 8)), 1U);
    EXPECT_EQ(fpwr(slave, 0x09A0, little_endian(kCycle, 8)), 1U);
    EXPECT_EQ(fpwr(slave, 0x09A4, little_endian(kCycle / 4, 4)), 1U);
    EXPECT_EQ(fpwr(slave, 0x0981, bytes({7})), 1U);
  }
  for (int i = 0; i < 300; ++i) {
    cycle(Command::frmw, station(kReference), 8);
  }
  expect_sync0_together(100, 0);
  expect_sync0_together(100, 1);
}

TEST_F(DcMasters, TwinCat_MeasuresOftenAndDistributesWithArmw) {
  // Clears 0x0910..0x092F in one datagram.
  EXPECT_EQ(bus.broadcast_write(0x0910, zeros(32)).working_counter, 3U);
  std::vector<std::uint32_t> first;
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(bus.broadcast_write(0x0900, zeros(8)).working_counter, 3U);
    for (const std::uint16_t slave : kClocks) {
      EXPECT_EQ(bus.read(slave, 0x0900, 32).working_counter, 1U);
    }
    const std::vector<std::uint32_t> measured = delays();
    first = first.empty() ? measured : first;
    for (std::size_t k = 0; k < measured.size(); ++k) {
      EXPECT_NEAR(measured[k], first[k], 2.0) << "every time the same but for rounding";
    }
  }
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::uint64_t unit = get(kClocks[i], 0x0918, 8);
    fpwr(kClocks[i], 0x0920, little_endian(0x0123'4567'0000'0000 - unit, 8));
    fpwr(kClocks[i], 0x0928, little_endian(first[i], 4));
  }
  bus.broadcast_write(0x0930, bytes({0x00, 0x10}));
  for (int i = 0; i < 8'000; ++i) {
    ASSERT_EQ(bus.transfer(Command::armw,
                           physical_address(auto_increment_address(kReference), 0x0910), zeros(4))
                  .working_counter,
              3U);
  }
  for (const std::uint16_t slave : kClocks) {
    EXPECT_LE(get(slave, 0x092C, 4) & 0x7FFFFFFFU, 50U);
    EXPECT_NEAR(static_cast<double>(
                    static_cast<std::int64_t>(bus.slave(slave).system_time(bus.now()) -
                                              bus.slave(kReference).system_time(bus.now()))),
                0.0, 50.0);
  }
}

}  // namespace
}  // namespace stator::ethercat
