// How the web server decodes paths and queries, and which methods a path has.
#include "stator/web/api/routes.hpp"

#include <gtest/gtest.h>

namespace stator::web {
namespace {

std::variant<Match, Response> find(const std::string& method, const std::string& target) {
  Request request;
  request.method = method;
  request.target = target;
  return find_route(request);
}

TEST(Routes, DecodeParametersAfterSplittingThePath) {
  const auto found = find("GET", "/api/v1/devices/a%2Fb%20c/objects/6041/00");
  ASSERT_TRUE(std::holds_alternative<Match>(found));
  EXPECT_EQ(std::get<Match>(found).parameters, (std::vector<std::string>{"a/b c", "6041", "00"}));
}

TEST(Routes, TakeTheirOwnParameterOfAQuery) {
  const auto found = find("GET", "/api/v1/signals?other=1&names=a%2A,b&names=c");
  ASSERT_TRUE(std::holds_alternative<Match>(found));
  EXPECT_EQ(std::get<Match>(found).query, "a*,b");
}

TEST(Routes, RefuseMalformedEscapesAndControlCharacters) {
  for (const char* target : {"/api/v1/devices/%", "/api/v1/devices/%4", "/api/v1/devices/%g0",
                             "/api/v1/devices/%0a", "/api/v1/devices/%7F"}) {
    const auto found = find("GET", target);
    ASSERT_TRUE(std::holds_alternative<Response>(found)) << target;
    EXPECT_EQ(std::get<Response>(found).status, 404U);
  }
}

TEST(Routes, NameTheMethodsOfAPath) {
  const auto found = find("POST", "/api/v1/rack");
  ASSERT_TRUE(std::holds_alternative<Response>(found));
  EXPECT_EQ(std::get<Response>(found).status, 405U);
  EXPECT_EQ(std::get<Response>(found).headers.at(0).second, "GET, HEAD");
  EXPECT_TRUE(std::holds_alternative<Match>(find("HEAD", "/api/v1/rack")));
}

}  // namespace
}  // namespace stator::web
