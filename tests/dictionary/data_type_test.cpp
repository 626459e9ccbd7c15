// Lengths, indices and names of data types, and the wording of abort codes (CiA 301).
#include "stator/dictionary/data_type.hpp"

#include <gtest/gtest.h>

#include "stator/dictionary/abort_code.hpp"

namespace stator::dictionary {
namespace {

TEST(DataType, LengthsAreThoseOfTheStandard) {
  EXPECT_EQ(bit_length(DataType::boolean), 1U);
  EXPECT_EQ(byte_length(DataType::boolean), 1U);
  EXPECT_EQ(byte_length(DataType::integer8), 1U);
  EXPECT_EQ(byte_length(DataType::unsigned16), 2U);
  EXPECT_EQ(byte_length(DataType::integer32), 4U);
  EXPECT_EQ(byte_length(DataType::real32), 4U);
  EXPECT_EQ(byte_length(DataType::real64), 8U);
  EXPECT_EQ(byte_length(DataType::unsigned64), 8U);
  EXPECT_EQ(byte_length(DataType::visible_string), 0U);
}

TEST(DataType, IndicesAreThoseOfTheStandard) {
  EXPECT_EQ(static_cast<int>(DataType::unsigned32), 0x0007);
  EXPECT_EQ(static_cast<int>(DataType::visible_string), 0x0009);
  EXPECT_EQ(static_cast<int>(DataType::domain), 0x000F);
  EXPECT_EQ(static_cast<int>(DataType::integer64), 0x0015);
  EXPECT_EQ(static_cast<int>(DataType::unsigned64), 0x001B);
}

TEST(DataType, OnlyTheIntegerTypesAreSigned) {
  EXPECT_TRUE(is_signed(DataType::integer8));
  EXPECT_TRUE(is_signed(DataType::integer64));
  EXPECT_FALSE(is_signed(DataType::unsigned8));
  EXPECT_FALSE(is_signed(DataType::boolean));
}

TEST(DataType, NamesAreThoseOfTheStandard) {
  EXPECT_EQ(to_text(DataType::unsigned32), "UNSIGNED32");
  EXPECT_EQ(to_text(DataType::octet_string), "OCTET_STRING");
  EXPECT_EQ(to_text(DataType::domain), "DOMAIN");
  EXPECT_EQ(to_text(static_cast<DataType>(0x7777)), "?");
}

TEST(AbortCode, EveryCodeHasAWordingAndOtherNumbersSaySo) {
  for (const auto code :
       {0x05030000U, 0x05040000U, 0x05040001U, 0x05040002U, 0x05040003U, 0x05040004U, 0x05040005U,
        0x06010000U, 0x06010001U, 0x06010002U, 0x06010003U, 0x06010004U, 0x06010005U, 0x06010006U,
        0x06020000U, 0x06040041U, 0x06040042U, 0x06040043U, 0x06040047U, 0x06060000U, 0x06070010U,
        0x06070012U, 0x06070013U, 0x06090011U, 0x06090030U, 0x06090031U, 0x06090032U, 0x06090036U,
        0x08000000U, 0x08000020U, 0x08000021U, 0x08000022U, 0x08000023U}) {
    EXPECT_NE(to_text(static_cast<AbortCode>(code)), "unknown abort code") << std::hex << code;
  }
  EXPECT_EQ(to_text(static_cast<AbortCode>(0x12345678)), "unknown abort code");
}

}  // namespace
}  // namespace stator::dictionary
