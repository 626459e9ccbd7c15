// Reset values and access rights of every register byte for bus and host, error counters,
// protection, reset.
#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::Answer;
using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

struct ResetValue {
  std::uint16_t address;
  std::size_t length;
  std::uint64_t value;
};

TEST(Registers, AfterPowerOn_HoldTheDocumentsValues) {
  TestBus bus;
  const ResetValue table[] = {
      {0x0000, 1, 0xD0},   {0x0001, 1, 0x61},       {0x0002, 2, 0x0011}, {0x0004, 1, 8},
      {0x0005, 1, 8},      {0x0006, 1, 16},         {0x0007, 1, 0x0F},   {0x0008, 2, 0x01CC},
      {0x0010, 2, 0},      {0x0100, 4, 0x00070001}, {0x0120, 2, 1},      {0x0130, 2, 1},
      {0x0134, 2, 0},      {0x0140, 1, 0x05},       {0x0200, 2, 0},      {0x0204, 4, 0x00FFFF0F},
      {0x0400, 2, 0x09C2}, {0x0410, 2, 0x03E8},     {0x0420, 2, 0x03E8}, {0x0500, 2, 0},
      {0x0805, 1, 0x30},   {0x0930, 2, 0x1000},     {0x0934, 1, 4},      {0x0935, 1, 12},
  };
  for (const ResetValue& row : table) {
    const Answer answer = bus.read(0, row.address, row.length);
    EXPECT_EQ(answer.working_counter, 1U) << std::hex << row.address;
    EXPECT_EQ(number(answer.data), row.value) << std::hex << row.address;
  }
}

/// Calls `visit(declaration, offset)` for every byte of every declared register's first channel.
template <typename Visitor>
void for_each_byte(Visitor visit) {
  for (const std::span<const RegisterDeclaration> group : register_groups()) {
    for (const RegisterDeclaration& declaration : group) {
      for (std::size_t i = 0; i < declaration.width / 8U; ++i) {
        visit(declaration, i);
      }
    }
  }
}

bool bus_may_write(const RegisterDeclaration& declaration, std::size_t byte) {
  return std::any_of(
      declaration.fields.begin(), declaration.fields.end(), [&](const RegisterField& field) {
        return field.bit_lo / 8U <= byte && byte <= field.bit_hi / 8U && may_write(field.bus);
      });
}

TEST(Registers, EveryReadOnlyByte_RefusesTheBusAndKeepsItsValue) {
  TestBus bus;
  for_each_byte([&](const RegisterDeclaration& declaration, std::size_t i) {
    if (bus_may_write(declaration, i)) {
      return;
    }
    const auto address = static_cast<std::uint16_t>(declaration.address + i);
    Bytes before(1);
    bus.slave().peek(address, before);
    const Answer answer = bus.write(0, address, bytes({0xA5}));
    EXPECT_EQ(answer.working_counter, 0U) << declaration.name << std::hex << " " << address;
    Bytes after(1);
    bus.slave().peek(address, after);
    EXPECT_EQ(after, before) << declaration.name << std::hex << " " << address;
  });
}

TEST(Registers, EveryDeclaredByte_LiesInTheRegisterSpaceOnce) {
  std::vector<int> uses(kRegisterSpace);
  for_each_byte([&](const RegisterDeclaration& declaration, std::size_t i) {
    EXPECT_EQ(declaration.width % 8, 0) << declaration.name;
    const std::size_t address = declaration.address + i;
    ASSERT_LT(address, kRegisterSpace);
    EXPECT_EQ(++uses[address], 1) << declaration.name;
  });
}

/// All that a byte allows and causes, in one number.
unsigned rights(const RegisterMap::Byte& byte) {
  return byte.bus_stores | unsigned{byte.host_stores} << 8 |
         static_cast<unsigned>(byte.effect) << 16 | unsigned{byte.bus_reads} << 24 |
         unsigned{byte.bus_writes} << 25 | unsigned{byte.host_reads} << 26 |
         unsigned{byte.host_writes} << 27 | unsigned{byte.built} << 28;
}

TEST(Registers, BytesThatAreDealtWithTogether_AllowAndCauseTheSame) {
  std::vector<ControllerPreset> presets;
  for (const auto& product : devices::products().products()) {
    const auto controllers = product->controllers();
    presets.insert(presets.end(), controllers.begin(), controllers.end());
  }
  for (const ControllerPreset& preset : presets) {
    const SlaveControllerConfiguration& chip = preset.configuration;
    const RegisterMap map(chip.features, chip.answered_features, chip.fmmu_count,
                          chip.sync_manager_count);
    for (std::size_t first = 0; first < kRegisterSpace; ++first) {
      ASSERT_LE(first + map[first].run(), kRegisterSpace);
      for (std::size_t i = 1; i < map[first].run(); ++i) {
        EXPECT_EQ(rights(map[first + i]), rights(map[first]))
            << preset.name << std::hex << " " << first << " and " << first + i;
      }
    }
    EXPECT_EQ(map[0x0910].run(), 4U) << "the half of the system time that is written";
    EXPECT_EQ(map[0x0920].run(), 8U);
  }
}

TEST(Registers, UndeclaredAndAbsentBytes_CountNothing) {
  SlaveControllerConfiguration small;
  small.fmmu_count = 4;
  small.sync_manager_count = 4;
  small.features = ControllerFeature::always;
  TestBus bus(1, small);
  constexpr std::array<std::uint16_t, 7> kAbsent{0x0014, 0x0020, 0x0040, 0x0640,
                                                 0x0820, 0x0910, 0x0F80};
  for (const std::uint16_t address : kAbsent) {
    EXPECT_EQ(bus.read(0, address, 1).working_counter, 0U) << std::hex << address;
    EXPECT_EQ(bus.write(0, address, bytes({1})).working_counter, 0U) << std::hex << address;
  }
}

TEST(Registers, PartlyPermittedAccess_CountsAndFillsTheRestWithZero) {
  TestBus bus;
  EXPECT_EQ(bus.write(0, 0x000E, zeros(4)).working_counter, 1U) << "0x0010 is writable";
  const Answer answer =
      bus.transfer(Command::aprd, physical_address(0, 0x0012), bytes({0xEE, 0xEE, 0xEE, 0xEE}));
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_EQ(number(answer.data), 0U);
}

TEST(Registers, ReservedBits_StayZero) {
  TestBus bus;
  bus.write(0, 0x0606, bytes({0xFF, 0xFF}));
  EXPECT_EQ(number(bus.read(0, 0x0606, 2).data), 0x0707U);
  bus.write(0, 0x0500, bytes({0xFC}));
  EXPECT_EQ(number(bus.read(0, 0x0500, 1).data), 0U);
}

TEST(Registers, HostSide_ReadsStationAddressButCannotChangeIt) {
  TestBus bus;
  bus.write(0, 0x0010, bytes({0x01, 0x10}));
  host_write(bus.slave(), 0x0010, bytes({0x55, 0x55}));
  EXPECT_EQ(number(host_read(bus.slave(), 0x0010, 2)), 0x1001U);
}

TEST(ErrorCounters, AnyWriteClearsTheGroupWhateverTheValue) {
  TestBus bus(2);  // a port without link does not count
  SlaveController& slave = bus.slave();
  slave.count_receive_error(0, ReceiveError::invalid_frame);
  slave.count_receive_error(1, ReceiveError::physical);
  slave.count_receive_error(1, ReceiveError::forwarded_error);
  slave.count_malformed_frame();
  EXPECT_EQ(bus.read(0, 0x0300, 13).data, bytes({1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(bus.write(0, 0x0305, bytes({0x77})).working_counter, 1U);
  EXPECT_EQ(bus.read(0, 0x0300, 13).data, bytes({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}))
      << "the processing unit counter is a group of its own";
  bus.write(0, 0x030C, bytes({0x77}));
  EXPECT_EQ(number(bus.read(0, 0x030C, 1).data), 0U);
}

TEST(ErrorCounters, Saturate) {
  TestBus bus;
  for (int i = 0; i < 300; ++i) {
    bus.slave().count_receive_error(0, ReceiveError::invalid_frame);
  }
  EXPECT_EQ(number(bus.read(0, 0x0300, 2).data), 0xFFU);
}

TEST(ErrorCounters, EveryOneStopsAtFF) {
  TestBus bus;
  SlaveController& slave = bus.slave();
  for (int i = 0; i < 260; ++i) {
    slave.count_receive_error(0, ReceiveError::invalid_frame);
    slave.count_receive_error(0, ReceiveError::physical);
    slave.count_receive_error(0, ReceiveError::forwarded_error);
    slave.count_malformed_frame();
    slave.count_host_error(0x15);
    slave.set_link(0, false);
    slave.set_link(0, true);
  }
  for (const std::uint16_t address :
       std::array<std::uint16_t, 6>{0x0300, 0x0301, 0x0308, 0x030C, 0x030D, 0x0310}) {
    EXPECT_EQ(number(bus.read(0, address, 1).data), 0xFFU) << std::hex << address;
  }
}

TEST(ErrorCounters, HostErrorKeepsTheLastCause) {
  TestBus bus;
  bus.slave().count_host_error(0x0B);
  bus.slave().count_host_error(0x53);
  EXPECT_EQ(bus.read(0, 0x030D, 2).data, bytes({2, 0x53}));
  EXPECT_EQ(host_read(bus.slave(), 0x030D, 2), bytes({2, 0x53}));
}

TEST(WriteProtection, RegistersUnlockForOneFrameOnly) {
  TestBus bus;
  bus.write(0, 0x0021, bytes({1}));
  EXPECT_EQ(bus.write(0, 0x0010, bytes({1, 0})).working_counter, 0U);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1})).working_counter, 1U) << "RAM is not covered";
  bus.with(Command::apwr, physical_address(0, 0x0020), bytes({0}))
      .with(Command::apwr, physical_address(0, 0x0010), bytes({7, 0}));
  const auto answers = bus.send();
  EXPECT_EQ(answers[1].working_counter, 1U);
  EXPECT_EQ(bus.write(0, 0x0010, bytes({1, 0})).working_counter, 0U);
  EXPECT_EQ(number(bus.read(0, 0x0010, 2).data), 7U);
}

TEST(WriteProtection, ControllerProtectionCoversTheMemoryToo) {
  TestBus bus;
  bus.write(0, 0x0031, bytes({1}));
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1})).working_counter, 0U);
  bus.with(Command::apwr, physical_address(0, 0x0030), bytes({0}))
      .with(Command::apwr, physical_address(0, 0x1000), bytes({7}));
  EXPECT_EQ(bus.send()[1].working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 7U);
}

TEST(ResetKey, ThreeStepsInConsecutiveFrames_ResetTheController) {
  TestBus bus;
  bus.write(0, 0x0010, bytes({1, 0x10}));
  bus.write(0, 0x0040, bytes({0x52}));
  bus.write(0, 0x0040, bytes({0x45}));
  EXPECT_FALSE(bus.slave().take_reset_request());
  bus.write(0, 0x0040, bytes({0x53}));
  EXPECT_TRUE(bus.slave().take_reset_request());
  EXPECT_FALSE(bus.slave().take_reset_request());
  EXPECT_EQ(number(bus.read(0, 0x0010, 2).data), 0U);
}

TEST(ResetKey, AFrameInBetween_SpoilsIt) {
  TestBus bus;
  bus.write(0, 0x0040, bytes({0x52}));
  bus.write(0, 0x0040, bytes({0x45}));
  bus.read(0, 0x0000, 1);
  bus.write(0, 0x0040, bytes({0x53}));
  EXPECT_FALSE(bus.slave().take_reset_request());
}

TEST(ResetKey, ThreeStepsInOneFrame_AreOneStep) {
  TestBus bus;
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    bus.with(Command::apwr, physical_address(0, 0x0040), bytes({key}));
  }
  bus.send();
  EXPECT_FALSE(bus.slave().take_reset_request());
}

TEST(ResetKey, ProgressIsReadInTheFrameOfTheStep) {
  TestBus bus;
  const auto step = [&](unsigned key) {
    bus.with(Command::apwr, physical_address(0, 0x0040), bytes({key}))
        .with(Command::aprd, physical_address(0, 0x0040), bytes({0}));
    return number(bus.send()[1].data);
  };
  EXPECT_EQ(step(0x52), 1U);
  EXPECT_EQ(step(0x45), 2U);
  EXPECT_EQ(step(0x45), 0U) << "wrong key";
  EXPECT_EQ(step(0x52), 1U);
  EXPECT_EQ(number(bus.read(0, 0x0040, 1).data), 1U) << "shown until this frame ends";
  EXPECT_EQ(number(bus.read(0, 0x0040, 1).data), 0U) << "a frame without a step";
}

TEST(ResetKey, HostHasItsOwn) {
  TestBus bus;
  host_write(bus.slave(), 0x0041, bytes({0x52}));
  EXPECT_EQ(number(bus.read(0, 0x0041, 1).data), 1U);
  host_write(bus.slave(), 0x0041, bytes({0x45}));
  host_write(bus.slave(), 0x0041, bytes({0x53}));
  EXPECT_TRUE(bus.slave().take_reset_request());
}

TEST(Events, MaskedRequestsReachTheInterruptFieldOfEveryDatagram) {
  TestBus bus;
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0U) << "mask is 0 after power-on";
  bus.broadcast_write(0x0200, bytes({0x04, 0x00}));
  bus.with(Command::nop, 0, zeros(1)).with(Command::brd, physical_address(0, 0), zeros(1));
  const auto answers = bus.send();
  EXPECT_EQ(answers[0].interrupt, 0x0004U) << "the links came up: DL status event";
  EXPECT_EQ(answers[1].interrupt, 0x0004U);
  EXPECT_EQ(number(bus.read(0, 0x0210, 2).data), 0x0004U);
  bus.read(0, 0x0110, 2);
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0U) << "reading DL status acknowledges";
}

TEST(Events, AlStatusChangeByTheHostIsToldAndReadAway) {
  TestBus bus;
  bus.broadcast_write(0x0200, bytes({0x08, 0x00}));
  host_write(bus.slave(), 0x0130, bytes({2, 0}));
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0x0008U);
  EXPECT_EQ(number(bus.read(0, 0x0130, 2).data), 2U);
  EXPECT_EQ(bus.read(0, 0x0000, 1).interrupt, 0U);
}

TEST(Events, HostInterruptPinFollowsTheAlEventMask) {
  TestBus bus;
  bus.write(0, 0x0120, bytes({2, 0}));
  EXPECT_TRUE(bus.slave().host_interrupt());
  host_write(bus.slave(), 0x0204, zeros(4));
  EXPECT_FALSE(bus.slave().host_interrupt());
  EXPECT_EQ(bus.slave().al_event_request(), al_event::kAlControl);
}

}  // namespace
}  // namespace stator::ethercat
