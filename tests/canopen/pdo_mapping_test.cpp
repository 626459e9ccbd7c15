// Which writes to PDO mappings a node refuses, and where mapped bits stand in a frame (CiA 301
// §7.5.2.36).
#include "stator/canopen/pdo/pdo_mapping.hpp"

#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using test::kTmcc160Pdos;
using test::ServiceBench;

constexpr std::uint32_t kUnsupportedAccess = 0x06010000;
constexpr std::uint32_t kObjectMissing = 0x06020000;
constexpr std::uint32_t kNotMappable = 0x06040041;
constexpr std::uint32_t kTooLong = 0x06040042;
constexpr std::uint32_t kLengthMismatch = 0x06070010;
constexpr std::uint32_t kSubindexMissing = 0x06090011;
constexpr std::uint32_t kDeviceState = 0x08000022;

/// A bench whose receive PDO 1 and transmit PDO 1 do not exist and map nothing.
struct MappingBench : ServiceBench {
  explicit MappingBench(const PdoRules& pdo_rules = {}) : ServiceBench(pdo_rules) {
    write(0x1400, 1, value(0x1400, 1) | kCobIdInvalid | kCobIdNoRemote);
    write(0x1800, 1, value(0x1800, 1) | kCobIdInvalid | kCobIdNoRemote);
    write(0x1600, 0, 0);
    write(0x1A00, 0, 0);
  }
};

TEST(PdoMapping, EntryOfAnActiveMapping_IsRefused) {
  MappingBench bench;
  EXPECT_EQ(bench.write(0x1600, 1, 0x20020010), 0U);
  EXPECT_EQ(bench.write(0x1600, 0, 1), 0U);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20010008), kUnsupportedAccess);
  EXPECT_EQ(bench.value(0x1600, 1), 0x20020010U);
}

TEST(PdoMapping, MappingOfAValidPdo_IsRefused) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1600, 0, 0), kUnsupportedAccess);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20010008), kUnsupportedAccess);
  EXPECT_EQ(bench.write(0x1A00, 0, 0), kUnsupportedAccess);
}

TEST(PdoMapping, ProductMayAnswerWithItsOwnAbortCodes) {
  ServiceBench valid(kTmcc160Pdos);
  EXPECT_EQ(valid.write(0x1600, 0, 0), kDeviceState);
  MappingBench bench(kTmcc160Pdos);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20020010), 0U);
  EXPECT_EQ(bench.write(0x1600, 0, 1), 0U);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20010008), kDeviceState);
  PdoRules rules;
  rules.wrong_entry_length = dictionary::AbortCode::not_mappable;
  MappingBench other(rules);
  EXPECT_EQ(other.write(0x1600, 1, 0x20020008), kNotMappable);
}

TEST(PdoMapping, ProductMayAllowMappingOfAValidPdo) {
  PdoRules rules;
  rules.map_valid_pdos = true;
  ServiceBench bench(rules);
  EXPECT_EQ(bench.write(0x1600, 0, 0), 0U);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20010008), 0U);
}

TEST(PdoMapping, ObjectsThatCannotBeMapped_AreRefused) {
  MappingBench bench;
  EXPECT_EQ(bench.write(0x1600, 1, 0x29990010), kObjectMissing);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20020110), kSubindexMissing);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20200020), kNotMappable) << "not mappable at all";
  EXPECT_EQ(bench.write(0x1600, 1, 0x20110010), kNotMappable) << "an input";
  EXPECT_EQ(bench.write(0x1A00, 1, 0x20020010), kNotMappable) << "an output";
  EXPECT_EQ(bench.write(0x1600, 1, 0x20230040), kNotMappable) << "a text";
  EXPECT_EQ(bench.write(0x1600, 1, 0x20020008), kLengthMismatch);
  EXPECT_EQ(bench.write(0x1600, 1, 0x20040020), 0U) << "write-only output";
}

TEST(PdoMapping, Count_IsRefusedWhenItsEntriesCannotBeMapped) {
  MappingBench bench;
  EXPECT_EQ(bench.write(0x1600, 1, 0x20020010), 0U);
  EXPECT_EQ(bench.write(0x1600, 2, 0), 0U);
  EXPECT_EQ(bench.write(0x1600, 0, 2), kObjectMissing) << "the second entry is erased";
  EXPECT_EQ(bench.write(0x1600, 0, test::kMappingEntries + 1), kObjectMissing);
  EXPECT_EQ(bench.write(0x1600, 0, 1), 0U);
}

TEST(PdoMapping, MoreThanEightBytes_AreRefusedWithTheCount) {
  MappingBench bench;
  for (std::uint8_t subindex = 1; subindex <= 9; ++subindex) {
    EXPECT_EQ(bench.write(0x1600, subindex, 0x20010008), 0U);
  }
  EXPECT_EQ(bench.write(0x1600, 0, 9), kTooLong);
  EXPECT_EQ(bench.write(0x1600, 0, 8), 0U);
  EXPECT_EQ(bench.write(0x1600, 0, 0), 0U);
  for (std::uint8_t subindex = 1; subindex <= test::kMappingEntries; ++subindex) {
    EXPECT_EQ(bench.write(0x1600, subindex, 0x20300101), 0U);
  }
  EXPECT_EQ(bench.write(0x1600, 0, test::kMappingEntries + 1), kTooLong) << "no such entry";
}

TEST(PdoMapping, DataTypes_MakeGapsInReceivePdosOnly) {
  MappingBench bench;
  EXPECT_EQ(bench.write(0x1600, 1, 0x00050008), 0U);
  EXPECT_EQ(bench.write(0x1600, 2, 0x00010001), 0U);
  EXPECT_EQ(bench.write(0x1600, 3, 0x00060008), kLengthMismatch);
  EXPECT_EQ(bench.write(0x1600, 3, 0x00080020), kObjectMissing);
  EXPECT_EQ(bench.write(0x1A00, 1, 0x00050008), kNotMappable);
}

TEST(PdoMapping, DataTypesThatDummyUsageDoesNotList_AreRefused) {
  PdoRules rules;
  rules.dummy_usage = 1U << 5;
  MappingBench bench(rules);
  EXPECT_EQ(bench.write(0x1600, 1, 0x00050008), 0U);
  EXPECT_EQ(bench.write(0x1600, 1, 0x00060010), kNotMappable);
}

TEST(PdoMapping, Bits_StandWhereTheMappingPutsThem) {
  ServiceBench bench;
  bench.reconfigure(0x1400,
                    {0x20300101, 0x20300201, 0x00010001, 0x20300301, 0x00020008, 0x20020010}, 255);
  bench.operational();
  // Bits from 0: 1, 1, gap, 1, eight bits of a gap, then sixteen bits of 2002h = BEEFh.
  bench.receive(0x205, {0b1111'1001, 0xFF, 0xEE, 0xB});
  EXPECT_EQ(bench.value(0x2030, 1), 1U);
  EXPECT_EQ(bench.value(0x2030, 2), 0U);
  EXPECT_EQ(bench.value(0x2030, 3), 1U);
  EXPECT_EQ(bench.value(0x2002), 0xBEEFU);
}

TEST(PdoMapping, TransmittedBits_AreFilledFromBelow) {
  ServiceBench bench;
  bench.set(0x2031, 1, 1);
  bench.set(0x2031, 3, 1);
  bench.set(0x2013, 0, static_cast<std::uint64_t>(-2));
  bench.reconfigure(0x1800, {0x20310101, 0x20310201, 0x20310301, 0x20130020}, 255);
  bench.operational();
  EXPECT_EQ(bench.take_sent().front(),
            can::data_frame(0x185, {0b1111'0101, 0xFF, 0xFF, 0xFF, 0b0000'0111}));
}

}  // namespace
}  // namespace stator::canopen
