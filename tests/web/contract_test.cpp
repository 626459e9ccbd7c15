// That the tests' contract finds answers that differ from the OpenAPI document, and that each
// operation keeps it.
#include "web/contract.hpp"

#include <chrono>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/web/api/assets.hpp"
#include "stator/web/api/routes.hpp"
#include "stator/web/rack_file_control.hpp"
#include "stator/web/session_control.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using testing::HasSubstr;

Answer json_answer(int status, const std::string& body,
                   const std::string& type = "application/json") {
  return {.status = status, .headers = {{"content-type", type}}, .body = body};
}

std::string violation(const std::string& target, const Answer& answer) {
  return Contract::own().violation("GET", target, answer);
}

constexpr const char* kInputStart =
    R"({"name": "a.b", "unit": "", "minimum": 0, "maximum": null, "group": "load",)"
    R"( "normal": 0, "value": null)";

TEST(Contract, KnowsAnAnswerByItsPathStatusAndType) {
  const std::string input = std::string(kInputStart) + "}";
  EXPECT_EQ(violation("/api/v1/inputs/a.b", json_answer(200, input)), "");
  EXPECT_EQ(violation("/api/v1/inputs/a.b?x=1", json_answer(200, input)), "");
  EXPECT_THAT(violation("/api/v1/inputs/a.b", json_answer(200, input, "text/plain")),
              HasSubstr("\"text/plain\" is not described"));
  EXPECT_THAT(violation("/api/v1/inputs/a.b", json_answer(202, input)), HasSubstr("status 202"));
  EXPECT_THAT(violation("/api/v1/nothing", json_answer(200, input)), HasSubstr("nothing is"));
  EXPECT_THAT(violation("/api/v1/inputs/a.b", json_answer(200, "{")), HasSubstr("no JSON"));
}

TEST(Contract, WantsEachMemberAndNoOthers) {
  const std::string without =
      R"({"name": "a.b", "unit": "", "minimum": 0, "maximum": null, "group": "load", "normal": 0})";
  EXPECT_THAT(violation("/api/v1/inputs/a.b", json_answer(200, without)), HasSubstr("value"));
  const std::string more = std::string(kInputStart) + R"(, "common": 1})";
  EXPECT_THAT(violation("/api/v1/inputs/a.b", json_answer(200, more)), HasSubstr("common"));
  const std::string wrong =
      R"({"name": 7, "unit": "", "minimum": 0, "maximum": 1, "group": "load", "normal": 0,)"
      R"( "value": 1})";
  EXPECT_THAT(violation("/api/v1/inputs/a.b", json_answer(200, wrong)), HasSubstr("name"));
  // What is deep inside, and what is put together of two schemas.
  const std::string entry =
      R"({"index": "1", "subindex": "0", "name": "", "type": "", "access": "ro", "pdo": "no",)"
      R"( "unit": "", "minimum": "", "maximum": "", "default": "", "value": 1)";
  const std::string object = "/api/v1/devices/d/objects/1000";
  EXPECT_EQ(violation(object + "/00", json_answer(200, entry + "}")), "");
  EXPECT_NE(violation(object + "/00", json_answer(200, entry + R"(, "common": 1})")), "");
  const std::string list = R"({"device": "d", "entries": [)" + entry;
  EXPECT_EQ(violation(object, json_answer(200, list + "}]}")), "");
  EXPECT_NE(violation(object, json_answer(200, list + R"(, "common": 1}]})")), "");
}

TEST(Contract, WantsProblemsToSayTheirStatus) {
  const char* type = "application/problem+json";
  const std::string body = R"({"type": "about:blank", "title": "", "status": 404, "detail": ""})";
  EXPECT_EQ(violation("/api/v1/nothing", json_answer(404, body, type)), "");
  EXPECT_EQ(violation("/api/v1/rack", json_answer(404, body, type)), "");
  EXPECT_THAT(violation("/api/v1/rack", json_answer(409, body, type)), HasSubstr("says status"));
  EXPECT_NE(violation("/api/v1/nothing", json_answer(404, R"({"status": 404})", type)), "");
  EXPECT_NE(violation("/api/v1/nothing", json_answer(404, body)), "");
}

TEST(Contract, HoldsForMessages) {
  const auto message = [](const std::string& target, const std::string& text) {
    return Contract::own().violation(target, false, text);
  };
  const std::string samples =
      R"({"type": "samples", "dropped": 0, "time_ns": [1], "values": [[null]])";
  EXPECT_EQ(message("/api/v1/signals", samples + "}"), "");
  EXPECT_NE(message("/api/v1/signals", samples + R"(, "more": 1})"), "");
  EXPECT_NE(message("/api/v1/signals", R"({"type": "frames", "dropped": 0, "frames": []})"), "");
  EXPECT_EQ(message("/api/v1/traffic", R"({"type": "frames", "dropped": 0, "frames": []})"), "");
  EXPECT_THAT(message("/api/v1/rack", samples + "}"), HasSubstr("no WebSocket"));
  EXPECT_NE(Contract::own().violation("/api/v1/signals", true, "SSB1"), "");
}

class Snapshots final : public SessionControl {
 public:
  Recording recording() override { return {"run.stator", base::SimTime(), 4096, true}; }
  std::vector<Snapshot> snapshots() override { return {{"there", base::SimTime()}}; }
  bool take_snapshot(const std::string& /*name*/) override { return true; }
  bool restore(const std::string& /*name*/) override { return true; }
  std::string start_recording(const std::string& /*name*/) override { return {}; }
  bool stop_recording() override { return true; }
  std::string content(std::uint64_t /*from*/, std::size_t /*most*/) override { return "StatorRn"; }
};

class GoodFile final : public RackFileControl {
 public:
  File file() override { return {.path = "rack.toml", .text = "", .changes = {"clock=real"}}; }
  base::Expected<std::string, std::string> replace(const std::string& /*text*/) override {
    return std::string("rack-2.toml");
  }
};

constexpr const char* kRackText =
    R"({"text": "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n"})";

/// A request that is answered without error, for operations that need more than a path without
/// parameters.
struct Example {
  std::string target;
  std::string body{};
};

// Whatever answers, its client has held against the document; this is to see that there is
// something of everything.
TEST(Contract, IsKeptByEveryOperation) {
  const std::string asset = [] {
    for (const Asset& each : assets()) {
      if (each.path.starts_with("/assets/")) {
        return std::string(each.path);
      }
    }
    return std::string();
  }();
  const std::map<std::string, Example> examples{
      {"getDevice", {"/api/v1/devices/servo"}},
      {"getInput", {"/api/v1/inputs/drive.axis0.load_torque"}},
      {"setInput", {"/api/v1/inputs/drive.axis0.load_torque", R"({"value": 0.1})"}},
      {"listObjects", {"/api/v1/devices/drive/objects"}},
      {"readObject", {"/api/v1/devices/servo/objects/1018"}},
      {"readEntry", {"/api/v1/devices/drive/objects/6083/00"}},
      {"writeEntry", {"/api/v1/devices/drive/objects/6083/00", R"({"value": 1000})"}},
      {"getPanel", {"/api/v1/devices/drive/panel"}},
      {"takeSnapshot", {"/api/v1/snapshots", R"({"name": "before"})"}},
      {"startRecording", {"/api/v1/recording", R"({"name": "again"})"}},
      {"restoreSnapshot", {"/api/v1/snapshots/there/restore"}},
      {"checkRack", {"/api/v1/rack/check", kRackText}},
      {"runRack", {"/api/v1/rack/file", kRackText}},
      {"injectFault", {"/api/v1/faults", R"({"kind": "power-off", "device": "drive"})"}},
      {"clearFault", {"/api/v1/faults/1"}},
      {"getManualControl", {"/api/v1/devices/servo/manual"}},
      {"beginManualControl", {"/api/v1/devices/servo/manual"}},
      {"endManualControl", {"/api/v1/devices/servo/manual"}},
      {"commandAxis", {"/api/v1/devices/servo/manual/0", R"({"command": "stop"})"}},
  };
  Snapshots session;
  GoodFile file;
  ServedRack rack(patient_limits(), rack::ClockKind::real, "127.0.0.1", {}, &session, &file);
  ServedRack module(
      ServedRack::module_with({tmcl::Instruction{}, tmcl::Instruction{.command = 28}}));
  for (const Route& route : routes()) {
    const std::string id(route.id);
    if (id == "dashboardFile" && asset.empty()) {
      continue;  // this build has no dashboard
    }
    Example example{.target = std::string(route.path)};
    if (const auto found = examples.find(id); found != examples.end()) {
      example = found->second;
    } else if (id == "dashboardFile") {
      example.target = asset;
    } else if (id == "getProgram") {
      example.target = "/api/v1/devices/module/program";
    }
    ASSERT_EQ(example.target.find('{'), std::string::npos) << id << " has no example";
    if (id == "commandAxis") {
      // What began manual control before is still under way in a thread of its own.
      while (rack.get("/api/v1/devices/servo/manual").json()["phase"] == "starting") {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
    }
    HttpClient client(id == "getProgram" ? module.port() : rack.port());
    std::string fields = "Authorization: Bearer " + std::string(kToken) + "\r\n";
    if (route.status == 101) {
      fields += HttpClient::upgrade_fields();
    }
    const Answer answer =
        client.request(std::string(route.method), example.target, example.body, fields);
    EXPECT_EQ(answer.status, static_cast<int>(route.status)) << id << ": " << answer.body;
  }
}

}  // namespace
}  // namespace stator::web
