// Recording and snapshots over the web server.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/web/session_control.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using ::testing::HasSubstr;

class FakeSession final : public SessionControl {
 public:
  Recording recording() override { return {"run.stator", base::SimTime(), 4096, true, running_}; }
  std::vector<Snapshot> snapshots() override { return taken_; }
  bool take_snapshot(const std::string& name) override {
    if (has(name)) {
      return false;
    }
    taken_.push_back({name, base::SimTime(base::SimDuration(5))});
    return true;
  }
  bool restore(const std::string& name) override { return has(name); }
  std::string start_recording(const std::string& name) override {
    return running_ ? "run.stator is being recorded" : name == "taken" ? "taken.stator exists" : "";
  }
  bool stop_recording() override { return std::exchange(running_, false); }
  std::string content(std::uint64_t from, std::size_t most) override {
    constexpr std::string_view kContent = "StatorRn and more";
    return std::string(kContent.substr(std::min<std::size_t>(from, kContent.size()), most));
  }

 private:
  [[nodiscard]] bool has(const std::string& name) const {
    return std::ranges::find(taken_, name, &Snapshot::name) != taken_.end();
  }

  std::vector<Snapshot> taken_;
  bool running_ = true;
};

class SessionApi : public ::testing::Test {
 protected:
  Answer post(const std::string& target, const std::string& body) {
    return HttpClient(rack_.port())
        .request("POST", target, body, "Authorization: Bearer " + std::string(kToken) + "\r\n");
  }

  FakeSession session_;
  ServedRack rack_{{}, rack::ClockKind::real, "127.0.0.1", {}, &session_};
};

TEST_F(SessionApi, TellsTheRecording) {
  const Answer answer = rack_.get("/api/v1/recording");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.json()["file"], "run.stator");
  EXPECT_EQ(answer.json()["bytes"], 4096);
  EXPECT_EQ(answer.json()["complete"], true);
}

TEST_F(SessionApi, TakesListsAndRestoresSnapshots) {
  EXPECT_EQ(post("/api/v1/snapshots", R"({"name": "before"})").status, 200);
  EXPECT_EQ(post("/api/v1/snapshots", R"({"name": "before"})").status, 409);
  const Answer list = rack_.get("/api/v1/snapshots");
  ASSERT_EQ(list.json()["snapshots"].size(), 1U);
  EXPECT_EQ(list.json()["snapshots"][0]["name"], "before");
  EXPECT_EQ(list.json()["snapshots"][0]["time_ns"], 5);
  EXPECT_EQ(post("/api/v1/snapshots/before/restore", "").status, 200);
  EXPECT_EQ(post("/api/v1/snapshots/after/restore", "").status, 404);
}

TEST_F(SessionApi, RefusesNamesThatAreNone) {
  for (const char* body :
       {R"({"name": ""})", R"({"name": "5s"})", R"({"name": "a/b"})", R"({"name": 7})"}) {
    EXPECT_EQ(post("/api/v1/snapshots", body).status, 422) << body;
  }
  EXPECT_EQ(post("/api/v1/snapshots", "{}").status, 400);
}

TEST_F(SessionApi, EndsARecordingAndBeginsAnother) {
  const auto end = [this] {
    return HttpClient(rack_.port())
        .request("DELETE", "/api/v1/recording", "",
                 "Authorization: Bearer " + std::string(kToken) + "\r\n");
  };
  const Answer under_way = post("/api/v1/recording", R"({"name": "other"})");
  EXPECT_EQ(under_way.status, 409);
  EXPECT_THAT(under_way.body, HasSubstr("run.stator is being recorded"));
  EXPECT_EQ(end().status, 200);
  EXPECT_EQ(end().status, 409);
  EXPECT_EQ(rack_.get("/api/v1/recording").json()["running"], false);
  EXPECT_EQ(post("/api/v1/snapshots", R"({"name": "before"})").status, 200)
      << "whether it can be is for the session to say";
  EXPECT_EQ(post("/api/v1/recording", R"({"name": "a/b"})").status, 422);
  EXPECT_THAT(post("/api/v1/recording", R"({"name": "taken"})").body,
              HasSubstr("taken.stator exists"));
  EXPECT_EQ(post("/api/v1/recording", R"({"name": "other"})").status, 200);
}

TEST_F(SessionApi, GivesTheRecordingInPieces) {
  EXPECT_EQ(rack_.get("/api/v1/recording/content").body, "StatorRn and more");
  EXPECT_EQ(rack_.get("/api/v1/recording/content?from=9").body, "and more");
  EXPECT_EQ(rack_.get("/api/v1/recording/content?from=17").body, "");
  EXPECT_EQ(rack_.get("/api/v1/recording/content?from=x").status, 400);
}

TEST(SessionApiWithout, SaysHowToRecord) {
  ServedRack rack;
  EXPECT_TRUE(rack.get("/api/v1/recording").json()["file"].is_null());
  EXPECT_TRUE(rack.get("/api/v1/snapshots").json()["snapshots"].empty());
  const Answer refused = HttpClient(rack.port())
                             .request("POST", "/api/v1/snapshots", R"({"name": "x"})",
                                      "Authorization: Bearer " + std::string(kToken) + "\r\n");
  EXPECT_EQ(refused.status, 409);
  EXPECT_THAT(refused.body, HasSubstr("--record NAME.stator"));
}

}  // namespace
}  // namespace stator::web
