// The spellings in which the command line takes index and subindex of an object.
#include "stator/cli/master/object_address.hpp"

#include <gtest/gtest.h>

#include "stator/cli/failure.hpp"

namespace stator::cli {
namespace {

void expect_address(const char* text, std::uint16_t index, std::uint8_t subindex) {
  const master::ObjectAddress address = parse_object_address(text);
  EXPECT_EQ(address.index, index) << text;
  EXPECT_EQ(address.subindex, subindex) << text;
}

TEST(ObjectAddress, AllCommonSpellingsAreHexadecimal) {
  expect_address("6041", 0x6041, 0);
  expect_address("6041h", 0x6041, 0);
  expect_address("1018:1", 0x1018, 1);
  expect_address("1a00h:0A", 0x1A00, 10);
  expect_address("0x607D:0x02", 0x607D, 2);
}

TEST(ObjectAddress, EverythingElseIsRefused) {
  for (const char* text : {"", ":", "60410", "6041:", "6041:100", "xyz", "6041 :1", "-1"}) {
    EXPECT_THROW((void)parse_object_address(text), Failure) << text;
  }
}

}  // namespace
}  // namespace stator::cli
