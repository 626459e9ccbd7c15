#include "stator/web/api/assets.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using testing::HasSubstr;

// Where the dashboard was built there is more than the page; without it, the page says so.

TEST(Dashboard, IsAPageThatRunsNothingButItsOwnFiles) {
  ServedRack rack;
  const Answer page = rack.get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.headers.at("content-type"), "text/html; charset=utf-8");
  EXPECT_THAT(page.body, HasSubstr("<title>Stator</title>"));
  EXPECT_THAT(page.body, testing::Not(HasSubstr("<style")));
  const std::string& policy = page.headers.at("content-security-policy");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'; script-src 'self'; style-src 'self'"));
  EXPECT_THAT(policy, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(policy, testing::Not(HasSubstr("unsafe")));
  EXPECT_EQ(page.headers.at("x-content-type-options"), "nosniff");
  EXPECT_EQ(page.headers.at("cache-control"), "no-cache");
}

TEST(Dashboard, IsNotSentAgainToWhoHasIt) {
  ServedRack rack;
  const std::string tag = rack.get("/").headers.at("etag");
  HttpClient client(rack.port());
  const Answer same = client.request("GET", "/", {}, "If-None-Match: \"x\", " + tag + "\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_TRUE(same.body.empty());
  EXPECT_EQ(client.request("GET", "/", {}, "If-None-Match: \"x\"\r\n").status, 200);
}

TEST(Dashboard, KeepsFilesThatAreNamedAfterTheirContent) {
  ServedRack rack;
  for (const Asset& asset : assets()) {
    if (!asset.path.starts_with("/assets/")) {
      continue;
    }
    const Answer answer = rack.get(std::string(asset.path));
    EXPECT_EQ(answer.status, 200) << asset.path;
    EXPECT_EQ(answer.body.size(), asset.content.size()) << asset.path;
    EXPECT_THAT(answer.headers.at("cache-control"), HasSubstr("immutable"));
    EXPECT_NE(answer.headers.at("content-type"), "application/octet-stream") << asset.path;
  }
  EXPECT_EQ(rack.get("/assets/nothing.js").status, 404);
  EXPECT_EQ(rack.get("/assets/..%2Findex.html").status, 404);
  EXPECT_EQ(rack.get("/index.html").status, 404);
}

TEST(Dashboard, IsOpenWithoutATokenAndTheRackIsNot) {
  ServedRack rack({}, rack::ClockKind::real, "0.0.0.0");
  EXPECT_EQ(rack.get("/").status, 200);
  EXPECT_EQ(rack.get("/api/v1/rack").status, 401);
}

}  // namespace
}  // namespace stator::web
