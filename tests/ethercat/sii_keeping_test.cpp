// An EEPROM whose content somebody keeps: words are busy until they are kept.

#include <vector>

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_ms;
using base::literals::operator""_us;
using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;

constexpr unsigned kBusy = 0x8000;
constexpr unsigned kNoAcknowledge = 0x2000;
constexpr std::size_t kCell = 0x200;  // of word 0100h

class SiiKeeping : public ::testing::Test, protected SiiKeeper {
 protected:
  SiiKeeping() { slave.set_sii_keeper(this); }
  ~SiiKeeping() override { slave.set_sii_keeper(nullptr); }

  bool keep_sii(std::span<const std::byte> content) override {
    given.emplace_back(content.begin(), content.end());
    return at_once;
  }
  void order(std::uint8_t value) {
    EXPECT_EQ(bus.write(0, 0x0502, bytes({0x81, 0x02, 0x00, 0x01, 0x00, 0x00, value, 0xA5}))
                  .working_counter,
              1U);
  }
  unsigned status() { return static_cast<unsigned>(number(bus.read(0, 0x0502, 2).data)); }
  unsigned cell() { return base::load_le<std::uint16_t>(slave.sii(), kCell); }
  void finish(bool kept) { slave.finish_sii_write(kept, slave.now()); }

  TestBus bus;
  SlaveController& slave = bus.slave();
  std::vector<Bytes> given;
  bool at_once = false;
};

TEST_F(SiiKeeping, WordIsBusyUntilItIsKept) {
  const unsigned before = cell();
  order(1);
  ASSERT_EQ(given.size(), 1U);
  EXPECT_EQ(base::load_le<std::uint16_t>(given[0], kCell), 0xA501) << "as it is to be";
  bus.wait(100_ms);
  EXPECT_EQ(status() & kBusy, kBusy);
  EXPECT_EQ(cell(), before);
  finish(true);
  EXPECT_EQ(status() & (kBusy | kNoAcknowledge), 0U);
  EXPECT_EQ(cell(), 0xA501U);
}

TEST_F(SiiKeeping, WordThatIsKeptSoonerThanItIsWritten_IsBusyForTheWriteTime) {
  order(1);
  finish(true);
  EXPECT_EQ(status() & kBusy, kBusy);
  EXPECT_NE(cell(), 0xA501U);
  bus.wait(SiiTiming{}.write);
  EXPECT_EQ(status() & kBusy, 0U);
  EXPECT_EQ(cell(), 0xA501U);
}

TEST_F(SiiKeeping, WordThatCannotBeKept_LeavesTheOldContentWithoutAcknowledge) {
  const unsigned before = cell();
  for (const bool late : {false, true}) {
    order(1);
    bus.wait(late ? 20_ms : 0_ms);
    finish(false);
    bus.wait(late ? 0_ms : 1_ms);
    EXPECT_EQ(status() & (kBusy | kNoAcknowledge), kNoAcknowledge);
    EXPECT_EQ(cell(), before);
  }
  order(2);
  bus.wait(1_ms);
  finish(true);
  EXPECT_EQ(status() & (kBusy | kNoAcknowledge), 0U) << "the next one is not blamed";
  EXPECT_EQ(cell(), 0xA502U);
}

TEST_F(SiiKeeping, DiskThatHangs_DoesNotKeepTheInterfaceForEver) {
  order(1);
  bus.wait(SiiInterface::kLongestWrite);
  EXPECT_EQ(status() & (kBusy | kNoAcknowledge), kNoAcknowledge);
  bus.write(0, 0x0502, bytes({0x00, 0x01, 0x00, 0x01}));
  EXPECT_EQ(status() & (kBusy | kNoAcknowledge), kNoAcknowledge) << "as in its write cycle";
  EXPECT_NE(cell(), 0xA501U);
  finish(true);
  EXPECT_EQ(cell(), 0xA501U) << "the file has it";
  bus.write(0, 0x0502, bytes({0x00, 0x01, 0x00, 0x01}));
  bus.wait(1_ms);
  EXPECT_EQ(status() & (kBusy | kNoAcknowledge), 0U);
  EXPECT_EQ(number(bus.read(0, 0x0508, 2).data), 0xA501U);
}

TEST_F(SiiKeeping, Reset_EndsTheAccessAndTheCellIsWhatTheFileIs) {
  for (const bool kept : {false, true}) {
    const unsigned before = cell();
    order(kept ? 3 : 4);
    slave.hold_reset(true);
    slave.hold_reset(false);
    EXPECT_EQ(status() & kBusy, 0U);
    EXPECT_EQ(cell(), before);
    finish(kept);
    EXPECT_EQ(cell(), kept ? 0xA503U : before);
  }
  order(5);
  finish(true);
  slave.hold_reset(true);
  slave.hold_reset(false);
  EXPECT_EQ(cell(), 0xA505U) << "kept before the write time had passed";
}

TEST_F(SiiKeeping, WordOfTheHost_IsBusyAsLong) {
  bus.write(0, 0x0500, bytes({1}));
  host_write(slave, 0x0501, bytes({1}));
  host_write(slave, 0x0502, bytes({0x81, 0x02, 0x00, 0x01, 0x00, 0x00, 0x06, 0xA5}));
  ASSERT_EQ(given.size(), 1U);
  bus.wait(20_ms);
  EXPECT_EQ(number(host_read(slave, 0x0502, 2)) & kBusy, kBusy);
  finish(true);
  EXPECT_EQ(number(host_read(slave, 0x0502, 2)) & kBusy, 0U);
  EXPECT_EQ(cell(), 0xA506U);
}

TEST_F(SiiKeeping, RegistersAreReadAndWrittenWhileAWordIsBusy) {
  order(1);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(bus.read(0, 0x0130, 2).working_counter, 1U);
    EXPECT_EQ(bus.write(0, 0x0020, bytes({0})).working_counter, 1U);
  }
  EXPECT_EQ(status() & kBusy, kBusy);
}

TEST_F(SiiKeeping, KeeperThatKeepsAtOnce_LeavesTheWriteTime) {
  at_once = true;
  order(1);
  EXPECT_EQ(status() & kBusy, kBusy);
  bus.wait(SiiTiming{}.write);
  EXPECT_EQ(status() & kBusy, 0U);
  EXPECT_EQ(cell(), 0xA501U);
}

}  // namespace
}  // namespace stator::ethercat
