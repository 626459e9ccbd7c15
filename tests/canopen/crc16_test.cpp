// The checksum of SDO block transfers against the value of CiA 301 §7.2.4.3.16.
#include "stator/canopen/sdo/crc16.hpp"

#include <array>
#include <string_view>

#include <gtest/gtest.h>

namespace stator::canopen {
namespace {

std::uint16_t crc(std::string_view text) {
  return crc16(std::as_bytes(std::span(text)));
}

TEST(Crc16, GivesTheStandardsCheckValue) {
  EXPECT_EQ(crc("123456789"), 0x31C3);
}

TEST(Crc16, OfNothingIs0) {
  EXPECT_EQ(crc(""), 0);
}

TEST(Crc16, SeesAChangedBitAndAnExchangedByte) {
  EXPECT_NE(crc("position"), crc("positioo"));
  EXPECT_NE(crc("position"), crc("opsition"));
}

}  // namespace
}  // namespace stator::canopen
