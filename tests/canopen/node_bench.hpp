// A CANopen node with one object for each service of this room, a dictionary, and the frames it
// sends.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/nmt/node.hpp"

namespace stator::canopen {

using namespace base::literals;

inline constexpr std::array<std::int64_t, 3> kBenchLegalValues{0, 3, 7};

/// One object of everything a node in this room deals with.
inline constexpr auto kBenchObjects = std::to_array<dictionary::EntryDeclaration>({
    {.index = 0x1000,
     .name = "Device type",
     .access = dictionary::Access::constant,
     .default_value = dictionary::hex(0x00020192)},
    {.index = 0x1008,
     .name = "Device name",
     .type = dictionary::DataType::visible_string,
     .access = dictionary::Access::constant,
     .default_value = "Bench node 1"},
    {.index = 0x100C, .name = "Guard time", .type = dictionary::DataType::unsigned16},
    {.index = 0x100D, .name = "Life time factor", .type = dictionary::DataType::unsigned8},
    {.index = 0x1012, .name = "COB-ID time stamp", .default_value = 0x80000100},
    {.index = 0x1016,
     .name = "Number of entries",
     .object_code = dictionary::ObjectCode::array,
     .type = dictionary::DataType::unsigned8,
     .access = dictionary::Access::read_only,
     .default_value = 2},
    {.index = 0x1016,
     .subindex = 1,
     .name = "Consumer heartbeat time 1",
     .object_code = dictionary::ObjectCode::array},
    {.index = 0x1016,
     .subindex = 2,
     .name = "Consumer heartbeat time 2",
     .object_code = dictionary::ObjectCode::array},
    {.index = 0x1017, .name = "Heartbeat time", .type = dictionary::DataType::unsigned16},
    {.index = 0x1018,
     .name = "Number of entries",
     .object_code = dictionary::ObjectCode::record,
     .type = dictionary::DataType::unsigned8,
     .access = dictionary::Access::read_only,
     .default_value = 3},
    {.index = 0x1018,
     .subindex = 1,
     .name = "Vendor-ID",
     .object_code = dictionary::ObjectCode::record,
     .access = dictionary::Access::read_only,
     .default_value = 0x00000286},
    {.index = 0x1018,
     .subindex = 2,
     .name = "Product code",
     .object_code = dictionary::ObjectCode::record,
     .access = dictionary::Access::read_only,
     .default_value = 0x000000A0},
    {.index = 0x1018,
     .subindex = 3,
     .name = "Revision number",
     .object_code = dictionary::ObjectCode::record,
     .access = dictionary::Access::read_only,
     .default_value = 0x00030000},
    {.index = 0x1021,
     .name = "Store EDS",
     .object_code = dictionary::ObjectCode::domain_object,
     .type = dictionary::DataType::domain,
     .access = dictionary::Access::read_only},
    {.index = 0x1200,
     .name = "Highest sub-index",
     .object_code = dictionary::ObjectCode::record,
     .type = dictionary::DataType::unsigned8,
     .access = dictionary::Access::read_only,
     .default_value = 2},
    {.index = 0x1200,
     .subindex = 1,
     .name = "COB-ID client to server",
     .object_code = dictionary::ObjectCode::record,
     .access = dictionary::Access::read_only},
    {.index = 0x1200,
     .subindex = 2,
     .name = "COB-ID server to client",
     .object_code = dictionary::ObjectCode::record,
     .access = dictionary::Access::read_only},
    {.index = 0x1201,
     .name = "Highest sub-index",
     .object_code = dictionary::ObjectCode::record,
     .type = dictionary::DataType::unsigned8,
     .access = dictionary::Access::read_only,
     .default_value = 2},
    {.index = 0x1201,
     .subindex = 1,
     .name = "COB-ID client to server",
     .object_code = dictionary::ObjectCode::record,
     .default_value = 0x80000000},
    {.index = 0x1201,
     .subindex = 2,
     .name = "COB-ID server to client",
     .object_code = dictionary::ObjectCode::record,
     .default_value = 0x80000000},
    {.index = 0x2000,
     .name = "Resolution",
     .type = dictionary::DataType::unsigned8,
     .default_value = 8,
     .range = dictionary::Range{1, 8}},
    {.index = 0x2001, .name = "Current", .type = dictionary::DataType::unsigned16},
    {.index = 0x2002,
     .name = "Target",
     .type = dictionary::DataType::integer32,
     .default_value = -7,
     .range = dictionary::Range{-1000, 1000}},
    {.index = 0x2003, .name = "Serial", .type = dictionary::DataType::unsigned64},
    {.index = 0x2004,
     .name = "Owner",
     .type = dictionary::DataType::visible_string,
     .default_value = "nobody"},
    {.index = 0x2005, .name = "Key", .access = dictionary::Access::write_only},
    {.index = 0x2006,
     .name = "Mode",
     .type = dictionary::DataType::integer8,
     .legal_values = kBenchLegalValues},
    {.index = 0x2007,
     .name = "Limit",
     .type = dictionary::DataType::unsigned16,
     .write_states = dictionary::kPreOperationalOnly},
});

/// Keeps what is sent, and when.
class RecordingTransmitter final : public can::Transmitter {
 public:
  bool send(const can::Frame& frame) override {
    if (room_ == 0) {
      return false;
    }
    --room_;
    sent.push_back(frame);
    times.push_back(now);
    return true;
  }
  [[nodiscard]] std::size_t room() const override { return room_; }
  void set_room(std::size_t room) { room_ = room; }

  std::vector<can::Frame> sent;
  std::vector<base::SimTime> times;
  base::SimTime now;

 private:
  std::size_t room_ = 1'000'000'000;
};

/// Keeps the sentences of what is reported.
class EventLog final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }
  /// Was there a sentence with `part` in it?
  [[nodiscard]] bool tells(std::string_view part) const {
    for (const std::string& sentence : sentences) {
      if (sentence.find(part) != std::string::npos) {
        return true;
      }
    }
    return false;
  }
  std::vector<std::string> sentences;
};

inline NodeConfiguration bench_configuration() {
  NodeConfiguration configuration;
  configuration.node_id = 5;
  return configuration;
}

/// A node with node-ID 5 on its own, and its time.
class NodeBench {
 public:
  static constexpr std::uint8_t kNodeId = 5;

  explicit NodeBench(const NodeConfiguration& configuration = bench_configuration())
      : objects_(dictionary),
        node(dictionary, transmitter, base::EventReporter(&events, 0), configuration) {}

  /// Switches the node on and lets it boot up; what it sent is forgotten.
  NodeBench& boot() {
    node.power_on(now);
    wait(1_s);
    transmitter.sent.clear();
    transmitter.times.clear();
    return *this;
  }

  /// Lets time pass, stopping at each of the node's deadlines.
  void wait(base::SimDuration duration) {
    const base::SimTime end = now + duration;
    for (base::SimTime next = node.next_deadline(); next <= end; next = node.next_deadline()) {
      set_time(next < now ? now : next);
      node.advance(now);
    }
    set_time(end);
    node.advance(now);
  }

  void receive(const can::Frame& frame) { node.receive(frame, now); }
  void receive(std::uint32_t identifier, std::initializer_list<unsigned> data) {
    receive(can::data_frame(identifier, data));
  }
  void nmt(unsigned command, unsigned node_id = kNodeId) { receive(0x000, {command, node_id}); }

  /// Everything sent since the last call.
  std::vector<can::Frame> take() { return std::exchange(transmitter.sent, {}); }

  [[nodiscard]] std::uint64_t value(std::uint16_t index, std::uint8_t subindex = 0) const {
    return dictionary.find(index, subindex)->value();
  }
  void set(std::uint16_t index, std::uint8_t subindex, std::uint64_t value) {
    dictionary.find(index, subindex)->set_value(value);
  }

  dictionary::Dictionary dictionary;
  RecordingTransmitter transmitter;
  EventLog events;
  base::SimTime now;

 private:
  /// Fills the dictionary before the node sees it.
  struct Objects {
    explicit Objects(dictionary::Dictionary& dictionary) {
      dictionary.add(kBenchObjects);
      dictionary.finish();
    }
  };
  void set_time(base::SimTime time) {
    now = time;
    transmitter.now = time;
  }

  Objects objects_;

 public:
  Node node;
};

/// A frame as text, for messages of failed tests: "585 [60 00 20 00 00 00 00 00]".
inline std::string to_text(const can::Frame& frame) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (int shift = 8; shift >= 0; shift -= 4) {
    text += kDigits[(frame.identifier >> shift) & 0xF];
  }
  text += frame.remote ? " remote [" : " [";
  for (const std::byte byte : frame.payload()) {
    text += text.back() == '[' ? "" : " ";
    text += kDigits[std::to_integer<unsigned>(byte) >> 4];
    text += kDigits[std::to_integer<unsigned>(byte) & 0xF];
  }
  return text + "]";
}

inline std::vector<std::string> to_text(const std::vector<can::Frame>& frames) {
  std::vector<std::string> texts;
  texts.reserve(frames.size());
  for (const can::Frame& frame : frames) {
    texts.push_back(to_text(frame));
  }
  return texts;
}

using Texts = std::vector<std::string>;

}  // namespace stator::canopen
