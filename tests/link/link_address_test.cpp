// Which texts name an Ethernet link, and what is said of others.
#include "stator/link/ethernet/link_address.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/link/ethernet/open_link.hpp"

namespace stator::link {
namespace {

using testing::HasSubstr;

LinkAddress parsed(std::string_view text) {
  const auto address = parse_link_address(text);
  EXPECT_TRUE(address) << address.error().text;
  return address ? *address : LinkAddress{};
}

std::string refusal_of(std::string_view text) {
  const auto address = parse_link_address(text);
  return address ? "accepted" : address.error().text;
}

TEST(LinkAddress, EveryKindIsReadAndWrittenBack) {
  EXPECT_EQ(parsed("ethercat:eth1"), (LinkAddress{LinkKind::raw_ethernet, "eth1", 0}));
  EXPECT_EQ(parsed("tap:drive0"), (LinkAddress{LinkKind::tap, "drive0", 0}));
  EXPECT_EQ(parsed("udp:127.0.0.1"), (LinkAddress{LinkKind::udp, "127.0.0.1", 34980}));
  EXPECT_EQ(parsed("udp:0.0.0.0:5000"), (LinkAddress{LinkKind::udp, "0.0.0.0", 5000}));
  EXPECT_TRUE(parsed("in-process").in_process());
  for (const char* text : {"ethercat:eth1", "tap:drive0", "udp:10.0.0.255:34980", "in-process"}) {
    EXPECT_EQ(to_text(parsed(text)), text);
  }
}

TEST(LinkAddress, AnInterfaceNameMayContainColons) {
  EXPECT_EQ(parsed("ethercat:eth0:1").name, "eth0:1");
}

TEST(LinkAddress, WhatIsNoLinkIsRefusedWithTheFormsThereAre) {
  for (const char* text : {"", "eth1", "ethercat:", "tap:", "udp:", "can:vcan0", "Ethercat:eth1"}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("ethercat:INTERFACE, udp:ADDRESS[:PORT] or tap:NAME"))
        << text;
  }
}

TEST(LinkAddress, UdpNeedsAnAddressInNumbersAndAPossiblePort) {
  for (const char* text : {"udp:localhost", "udp:300.0.0.1", "udp:5000", "udp::5000", "udp:::1"}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("IPv4 address in numbers")) << text;
  }
  for (const char* text : {"udp:127.0.0.1:", "udp:127.0.0.1:0", "udp:127.0.0.1:65536",
                           "udp:127.0.0.1:12x", "udp:127.0.0.1:1:2"}) {
    EXPECT_THAT(refusal_of(text), HasSubstr("port from 1 to 65535")) << text;
  }
}

TEST(LinkAddress, AnInProcessLinkCannotBeOpened) {
  const auto opened = open_link({}, LinkEnd::slaves, {});
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, LinkErrorCode::invalid_option);
}

}  // namespace
}  // namespace stator::link
