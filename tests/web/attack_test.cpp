// What a hostile page or program would try. Each test also shows that the server serves others
// after.
#include <chrono>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using namespace std::chrono_literals;

constexpr const char* kInput = "/api/v1/inputs/drive.axis0.load_torque";

ServerLimits impatient() {
  ServerLimits limits;
  limits.request_time = 300ms;
  limits.stream_idle_time = 400ms;
  return limits;
}

std::string token_field(const std::string& token = kToken) {
  return "Authorization: Bearer " + token + "\r\n";
}

class WebAttack : public testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(rack.get("/healthz").status, 200) << "others suffer"; }

  ServedRack rack{impatient()};
  Answer raw(const std::string& text) {
    HttpClient client(rack.port());
    client.send(text);
    return client.receive();
  }
};

TEST_F(WebAttack, OfAnotherOriginIsRefused) {
  HttpClient client(rack.port());
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1", "http://localhost",
                             "http://127.0.0.1:1"}) {
    EXPECT_EQ(
        client.request("GET", "/api/v1/rack", {}, fmt::format("Origin: {}\r\n", origin)).status,
        403)
        << origin;
  }
  const std::string own = fmt::format("Origin: http://127.0.0.1:{}\r\n", rack.port());
  EXPECT_EQ(client.request("GET", "/api/v1/rack", {}, own).status, 200);
  EXPECT_EQ(client.request("GET", "/api/v1/rack", {}, "Sec-Fetch-Site: cross-site\r\n").status,
            403);
  HttpClient writer(rack.port());
  EXPECT_EQ(writer
                .request("PUT", kInput, R"({"value": 1})",
                         "Origin: http://evil.example\r\n" + token_field())
                .status,
            403);
  HttpClient socket(rack.port());
  EXPECT_EQ(socket
                .request("GET", "/api/v1/signals", {},
                         HttpClient::upgrade_fields() + "Origin: http://evil.example\r\n")
                .status,
            403);
}

TEST_F(WebAttack, ByAReboundNameIsRefused) {
  EXPECT_EQ(raw("GET /api/v1/rack HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 421);
  EXPECT_EQ(raw("GET /api/v1/rack HTTP/1.1\r\nHost: 192.0.2.1\r\n\r\n").status, 421);
  EXPECT_EQ(raw("GET /api/v1/rack HTTP/1.1\r\nHost: localhost.evil.example\r\n\r\n").status, 421);
  EXPECT_EQ(
      raw("GET /api/v1/rack HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n").status,
      400);
  EXPECT_EQ(raw("GET /api/v1/rack HTTP/1.1\r\n\r\n").status, 400);
  EXPECT_EQ(raw("GET /api/v1/rack HTTP/1.1\r\nHost: LocalHost:99\r\n\r\n").status, 200);
}

TEST_F(WebAttack, WithoutTheTokenWritesNothing) {
  const std::string body = R"({"value": 1})";
  for (const std::string& field : {std::string(), token_field("wrong"), token_field(""),
                                   token_field(std::string(kToken) + "x"),
                                   "Authorization: Basic " + std::string(kToken) + "\r\n"}) {
    HttpClient client(rack.port());
    EXPECT_EQ(client.request("PUT", kInput, body, field).status, 401) << field;
  }
  EXPECT_TRUE(rack.get("/api/v1/events").json()["events"].empty()) << "an input was set";
}

TEST_F(WebAttack, WithAFormIsRefused) {
  const Answer answer =
      raw("PUT " + std::string(kInput) + " HTTP/1.1\r\nHost: localhost\r\n" + token_field() +
          "Content-Type: text/plain\r\nContent-Length: 12\r\n\r\n{\"value\": 1}");
  EXPECT_EQ(answer.status, 415);
}

TEST_F(WebAttack, ByPathTraversalFindsNothing) {
  for (const char* path :
       {"/../../etc/passwd", "/..%2f..%2fetc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
        "/api/v1/devices/../rack", "/api/v1/devices/..%2frack", "/api/v1/devices/%00",
        "/api/v1/devices/%zz", "/api/v1//rack", "/api/v1/devices/"}) {
    EXPECT_EQ(rack.get(path).status, 404) << path;
  }
  EXPECT_EQ(rack.get("http://evil.example/api/v1/rack").status, 400);
}

TEST_F(WebAttack, WithAHugeBodyIsRefusedWithoutReadingIt) {
  HttpClient announced(rack.port());
  announced.send("PUT " + std::string(kInput) + " HTTP/1.1\r\nHost: localhost\r\n" + token_field() +
                 "Content-Type: application/json\r\nContent-Length: 1000000000\r\n\r\n");
  EXPECT_EQ(announced.receive().status, 413);
  EXPECT_TRUE(announced.ended());
  HttpClient chunked(rack.port());
  chunked.send("PUT " + std::string(kInput) + " HTTP/1.1\r\nHost: localhost\r\n" + token_field() +
               "Content-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n");
  const std::string chunk = "4000\r\n" + std::string(0x4000, ' ') + "\r\n";
  for (int i = 0; i < 8; ++i) {
    chunked.send(chunk);
  }
  EXPECT_EQ(chunked.receive().status, 413);
  EXPECT_TRUE(chunked.ended());
  HttpClient unauthorised(rack.port());
  unauthorised.send("PUT " + std::string(kInput) + " HTTP/1.1\r\nHost: localhost\r\n" +
                    "Content-Type: application/json\r\nContent-Length: 60000\r\n\r\n");
  EXPECT_EQ(unauthorised.receive().status, 401) << "waits for a body that nobody may send";
}

TEST_F(WebAttack, WithAHugeHeadIsRefused) {
  EXPECT_EQ(
      raw("GET / HTTP/1.1\r\nHost: localhost\r\nX: " + std::string(20000, 'x') + "\r\n\r\n").status,
      431);
  EXPECT_EQ(raw("GET /" + std::string(20000, 'x') + " HTTP/1.1\r\nHost: localhost\r\n\r\n").status,
            431);
}

TEST_F(WebAttack, WithWhatIsNoHttpIsRefused) {
  EXPECT_EQ(raw("\x16\x03\x01 no HTTP at all\r\n\r\n").status, 400);
  EXPECT_EQ(raw("GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n").status, 400);
}

TEST_F(WebAttack, ByDeeplyNestedJsonIsRefused) {
  EXPECT_EQ(rack.put(kInput, std::string(60000, '[')).status, 400);
  EXPECT_EQ(rack.put(kInput, R"({"value": 1e999})").status, 400);
}

TEST_F(WebAttack, OfSlowRequestsAndHalfOpenSocketsEnds) {
  HttpClient silent(rack.port());
  HttpClient slow(rack.port());
  HttpClient body(rack.port());
  slow.send("GET /healthz HTT");
  body.send("PUT " + std::string(kInput) + " HTTP/1.1\r\nHost: localhost\r\n" + token_field() +
            "Content-Type: application/json\r\nContent-Length: 12\r\n\r\n{\"val");
  // A byte now and then buys no time.
  const auto begin = std::chrono::steady_clock::now();
  while (slow.send("P") && std::chrono::steady_clock::now() - begin < 5s) {
    EXPECT_EQ(rack.get("/healthz").status, 200);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 5s);
  EXPECT_TRUE(silent.ended());
  EXPECT_TRUE(body.ended());
}

/// Sockets beyond what the server serves at a time, on which no request comes.
std::vector<std::unique_ptr<HttpClient>> idle_sockets(std::uint16_t port) {
  std::vector<std::unique_ptr<HttpClient>> sockets;
  for (std::size_t i = 0; i < ServerLimits{}.connections * 4; ++i) {
    sockets.push_back(std::make_unique<HttpClient>(port));
    if (i % 2 == 0) {
      sockets.back()->send("GET /healthz HTT");
    }
  }
  return sockets;
}

// Nothing ends by its age here: that a good client gets its answer is because idle ones give way.
TEST(WebFlood, OfIdleConnectionsTakesNobodysPlace) {
  ServedRack rack;
  HttpClient socket(rack.port());
  ASSERT_EQ(socket.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status, 101);
  HttpClient at_work(rack.port());
  at_work.send("PUT " + std::string(kInput) + " HTTP/1.1\r\nHost: localhost\r\n" + token_field() +
               "Content-Type: application/json\r\nContent-Length: 12\r\n\r\n{\"val");
  ASSERT_EQ(rack.get("/healthz").status, 200) << "the server has seen those before this";
  HttpClient kept(rack.port());
  ASSERT_EQ(kept.request("GET", "/healthz").status, 200);
  const auto flood = idle_sockets(rack.port());
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(rack.get("/healthz").status, 200) << i;
  }
  EXPECT_TRUE(flood.front()->ended());
  EXPECT_TRUE(kept.ended()) << "it was idle for longer than the flood";
  EXPECT_EQ(flood.back()->request("GET", "/healthz").status, 200) << "it came last";
  at_work.send("ue\": 1}");
  EXPECT_EQ(at_work.receive().status, 200);
  EXPECT_TRUE(socket.send_frame(1, R"({"signals": []})"));
  EXPECT_TRUE(socket.receive_message("subscribed").is_object()) << "the stream goes on";
  const std::string metrics = rack.get("/metrics").body;
  EXPECT_THAT(metrics, testing::ContainsRegex("stator_http_connections_displaced_total [1-9]"));
  EXPECT_THAT(metrics, testing::HasSubstr("stator_http_connections_refused_total 0\n"));
  EXPECT_THAT(metrics, testing::ContainsRegex("stator_http_connections 6[34]\n"));
}

TEST(WebFlood, OfConnectionsAtWorkIsRefused) {
  ServerLimits limits = patient_limits();
  limits.connections = limits.streams;
  ServedRack rack(limits);
  std::vector<std::unique_ptr<HttpClient>> streams;
  for (std::size_t i = 0; i < limits.streams; ++i) {
    streams.push_back(std::make_unique<HttpClient>(rack.port()));
    ASSERT_EQ(
        streams.back()->request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status,
        101);
  }
  EXPECT_EQ(HttpClient(rack.port()).receive().status, 503);
  streams.pop_back();
  while (rack.get("/healthz").status != 200) {
    // The server has yet to notice that it has gone.
  }
  EXPECT_THAT(rack.get("/metrics").body,
              testing::ContainsRegex("stator_http_connections_refused_total [1-9]"));
}

TEST_F(WebAttack, ByBadWebSocketFramesEndsTheirConnection) {
  const auto open = [this] {
    auto client = std::make_unique<HttpClient>(rack.port());
    EXPECT_EQ(client->request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status,
              101);
    return client;
  };
  const auto code_of = [](HttpClient& client) {
    while (const auto frame = client.receive_frame()) {
      if (frame->opcode == 8 && frame->payload.size() >= 2) {
        return static_cast<unsigned char>(frame->payload[0]) * 256 +
               static_cast<unsigned char>(frame->payload[1]);
      }
    }
    return 0;
  };
  auto client = open();
  client->send_frame(1, "{}", false);  // not masked
  EXPECT_EQ(code_of(*client), 1002);
  client = open();
  client->send_frame(3, "reserved");
  EXPECT_EQ(code_of(*client), 1002);
  client = open();
  client->send_frame(2, "binary");
  EXPECT_EQ(code_of(*client), 1003);
  client = open();
  client->send_frame(1, "\xff\xfe no UTF-8");
  EXPECT_EQ(code_of(*client), 1007);
  client = open();
  client->send_frame(1, std::string(20000, ' '));
  EXPECT_EQ(code_of(*client), 1009);
  client = open();  // silent, and does not answer the server's ping
  EXPECT_TRUE(client->ended());
}

TEST_F(WebAttack, ByManyStreamsIsBounded) {
  std::vector<std::unique_ptr<HttpClient>> clients;
  for (int i = 0; i < 8; ++i) {
    clients.push_back(std::make_unique<HttpClient>(rack.port()));
    EXPECT_EQ(
        clients.back()->request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status,
        101);
  }
  HttpClient one_more(rack.port());
  EXPECT_EQ(one_more.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status,
            503);
}

TEST_F(WebAttack, ByPatternsWithManyStarsTakesNoTime) {
  std::string pattern;
  for (int i = 0; i < 1000; ++i) {
    pattern += "*a";
  }
  EXPECT_EQ(rack.get("/api/v1/signals?names=" + pattern + "b").status, 404);
}

}  // namespace
}  // namespace stator::web
