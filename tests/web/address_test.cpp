// Addresses at which the web server listens, and its token.
#include "stator/web/address.hpp"

#include <cstdio>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::web {
namespace {

TEST(WebAddress, IsThisMachineUnlessToldOtherwise) {
  EXPECT_EQ(parse_address("8080").text(), "127.0.0.1:8080");
  EXPECT_TRUE(parse_address("8080").loopback());
  EXPECT_TRUE(parse_address("127.3.2.1:80").loopback());
  EXPECT_TRUE(parse_address("[::1]:80").loopback());
  EXPECT_EQ(parse_address("[::1]:80").text(), "[::1]:80");
  EXPECT_FALSE(parse_address("0.0.0.0:80").loopback());
  EXPECT_FALSE(parse_address("[::]:80").loopback());
  EXPECT_FALSE(parse_address("192.0.2.1:80").loopback());
}

TEST(WebAddress, RefusesWhatIsNone) {
  for (const char* text : {"", "x", "65536", ":80", "localhost:80", "127.0.0.1",
                           "127.0.0.1:", "::1:80", "[::1]80", "[::1", "127.0.0.1:80x", "-1"}) {
    EXPECT_THROW(static_cast<void>(parse_address(text)), std::runtime_error) << text;
  }
}

TEST(WebAddress, TakesTheHostOutOfAnAuthority) {
  EXPECT_EQ(host_of("LocalHost:80"), "localhost");
  EXPECT_EQ(host_of("[::1]:80"), "::1");
  EXPECT_EQ(host_of("127.0.0.1"), "127.0.0.1");
  EXPECT_EQ(host_of("localhost:80@evil"), "");
  EXPECT_EQ(host_of("[::1]evil"), "");
}

TEST(WebToken, ComesFromTheFirstLineOfAFile) {
  const std::string path = ::testing::TempDir() + "stator-web-token";
  const auto read = [&path](const std::string& content) {
    std::ofstream(path) << content;
    return read_token(path);
  };
  EXPECT_EQ(read("0123456789abcdef\r\nmore\n"), "0123456789abcdef");
  EXPECT_THROW(read("short\n"), std::runtime_error);
  EXPECT_THROW(read("0123456789 abcdef\n"), std::runtime_error);
  EXPECT_THROW(read(""), std::runtime_error);
  std::remove(path.c_str());
  EXPECT_THROW(static_cast<void>(read_token(path)), std::runtime_error);
}

TEST(WebToken, OfOnesOwnIsNewEachTime) {
  EXPECT_THAT(make_token(), testing::MatchesRegex("[0-9a-f]+"));
  EXPECT_EQ(make_token().size(), 32U);
  EXPECT_NE(make_token(), make_token());
}

TEST(WebToken, EqualsOnlyItself) {
  EXPECT_TRUE(equal_tokens("abc", "abc"));
  EXPECT_FALSE(equal_tokens("abc", "abd"));
  EXPECT_FALSE(equal_tokens("abcabc", "abc"));
  EXPECT_FALSE(equal_tokens("abc", "abcabc"));
  EXPECT_FALSE(equal_tokens("", "abc"));
  EXPECT_FALSE(equal_tokens("abc", ""));
}

}  // namespace
}  // namespace stator::web
