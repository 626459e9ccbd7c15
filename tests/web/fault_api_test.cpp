// Faults over HTTP.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

const std::string kWithToken = "Authorization: Bearer " + std::string(kToken) + "\r\n";

class FaultApi : public ::testing::Test {
 protected:
  Answer send(const std::string& method, const std::string& target, const json& body = nullptr) {
    return HttpClient(rack_.port())
        .request(method, target, body.is_null() ? "" : body.dump(), kWithToken);
  }
  json fault(std::uint64_t id) {
    const json all = rack_.get("/api/v1/faults").json();
    for (const json& fault : all["faults"]) {
      if (fault["id"] == id) {
        return fault;
      }
    }
    return nullptr;
  }

  ServedRack rack_;
};

TEST_F(FaultApi, TellsEveryKindWithItsParameters) {
  const json kinds = rack_.get("/api/v1/faults/kinds").json();
  bool found = false;
  for (const json& kind : kinds["kinds"]) {
    EXPECT_TRUE((std::set<std::string>{"port", "device", "bus", "axis", "line"})
                    .contains(kind["applies_to"]));
    if (kind["name"] == "ethercat-delay") {
      found = true;
      EXPECT_EQ(kind["parameters"][1]["name"], "delay");
      EXPECT_EQ(kind["parameters"][1]["type"], "duration");
      EXPECT_EQ(kind["parameters"][1]["maximum"], 60.0);
      EXPECT_EQ(kind["parameters"][0]["choices"], (json{"in", "out"}));
      EXPECT_THAT(kind["parameters"].dump(), HasSubstr("\"probability\""));
      EXPECT_TRUE(kind["inputs"].empty());
    }
    if (kind["name"] == "hall-fault") {
      EXPECT_EQ(kind["inputs"][1], (json{{"name", "hall_fault_2"},
                                         {"of_peripheral", false},
                                         {"keys", {{"mode", "low"}, {"sensor", 2}}}}));
    }
  }
  EXPECT_TRUE(found);
  EXPECT_FALSE(kinds["when"].empty());
}

TEST_F(FaultApi, ArmsListsAndClears) {
  const Answer created =
      send("POST", "/api/v1/faults",
           {{"action", "ethercat-drop"}, {"device", "drive"}, {"name", "cut"}, {"count", 7}});
  ASSERT_EQ(created.status, 201) << created.body;
  const auto id = created.json()["id"].get<std::uint64_t>();
  const json active = fault(id);
  EXPECT_EQ(active["kind"], "ethercat-drop");
  EXPECT_EQ(active["name"], "cut");
  EXPECT_EQ(active["target"], "drive port 0");
  EXPECT_EQ(active["state"], "active");
  EXPECT_EQ(active["remaining"], "7 more frames");
  EXPECT_EQ(active["remaining_count"], 7);
  EXPECT_TRUE(active["remaining_ns"].is_null());

  const Answer waits = send("POST", "/api/v1/faults",
                            {{"kind", "can-drop"},
                             {"device", "servo"},
                             {"for", "1s"},
                             {"when", {{"frame", 0x601}, {"count", 2}}}});
  ASSERT_EQ(waits.status, 201) << waits.body;
  EXPECT_EQ(fault(waits.json()["id"])["state"], "armed");

  const Answer cleared = send("DELETE", "/api/v1/faults/" + std::to_string(id));
  EXPECT_EQ(cleared.status, 200) << cleared.body;
  EXPECT_EQ(fault(id)["state"], "done");
  EXPECT_EQ(send("DELETE", "/api/v1/faults").json()["cleared"], 1);
  EXPECT_EQ(send("DELETE", "/api/v1/faults/99").status, 404);
  EXPECT_EQ(send("DELETE", "/api/v1/faults/first").status, 400);
}

TEST_F(FaultApi, SaysWhatIsWrong) {
  const auto refusal = [this](const json& body) {
    const Answer answer = send("POST", "/api/v1/faults", body);
    EXPECT_EQ(answer.status, 422) << answer.body;
    return answer.json().value("detail", "");
  };
  EXPECT_THAT(refusal({{"kind", "ethercat-dorp"}, {"device", "drive"}}),
              HasSubstr("did you mean \"ethercat-drop\"?"));
  EXPECT_THAT(refusal({{"kind", "ethercat-drop"}, {"device", "drvie"}}),
              HasSubstr("did you mean \"drive\"?"));
  EXPECT_THAT(refusal({{"kind", "ethercat-drop"}, {"device", "drive"}, {"for", 3}}),
              HasSubstr("\"for\" must be a text"));
  EXPECT_THAT(refusal({{"kind", "ethercat-drop"}, {"device", {"drive"}}}),
              HasSubstr("\"device\" must be"));
  EXPECT_THAT(refusal({{"kind", "ethercat-drop"}, {"device", "dri\nve\" = 1"}}),
              HasSubstr("\"device\" is"));
  EXPECT_EQ(HttpClient(rack_.port()).request("POST", "/api/v1/faults", "[]", kWithToken).status,
            400);
}

TEST_F(FaultApi, WantsTheTokenForAllThatChangesTheRack) {
  HttpClient stranger(rack_.port());
  EXPECT_EQ(stranger.request("POST", "/api/v1/faults", R"({"kind": "set"})").status, 401);
  EXPECT_EQ(HttpClient(rack_.port()).request("DELETE", "/api/v1/faults").status, 401);
}

}  // namespace
}  // namespace stator::web
