// Which changes of PDO mapping and assignment a CoE slave accepts, and in which order.
#include "stator/ethercat/stack/pdo_configuration.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using dictionary::AbortCode;
using testing::HasSubstr;

class PdoConfigurationTest : public StackFixture {
 protected:
  PdoConfigurationTest() { go_pre_operational(); }

  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::uint32_t data) {
    const std::size_t size = dictionary.find(index, subindex)->size();
    const unsigned command = 0x23 | static_cast<unsigned>(4 - size) << 2;
    return static_cast<AbortCode>(abort_code(
        sdo(concat({{static_cast<std::byte>(command)}, le(index), le(subindex), le(data)}))));
  }
  static constexpr AbortCode kOk = static_cast<AbortCode>(0);
};

TEST_F(PdoConfigurationTest, TheUsualOrder_ReplacesAMapping) {
  EXPECT_EQ(write(0x1C12, 0, 0), kOk);
  EXPECT_EQ(write(0x1600, 0, 0), kOk);
  EXPECT_EQ(write(0x1600, 1, 0x60FF0020), kOk);
  EXPECT_EQ(write(0x1600, 2, 0x60600008), kOk);
  EXPECT_EQ(write(0x1600, 0, 2), kOk);
  EXPECT_EQ(write(0x1C12, 1, 0x1600), kOk);
  EXPECT_EQ(write(0x1C12, 0, 1), kOk);
  configure_process_data(5, 30);
  request(0x04);
  EXPECT_EQ(controller.al_status(), 0x04U);
  EXPECT_EQ(stack.output_bytes(), 5U);
}

TEST_F(PdoConfigurationTest, EntriesChangeOnlyWhileSubindexZeroIsZero) {
  EXPECT_EQ(write(0x1600, 1, 0x60FF0020), AbortCode::subindex_zero_must_be_zero);
  EXPECT_EQ(write(0x1C12, 1, 0x1601), AbortCode::subindex_zero_must_be_zero);
  EXPECT_THAT(log.last("pdo-active"), HasSubstr("write 0 to 1C12h:00h before"));
}

TEST_F(PdoConfigurationTest, EntriesMustExistFitTheDirectionAndHaveTheirLength) {
  ASSERT_EQ(write(0x1600, 0, 0), kOk);
  ASSERT_EQ(write(0x1A00, 0, 0), kOk);
  EXPECT_EQ(write(0x1600, 1, 0x2FFF0010), AbortCode::object_does_not_exist);
  EXPECT_EQ(write(0x1600, 1, 0x60400110), AbortCode::subindex_does_not_exist);
  EXPECT_EQ(write(0x1600, 1, 0x60410010), AbortCode::not_mappable);
  EXPECT_EQ(write(0x1600, 1, 0x20030008), AbortCode::not_mappable);
  EXPECT_EQ(write(0x1A00, 1, 0x60400010), AbortCode::not_mappable);
  EXPECT_EQ(write(0x1A00, 2, 0x60640008), AbortCode::length_mismatch);
  EXPECT_THAT(log.last("pdo-entry-length"), HasSubstr("6064h with 8 bits, the object has 32"));
  EXPECT_EQ(write(0x1A00, 2, 0x60640020), kOk);
}

TEST_F(PdoConfigurationTest, Padding_IsAllowedByTypeOrByIndexZero) {
  ASSERT_EQ(write(0x1600, 0, 0), kOk);
  EXPECT_EQ(write(0x1600, 1, 0x00050008), kOk);
  EXPECT_EQ(write(0x1600, 1, 0x00050010), AbortCode::length_mismatch);
  EXPECT_EQ(write(0x1600, 1, 0x00000003), kOk);
}

TEST_F(PdoConfigurationTest, ErasedEntry_CannotBeActivated) {
  ASSERT_EQ(write(0x1600, 0, 0), kOk);
  EXPECT_EQ(write(0x1600, 2, 0), kOk);
  EXPECT_EQ(write(0x1600, 0, 3), AbortCode::object_does_not_exist);
  EXPECT_EQ(write(0x1600, 0, 1), kOk);
}

TEST_F(PdoConfigurationTest, MoreEntriesOrPdosThanThereAre_AreRefused) {
  EXPECT_EQ(write(0x1600, 0, 10), AbortCode::pdo_length_exceeded);
  EXPECT_EQ(write(0x1C12, 0, 3), AbortCode::value_range_exceeded);
}

TEST_F(PdoConfigurationTest, OnlyPdosOfTheRightDirectionCanBeAssigned) {
  ASSERT_EQ(write(0x1C12, 0, 0), kOk);
  EXPECT_EQ(write(0x1C12, 1, 0x1A00), AbortCode::value_range_exceeded);
  EXPECT_EQ(write(0x1C12, 1, 0x1602), AbortCode::value_range_exceeded);
  EXPECT_EQ(write(0x1C12, 1, 0x6040), AbortCode::value_range_exceeded);
  EXPECT_EQ(write(0x1C12, 1, 0), kOk);
  EXPECT_EQ(write(0x1C12, 0, 1), AbortCode::value_range_exceeded);
  EXPECT_EQ(write(0x1C12, 1, 0x1601), kOk);
  EXPECT_EQ(write(0x1C12, 0, 1), kOk);
}

TEST_F(PdoConfigurationTest, AboveNothingChangesOutsidePreOperational) {
  configure_process_data();
  request(0x04);
  EXPECT_EQ(write(0x1C12, 0, 0), AbortCode::device_state);
  EXPECT_EQ(write(0x1600, 0, 0), AbortCode::device_state);
  request(0x02);
  EXPECT_EQ(write(0x1C12, 0, 0), kOk);
}

TEST_F(PdoConfigurationTest, SyncManagerTypes_KeepTheirValues) {
  EXPECT_EQ(write(0x1C00, 3, 3), kOk);
  EXPECT_EQ(write(0x1C00, 3, 4), AbortCode::read_only);
  EXPECT_EQ(write(0x1C00, 0, 3), AbortCode::read_only);
}

class NarrowOutputs : public StackFixture {
 protected:
  NarrowOutputs() : StackFixture(narrow()) { go_pre_operational(); }
  static DeviceDescription narrow() {
    DeviceDescription description = test_description();
    description.input_offset = 0x1100 + 3 * 30;
    return description;
  }
};

TEST_F(NarrowOutputs, AssignmentLongerThanTheMemory_IsRefused) {
  EXPECT_EQ(abort_code(sdo("2F 12 1C 00 00 00 00 00")), 0U);
  EXPECT_EQ(abort_code(sdo("2B 12 1C 02 01 16 00 00")), 0U);
  EXPECT_EQ(abort_code(sdo("2F 12 1C 00 02 00 00 00")),
            static_cast<std::uint32_t>(AbortCode::pdo_length_exceeded));
  EXPECT_THAT(log.last("pdo-too-long"), HasSubstr("31 bytes would be mapped"));
  EXPECT_EQ(abort_code(sdo("2F 12 1C 00 01 00 00 00")), 0U);
}

}  // namespace
}  // namespace stator::ethercat::test
