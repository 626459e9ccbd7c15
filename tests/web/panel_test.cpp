// What a person in front of the devices sees: wiring, panels, graphs, programs.
#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

json led(const json& panel, const std::string& name) {
  for (const json& each : panel["leds"]) {
    if (each["name"] == name) {
      return each;
    }
  }
  return nullptr;
}

TEST(Panel, OfAnEtherCatSlaveShowsItsLedsAndItsState) {
  ServedRack rack;
  const json panel = rack.get("/api/v1/devices/drive/panel").json();
  EXPECT_EQ(led(panel, "RUN")["pattern"], "off") << "Init";
  EXPECT_EQ(led(panel, "RUN")["colour"], "green");
  EXPECT_EQ(led(panel, "ERR")["colour"], "red");
  EXPECT_EQ(led(panel, "ERR")["pattern"], "off");
  EXPECT_TRUE(led(panel, "L/A IN").is_object());
  EXPECT_EQ(panel["network"]["machine"], "esm");
  EXPECT_EQ(panel["network"]["state"], "Init");
  EXPECT_EQ(rack.get("/api/v1/devices/drive").json()["network_state"], "Init");
  EXPECT_EQ(panel["network"]["status_code"], 0);
  EXPECT_FALSE(panel["program"].get<bool>());
}

TEST(Panel, OfACanopenNodeShowsItsLedsAndItsState) {
  ServedRack rack;
  json panel;
  do {  // until the node has booted
    panel = rack.get("/api/v1/devices/servo/panel").json();
  } while (panel["network"]["state"] == "Initialisation");
  EXPECT_EQ(panel["network"]["machine"], "nmt");
  EXPECT_EQ(panel["network"]["state"], "Pre-operational");
  EXPECT_EQ(rack.get("/api/v1/devices").json()["devices"][1]["network_state"], "Pre-operational");
  EXPECT_EQ(led(panel, "RUN")["pattern"], "blinking");
  EXPECT_EQ(led(panel, "ERR")["pattern"], "off");
}

TEST(Panel, OfAModuleWithTmclHasNoStateOfANetwork) {
  ServedRack rack(ServedRack::module_with({}));
  EXPECT_TRUE(rack.get("/api/v1/devices/module/panel").json()["network"].is_null());
  const json device = rack.get("/api/v1/devices/module").json();
  ASSERT_TRUE(device.contains("network_state"));
  EXPECT_TRUE(device["network_state"].is_null());
  EXPECT_TRUE(device["powered"].get<bool>());
}

TEST(Panel, OfADeviceTellsWhatARevolutionIsToMasters) {
  ServedRack rack;
  const json devices = rack.get("/api/v1/devices").json()["devices"];
  EXPECT_EQ(devices[0]["per_revolution"]["position"], 51'200.0);
  EXPECT_EQ(devices[0]["per_revolution"]["velocity"], 51'200.0);
  EXPECT_EQ(devices[1]["per_revolution"]["velocity"], 60.0) << "1/min";
}

TEST(Panel, NamesStateModeAndSignalsOfEachAxis) {
  ServedRack rack;
  ASSERT_EQ(rack.put("/api/v1/devices/drive/objects/6060/00", R"({"value": 8})").status, 200);
  const json axes = rack.get("/api/v1/devices/drive/panel").json()["axes"];
  ASSERT_EQ(axes.size(), 3U);
  EXPECT_EQ(axes[0]["name"], "axis0");
  EXPECT_EQ(axes[0]["machine"], "cia402");
  EXPECT_EQ(axes[0]["state"], "Switch on disabled");
  EXPECT_EQ(axes[0]["mode_name"], "cyclic synchronous position");
  EXPECT_EQ(axes[0]["signals"]["shaft_angle"], "drive.axis0.shaft_position");
  const json machines = rack.get("/api/v1/state-machines").json()["machines"];
  EXPECT_THAT(machines[0]["states"], testing::Contains(axes[0]["state"]));
  const json servo = rack.get("/api/v1/devices/servo/panel").json()["axes"];
  EXPECT_EQ(servo[0]["signals"]["current"], "servo.axis0.current_actual");
}

TEST(Panel, TellsTheNewestRefusalOfTheAxis) {
  ServedRack rack;
  EXPECT_TRUE(rack.get("/api/v1/devices/drive/panel").json()["last_refusal"].is_null());
  ASSERT_EQ(rack.put("/api/v1/devices/drive/objects/6040/00", R"({"value": 15})").status, 200);
  const json events = rack.get("/api/v1/events").json()["events"];
  const json panel = rack.get("/api/v1/devices/drive/panel").json();
  ASSERT_TRUE(panel["last_refusal"].is_object()) << events.dump(2);
  EXPECT_EQ(panel["last_refusal"]["severity"], "refusal");
  EXPECT_EQ(panel["axes"][0]["last_refusal"], panel["last_refusal"]);
  EXPECT_THAT(panel["last_refusal"]["text"].get<std::string>(), HasSubstr("axis 0"));
  EXPECT_TRUE(panel["axes"][1]["last_refusal"].is_null());
  EXPECT_TRUE(rack.get("/api/v1/devices/servo/panel").json()["last_refusal"].is_null());
}

TEST(Wiring, TellsPortsNeighboursAndBuses) {
  ServedRack rack;
  const json wiring = rack.get("/api/v1/wiring").json();
  ASSERT_EQ(wiring["segments"].size(), 1U);
  const json& segment = wiring["segments"][0];
  EXPECT_EQ(segment["name"], "segment 0");
  EXPECT_FALSE(segment["redundant"].get<bool>());
  EXPECT_THAT(segment["link"].get<std::string>(), HasSubstr("udp:127.0.0.1"));
  EXPECT_EQ(segment["carrier"], json::parse("[true, false]"));
  const json& device = segment["devices"][0];
  EXPECT_EQ(device["name"], "drive");
  EXPECT_TRUE(device["after"].is_null());
  ASSERT_EQ(device["ports"].size(), 2U);
  EXPECT_EQ(device["ports"][0]["neighbour"], "master");
  EXPECT_TRUE(device["ports"][0]["link"].get<bool>());
  EXPECT_TRUE(device["ports"][1]["neighbour"].is_null());
  EXPECT_TRUE(device["ports"][1]["loop_closed"].get<bool>());
  EXPECT_EQ(device["ports"][0]["lost_links"], 0);
  ASSERT_EQ(wiring["buses"].size(), 1U);
  EXPECT_EQ(wiring["buses"][0]["bit_rate"], 1'000'000);
  EXPECT_EQ(wiring["buses"][0]["devices"], json::parse(R"(["servo"])"));
  EXPECT_TRUE(wiring["lines"].empty());
}

TEST(Connections, AreForTheLinksOfThisRack) {
  rack::RackConfiguration configuration = ServedRack::module_with({});
  configuration.buses[0].ports.emplace_back("slcan-tcp:0");
  configuration.buses[0].devices[0].serial = {{"rs232", "tcp:0"}};
  configuration.segments = ServedRack::configuration(rack::ClockKind::real, "").segments;
  ServedRack rack(configuration);
  const json links = rack.get("/api/v1/connections").json()["links"];
  ASSERT_EQ(links.size(), 4U) << links.dump(2);
  EXPECT_EQ(links[0]["network"], "segment 0");
  EXPECT_EQ(links[0]["where"], "Masters send to 127.0.0.1");
  EXPECT_THAT(links[0]["programs"][0]["lines"].get<std::string>(),
              HasSubstr("--link " + to_text(configuration.segments[0].link)));
  EXPECT_EQ(links[1]["link"], configuration.buses[0].ports[0]);
  // Ports that the system has chosen.
  const std::string port = rack.runner().bus(0).port(1).name();
  EXPECT_THAT(port, Not(HasSubstr(":0")));
  EXPECT_EQ(links[2]["link"], port);
  const std::string line = rack.runner().line(0).link().name();
  EXPECT_EQ(links[3]["network"], "tcp:0");
  EXPECT_EQ(links[3]["link"], line);
  EXPECT_THAT(links[3]["programs"][0]["lines"].get<std::string>(), HasSubstr(line));
}

TEST(StateMachines, AreWholeGraphs) {
  ServedRack rack;
  const json machines = rack.get("/api/v1/state-machines").json()["machines"];
  ASSERT_EQ(machines.size(), 3U);
  for (const json& machine : machines) {
    std::set<std::string> entered;
    for (const json& transition : machine["transitions"]) {
      EXPECT_THAT(machine["states"], testing::Contains(transition["from"]));
      EXPECT_THAT(machine["states"], testing::Contains(transition["to"]));
      entered.insert(transition["to"].get<std::string>());
    }
    // The first one of CiA 402 is entered by the start alone.
    EXPECT_GE(entered.size() + 1, machine["states"].size()) << machine["name"];
  }
  std::set<std::string> numbers;
  for (const json& transition : machines[0]["transitions"]) {
    numbers.insert(transition["number"].get<std::string>());
  }
  EXPECT_EQ(numbers.size(), 16U) << "transitions 1 to 16";
}

TEST(Program, OfADeviceWithoutTmclIsNotThere) {
  ServedRack rack;
  EXPECT_EQ(rack.get("/api/v1/devices/drive/program").status, 404);
}

TEST(Program, IsListedInWordsWithItsAddresses) {
  constexpr std::uint8_t kRotateRight = 1;
  constexpr std::uint8_t kStop = 28;
  ServedRack rack(
      ServedRack::module_with({{.command = kRotateRight, .value = 500}, {.command = kStop}}));
  const json panel = rack.get("/api/v1/devices/module/panel").json();
  EXPECT_TRUE(panel["program"].get<bool>());
  EXPECT_TRUE(panel["network"].is_null());
  EXPECT_EQ(led(panel, "POWER")["pattern"], "on");
  const json program = rack.get("/api/v1/devices/module/program").json();
  EXPECT_FALSE(program["running"].get<bool>());
  EXPECT_EQ(program["line"], 0);
  ASSERT_EQ(program["lines"].size(), 2U);
  EXPECT_EQ(program["lines"][0]["address"], 0);
  EXPECT_THAT(program["lines"][0]["text"].get<std::string>(), HasSubstr("ROR 0, 500"));
  EXPECT_THAT(program["lines"][1]["text"].get<std::string>(), HasSubstr("STOP"));
}

}  // namespace
}  // namespace stator::web
