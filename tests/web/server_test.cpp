// The web server over real sockets: REST, WebSocket streams, tokens, slow clients.
#include "stator/web/server/server.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "base/wait_for.hpp"
#include "rack/text_log.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/web/api/routes.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using testing::HasSubstr;

TEST(WebServer, TellsThatItIsHealthy) {
  ServedRack rack;
  const Answer answer = rack.get("/healthz");
  EXPECT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, "ok\n");
  EXPECT_EQ(answer.headers.at("content-type"), "text/plain; charset=utf-8");
}

TEST(WebServer, DescribesTheRackAndItsDevices) {
  ServedRack rack;
  const auto described = rack.get("/api/v1/rack").json();
  EXPECT_EQ(described["clock"], "real");
  EXPECT_EQ(described["devices"], 2);
  ASSERT_EQ(described["networks"].size(), 2U);
  EXPECT_EQ(described["networks"][0]["kind"], "ethercat");
  EXPECT_EQ(described["networks"][1]["name"], "can0");
  const auto devices = rack.get("/api/v1/devices").json()["devices"];
  ASSERT_EQ(devices.size(), 2U);
  EXPECT_EQ(devices[0]["name"], "drive");
  EXPECT_EQ(devices[1]["product"], "TMCC160");
  EXPECT_EQ(rack.get("/api/v1/devices/drive").json(), devices[0]);
  EXPECT_EQ(rack.get("/api/v1/devices/nobody").status, 404);
}

TEST(WebServer, TellsTheKeysOfRackFiles) {
  ServedRack rack;
  const Answer answer = rack.get("/api/v1/keys");
  EXPECT_EQ(answer.status, 200);
  const auto schema = answer.json();
  EXPECT_EQ(schema["title"], "Rack file of Stator");
  EXPECT_EQ(schema["properties"]["clock"]["default"], "real");
  EXPECT_THAT(answer.body, HasSubstr("At the motor shaft. 0 to 10 kg m²."));
  EXPECT_EQ(rack.get("/api/v1/keys").body, answer.body);
}

TEST(WebServer, NamesEachRunOfTheRack) {
  const auto run_of = [](ServedRack& rack) { return rack.get("/api/v1/rack").json()["run"]; };
  nlohmann::json first;
  {
    ServedRack rack;
    first = run_of(rack);
    EXPECT_EQ(run_of(rack), first) << "it stays while the rack runs";
  }
  ServedRack again;
  EXPECT_NE(run_of(again), first);
}

TEST(WebServer, GivesSignalsWithUnitAndValue) {
  ServedRack rack;
  const auto all = rack.get("/api/v1/signals").json()["signals"];
  EXPECT_GT(all.size(), 50U);
  const auto some = rack.get("/api/v1/signals?names=drive.axis0.coil_current_*,servo.*").json();
  for (const auto& signal : some["signals"]) {
    const auto name = signal["name"].get<std::string>();
    EXPECT_TRUE(name.starts_with("drive.axis0.coil_current_") || name.starts_with("servo."))
        << name;
    EXPECT_TRUE(signal["value"].is_number());
  }
  EXPECT_EQ(some["signals"][0]["unit"], "A");
  EXPECT_EQ(rack.get("/api/v1/signals?names=nothing*").status, 404);
}

TEST(WebServer, SetsInputsWithinTheirRange) {
  ServedRack rack;
  const std::string input = "/api/v1/inputs/drive.axis0.supply_voltage";
  const auto declared = rack.get(input).json();
  EXPECT_EQ(declared["unit"], "V");
  EXPECT_EQ(declared["group"], "supply");
  EXPECT_EQ(declared["normal"], 24.0)
      << "what the axis is supplied with unless its rack file says otherwise";
  EXPECT_TRUE(declared["value"].is_null()) << "nobody has set it";
  EXPECT_THAT(rack.get("/api/v1/inputs").json()["inputs"], testing::Contains(declared));
  EXPECT_EQ(rack.put(input, R"({"value": 31.5})").status, 200);
  EXPECT_EQ(rack.get(input).json()["value"], 31.5);
  const auto events = rack.get("/api/v1/events").json()["events"];
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back()["rule"], "input-set");
  EXPECT_THAT(events.back()["text"].get<std::string>(), HasSubstr("31.5"));
  EXPECT_TRUE(rack.get("/api/v1/events?after=1000000").json()["events"].empty());

  const double too_high = declared["maximum"].get<double>() + 1;
  const Answer refused = rack.put(input, R"({"value": )" + std::to_string(too_high) + "}");
  EXPECT_EQ(refused.status, 422);
  EXPECT_EQ(refused.headers.at("content-type"), "application/problem+json");
  EXPECT_EQ(rack.put(input, R"({"value": "much"})").status, 422);
  EXPECT_EQ(rack.put(input, R"({"volts": 1})").status, 400);
  EXPECT_EQ(rack.put(input, "{").status, 400);
  EXPECT_EQ(rack.put("/api/v1/inputs/drive.nothing", R"({"value": 1})").status, 404);
}

TEST(WebServer, ReadsObjects) {
  ServedRack rack;
  const auto identity = rack.get("/api/v1/devices/drive/objects/1018").json()["entries"];
  ASSERT_GE(identity.size(), 4U);
  EXPECT_EQ(identity[1]["value"], 0x286);
  EXPECT_EQ(identity[1]["access"], "ro");
  EXPECT_EQ(rack.get("/api/v1/devices/drive/objects/1018/01").json(), identity[1]);
  const auto all = rack.get("/api/v1/devices/servo/objects").json()["entries"];
  EXPECT_GT(all.size(), 100U);
  const Answer missing = rack.get("/api/v1/devices/drive/objects/1234/00");
  EXPECT_EQ(missing.status, 404);
  EXPECT_EQ(missing.json()["abort_code"], "0x06020000");
  EXPECT_EQ(rack.get("/api/v1/devices/drive/objects/x/00").status, 400);
}

TEST(WebServer, WritesObjectsAndTellsTheAbortCodesText) {
  ServedRack rack;
  const std::string mode = "/api/v1/devices/drive/objects/6060/00";
  EXPECT_EQ(rack.put(mode, R"({"value": 1})").status, 200);
  EXPECT_EQ(rack.get(mode).json()["value"], 1);
  EXPECT_EQ(rack.get("/api/v1/devices/drive/objects/6061/00").json()["value"], 1)
      << "the firmware has not acted on it";

  const Answer illegal = rack.put(mode, R"({"value": 99})");
  EXPECT_EQ(illegal.status, 422);
  EXPECT_EQ(illegal.json()["abort_code"], "0x06090030");
  EXPECT_THAT(illegal.json()["abort_text"].get<std::string>(), HasSubstr("range"));
  EXPECT_THAT(illegal.json()["detail"].get<std::string>(), HasSubstr("6060h"));
  EXPECT_EQ(rack.put(mode, R"({"value": 1000})").json()["abort_code"], "0x06090030");

  const Answer read_only = rack.put("/api/v1/devices/drive/objects/6041/00", R"({"value": 1})");
  EXPECT_EQ(read_only.status, 403);
  EXPECT_EQ(read_only.json()["abort_code"], "0x06010002");
}

TEST(WebServer, TellsOfARefusedWriteAmongTheEventsAsOfAMastersWrite) {
  ServedRack rack;
  const Answer refused = rack.put("/api/v1/devices/drive/objects/6060/00", R"({"value": 99})");
  ASSERT_EQ(refused.status, 422);
  const auto events = rack.get("/api/v1/events").json()["events"];
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back()["rule"], "od-illegal-value");
  EXPECT_EQ(events.back()["severity"], "refusal");
  EXPECT_EQ(events.back()["device"], "drive");
  EXPECT_EQ(events.back()["text"], refused.json()["detail"]);
}

/// Requests Operational of all slaves of the rack's segment.
void request_operational(rack::RunningRack& running) {
  std::array<std::byte, 2> state{
      std::byte{static_cast<std::uint8_t>(ethercat::AlState::operational)}};
  std::array<std::byte, ethercat::kMinimumFrameLength> buffer{};
  ethercat::FrameBuilder frame(buffer, {0x02, 0, 0, 0, 0, 1});
  frame.append(ethercat::Command::bwr, 0,
               ethercat::physical_address(0, ethercat::register_address::kAlControl), state);
  const std::scoped_lock lock(running.mutex);
  const base::SimTime now = running.now();
  ASSERT_TRUE(running.rack.process_frame(0, frame.finish(), now));
  running.rack.handle_bus_events(0, now);
}

TEST(WebServer, TellsTheMeaningOfTheCodesInEvents) {
  ServedRack rack;
  const auto events = [&rack](std::string_view rule) {
    auto all = rack.get("/api/v1/events").json()["events"];
    std::erase_if(all.get_ref<nlohmann::json::array_t&>(),
                  [&](const nlohmann::json& event) { return event["rule"] != rule; });
    return all;
  };
  request_operational(rack.runner().running());
  ASSERT_TRUE(tests::wait_for([&] { return !events("al-invalid-change").empty(); }));
  EXPECT_EQ(events("al-invalid-change")[0]["meaning"],
            "AL status code 0011h: invalid requested state change");
  request_operational(rack.runner().running());
  ASSERT_TRUE(tests::wait_for([&] { return !events("al-error-not-acknowledged").empty(); }));
  EXPECT_EQ(events("al-error-not-acknowledged")[0]["meaning"],
            "AL status code 0011h: invalid requested state change");
  ASSERT_EQ(rack.put("/api/v1/inputs/drive.axis0.load_torque", R"({"value": 0.1})").status, 200);
  EXPECT_EQ(events("input-set")[0]["meaning"], "") << "it tells no code";
}

TEST(WebServer, AnswersAnOrderToStoreOnceItIsKept) {
  const tests::TemporaryDirectory folder;
  rack::RackConfiguration configuration = rack::single_device_rack("tmc8670", devices::products());
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_udp_port()};
  configuration.segments[0].devices[0].name = "servo";
  configuration.state = folder.path() + "/state";
  ServedRack rack(configuration);
  const std::string store = "/api/v1/devices/servo/objects/1010/01";
  const std::string save = R"({"value": 1702257011})";
  ASSERT_EQ(rack.put(store, save).status, 200);
  EXPECT_TRUE(std::filesystem::exists(configuration.state + "/servo.parameters"));

  std::filesystem::remove_all(configuration.state);
  const Answer refused = rack.put(store, save);
  EXPECT_GE(refused.status, 400);
  EXPECT_EQ(refused.json()["abort_code"], "0x06060000");
  EXPECT_THAT(refused.json()["detail"].get<std::string>(), HasSubstr("could not be written"));
}

// In lockstep nothing is stored before a master moves time.
TEST(WebServer, ServesOthersWhileAnOrderIsUnderWay) {
  const tests::TemporaryDirectory folder;
  rack::RackConfiguration configuration = rack::single_device_rack("tmc8670", devices::products());
  configuration.clock = rack::ClockKind::lockstep;
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_udp_port()};
  configuration.segments[0].devices[0].name = "servo";
  configuration.state = folder.path() + "/state";
  ServedRack rack(configuration, {.rack_time = std::chrono::milliseconds(500)});
  const Answer late = rack.put("/api/v1/devices/servo/objects/1010/01", R"({"value": 1702257011})");
  EXPECT_EQ(late.status, 503);
  EXPECT_THAT(late.json()["detail"].get<std::string>(), HasSubstr("no master moves simulated"));
  EXPECT_EQ(rack.get("/api/v1/devices/servo/objects/1018/01").status, 200);
}

TEST(WebServer, WritesObjectsOfACanDevice) {
  ServedRack rack;
  const std::string mode = "/api/v1/devices/servo/objects/6060/00";
  ASSERT_EQ(rack.put(mode, R"({"value": 3})").status, 200);
  EXPECT_EQ(rack.get("/api/v1/devices/servo/objects/6061/00").json()["value"], 3);
}

TEST(WebServer, TellsMethodsThatAreAllowed) {
  ServedRack rack;
  const Answer answer = HttpClient(rack.port()).request("DELETE", "/api/v1/inputs/drive.x");
  EXPECT_EQ(answer.status, 405);
  EXPECT_EQ(answer.headers.at("allow"), "GET, HEAD, PUT");
  EXPECT_EQ(answer.json()["title"], "Method Not Allowed");
}

TEST(WebServer, KeepsAConnectionAndAnswersHeadWithoutABody) {
  ServedRack rack;
  HttpClient client(rack.port());
  const Answer head = client.request("HEAD", "/healthz");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.headers.at("content-length"), "3");
  EXPECT_EQ(client.request("GET", "/healthz").body, "ok\n");
  EXPECT_EQ(client.request("GET", "/nothing").status, 404);
  EXPECT_EQ(client.request("GET", "/healthz").body, "ok\n");
}

TEST(WebServer, AnswersEveryRouteOfItsTable) {
  ServedRack rack;
  for (const Route& route : routes()) {
    // Which pages there are depends on the build, and what is made or removed has to be there
    // first. Each has a test of its own.
    if (route.operation == Operation::page || route.operation == Operation::asset ||
        route.operation == Operation::run_rack || route.method == "POST" ||
        route.method == "DELETE") {
      continue;
    }
    std::string target(route.path);
    for (const auto& [name, value] : {std::pair<std::string, std::string>{"{device}", "drive"},
                                      {"{input}", "drive.axis0.load_torque"},
                                      {"{index}", "6083"},
                                      {"{subindex}", "00"}}) {
      if (const auto at = target.find(name); at != std::string::npos) {
        target.replace(at, name.size(), value);
      }
    }
    const Answer answer = route.writes() ? rack.put(target, R"({"value": 1})") : rack.get(target);
    // Three have nothing for a GET of this rack.
    const int expected = route.operation == Operation::traffic             ? 426
                         : route.operation == Operation::program           ? 404
                         : route.operation == Operation::recording_content ? 409
                                                                           : 200;
    EXPECT_EQ(answer.status, expected) << route.method << " " << target << ": " << answer.body;
    EXPECT_EQ(answer.headers.at("content-type"),
              expected == 200 ? route.content_type : "application/problem+json")
        << target;
    EXPECT_EQ(answer.headers.at("cache-control"), "no-store");
    EXPECT_EQ(answer.headers.at("x-content-type-options"), "nosniff");
  }
}

TEST(WebServer, NeedsATokenForAllButHealthWhenOthersReachIt) {
  ServedRack rack({}, rack::ClockKind::real, "0.0.0.0");
  EXPECT_EQ(rack.get("/healthz").status, 200);
  const std::string token = "Authorization: Bearer " + std::string(kToken) + "\r\n";
  for (const Route& route : routes()) {
    if (route.open) {
      continue;
    }
    const Answer answer =
        HttpClient(rack.port()).request(std::string(route.method), std::string(route.path));
    EXPECT_EQ(answer.status, 401) << route.path;
    EXPECT_EQ(answer.headers.at("www-authenticate"), "Bearer realm=\"stator\"");
  }
  EXPECT_EQ(rack.get("/nothing").status, 401) << "tells what is there";
  EXPECT_EQ(HttpClient(rack.port()).request("GET", "/api/v1/rack", {}, token).status, 200);
}

TEST(WebServer, DoesNotOpenToOthersWithoutAToken) {
  rack::RackConfiguration configuration =
      rack::single_device_rack("tmcm-3315", devices::products());
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_udp_port()};
  rack::EventLog log;
  rack::Rack rack(configuration, log);
  rack::Runner runner(rack, configuration, tests::no_log());
  try {
    const Server server({.address = {"0.0.0.0", 0}, .token = {}}, rack, configuration, log, runner);
    FAIL() << "listens";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("needs a token"));
  }
}

TEST(WebStream, SendsWhatWasSubscribedAtItsPeriod) {
  ServedRack rack;
  HttpClient client(rack.port());
  ASSERT_EQ(client.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status, 101);
  client.send_frame(1, R"({"signals": ["drive.axis0.position_*"], "period": "1ms"})");
  const auto subscribed = client.receive_message("subscribed");
  EXPECT_EQ(subscribed["period_ns"], 1'000'000);
  ASSERT_EQ(subscribed["signals"].size(), 2U);
  EXPECT_EQ(subscribed["signals"][0]["unit"], "microstep");
  std::int64_t expected = -1;
  for (std::size_t rows = 0; rows < 100;) {
    const auto samples = client.receive_message("samples");
    ASSERT_TRUE(samples.is_object());
    ASSERT_EQ(samples["values"].size(), 2U);
    EXPECT_EQ(samples["values"][1].size(), samples["time_ns"].size());
    for (const auto& time : samples["time_ns"]) {
      EXPECT_EQ(time.get<std::int64_t>() % 1'000'000, 0);
      EXPECT_TRUE(expected < 0 || samples["dropped"] != 0 || time == expected);
      expected = time.get<std::int64_t>() + 1'000'000;
      ++rows;
    }
  }
  client.send_frame(1, R"({"signals": []})");
  EXPECT_TRUE(client.receive_message("subscribed")["signals"].empty());
}

TEST(WebStream, SendsSamplesInBinaryAndEventsAsText) {
  ServedRack rack;
  HttpClient client(rack.port());
  ASSERT_EQ(client.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status, 101);
  client.send_frame(1, R"({"signals": ["drive.axis0.load_torque"], "period": "50us",)"
                       R"( "format": "binary", "events": true})");
  const auto subscribed = client.receive_message("subscribed");
  EXPECT_EQ(subscribed["format"], "binary");
  EXPECT_EQ(subscribed["events"], true);
  EXPECT_EQ(rack.put("/api/v1/inputs/drive.axis0.load_torque", R"({"value": 0.25})").status, 200);
  std::int64_t event_time = -1;
  std::int64_t step_time = -1;
  while (event_time < 0 || step_time < 0) {
    const auto frame = client.receive_frame();
    ASSERT_TRUE(frame);
    const std::string& payload = frame->payload;
    if (frame->opcode == 1) {
      const auto message = nlohmann::json::parse(payload);
      ASSERT_EQ(message["type"], "events");
      for (const auto& event : message["events"]) {
        if (event["rule"] == "input-set") {
          event_time = event["time_ns"];
        }
      }
      continue;
    }
    const auto bytes = std::as_bytes(std::span(payload));
    ASSERT_EQ(payload.substr(0, 4), "SSB1");
    const auto rows = base::load_le<std::uint32_t>(bytes, 8);
    for (std::size_t row = 0; row < rows && step_time < 0; ++row) {
      if (base::load_le<double>(bytes, 24 + (rows + row) * 8) == 0.25) {
        step_time = base::load_le<std::int64_t>(bytes, 24 + row * 8);
      }
    }
  }
  EXPECT_GE(step_time, event_time);
}

TEST(WebStream, OfAClientThatDoesNotReadLosesTheOldestAndCountsThem) {
  ServedRack rack;
  HttpClient client(rack.port(), 4096);
  ASSERT_EQ(client.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status, 101);
  client.send_frame(
      1, R"({"signals": ["drive.axis0.coil_*", "drive.axis1.coil_*", "drive.axis2.coil_*"],)"
         R"( "period": "50us"})");
  HttpClient observer(rack.port());
  const auto dropped = [&observer] {
    const std::string metrics = observer.request("GET", "/metrics").body;
    const std::string name = "\nstator_stream_rows_dropped_total ";
    return std::stoul(metrics.substr(metrics.find(name) + name.size()));
  };
  EXPECT_TRUE(tests::wait_for([&dropped] { return dropped() > 0; }));
  EXPECT_EQ(observer.request("GET", "/healthz").status, 200);
  // What is left of the queue still comes, and tells of the loss.
  nlohmann::json samples;
  do {
    samples = client.receive_message("samples");
    ASSERT_TRUE(samples.is_object());
  } while (samples["dropped"] == 0);
}

TEST(WebStream, SaysWhatIsWrongWithASubscription) {
  ServedRack rack;
  HttpClient client(rack.port());
  ASSERT_EQ(client.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status, 101);
  const auto status_of = [&client](const std::string& message) {
    client.send_frame(1, message);
    return client.receive_message("problem")["problem"]["status"];
  };
  EXPECT_EQ(status_of("nonsense"), 400);
  EXPECT_EQ(status_of(R"({"signals": [1]})"), 400);
  EXPECT_EQ(status_of(R"({"signals": ["nothing"]})"), 404);
  EXPECT_EQ(status_of(R"({"signals": ["drive.axis0.*"], "period": "70us"})"), 422);
  EXPECT_EQ(status_of(R"({"signals": ["drive.*"], "period": "50us"})"), 422) << "too many values";
}

TEST(WebStream, ChoosesItsProtocolAndTakesTheTokenBesideIt) {
  ServedRack rack({}, rack::ClockKind::real, "0.0.0.0");
  HttpClient refused(rack.port());
  EXPECT_EQ(refused.request("GET", "/api/v1/signals", {}, HttpClient::upgrade_fields()).status,
            401);
  HttpClient client(rack.port());
  const Answer answer =
      client.request("GET", "/api/v1/signals", {},
                     HttpClient::upgrade_fields() + "Sec-WebSocket-Protocol: stator.signals.v1, " +
                         "token." + kToken + "\r\n");
  EXPECT_EQ(answer.status, 101);
  EXPECT_EQ(answer.headers.at("sec-websocket-protocol"), "stator.signals.v1");
}

}  // namespace
}  // namespace stator::web
