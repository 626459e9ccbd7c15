// What SOEM's config_map sends: mapping from objects, sync managers, FMMUs, the working counter.

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

class SoemMap : public ::testing::Test {
 protected:
  explicit SoemMap(std::size_t devices = 3) : bus(devices), soem(bus) { soem.config_init(); }

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemMap, CommunicationTypesComeInOneCompleteAccess) {
  const Bytes value = upload_value(soem.upload(0, 0x1C00, 0, true));
  EXPECT_EQ(to_hex(value), "04 00 01 02 03 04") << "sub-index 0 takes sixteen bits";
}

TEST_F(SoemMap, AssignmentsComeInOneCompleteAccessEach) {
  EXPECT_EQ(to_hex(upload_value(soem.upload(0, 0x1C12, 0, true))), "01 00 00 16");
  EXPECT_EQ(to_hex(upload_value(soem.upload(0, 0x1C13, 0, true))), "01 00 00 1A");
}

TEST_F(SoemMap, MappingsComeInOneCompleteAccessEachAndSumUpToThirtyBytes) {
  for (const std::uint16_t index : {std::uint16_t{0x1600}, std::uint16_t{0x1A00}}) {
    const Bytes value = upload_value(soem.upload(0, index, 0, true));
    ASSERT_EQ(value.size(), 2U + 9 * 4);
    EXPECT_EQ(number(part(value, 0, 2)), 9U);
    unsigned bits = 0;
    for (std::size_t entry = 0; entry < 9; ++entry) {
      bits += std::to_integer<unsigned>(value[2 + 4 * entry]);
    }
    EXPECT_EQ(bits, 8U * Soem::kProcessData);
  }
}

TEST_F(SoemMap, SingleReadsTellTheSameAsCompleteAccess) {
  for (const std::uint16_t index :
       {std::uint16_t{0x1C00}, std::uint16_t{0x1C12}, std::uint16_t{0x1C13}, std::uint16_t{0x1600},
        std::uint16_t{0x1A00}}) {
    const Bytes complete = upload_value(soem.upload(0, index, 0, true));
    const auto count = number(upload_value(soem.upload(0, index, 0)));
    Bytes singly = little_endian(count, 2);
    for (std::uint8_t subindex = 1; subindex <= count; ++subindex) {
      const Bytes value = upload_value(soem.upload(0, index, subindex));
      singly.insert(singly.end(), value.begin(), value.end());
    }
    EXPECT_EQ(to_hex(singly), to_hex(complete)) << std::hex << index;
  }
}

TEST_F(SoemMap, SyncManagerTypesAreOneToFour) {
  for (std::uint8_t subindex = 1; subindex <= 4; ++subindex) {
    EXPECT_EQ(number(upload_value(soem.upload(0, 0x1C00, subindex))), subindex);
  }
}

TEST_F(SoemMap, OutputsInputsAndMailboxStatusMapAndSafeOperationalFollows) {
  soem.config_map();
}

TEST_F(SoemMap, EachSlaveCountsTwoForOutputsAndOneForWhatItReads) {
  soem.config_map();
  const auto answers = soem.exchange(zeros(soem.image_length()));
  EXPECT_EQ(answers[0].working_counter, soem.expected_working_counter());
}

TEST_F(SoemMap, AMailboxSlaveWithoutInputsCountsOneThroughItsMailboxStatus) {
  for (std::size_t i = 0; i < bus.size(); ++i) {
    bus.fpwr(Soem::station(i), 0x0600, fmmu(static_cast<std::uint32_t>(i), 1, 0x080D, 1));
  }
  EXPECT_EQ(bus.lrw(0, zeros(3)).working_counter, 3U);
}

TEST_F(SoemMap, SegmentsInTwoFramesCountWhatEachOfThemTouches) {
  soem.config_map();
  const auto outputs = static_cast<std::uint32_t>(bus.size() * Soem::kProcessData);
  EXPECT_EQ(bus.lrw(0, zeros(outputs)).working_counter, 2U * bus.size());
  EXPECT_EQ(bus.lrw(outputs, zeros(outputs)).working_counter, bus.size());
  EXPECT_EQ(bus.lrw(2 * outputs, zeros(bus.size())).working_counter, bus.size())
      << "mailbox status in a frame of its own counts again";
}

TEST_F(SoemMap, ASyncManagerOfLengthZeroStaysSwitchedOff) {
  Bytes off = sync_manager(Soem::kOutputs, 0, 0x64);
  off[6] = std::byte{0};
  EXPECT_EQ(soem.download(0, 0x1C12, 0, 0, 1), 0U) << "no outputs any more";
  EXPECT_EQ(bus.fpwr(Soem::station(0), 0x0810, off).working_counter, 1U);
  EXPECT_EQ(
      bus.fpwr(Soem::station(0), 0x0818, sync_manager(Soem::kInputs, 30, 0x20)).working_counter,
      1U);
  soem.request(0, Soem::kSafeOperational);
  bus.pass(1_ms);
  EXPECT_EQ(number(bus.fprd(Soem::station(0), 0x0130, 2).data), 0x04U);
}

TEST_F(SoemMap, TheStatesOfAllSlavesAreReadAsOneOredByte) {
  soem.config_map();
  soem.request(1, Soem::kPreOperational);
  const Answer status = bus.brd(0x0130, 2);
  EXPECT_EQ(status.working_counter, bus.size());
  EXPECT_EQ(number(status.data), 0x06U) << "Pre-Operational ored with Safe-Operational";
}

TEST_F(SoemMap, OperationalIsReachedAndInputsFollowOutputs) {
  soem.config_map();
  soem.to_operational();
  Bytes image = zeros(soem.image_length());
  base::store_le(image, Soem::kProcessData, std::uint16_t{6});  // axis 0 of the second slave
  soem.exchange(image);
  const auto answers = soem.exchange(image);
  EXPECT_EQ(answers[0].working_counter, soem.expected_working_counter());
  const std::size_t inputs = 3 * Soem::kProcessData;
  const auto statusword = [&](std::size_t slave) {
    return base::load_le<std::uint16_t>(answers[0].data, inputs + slave * Soem::kProcessData) &
           0x004FU;
  };
  EXPECT_EQ(statusword(0), 0x0040U) << "switch on disabled";
  EXPECT_EQ(statusword(1), 0x0001U) << "ready to switch on";
  EXPECT_EQ(statusword(2), 0x0040U);
}

TEST_F(SoemMap, FiftyCyclesKeepTheWorkingCounterAndTheState) {
  soem.config_map();
  soem.to_operational();
  for (int cycle = 0; cycle < 50; ++cycle) {
    const auto answers = soem.exchange(zeros(soem.image_length()));
    ASSERT_EQ(answers[0].working_counter, soem.expected_working_counter()) << cycle;
    bus.pass(1_ms);
  }
  EXPECT_EQ(number(bus.brd(0x0130, 2).data), Soem::kOperational);
}

TEST_F(SoemMap, ALostSlaveIsReaddressedRecognisedByAliasAndIdentityAndConfiguredAgain) {
  constexpr std::uint16_t kTemporary = 0xFFFF;
  soem.config_map();
  soem.to_operational();
  for (const char key : {'R', 'E', 'S'}) {
    bus.fpwr(Soem::station(1), 0x0040, bytes({static_cast<unsigned>(key)}));
  }
  EXPECT_EQ(bus.fprd(Soem::station(1), 0x0130, 2).working_counter, 0U) << "lost";
  EXPECT_EQ(number(bus.aprd(1, 0x0010, 2).data), 0U) << "found without an address";

  bus.fpwr(kTemporary, 0x0010, zeros(2));
  EXPECT_EQ(bus.apwr(1, 0x0010, little_endian(kTemporary, 2)).working_counter, 1U);
  EXPECT_EQ(number(bus.fprd(kTemporary, 0x0012, 2).data), 0U) << "alias";
  EXPECT_EQ(bus.fpwr(kTemporary, 0x0010, little_endian(Soem::station(1), 2)).working_counter, 1U);
  EXPECT_EQ(soem.read_sii(1, 0x08), 0x286U);
  EXPECT_EQ(soem.read_sii(1, 0x0A), 3315U);
  EXPECT_EQ(soem.read_sii(1, 0x0C), 0x00010009U);

  // Reconfiguration: sync managers, then states, the FMMUs only in Safe-Operational.
  const auto write = [&](std::uint16_t address, const Bytes& registers) {
    EXPECT_EQ(bus.fpwr(Soem::station(1), address, registers).working_counter, 1U);
  };
  const auto state = [&] { return number(bus.fprd(Soem::station(1), 0x0130, 2).data); };
  soem.request(1, Soem::kInit);
  write(0x0800, sync_manager(Soem::kReceiveMailbox, Soem::kMailboxLength, 0x26));
  write(0x0808, sync_manager(Soem::kTransmitMailbox, Soem::kMailboxLength, 0x22));
  write(0x0810, sync_manager(Soem::kOutputs, Soem::kProcessData, 0x64));
  write(0x0818, sync_manager(Soem::kInputs, Soem::kProcessData, 0x20));
  soem.request(1, Soem::kPreOperational);
  ASSERT_EQ(state(), Soem::kPreOperational);
  soem.request(1, Soem::kSafeOperational);
  ASSERT_EQ(state(), Soem::kSafeOperational);
  write(0x0600, fmmu(30, 30, Soem::kOutputs, 2));
  write(0x0610, fmmu(120, 30, Soem::kInputs, 1));
  write(0x0620, fmmu(181, 1, 0x080D, 1));
  EXPECT_EQ(soem.exchange(zeros(soem.image_length()))[0].working_counter,
            soem.expected_working_counter());
  soem.request(1, Soem::kOperational);
  EXPECT_EQ(state(), Soem::kOperational);
}

}  // namespace
}  // namespace stator::tests
