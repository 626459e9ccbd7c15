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

TEST(Addressing, ReadWriteOffset_MovesTheWritePartOfFprw) {
  TestBus bus;
  bus.write(0, 0x0010, bytes({0x01, 0x10}));
  bus.write(0, 0x0108, bytes({0x10, 0x00}));
  bus.write(0, 0x1000, bytes({0xAA}));
  const Answer answer =
      bus.transfer(Command::fprw, physical_address(0x1001, 0x1000), bytes({0x55}));
  EXPECT_EQ(answer.working_counter, 3U);
  EXPECT_EQ(number(answer.data), 0xAAU);
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 0xAAU);
  EXPECT_EQ(number(bus.read(0, 0x1010, 1).data), 0x55U);
}

TEST(Addressing, MemoryEndsWhereTheRamEnds) {
  TestBus bus;
  EXPECT_EQ(bus.write(0, 0x4FFF, bytes({1, 2})).working_counter, 1U) << "first byte exists";
  EXPECT_EQ(bus.read(0, 0x5000, 1).working_counter, 0U);
  EXPECT_EQ(bus.read(0, 0xFFFF, 4).working_counter, 0U);
}

}  // namespace
}  // namespace stator::ethercat
