// Features, memory and reset values of the TMC8461's and TMC8670's slave controllers.
#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_ms;
using testing::bytes;
using testing::controller_of;
using testing::find_controller;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

TestBus bus_of(std::string_view device, std::string_view preset = {}) {
  return TestBus(1, controller_of(device, preset));
}

TEST(ControllerPresets, AreFoundByProductAndName) {
  EXPECT_EQ(find_controller("tmc8670")->name, "document");
  EXPECT_EQ(find_controller("tmc8670", "silicon")->name, "silicon");
  EXPECT_EQ(find_controller("tmc8670", "gold"), nullptr);
  EXPECT_EQ(find_controller("tmc8462"), nullptr);
}

TEST(Tmc8461Preset, IdentifiesItselfAsTheDocumentPrints) {
  TestBus bus = bus_of("tmc8461");
  EXPECT_EQ(bus.read(0, 0x0000, 10).data,
            bytes({0xD0, 0x61, 0x11, 0x00, 8, 8, 16, 0x0F, 0xCC, 0x01}));
  EXPECT_EQ(bus.read(0, 0x0E00, 16).data, bytes({0x61, 0x84, 0x10, 0x01, 0, 0, 0, 0,  //
                                                 0x86, 0x02, 0, 0, 1, 0, 0, 0}));
}

TEST(Tmc8461Preset, Has16KilobytesFrom1000h) {
  TestBus bus = bus_of("tmc8461");
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x4FFF, bytes({1})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x5000, bytes({1})).working_counter, 0U);
  EXPECT_EQ(host_read(bus.slave(), 0x4FFF, 2), bytes({1, 0}));
}

TEST(Tmc8461Preset, BeforeTheEepromIsLoaded_ShowsTheDocumentsResetValues) {
  SlaveController bare(controller_of("tmc8461"));
  const auto shown = [&bare](std::uint16_t address, std::size_t length) {
    testing::Bytes value(length);
    bare.peek(address, value);
    return value;
  };
  EXPECT_EQ(shown(0x0140, 2), zeros(2));
  EXPECT_EQ(shown(0x0151, 1), bytes({0x66}));
  EXPECT_EQ(number(shown(0x0502, 2)) & 0x1000U, 0x1000U) << "not loaded";
  EXPECT_EQ(number(shown(0x0110, 1)) & 1U, 0U);
  EXPECT_EQ(shown(0x014E, 1), bytes({0}));
}

TEST(Tmc8670Preset, IdentifiesItselfAsTheDocumentPrints) {
  for (const std::string_view preset : {"document", "silicon"}) {
    TestBus bus = bus_of("tmc8670", preset);
    EXPECT_EQ(bus.read(0, 0x0000, 10).data,
              bytes({0xD0, 0x70, 0x10, 0x00, 4, 4, 4, 0x0F, 0xCC, 0x01}));
    EXPECT_EQ(bus.read(0, 0x0E00, 16).data, bytes({0x70, 0x86, 0x00, 0x01, 0, 0, 0, 0,  //
                                                   0x86, 0x02, 0, 0, 1, 0, 0, 0}));
  }
}

TEST(Tmc8670Preset, Has4KilobytesFrom1000h) {
  TestBus bus = bus_of("tmc8670");
  EXPECT_EQ(bus.write(0, 0x1FFF, bytes({1})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x2000, bytes({1})).working_counter, 0U);
}

TEST(Tmc8670Preset, HasFourChannelsOfEachKind) {
  TestBus bus = bus_of("tmc8670");
  bus.set_sync_manager(0, 3, {.start = 0x1100, .length = 2, .control = 0x20});
  host_write(bus.slave(), 0x1100, bytes({1, 2}));
  bus.set_fmmu(0, 3, {.logical = 0, .length = 2, .physical = 0x1100, .type = 1});
  EXPECT_EQ(bus.transfer(Command::lrd, 0, zeros(2)).data, bytes({1, 2}));
  EXPECT_EQ(bus.write(0, 0x0640, zeros(16)).working_counter, 0U);
  EXPECT_EQ(bus.write(0, 0x0820, zeros(8)).working_counter, 0U);
}

TEST(UserRam, IsPlainMemoryOfBothSidesAndStartsAtZero) {
  for (const std::string_view device : {"tmc8461", "tmc8670"}) {
    TestBus bus = bus_of(device);
    EXPECT_EQ(bus.read(0, 0x0F80, 128).data, zeros(128));
    bus.write(0, 0x0F80, bytes({0x12, 0x34}));
    EXPECT_EQ(host_read(bus.slave(), 0x0F80, 2), bytes({0x12, 0x34}));
    host_write(bus.slave(), 0x0FFF, bytes({0x56}));
    EXPECT_EQ(number(bus.read(0, 0x0FFF, 1).data), 0x56U);
  }
}

TEST(Tmc8670Silicon, WatchdogDividerAndHostTimeCannotBeWritten) {
  TestBus bus = bus_of("tmc8670", "silicon");
  EXPECT_EQ(bus.write(0, 0x0400, bytes({1, 0})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x0410, bytes({1, 0})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x0400, 2).data), 0x09C2U);
  EXPECT_EQ(number(bus.read(0, 0x0410, 2).data), 0x03E8U);
  bus.write(0, 0x0420, bytes({10, 0}));
  bus.set_sync_manager(0, 2, {.start = 0x1100, .length = 2, .control = 0x64});
  bus.write(0, 0x1100, bytes({1, 2}));
  bus.wait(2_ms);
  EXPECT_EQ(number(bus.read(0, 0x0442, 1).data), 1U) << "the process data time can: 1 ms";
}

TEST(Tmc8670Silicon, CountersThatAreNotBuiltStayZero) {
  TestBus bus = bus_of("tmc8670", "silicon");
  bus.slave().count_malformed_frame();
  bus.slave().count_host_error(0x1B);
  bus.slave().set_link(0, false);
  bus.slave().set_link(0, true);
  bus.slave().count_receive_error(0, ReceiveError::invalid_frame);
  EXPECT_EQ(bus.read(0, 0x030C, 3).data, zeros(3));
  EXPECT_EQ(bus.read(0, 0x0310, 4).data, zeros(4));
  EXPECT_EQ(number(bus.read(0, 0x0300, 1).data), 1U) << "these are built";
}

TEST(Tmc8670Silicon, ProtectionAndOffsetHaveNoEffect) {
  TestBus bus = bus_of("tmc8670", "silicon");
  EXPECT_EQ(bus.write(0, 0x0021, bytes({1})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x0031, bytes({1})).working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1})).working_counter, 1U) << "nothing is protected";
  EXPECT_EQ(bus.write(0, 0x0108, bytes({0x10, 0})).working_counter, 1U);
  bus.write(0, 0x0010, bytes({0x01, 0x10}));
  bus.transfer(Command::aprw, physical_address(0, 0x1000), bytes({7}));
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 7U) << "written where it was read";
  bus.transfer(Command::fprw, physical_address(0x1001, 0x1000), bytes({8}));
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 8U);
  EXPECT_EQ(number(bus.read(0, 0x1010, 1).data), 0U);
}

TEST(Tmc8670Silicon, EepromStaysTheMasters) {
  TestBus bus = bus_of("tmc8670", "silicon");
  EXPECT_EQ(bus.write(0, 0x0500, bytes({1})).working_counter, 1U);
  host_write(bus.slave(), 0x0501, bytes({1}));
  EXPECT_EQ(number(bus.read(0, 0x0500, 2).data), 0U);
  EXPECT_EQ(bus.write(0, 0x0504, zeros(4)).working_counter, 1U);
}

TEST(Tmc8670Silicon, LinkDetectionIsAbsentButPhysCanBeRead) {
  TestBus bus = bus_of("tmc8670", "silicon");
  EXPECT_EQ(number(bus.read(0, 0x0510, 1).data), 0x02U);
  const auto status = bus.read(0, 0x0518, 4);
  EXPECT_EQ(status.working_counter, 1U);
  EXPECT_EQ(status.data, zeros(4));
  bus.write(0, 0x0510, bytes({0, 1, 0, 2}));
  bus.wait(1_ms);
  EXPECT_EQ(number(bus.read(0, 0x0514, 2).data), 0x0022U);
}

}  // namespace
}  // namespace stator::ethercat
