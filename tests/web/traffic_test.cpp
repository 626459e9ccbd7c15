// Frames of EtherCAT, CANopen and TMCL in words, damaged and truncated ones included.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/bench/link_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/controller/frame_text.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/web/stream/can_text.hpp"
#include "stator/web/stream/ethercat_text.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using ethercat::Command;
using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

constexpr ethercat::MacAddress kSource{2, 0, 0, 0, 0, 1};

/// A device's dictionary, for names and types.
const dictionary::Dictionary& objects() {
  static const auto device = rack::make_ethercat_device(
      rack::single_device_rack("tmcm-3315", devices::products()).segments[0].devices[0].setup,
      base::EventReporter());
  return *device->object_dictionary();
}

SlaveMap slave() {
  SlaveMap map{.name = "drive", .objects = &objects(), .station = 0x1001};
  map.areas = {{{0x1000, 128}, {0x1080, 128}, {0x1100, 6}, {0x1180, 2}}};
  map.fmmus = {{.logical_start = 0x10000,
                .length = 6,
                .logical_stop_bit = 7,
                .physical_start = 0x1100,
                .writes = true},
               {.logical_start = 0x10006,
                .length = 2,
                .logical_stop_bit = 7,
                .physical_start = 0x1180,
                .reads = true}};
  map.outputs = {{.index = 0x6040, .bit = 0, .bits = 16}, {.index = 0x607A, .bit = 16, .bits = 32}};
  map.inputs = {{.index = 0x6041, .bit = 0, .bits = 16}};
  return map;
}

class Frame {
 public:
  Frame() : builder_(buffer_, kSource) {}
  Frame& add(Command command, std::uint32_t address, std::vector<std::uint8_t> data,
             std::uint16_t working_counter = 0) {
    const auto bytes = std::as_bytes(std::span(data));
    const auto place = builder_.append(command, 0, address, bytes);
    base::store_le(place->data() + place->size(), working_counter);
    return *this;
  }
  std::span<const std::byte> bytes() { return builder_.finish(); }

 private:
  std::array<std::byte, ethercat::kMaximumFrameLength> buffer_{};
  ethercat::FrameBuilder builder_;
};

std::string field(const DecodedFrame& frame, const std::string& name) {
  for (const auto& [key, value] : frame.fields) {
    if (key == name) {
      return value;
    }
  }
  return "(none)";
}

/// An SDO request to the mailbox of the slave at station 1001h.
std::vector<std::uint8_t> mailbox(std::vector<std::uint8_t> coe) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(coe.size()), 0, 0, 0, 0, 0x13};
  bytes.insert(bytes.end(), coe.begin(), coe.end());
  bytes.resize(128);
  return bytes;
}

TEST(EtherCatText, NamesCommandAddressRegisterAndWorkingCounter) {
  Frame frame;
  frame.add(Command::fprd, ethercat::physical_address(0x1001, 0x0130), {8, 0}, 1);
  EXPECT_EQ(describe_ethercat(frame.bytes(), true, {slave()}).summary,
            "FPRD 1001h drive 0130h " + ethercat::register_name(0x0130) +
                ", 2 bytes, WKC 1: Operational");
  EXPECT_THAT(ethercat::register_name(0x0130), HasSubstr("AL Status"));
  Frame broadcast;
  broadcast.add(Command::brd, ethercat::physical_address(0, 0), {0});
  EXPECT_THAT(describe_ethercat(broadcast.bytes(), false, {slave()}).summary,
              StartsWith("BRD 0000h "));
}

TEST(EtherCatText, TellsStateChangesInWords) {
  Frame request;
  request.add(Command::fpwr, ethercat::physical_address(0x1001, 0x0120), {0x14, 0});
  EXPECT_THAT(describe_ethercat(request.bytes(), false, {slave()}).summary,
              HasSubstr("Safe-Operational requested, error acknowledged"));
  Frame status;
  status.add(Command::fprd, ethercat::physical_address(0x1001, 0x0130), {0x12, 0, 0, 0, 0x1B, 0},
             1);
  EXPECT_THAT(describe_ethercat(status.bytes(), true, {slave()}).summary,
              HasSubstr("Pre-Operational, error, 001Bh sync manager watchdog"));
}

TEST(EtherCatText, FindsSlavesByTheirPositionBeforeAndBehindThem) {
  std::vector<SlaveMap> slaves{slave(), slave()};
  slaves[1].name = "second";
  Frame request;
  request.add(Command::apwr, ethercat::physical_address(0xFFFF, 0x0010), {1, 0x10});
  EXPECT_THAT(describe_ethercat(request.bytes(), false, slaves).summary, HasSubstr("second"));
  Frame answer;
  answer.add(Command::apwr, ethercat::physical_address(1, 0x0010), {1, 0x10}, 1);
  EXPECT_THAT(describe_ethercat(answer.bytes(), true, slaves).summary, HasSubstr("second"));
}

TEST(EtherCatText, ShowsSdosWithNameAndValue) {
  Frame download;
  download.add(Command::fpwr, ethercat::physical_address(0x1001, 0x1000),
               mailbox({0x00, 0x20, 0x2B, 0x40, 0x60, 0x00, 0x06, 0x00, 0x00, 0x00}));
  const DecodedFrame decoded = describe_ethercat(download.bytes(), false, {slave()});
  EXPECT_THAT(decoded.summary,
              HasSubstr("SDO download 6040h:00h \"Axis 0: Controlword\" = 0006h (Shutdown)"));
  EXPECT_EQ(field(decoded, "value"), "0006h (Shutdown)");
  Frame upload;
  upload.add(Command::fprd, ethercat::physical_address(0x1001, 0x1080),
             mailbox({0x00, 0x30, 0x4F, 0x61, 0x60, 0x00, 0x08, 0x00, 0x00, 0x00}), 1);
  EXPECT_THAT(describe_ethercat(upload.bytes(), true, {slave()}).summary,
              HasSubstr("SDO upload 6061h:00h \"Axis 0: Modes of operation display\" = 8"));
  // An abort is a request, whoever sends it; some slaves send it as a response.
  for (const std::uint8_t service : {std::uint8_t{0x20}, std::uint8_t{0x30}}) {
    Frame abort;
    abort.add(Command::fprd, ethercat::physical_address(0x1001, 0x1080),
              mailbox({0x00, service, 0x80, 0x61, 0x60, 0x00, 0x02, 0x00, 0x01, 0x06}), 1);
    EXPECT_THAT(
        describe_ethercat(abort.bytes(), true, {slave()}).summary,
        HasSubstr("SDO abort 6061h:00h \"Axis 0: Modes of operation display\": 06010002h ("));
  }
}

TEST(EtherCatText, ShowsProcessDataAsObjects) {
  Frame frame;
  frame.add(Command::lrw, 0x10000, {0x0F, 0x00, 0xE8, 0x03, 0x00, 0x00, 0x27, 0x06}, 3);
  const DecodedFrame request = describe_ethercat(frame.bytes(), false, {slave()});
  EXPECT_EQ(request.summary, "LRW 00010000h, 8 bytes");
  EXPECT_EQ(field(request, "drive 6040h:00h \"Axis 0: Controlword\""), "000Fh (Enable operation)");
  EXPECT_EQ(field(request, "drive 607Ah:00h \"Axis 0: Target position\""), "1000");
  const DecodedFrame answer = describe_ethercat(frame.bytes(), true, {slave()});
  EXPECT_EQ(answer.summary, "LRW 00010000h, 8 bytes, WKC 3");
  EXPECT_EQ(field(answer, "drive 6041h:00h \"Axis 0: Statusword\""), "0627h (Operation enabled)");
}

TEST(EtherCatText, SaysWhatIsNoEtherCat) {
  EXPECT_EQ(describe_ethercat({}, false, {}).summary, "too short for EtherCAT");
  const std::array<std::byte, 60> foreign{};
  EXPECT_EQ(describe_ethercat(foreign, false, {}).summary, "no EtherCAT");
}

// Whatever a program on the wire sends: cut short, and with any bytes changed.
TEST(EtherCatText, TakesTruncatedAndDamagedFrames) {
  std::mt19937 random(7);  // NOLINT: the same each time
  Frame frame;
  frame
      .add(Command::fpwr, ethercat::physical_address(0x1001, 0x1000),
           mailbox({0x00, 0x20, 0x21, 0x40, 0x60, 0x00, 0x06, 0x00, 0x00, 0x00}))
      .add(Command::fprd, ethercat::physical_address(0x1001, 0x1080),
           mailbox({0x00, 0x30, 0x41, 0x61, 0x60, 0x00, 0x02, 0x00, 0x01, 0x06}), 1)
      .add(Command::lrw, 0x10000, {0x0F, 0x00, 0xE8, 0x03, 0x00, 0x00, 0x27, 0x06}, 3);
  const auto whole = frame.bytes();
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const DecodedFrame decoded = describe_ethercat(whole.first(length), true, {slave()});
    EXPECT_FALSE(decoded.summary.empty());
  }
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::byte> damaged(whole.begin(), whole.end());
    for (int change = 0; change < 6; ++change) {
      damaged[14 + random() % (damaged.size() - 14)] = static_cast<std::byte>(random());
    }
    damaged.resize(random() % 4 == 0 ? random() % damaged.size() : damaged.size());
    const DecodedFrame decoded = describe_ethercat(damaged, i % 2 == 0, {slave()});
    EXPECT_LE(decoded.fields.size(), DecodedFrame::kMostFields);
  }
}

NodeMap node() {
  NodeMap map{.name = "servo", .objects = &objects(), .node_id = 5};
  map.pdos[0x205] = {.name = "RPDO1", .objects = {{.index = 0x6040, .bit = 0, .bits = 16}}};
  return map;
}

std::string can_summary(std::uint32_t identifier, std::initializer_list<unsigned> data) {
  return describe_can(can::data_frame(identifier, data), {node()}).summary;
}

TEST(CanText, TellsTheServicesOfCanopen) {
  EXPECT_EQ(can_summary(0x000, {1, 5}), "000h NMT Operational, node 5 servo");
  EXPECT_EQ(can_summary(0x000, {129, 0}), "000h NMT reset node, all nodes");
  EXPECT_EQ(can_summary(0x080, {}), "080h SYNC");
  EXPECT_EQ(can_summary(0x085, {0x30, 0x81, 0x10, 0, 0, 0, 0, 0}), "085h EMCY 8130h, node 5 servo");
  EXPECT_EQ(can_summary(0x705, {0}), "705h boot-up, node 5 servo");
  EXPECT_EQ(can_summary(0x705, {5}), "705h heartbeat Operational, node 5 servo");
  EXPECT_EQ(can_summary(0x605, {0x2B, 0x40, 0x60, 0, 0x0F, 0, 0, 0}),
            "605h SDO download 6040h:00h \"Axis 0: Controlword\" = 000Fh (Enable operation), node "
            "5 servo");
  EXPECT_EQ(can_summary(0x585, {0x60, 0x40, 0x60, 0, 0, 0, 0, 0}),
            "585h SDO download done 6040h:00h \"Axis 0: Controlword\", node 5 servo");
  EXPECT_EQ(can_summary(0x606, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0}),
            "606h SDO upload 6041h:00h, node 6");
  EXPECT_EQ(can_summary(0x205, {0x06, 0x00}), "205h PDO RPDO1, servo: 0006h (Shutdown)");
  EXPECT_EQ(describe_can(can::remote_frame(0x705), {node()}).summary,
            "705h node guarding, request to node 5 servo");
}

TEST(CanText, TellsRequestsAndRepliesOfTmcl) {
  NodeMap module{.name = "module"};
  module.tmcl_requests = {1};
  module.tmcl_replies = 2;
  const auto request = can::data_frame(1, {4, 0, 0, 0, 0, 0xC8, 0});
  EXPECT_EQ(describe_can(request, {module}).summary, "001h TMCL MVP 0, 0, 51200, to module");
  const auto reply = can::data_frame(2, {1, 100, 4, 0, 0, 0xC8, 0});
  EXPECT_EQ(describe_can(reply, {module}).summary, "002h TMCL success, MVP = 51200");
}

TEST(CanText, TakesAnyFrame) {
  std::mt19937 random(11);  // NOLINT: the same each time
  NodeMap module{.name = "module"};
  module.tmcl_requests = {1};
  module.tmcl_replies = 2;
  for (int i = 0; i < 20'000; ++i) {
    can::Frame frame{.identifier = static_cast<std::uint32_t>(random() % 0x800),
                     .extended = random() % 16 == 0,
                     .remote = random() % 16 == 0,
                     .length = static_cast<std::uint8_t>(random() % 9)};
    std::ranges::generate(frame.data, [&] { return static_cast<std::byte>(random()); });
    EXPECT_FALSE(describe_can(frame, {node(), module}).summary.empty());
  }
}

class Traffic : public testing::Test {
 protected:
  /// A WebSocket that has asked for `wanted`.
  std::unique_ptr<HttpClient> open(const std::string& wanted) {
    auto client = std::make_unique<HttpClient>(rack.port());
    EXPECT_EQ(client->request("GET", "/api/v1/traffic", {}, HttpClient::upgrade_fields()).status,
              101);
    client->send_frame(1, wanted);
    return client;
  }
  /// Sends what a master sends first, again and again until `client` has got frames.
  json frames_of(HttpClient& client) {
    const auto opened =
        link::open_link(rack.configuration().segments[0].link, link::LinkEnd::master, {});
    EXPECT_TRUE(opened);
    std::atomic<bool> stopping{false};
    std::thread talker([&] {
      bench::LinkPort port(**opened);
      while (!stopping) {
        master::Master master(port);
        static_cast<void>(master.scan());
      }
    });
    const json message = client.receive_message("frames");
    stopping = true;
    talker.join();
    return message;
  }

  ServedRack rack;
};

TEST_F(Traffic, ShowsWhatAMasterSendsInWords) {
  auto client = open(R"({"networks": ["segment 0"], "filter": "", "frames": true})");
  const json subscribed = client->receive_message("subscribed");
  EXPECT_EQ(subscribed["networks"], json::parse(R"(["segment 0"])"));
  const json message = frames_of(*client);
  ASSERT_TRUE(message.is_object());
  ASSERT_FALSE(message["frames"].empty());
  std::uint64_t last = 0;
  for (const json& frame : message["frames"]) {
    EXPECT_EQ(frame["network"], "segment 0");
    EXPECT_GT(frame["number"], last);
    last = frame["number"].get<std::uint64_t>();
    EXPECT_TRUE(frame["direction"] == "request" || frame["direction"] == "answer");
    EXPECT_EQ(frame["raw"].get<std::string>().substr(24, 4), "88a4");
    EXPECT_FALSE(frame["fields"].empty());
  }
}

TEST_F(Traffic, FiltersByWords) {
  auto client = open(R"({"networks": [], "filter": "AL STATUS"})");
  const json message = frames_of(*client);
  ASSERT_TRUE(message.is_object());
  for (const json& frame : message["frames"]) {
    EXPECT_THAT(frame.dump(), HasSubstr("AL Status"));
  }
}

TEST_F(Traffic, RefusesWhatItDoesNotUnderstand) {
  for (const char* wrong : {"{", "[]", R"({"networks": 1})", R"({"networks": ["nothing"]})",
                            R"({"networks": [1]})", R"({"filter": 1})", R"({"frames": "yes"})"}) {
    auto client = open(wrong);
    EXPECT_EQ(client->receive_message("problem")["problem"]["status"], 400) << wrong;
  }
  const Answer plain = rack.get("/api/v1/traffic");
  EXPECT_EQ(plain.status, 426);
}

}  // namespace
}  // namespace stator::web
