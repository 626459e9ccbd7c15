// Which COB-IDs each communication object accepts, restricted CAN-IDs of CiA 301 among them.
#include "stator/canopen/cob_id.hpp"

#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using test::kTmcc160Pdos;
using test::ServiceBench;

constexpr std::uint32_t kRangeExceeded = 0x06090030;
constexpr std::uint32_t kDeviceState = 0x08000022;

TEST(CobId, RestrictedCanIds_AreThe797OfTheStandard) {
  unsigned restricted = 0;
  for (std::uint16_t can_id = 0; can_id <= 0x7FF; ++can_id) {
    restricted += is_restricted(can_id) ? 1U : 0U;
  }
  EXPECT_EQ(restricted, 797U);
  for (const int can_id : {0x000, 0x07F, 0x101, 0x180, 0x581, 0x5FF, 0x601, 0x67F, 0x6E0, 0x6FF,
                           0x701, 0x77F, 0x780, 0x7FF}) {
    EXPECT_TRUE(is_restricted(static_cast<std::uint16_t>(can_id))) << can_id;
  }
  for (const int can_id : {0x080, 0x100, 0x181, 0x580, 0x600, 0x680, 0x6DF, 0x700}) {
    EXPECT_FALSE(is_restricted(static_cast<std::uint16_t>(can_id))) << can_id;
  }
}

TEST(CobId, RestrictedCanId_IsRefusedInEveryConfigurableObject) {
  ServiceBench bench;
  for (std::uint16_t can_id = 0; can_id <= 0x7FF; ++can_id) {
    if (!is_restricted(can_id)) {
      continue;
    }
    EXPECT_EQ(bench.write(0x1005, 0, can_id), kRangeExceeded) << can_id;
    EXPECT_EQ(bench.write(0x1014, 0, can_id), kRangeExceeded) << can_id;
    EXPECT_EQ(bench.write(0x1400, 1, can_id), kRangeExceeded) << can_id;
    EXPECT_EQ(bench.write(0x1800, 1, can_id), kRangeExceeded) << can_id;
  }
}

TEST(CobId, ObjectThatDoesNotExist_MayNameNoCanId) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1404, 1, 0x80000000), 0U);
  EXPECT_EQ(bench.write(0x1804, 1, 0xC0000000), 0U);
  EXPECT_EQ(bench.write(0x1404, 1, 0x00000000), kRangeExceeded);
}

TEST(CobId, ExtendedIdentifiers_AreRefused) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1005, 0, 0x20000090), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1005, 0, 0x00000890), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1014, 0, 0x20000090), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1400, 1, 0x20000210), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1800, 1, 0x10000210), kRangeExceeded);
}

TEST(CobId, CanIdOfAValidObject_ChangesOnlyWhenItCeasesToExist) {
  ServiceBench bench;
  for (const auto& [index, subindex] : {std::pair{0x1014, 0}, {0x1400, 1}, {0x1800, 1}}) {
    const auto object = static_cast<std::uint16_t>(index);
    const auto place = static_cast<std::uint8_t>(subindex);
    EXPECT_EQ(bench.write(object, place, 0x210), kDeviceState) << index;
    EXPECT_EQ(bench.write(object, place, 0x80000210), 0U) << index;
    EXPECT_EQ(bench.write(object, place, 0x80000220), 0U) << index;
    EXPECT_EQ(bench.write(object, place, 0x220), 0U) << index;
    EXPECT_EQ(bench.write(object, place, 0x220), 0U) << "the same value " << index;
    EXPECT_EQ(bench.value(object, place), 0x220U) << index;
  }
}

TEST(CobId, EmergencyCanId_ChangesAtOnceWhereTheProductAllowsIt) {
  ServiceBench bench({}, {.change_valid_cob_id = true});
  EXPECT_EQ(bench.write(0x1014, 0, 0x210), 0U);
  EXPECT_EQ(bench.write(0x1014, 0, 0x40000210), kRangeExceeded) << "bit 30 is reserved";
}

TEST(CobId, SyncCanId_ChangesUnlessItIsProduced) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1005, 0, 0x90), 0U);
  EXPECT_EQ(bench.write(0x1005, 0, 0x40000090), 0U);
  EXPECT_EQ(bench.write(0x1005, 0, 0x40000091), kDeviceState);
  EXPECT_EQ(bench.write(0x1005, 0, 0x00000091), 0U);
}

TEST(CobId, ProductWithoutRemoteRequests_WantsBit30InEveryPdo) {
  ServiceBench bench(kTmcc160Pdos);
  EXPECT_EQ(bench.write(0x1400, 1, 0x80000205), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1800, 1, 0x80000185), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1400, 1, 0xC0000205), 0U);
  EXPECT_EQ(bench.write(0x1800, 1, 0xC0000185), 0U);
  EXPECT_EQ(bench.write(0x1400, 1, 0x60000205), kRangeExceeded) << "bit 29";
}

TEST(CobId, SyncCanId_OfAnotherServiceIsRefusedWhereTheProductSaysSo) {
  ServiceBench bench({}, {}, {.refuse_shared_can_id = true});
  EXPECT_EQ(bench.write(0x1005, 0, 0x185), 0x06090030U) << "transmit PDO 1";
  EXPECT_EQ(bench.write(0x1005, 0, 0x85), 0x06090030U) << "emergencies";
  EXPECT_EQ(bench.write(0x1005, 0, 0x80), 0U);
  EXPECT_EQ(bench.write(0x1800, 1, 0x80000185), 0U);
  EXPECT_EQ(bench.write(0x1005, 0, 0x185), 0U) << "nobody uses it any more";
}

}  // namespace
}  // namespace stator::canopen
