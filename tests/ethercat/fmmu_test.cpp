// Mapping of logical addresses by FMMU, bitwise and bytewise, with working counters.
#include "stator/ethercat/units/fmmu.hpp"

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"
#include "stator/base/random.hpp"

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

TEST(Fmmu, CopyBits_AgreesWithCopyingBitByBit) {
  base::Random random(7);
  for (int round = 0; round < 5'000; ++round) {
    std::array<std::byte, 12> source;
    std::array<std::byte, 12> destination;
    for (std::size_t i = 0; i < source.size(); ++i) {
      source[i] = static_cast<std::byte>(random.below(256));
      destination[i] = static_cast<std::byte>(random.below(256));
    }
    const std::size_t count = random.below(64);
    const std::size_t from = random.below(24);
    const std::size_t to = random.below(24);
    std::array<std::byte, 12> expected = destination;
    for (std::size_t bit = 0; bit < count; ++bit) {
      const bool set =
          (source[(from + bit) / 8] >> ((from + bit) % 8) & std::byte{1}) == std::byte{1};
      const std::byte mask = std::byte{1} << ((to + bit) % 8);
      expected[(to + bit) / 8] =
          set ? expected[(to + bit) / 8] | mask : expected[(to + bit) / 8] & ~mask;
    }
    copy_bits(destination.data(), to, source.data(), from, count);
    ASSERT_EQ(destination, expected) << count << " bits from " << from << " to " << to;
  }
}

/// Outputs 1100h and inputs 1200h of 4 bytes each in three-buffer mode.
void set_up_process_data(TestBus& bus, std::uint16_t position, std::uint32_t outputs,
                         std::uint32_t inputs) {
  bus.set_sync_manager(position, 2, {0x1100, 4, 0x64});
  bus.set_sync_manager(position, 3, {0x1200, 4, 0x20});
  bus.set_fmmu(position, 0, {outputs, 4, 0x1100, 2});
  bus.set_fmmu(position, 1, {inputs, 4, 0x1200, 1});
}

TEST(Fmmu, MapsAtOnceInInitWithoutAnyStateChange) {
  TestBus bus;
  set_up_process_data(bus, 0, 0x10000, 0x10004);
  host_write(bus.slave(), 0x1200, bytes({5, 6, 7, 8}));
  const Answer answer =
      bus.transfer(Command::lrw, 0x10000, bytes({1, 2, 3, 4, 0xEE, 0xEE, 0xEE, 0xEE}));
  EXPECT_EQ(answer.working_counter, 3U);
  EXPECT_EQ(answer.data, bytes({1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(host_read(bus.slave(), 0x1100, 4), bytes({1, 2, 3, 4}));
  bus.write(0, 0x060C, bytes({0}));
  bus.write(0, 0x061C, bytes({0}));
  EXPECT_EQ(bus.transfer(Command::lrw, 0x10000, zeros(8)).working_counter, 0U)
      << "and stops at once";
}

TEST(Fmmu, LogicalCommands_CountOnePerReadAndWriteAndThreeForBoth) {
  TestBus bus(2);
  for (std::uint16_t i = 0; i < 2; ++i) {
    set_up_process_data(bus, i, 0x10000 + 8U * i, 0x10004 + 8U * i);
  }
  EXPECT_EQ(bus.transfer(Command::lrd, 0x10000, zeros(16)).working_counter, 2U);
  EXPECT_EQ(bus.transfer(Command::lwr, 0x10000, zeros(16)).working_counter, 2U);
  EXPECT_EQ(bus.transfer(Command::lrw, 0x10000, zeros(16)).working_counter, 6U);
  EXPECT_EQ(bus.transfer(Command::lrw, 0x10000, zeros(4)).working_counter, 2U) << "outputs of one";
  EXPECT_EQ(bus.transfer(Command::lrw, 0x10004, zeros(4)).working_counter, 1U) << "inputs of one";
}

TEST(Fmmu, OverlappingInputsAndOutputs_ExchangeInTheSameBytes) {
  TestBus bus;
  set_up_process_data(bus, 0, 0x10000, 0x10000);
  host_write(bus.slave(), 0x1200, bytes({5, 6, 7, 8}));
  const Answer answer = bus.transfer(Command::lrw, 0x10000, bytes({1, 2, 3, 4}));
  EXPECT_EQ(answer.working_counter, 3U);
  EXPECT_EQ(answer.data, bytes({5, 6, 7, 8}));
  EXPECT_EQ(host_read(bus.slave(), 0x1100, 4), bytes({1, 2, 3, 4}));
}

TEST(Fmmu, TypeReadAndWrite_OnPlainMemory_ReturnsTheOldAndStoresTheNew) {
  TestBus bus;
  bus.write(0, 0x1000, bytes({0xAA, 0xBB}));
  bus.set_fmmu(0, 0, {0x10000, 2, 0x1000, 3});
  const Answer answer = bus.transfer(Command::lrw, 0x10000, bytes({1, 2}));
  EXPECT_EQ(answer.working_counter, 3U);
  EXPECT_EQ(answer.data, bytes({0xAA, 0xBB}));
  EXPECT_EQ(bus.read(0, 0x1000, 2).data, bytes({1, 2}));
}

TEST(Fmmu, TwoSlavesShareOneByteBitwise) {
  TestBus bus(2);
  for (std::uint16_t i = 0; i < 2; ++i) {
    const auto low = static_cast<std::uint8_t>(4 * i);
    const auto high = static_cast<std::uint8_t>(4 * i + 3);
    bus.set_fmmu(i, 0, {0x10000, 1, 0x1000, 2, low, high, 0});
    bus.set_fmmu(i, 1, {0x10001, 1, 0x1001, 1, low, high, 0});
  }
  bus.write(0, 0x1001, bytes({0xF3}));
  bus.write(1, 0x1001, bytes({0xFC}));
  bus.broadcast_write(0x1000, bytes({0xF0}));
  const Answer answer = bus.transfer(Command::lrw, 0x10000, bytes({0xA5, 0x00}));
  EXPECT_EQ(answer.working_counter, 6U);
  EXPECT_EQ(answer.data, bytes({0xA5, 0xC3}));
  EXPECT_EQ(number(bus.read(0, 0x1000, 1).data), 0xF5U) << "upper bits are not mapped";
  EXPECT_EQ(number(bus.read(1, 0x1000, 1).data), 0xFAU);
}

TEST(Fmmu, BitsAcrossByteBorders_KeepTheirNeighbours) {
  TestBus bus;
  // 12 bits from logical 1.3 on to physical 0.6 on.
  bus.set_fmmu(0, 0, {0x10001, 2, 0x1000, 2, 3, 6, 6});
  EXPECT_EQ(bus.transfer(Command::lwr, 0x10000, bytes({0xFF, 0xFF, 0xFF, 0xFF})).working_counter,
            1U);
  EXPECT_EQ(bus.read(0, 0x1000, 4).data, bytes({0xC0, 0xFF, 0x03, 0x00}));
}

TEST(Fmmu, MailboxStatusByte_IsReadThroughAnFmmu) {
  TestBus bus;
  bus.set_sync_manager(0, 1, {0x1080, 16, 0x22});
  bus.set_fmmu(0, 2, {0x10000, 1, 0x080D, 1});
  Answer answer = bus.transfer(Command::lrd, 0x10000, zeros(1));
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_EQ(number(answer.data), 0x00U);
  host_write(bus.slave(), 0x1080, zeros(16));
  answer = bus.transfer(Command::lrw, 0x10000, zeros(1));
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_EQ(number(answer.data) & 0x08U, 0x08U);
}

TEST(Fmmu, MailboxFullBits_OfTwoSlavesShareOneByte) {
  TestBus bus(2);
  for (std::uint16_t i = 0; i < 2; ++i) {
    const auto bit = static_cast<std::uint8_t>(i);
    bus.set_sync_manager(i, 1, {0x1080, 16, 0x22});
    bus.set_fmmu(i, 2, {0x10000, 1, 0x080D, 1, bit, bit, 3});
  }
  host_write(bus.slave(1), 0x1080, zeros(16));
  const Answer answer = bus.transfer(Command::lrd, 0x10000, bytes({0x81}));
  EXPECT_EQ(answer.working_counter, 2U);
  EXPECT_EQ(number(answer.data), 0x82U);
}

TEST(Fmmu, SeveralUnits_FillOneSyncManagerInOrder) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {0x1100, 4, 0x64});
  bus.set_fmmu(0, 0, {0x10000, 2, 0x1100, 2});
  bus.set_fmmu(0, 1, {0x20000, 2, 0x1102, 2});
  EXPECT_EQ(bus.transfer(Command::lwr, 0x20000, bytes({9, 9})).working_counter, 0U)
      << "the buffer is opened by its first byte";
  EXPECT_EQ(bus.transfer(Command::lwr, 0x10000, bytes({1, 2})).working_counter, 1U);
  EXPECT_EQ(bus.slave().al_event_request() & al_event::sync_manager(2), 0U);
  EXPECT_EQ(bus.transfer(Command::lwr, 0x20000, bytes({3, 4})).working_counter, 1U);
  EXPECT_EQ(host_read(bus.slave(), 0x1100, 4), bytes({1, 2, 3, 4}));
}

TEST(Fmmu, ADatagramOverPartOfTheRange_MovesThatPart) {
  TestBus bus;
  set_up_process_data(bus, 0, 0x10000, 0x10004);
  host_write(bus.slave(), 0x1200, bytes({5, 6, 7, 8}));
  const Answer answer = bus.transfer(Command::lrw, 0x10002, bytes({3, 4, 0, 0}));
  EXPECT_EQ(answer.working_counter, 1U) << "outputs not opened by their first byte, inputs read";
  EXPECT_EQ(answer.data, bytes({3, 4, 5, 6}));
}

TEST(Fmmu, RangeAtTheEndOfTheAddressSpace_DoesNotWrap) {
  TestBus bus;
  bus.set_fmmu(0, 0, {0xFFFFFFFE, 4, 0x1000, 1});
  bus.write(0, 0x1000, bytes({1, 2, 3, 4}));
  EXPECT_EQ(bus.transfer(Command::lrd, 0xFFFFFFFE, zeros(2)).data, bytes({1, 2}));
  EXPECT_EQ(bus.transfer(Command::lrd, 0, zeros(2)).working_counter, 0U);
}

/// The compiled mappings and the bitwise path are two ways to the same result: the same random
/// set-up runs once as it is and once with an idle bit-wise unit that forces the slow path.
TEST(Fmmu, DirectAndBitwisePath_AgreeOnRandomTraffic) {
  base::Random random(11);
  for (int round = 0; round < 200; ++round) {
    TestBus direct;
    TestBus bitwise;
    bitwise.set_fmmu(0, 7, {0x80000000, 1, 0x2000, 1, 1, 2, 0});
    const auto both = [&](auto action) {
      action(direct);
      action(bitwise);
    };
    const std::uint32_t outputs = 0x10000 + static_cast<std::uint32_t>(random.below(8));
    const std::uint32_t inputs = 0x10000 + static_cast<std::uint32_t>(random.below(8));
    both([&](TestBus& bus) { set_up_process_data(bus, 0, outputs, inputs); });
    for (int step = 0; step < 30; ++step) {
      Bytes data(1 + random.below(16));
      std::generate(data.begin(), data.end(),
                    [&] { return static_cast<std::byte>(random.below(256)); });
      const auto address = 0x10000 + static_cast<std::uint32_t>(random.below(8));
      const auto command = static_cast<Command>(10 + random.below(3));
      Bytes input(4);
      std::generate(input.begin(), input.end(),
                    [&] { return static_cast<std::byte>(random.below(256)); });
      both([&](TestBus& bus) { host_write(bus.slave(), 0x1200, input); });
      const Answer a = direct.transfer(command, address, data);
      const Answer b = bitwise.transfer(command, address, data);
      ASSERT_EQ(a.data, b.data);
      ASSERT_EQ(a.working_counter, b.working_counter);
      ASSERT_EQ(host_read(direct.slave(), 0x1100, 4), host_read(bitwise.slave(), 0x1100, 4));
      ASSERT_EQ(direct.slave().al_event_request(), bitwise.slave().al_event_request());
    }
  }
}

}  // namespace
}  // namespace stator::ethercat
