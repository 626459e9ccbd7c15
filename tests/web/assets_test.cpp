#include "stator/web/api/assets.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
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

/// What the program gzip makes of `compressed`.
std::string decompressed(const std::string& compressed) {
  const tests::TemporaryDirectory folder;
  const std::string path = folder.path() + "/file.gz";
  std::ofstream(path, std::ios::binary) << compressed;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(
      ::popen(("gzip --decompress --stdout " + path).c_str(), "r"),
      ::pclose);  // NOLINT(cert-env33-c)
  std::string plain;
  std::array<char, 65536> part{};
  for (std::size_t read = 0; (read = std::fread(part.data(), 1, part.size(), pipe.get())) > 0;) {
    plain.append(part.data(), read);
  }
  return plain;
}

TEST(Dashboard, IsCompressedForWhoTakesThat) {
  ServedRack rack;
  HttpClient client(rack.port());
  const std::string takes = "Accept-Encoding: gzip, deflate, br\r\n";
  for (const Asset& asset : assets()) {
    const std::string path(asset.path == "/index.html" ? "/" : asset.path);
    const Answer plain = client.request("GET", path);
    EXPECT_FALSE(plain.headers.contains("content-encoding")) << path;
    EXPECT_EQ(plain.headers.at("vary"), "Accept-Encoding");
    const Answer answer = client.request("GET", path, {}, takes);
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.headers.at("content-type"), plain.headers.at("content-type"));
    EXPECT_EQ(answer.headers.at("cache-control"), plain.headers.at("cache-control"));
    if (asset.compressed.empty()) {
      EXPECT_EQ(answer.body, plain.body) << path;
      continue;
    }
    EXPECT_EQ(answer.headers.at("content-encoding"), "gzip") << path;
    EXPECT_EQ(answer.headers.at("vary"), "Accept-Encoding");
    EXPECT_LT(answer.body.size(), plain.body.size()) << path;
    EXPECT_EQ(answer.body.substr(0, 4), "\x1F\x8B\x08" + std::string(1, '\0')) << path;
    EXPECT_EQ(answer.body.substr(4, 4), std::string(4, '\0')) << "the time of the build: " << path;
    EXPECT_TRUE(decompressed(answer.body) == plain.body) << path;
    const Answer head = client.request("HEAD", path, {}, takes);
    EXPECT_EQ(head.headers.at("content-length"), std::to_string(answer.body.size()));
  }
}

TEST(Dashboard, HasATagForEachOfItsForms) {
  ServedRack rack;
  HttpClient client(rack.port());
  const std::string takes = "Accept-Encoding: gzip\r\n";
  const std::string plain = client.request("GET", "/").headers.at("etag");
  const std::string compressed = client.request("GET", "/", {}, takes).headers.at("etag");
  EXPECT_NE(plain, compressed);
  const auto status = [&client](const std::string& fields, const std::string& tag) {
    return client.request("GET", "/", {}, fields + "If-None-Match: " + tag + "\r\n").status;
  };
  EXPECT_EQ(status({}, plain), 304);
  EXPECT_EQ(status(takes, compressed), 304);
  EXPECT_EQ(status({}, compressed), 200);
  EXPECT_EQ(status(takes, plain), 200);
}

TEST(Dashboard, KnowsWhoTakesGzip) {
  for (const char* text : {"gzip", "GZip", "x-gzip", "deflate, gzip;q=1.0", "br;q=1, gzip ; q=0.5",
                           "*", "gzip;q=0.001", "*;q=0, gzip"}) {
    EXPECT_TRUE(takes_gzip(text)) << text;
  }
  for (const char* text : {"", "identity", "gzip;q=0", "gzip; Q=0.000", "gzip;q=0, *",
                           "br, deflate", "*;q=0", "gzipped", ",", ";q=1"}) {
    EXPECT_FALSE(takes_gzip(text)) << text;
  }
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
