// Which hosts, origins and tokens the web server lets in.
#include "stator/web/server/guard.hpp"

#include <gtest/gtest.h>

namespace stator::web {
namespace {

constexpr const char* kGuardedToken = "0123456789abcdef";

// Not inline: GCC 12 sees overruns in assignments of literals that are not there.
[[gnu::noinline]] void set(std::optional<std::string>& field, const std::string& value) {
  field = value;
}

Request from(const std::string& host) {
  Request request;
  set(request.host, host);
  return request;
}

unsigned status(const std::optional<Response>& refused) {
  return refused ? refused->status : 0;
}

TEST(Guard, OnLoopbackKnowsItselfByNamesOfThisMachineOnly) {
  const Guard guard(true, kGuardedToken);
  for (const char* host : {"localhost", "localhost:1", "127.0.0.1:8080", "[::1]:8080"}) {
    EXPECT_EQ(status(guard.check_source(from(host))), 0U) << host;
  }
  for (const char* host : {"evil.example", "192.0.2.1", "", "[::2]", "127.0.0.1.evil.example"}) {
    EXPECT_EQ(status(guard.check_source(from(host))), 421U) << host;
  }
  EXPECT_EQ(status(guard.check_source(Request{})), 400U);
}

TEST(Guard, ElsewhereKnowsItselfByItsAddressesButNotByNamesOfOthers) {
  const Guard guard(false, kGuardedToken);
  EXPECT_EQ(status(guard.check_source(from("192.0.2.1:8080"))), 0U);
  EXPECT_EQ(status(guard.check_source(from("evil.example:8080"))), 421U);
}

TEST(Guard, LetsOnlyPagesOfItsOwnOriginIn) {
  const Guard guard(true, kGuardedToken);
  Request request = from("localhost:8080");
  set(request.origin, "http://localhost:8080");
  EXPECT_EQ(status(guard.check_source(request)), 0U);
  for (const char* origin : {"null", "http://localhost", "http://127.0.0.1:8080", ""}) {
    set(request.origin, origin);
    EXPECT_EQ(status(guard.check_source(request)), 403U) << origin;
  }
  request.origin.reset();
  for (const char* site : {"cross-site", "same-site"}) {
    set(request.fetch_site, site);
    EXPECT_EQ(status(guard.check_source(request)), 403U) << site;
  }
  set(request.fetch_site, "none");
  EXPECT_EQ(status(guard.check_source(request)), 0U);
}

TEST(Guard, WantsTheTokenForWritesAndFromOtherMachines) {
  Request request = from("localhost");
  const Guard here(true, kGuardedToken);
  const Guard open(false, kGuardedToken);
  EXPECT_EQ(status(here.check_token(request, false, false)), 0U);
  EXPECT_EQ(status(here.check_token(request, true, false)), 401U);
  EXPECT_EQ(status(open.check_token(request, false, false)), 401U);
  EXPECT_EQ(status(open.check_token(request, false, true)), 0U);
  set(request.authorization, "bearer 0123456789abcdef");
  EXPECT_EQ(status(here.check_token(request, true, false)), 0U);
  EXPECT_EQ(status(open.check_token(request, false, false)), 0U);
}

TEST(Guard, WithoutATokenLetsNobodyWrite) {
  const Guard guard(true, "");
  Request request = from("localhost");
  set(request.authorization, "Bearer ");
  set(request.websocket_protocol, "token.");
  EXPECT_EQ(status(guard.check_token(request, true, false)), 401U);
}

TEST(Guard, TakesTheTokenOfAWebSocketFromItsProtocols) {
  const Guard guard(false, kGuardedToken);
  Request request = from("192.0.2.1");
  set(request.websocket_protocol, "stator.signals.v1 , token.0123456789abcdef");
  EXPECT_EQ(status(guard.check_token(request, false, false)), 0U);
  EXPECT_EQ(Guard::chosen_protocol(request), "stator.signals.v1");
  set(request.websocket_protocol, "token.wrong");
  EXPECT_EQ(status(guard.check_token(request, false, false)), 401U);
  EXPECT_EQ(Guard::chosen_protocol(request), "");
}

}  // namespace
}  // namespace stator::web
