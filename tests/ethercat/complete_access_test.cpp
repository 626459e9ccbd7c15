// SDO complete access to records, mappings and assignments (ETG.1000.6).
#include "stator/ethercat/stack/complete_access.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using dictionary::AbortCode;

class CompleteAccessTest : public StackFixture {
 protected:
  CompleteAccessTest() { go_pre_operational(); }
  explicit CompleteAccessTest(const DeviceDescription& device) : StackFixture(device) {
    go_pre_operational();
  }
  void expect_abort(std::string_view request, AbortCode code) {
    EXPECT_EQ(abort_code(sdo(request)), static_cast<std::uint32_t>(code)) << request;
  }
};

TEST_F(CompleteAccessTest, Assignment_IsReadWithSixteenBitSubindexZero) {
  EXPECT_EQ(to_hex(sdo("50 12 1C 00 00 00 00 00")), "53 12 1C 00 01 00 00 16");
}

TEST_F(CompleteAccessTest, SyncManagerTypes_AreReadAsSoemReadsThem) {
  EXPECT_EQ(to_hex(sdo("50 00 1C 00 00 00 00 00")), "51 00 1C 00 06 00 00 00 04 00 01 02 03 04");
}

TEST_F(CompleteAccessTest, Mapping_IsReadInOneTransfer) {
  const Bytes reply = sdo("50 00 16 00 00 00 00 00");
  EXPECT_EQ(to_hex(part(reply, 0, 18)), "51 00 16 00 26 00 00 00 09 00 10 00 40 60 20 00 7A 60");
  EXPECT_EQ(reply.size(), 8U + 38);
}

TEST_F(CompleteAccessTest, Identity_FromSubindexOneLeavesSubindexZeroOut) {
  EXPECT_EQ(to_hex(sdo("50 18 10 01 00 00 00 00")),
            "51 18 10 01 0C 00 00 00 86 02 00 00 F3 0C 00 00 09 00 01 00");
}

TEST_F(CompleteAccessTest, RecordWithBits_PacksThemAndReadsWriteOnlyAsZero) {
  EXPECT_EQ(to_hex(sdo("50 20 20 00 00 00 00 00")),
            "51 20 20 00 08 00 00 00 07 00 05 34 12 77 00 00");
}

TEST_F(CompleteAccessTest, RecordWithBits_IsWrittenWithoutItsReadOnlyEntries) {
  EXPECT_EQ(abort_code(sdo("31 20 20 00 08 00 00 00 63 00 02 CD AB 11 22 33")), 0U);
  EXPECT_EQ(value(0x2020, 0), 7U);
  EXPECT_EQ(value(0x2020, 1), 0U);
  EXPECT_EQ(value(0x2020, 2), 1U);
  EXPECT_EQ(value(0x2020, 3), 0U);
  EXPECT_EQ(value(0x2020, 4), 0xABCDU);
  EXPECT_EQ(value(0x2020, 6), 0x77U);
  EXPECT_EQ(value(0x2020, 7), 0x3322U);
}

TEST_F(CompleteAccessTest, DataMayEndAtABorder) {
  EXPECT_EQ(abort_code(sdo("31 20 20 00 05 00 00 00 07 00 02 CD AB")), 0U);
  EXPECT_EQ(value(0x2020, 4), 0xABCDU);
  EXPECT_EQ(value(0x2020, 7), 0xBEEFU);
}

TEST_F(CompleteAccessTest, DataThatEndInsideAnEntryOrBehindTheLast_AreRefused) {
  expect_abort("31 20 20 00 04 00 00 00 07 00 02 CD", AbortCode::length_too_low);
  expect_abort("31 20 20 00 01 00 00 00 07", AbortCode::length_too_low);
  expect_abort("31 20 20 00 09 00 00 00 07 00 02 CD AB 11 22 33 44", AbortCode::length_too_high);
}

TEST_F(CompleteAccessTest, StartsAtSubindexZeroOrOneOnly) {
  expect_abort("50 18 10 02 00 00 00 00", AbortCode::unsupported_access);
  expect_abort("50 00 10 00 00 00 00 00", AbortCode::unsupported_access);
  expect_abort("50 FF 2F 00 00 00 00 00", AbortCode::object_does_not_exist);
}

TEST_F(CompleteAccessTest, Assignment_IsReplacedByOneTransfer) {
  EXPECT_EQ(abort_code(sdo("31 12 1C 00 06 00 00 00 02 00 01 16 00 16")), 0U);
  EXPECT_EQ(value(0x1C12, 0), 2U);
  EXPECT_EQ(value(0x1C12, 1), 0x1601U);
  EXPECT_EQ(value(0x1C12, 2), 0x1600U);
  EXPECT_EQ(abort_code(sdo("33 12 1C 00 01 00 00 16")), 0U);
  EXPECT_EQ(value(0x1C12, 0), 1U);
  EXPECT_EQ(value(0x1C12, 1), 0x1600U);
}

TEST_F(CompleteAccessTest, Mapping_IsReplacedByOneTransfer) {
  EXPECT_EQ(abort_code(sdo("31 00 16 00 0A 00 00 00 02 00 10 00 40 60 20 00 FF 60")), 0U);
  EXPECT_EQ(value(0x1600, 0), 2U);
  EXPECT_EQ(value(0x1600, 2), 0x60FF0020U);
}

TEST_F(CompleteAccessTest, RefusedEntryOfAMapping_LeavesItDeactivated) {
  expect_abort("31 00 16 00 0A 00 00 00 02 00 10 00 40 60 20 00 64 60", AbortCode::not_mappable);
  EXPECT_EQ(value(0x1600, 0), 0U);
}

class WithoutCompleteAccess : public CompleteAccessTest {
 protected:
  WithoutCompleteAccess() : CompleteAccessTest(plain()) {}
  static DeviceDescription plain() {
    DeviceDescription description = test_description();
    description.complete_access = false;
    return description;
  }
};

TEST_F(WithoutCompleteAccess, CompleteAccess_IsRefused) {
  expect_abort("50 18 10 00 00 00 00 00", AbortCode::unsupported_access);
  expect_abort("33 12 1C 00 01 00 00 16", AbortCode::unsupported_access);
}

}  // namespace
}  // namespace stator::ethercat::test
