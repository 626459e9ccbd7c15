// What each EtherCAT command counts and moves, station alias, and the read/write offset 0210h.
#include <ostream>

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::Answer;
using testing::Bytes;
using testing::bytes;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr std::uint16_t kUserRam = 0x0F80;

/// A probe: three slaves with stations 1001h..1003h and 10h, 20h, 40h in their user RAM.
struct Probe {
  const char* name;
  Command command;
  std::uint32_t address;
  unsigned data;
  unsigned working_counter;
  unsigned returned_data;
  unsigned ram[3];  ///< afterwards
  friend void PrintTo(const Probe& probe, std::ostream* out) { *out << probe.name; }
};

class Commands : public ::testing::TestWithParam<Probe> {};

TEST_P(Commands, CountAndMoveExactly) {
  const Probe& probe = GetParam();
  TestBus bus(3);
  for (std::uint16_t i = 0; i < 3; ++i) {
    bus.write(i, 0x0010, testing::little_endian(0x1001U + i, 2));
    bus.write(i, kUserRam, bytes({0x10U << i}));
  }
  const Answer answer = bus.transfer(probe.command, probe.address, bytes({probe.data}));
  EXPECT_TRUE(answer.returned);
  EXPECT_EQ(answer.working_counter, probe.working_counter);
  EXPECT_EQ(number(answer.data), probe.returned_data);
  for (std::uint16_t i = 0; i < 3; ++i) {
    EXPECT_EQ(number(bus.read(i, kUserRam, 1).data), probe.ram[i]) << "slave " << i;
  }
}

constexpr std::uint32_t position(std::uint16_t slave) {
  return physical_address(auto_increment_address(slave), kUserRam);
}
constexpr std::uint32_t station(std::uint16_t address) {
  return physical_address(address, kUserRam);
}

INSTANTIATE_TEST_SUITE_P(
    All, Commands,
    ::testing::Values(
        Probe{"NOP", Command::nop, station(0x1001), 0x01, 0, 0x01, {0x10, 0x20, 0x40}},
        Probe{"APRD", Command::aprd, position(1), 0x01, 1, 0x20, {0x10, 0x20, 0x40}},
        Probe{"APRD_BehindTheLast", Command::aprd, position(3), 0x01, 0, 0x01, {0x10, 0x20, 0x40}},
        Probe{"APWR", Command::apwr, position(2), 0x01, 1, 0x01, {0x10, 0x20, 0x01}},
        Probe{"APRW", Command::aprw, position(0), 0x01, 3, 0x10, {0x01, 0x20, 0x40}},
        Probe{"FPRD", Command::fprd, station(0x1003), 0x01, 1, 0x40, {0x10, 0x20, 0x40}},
        Probe{"FPRD_Nobody", Command::fprd, station(0x2000), 0x01, 0, 0x01, {0x10, 0x20, 0x40}},
        Probe{"FPWR", Command::fpwr, station(0x1002), 0x01, 1, 0x01, {0x10, 0x01, 0x40}},
        Probe{"FPRW", Command::fprw, station(0x1002), 0x01, 3, 0x20, {0x10, 0x01, 0x40}},
        Probe{
            "BRD", Command::brd, physical_address(0, kUserRam), 0x01, 3, 0x71, {0x10, 0x20, 0x40}},
        Probe{
            "BWR", Command::bwr, physical_address(0, kUserRam), 0x01, 3, 0x01, {0x01, 0x01, 0x01}},
        Probe{
            "BRW", Command::brw, physical_address(0, kUserRam), 0x01, 9, 0x71, {0x01, 0x11, 0x31}},
        Probe{"LRD_Unmapped", Command::lrd, 0x10000, 0x01, 0, 0x01, {0x10, 0x20, 0x40}},
        Probe{"LWR_Unmapped", Command::lwr, 0x10000, 0x01, 0, 0x01, {0x10, 0x20, 0x40}},
        Probe{"LRW_Unmapped", Command::lrw, 0x10000, 0x01, 0, 0x01, {0x10, 0x20, 0x40}},
        Probe{"ARMW", Command::armw, position(1), 0x01, 3, 0x20, {0x01, 0x20, 0x20}},
        Probe{"FRMW", Command::frmw, station(0x1001), 0x01, 3, 0x10, {0x10, 0x10, 0x10}},
        Probe{"Unknown",
              static_cast<Command>(15),
              station(0x1001),
              0x01,
              0,
              0x01,
              {0x10, 0x20, 0x40}}),
    [](const auto& instance) { return instance.param.name; });

TEST(Addressing, EachSlaveCountsThePositionUp) {
  TestBus bus(3);
  EXPECT_EQ(bus.read(0, 0x0000, 1).address & 0xFFFF, 3U);
  EXPECT_EQ(bus.broadcast_read(0x0000, 1).address & 0xFFFF, 3U);
}

TEST(Addressing, Alias_CountsOnlyWhenEnabledAndIsReadOnlyForTheBus) {
  TestBus bus;
  bus.slave().load_sii(testing::valid_sii(0x1234));
  EXPECT_EQ(number(bus.read(0, 0x0012, 2).data), 0x1234U);
  EXPECT_EQ(bus.write(0, 0x0012, bytes({1, 1})).working_counter, 0U);
  const auto by_alias = [&] {
    return bus.transfer(Command::fprd, physical_address(0x1234, 0x0000), zeros(1)).working_counter;
  };
  EXPECT_EQ(by_alias(), 0U);
  bus.write(0, 0x0103, bytes({1}));
  EXPECT_EQ(by_alias(), 1U);
  host_write(bus.slave(), 0x0012, bytes({0x35, 0x12}));
  EXPECT_EQ(by_alias(), 0U) << "the host may change it";
}

/// Both bytes of the offset count: 0210h, from 1000h to 1210h.
class ReadWriteOffset : public ::testing::Test {
 protected:
  ReadWriteOffset() {
    bus.write(0, 0x0010, bytes({0x01, 0x10}));
    bus.write(0, 0x0108, bytes({0x10, 0x02}));
    bus.write(0, kRead, bytes({0xAA}));
  }
  std::uint64_t at(std::uint16_t address) { return number(bus.read(0, address, 1).data); }
  /// One exchange of a byte; what was read.
  std::uint64_t exchange(Command command, std::uint16_t slave, unsigned byte) {
    const Answer answer = bus.transfer(command, physical_address(slave, kRead), bytes({byte}));
    EXPECT_EQ(answer.working_counter, 3U);
    return number(answer.data);
  }

  static constexpr std::uint16_t kRead = 0x1000;
  static constexpr std::uint16_t kWritten = 0x1210;
  TestBus bus;
};

TEST_F(ReadWriteOffset, MovesTheWritePartOfFprwAndAprw) {
  EXPECT_EQ(exchange(Command::fprw, 0x1001, 0x55), 0xAAU);
  EXPECT_EQ(at(kRead), 0xAAU);
  EXPECT_EQ(at(kWritten), 0x55U);
  EXPECT_EQ(exchange(Command::aprw, 0, 0x66), 0xAAU);
  EXPECT_EQ(at(kRead), 0xAAU);
  EXPECT_EQ(at(kWritten), 0x66U);
}

TEST_F(ReadWriteOffset, MovesNoOtherCommand) {
  EXPECT_EQ(exchange(Command::brw, 0, 0x57), 0xAAU | 0x57U) << "a broadcast ORs";
  EXPECT_EQ(at(kRead), 0x57U) << "BRW writes where it reads";
  bus.transfer(Command::apwr, physical_address(0, kRead), bytes({0x58}));
  EXPECT_EQ(at(kRead), 0x58U);
  bus.transfer(Command::fpwr, physical_address(0x1001, kRead), bytes({0x59}));
  EXPECT_EQ(at(kRead), 0x59U);
  bus.transfer(Command::bwr, physical_address(0, kRead), bytes({0x5A}));
  EXPECT_EQ(at(kRead), 0x5AU);
  bus.transfer(Command::armw, physical_address(1, kRead), bytes({0x5B}));
  EXPECT_EQ(at(kRead), 0x5BU);
  bus.transfer(Command::frmw, physical_address(0x2002, kRead), bytes({0x5C}));
  EXPECT_EQ(at(kRead), 0x5CU);
  EXPECT_EQ(at(kWritten), 0U);
}

TEST(Addressing, MemoryEndsWhereTheRamEnds) {
  TestBus bus;
  EXPECT_EQ(bus.write(0, 0x4FFF, bytes({1, 2})).working_counter, 1U) << "first byte exists";
  EXPECT_EQ(bus.read(0, 0x5000, 1).working_counter, 0U);
  EXPECT_EQ(bus.read(0, 0xFFFF, 4).working_counter, 0U);
}

}  // namespace
}  // namespace stator::ethercat
