// Which texts name a port of a CAN bus, and what is said of others.
#include "stator/link/can/can_link_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::link {
namespace {

using testing::HasSubstr;

TEST(CanLinkAddress, FormsAreReadAndWrittenWithWhatWasLeftOut) {
  const std::pair<const char*, const char*> forms[] = {
      {"slcan:/tmp/can0", "slcan:/tmp/can0"},
      {"slcan:/tmp/can0,acknowledge", "slcan:/tmp/can0,acknowledge"},
      {"slcan-tcp:3000", "slcan-tcp:127.0.0.1:3000"},
      {"slcan-tcp:0.0.0.0:0", "slcan-tcp:0.0.0.0:0"},
      {"socketcand", "socketcand:127.0.0.1:29536"},
      {"socketcand:", "socketcand:127.0.0.1:29536"},
      {"socketcand:10.0.0.1:29537,beacon", "socketcand:10.0.0.1:29537,beacon"},
      {"socketcan:vcan0", "socketcan:vcan0"},
      {"udp-multicast", "udp-multicast:239.74.163.2:43113"},
      {"udp-multicast:224.1.1.1", "udp-multicast:224.1.1.1:43113"},
      {"udp-multicast:224.1.1.1:9000", "udp-multicast:224.1.1.1:9000"},
      {"can-exec:can0", "can-exec:can0"},
  };
  for (const auto& [text, whole] : forms) {
    const auto address = parse_can_link_address(text);
    ASSERT_TRUE(address) << address.error().text;
    EXPECT_EQ(to_text(*address), whole);
    EXPECT_EQ(parse_can_link_address(whole).value(), *address);
  }
}

TEST(CanLinkAddress, WhatIsWrongIsSaidWithTheRemedy) {
  const std::pair<const char*, const char*> wrong[] = {
      {"", "write slcan:PATH"},
      {"canbus:x", "write slcan:PATH"},
      {"slcan:", "the path"},
      {"slcan:/tmp/x,beacon", "option"},
      {"slcan-tcp:", "port"},
      {"slcan-tcp:70000", "port"},
      {"slcan-tcp:localhost:3000", "IPv4 address"},
      {"socketcand:1,acknowledge", "option"},
      {"socketcan:", "name of an interface"},
      {"can-exec:a/b", "name of an interface"},
      {"can-exec:sixteenletters16", "name of an interface"},
      {"udp-multicast:127.0.0.1", "multicast group"},
      {"udp-multicast:224.1.1.1:0", "port"},
  };
  for (const auto& [text, reason] : wrong) {
    const auto address = parse_can_link_address(text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().code, LinkErrorCode::invalid_option);
    EXPECT_THAT(address.error().text, HasSubstr(reason)) << text;
  }
}

}  // namespace
}  // namespace stator::link
