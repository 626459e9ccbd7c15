// The services of a CANopen node: any frames in any state, SDO requests that continue a transfer,
// LSS, silence, values that change under a transfer, a transmit buffer that fills. Whatever came,
// a power cycle brings the node back with its boot-up message and an answer to an SDO request.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "input.hpp"
#include "stator/canopen/nmt/node.hpp"

namespace {

using namespace stator;
using namespace stator::canopen;
using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using dictionary::ObjectCode;
using stator::fuzz::Input;
using stator::fuzz::require;

constexpr std::uint8_t kNodeId = 5;
constexpr std::uint32_t kRequest = 0x605;

constexpr auto kObjects = std::to_array<EntryDeclaration>({
    {.index = 0x1000, .name = "Device type", .access = Access::constant, .default_value = 0x20192},
    {.index = 0x100C, .name = "Guard time", .type = DataType::unsigned16},
    {.index = 0x100D, .name = "Life time factor", .type = DataType::unsigned8},
    {.index = 0x1012, .name = "COB-ID time stamp", .default_value = 0x80000100},
    {.index = 0x1016,
     .name = "Number of entries",
     .object_code = ObjectCode::array,
     .type = DataType::unsigned8,
     .access = Access::read_only,
     .default_value = 2},
    {.index = 0x1016, .subindex = 1, .name = "Heartbeat 1", .object_code = ObjectCode::array},
    {.index = 0x1016, .subindex = 2, .name = "Heartbeat 2", .object_code = ObjectCode::array},
    {.index = 0x1017, .name = "Heartbeat time", .type = DataType::unsigned16},
    {.index = 0x1021,
     .name = "Store EDS",
     .object_code = ObjectCode::domain_object,
     .type = DataType::domain,
     .access = Access::read_only},
    {.index = 0x1201,
     .name = "Highest sub-index",
     .object_code = ObjectCode::record,
     .type = DataType::unsigned8,
     .access = Access::read_only,
     .default_value = 2},
    {.index = 0x1201,
     .subindex = 1,
     .name = "Client to server",
     .object_code = ObjectCode::record,
     .default_value = 0x6A0},
    {.index = 0x1201,
     .subindex = 2,
     .name = "Server to client",
     .object_code = ObjectCode::record,
     .default_value = 0x6A1},
    {.index = 0x2000, .name = "Number", .type = DataType::unsigned16},
    {.index = 0x2001, .name = "Long number", .type = DataType::unsigned64},
    {.index = 0x2002, .name = "Text", .type = DataType::visible_string, .default_value = "text"},
    {.index = 0x2003, .name = "Order", .type = DataType::unsigned8},
});

/// Counts frames and takes as many as there is room for.
class Buffer final : public can::Transmitter {
 public:
  bool send(const can::Frame& frame) override {
    require(frame.length <= can::kMaximumData && frame.identifier < 0x800);
    if (room_ == 0) {
      return false;
    }
    --room_;
    last = frame;
    return true;
  }
  [[nodiscard]] std::size_t room() const override { return room_; }
  void set_room(std::size_t room) { room_ = room; }

  std::optional<can::Frame> last;

 private:
  std::size_t room_ = 1000;
};

/// Lets some writes to 2003h be under way for a while, and some fail.
class Disk final : public dictionary::WriteCompletion {
 public:
  [[nodiscard]] std::optional<dictionary::Verdict> poll(const dictionary::Entry& entry,
                                                        base::SimTime) override {
    if (entry.index() != 0x2003 || entry.value() == 0) {
      return dictionary::Verdict{};
    }
    if (polls_++ % 4 != 3) {
      return std::nullopt;
    }
    return entry.value() == 1
               ? dictionary::Verdict{}
               : dictionary::refuse(dictionary::AbortCode::hardware_error, kFull, {});
  }

 private:
  static constexpr base::EventRule kFull{"full", base::Severity::refusal, "the memory is full"};
  unsigned polls_ = 0;
};

NodeConfiguration configuration(Input& input) {
  const unsigned choice = input.byte();
  NodeConfiguration result;
  result.node_id = (choice & 1) != 0 ? kUnconfiguredNodeId : kNodeId;
  result.lss = LssConfiguration{.serial_number = 7};
  result.sdo.honour_protocol_switch_threshold = (choice & 2) != 0;
  result.sdo.block_transfer = (choice & 4) == 0;
  result.sdo.block_size = static_cast<std::uint8_t>(choice >> 3);
  result.sdo.longest_download = 300;
  return result;
}

struct Objects {
  explicit Objects(dictionary::Dictionary& dictionary) {
    dictionary.add(kObjects);
    dictionary.finish();
  }
};

class Session {
 public:
  explicit Session(Input& input)
      : objects_(dictionary_),
        node_(dictionary_, buffer_, base::EventReporter(), configuration(input)) {
    node_.set_write_completion(&disk_);
    node_.power_on(now_);
    wait(base::SimDuration(1'000'000'000));
  }

  /// Lets time pass from deadline to deadline; one that does not move on is a mistake.
  void wait(base::SimDuration duration) {
    const base::SimTime end = now_ + duration;
    for (int steps = 0; node_.next_deadline() <= end; ++steps) {
      require(steps < 100'000);
      now_ = node_.next_deadline() < now_ ? now_ : node_.next_deadline();
      node_.advance(now_);
      require(node_.next_deadline() > now_);
    }
    now_ = end;
    node_.advance(now_);
  }

  void run_step(Input& input) {
    switch (input.below(12)) {
      case 0: {  // any frame
        can::Frame frame = can::data_frame(input.word() & 0x7FF, {});
        frame.length = static_cast<std::uint8_t>(input.below(9));
        const unsigned flags = input.byte();
        frame.remote = (flags & 1) != 0;
        frame.extended = (flags & 2) != 0;
        input.fill(frame.data);
        node_.receive(frame, now_);
        break;
      }
      case 1:  // NMT
        node_.receive(can::data_frame(0, {input.byte(), input.below(8)}), now_);
        break;
      case 2:
        send(input, 0x7E5);
        break;
      case 3:
        wait(base::SimDuration(std::int64_t{input.byte()} * 10'000'000));
        break;
      case 4:
        dictionary_.find(0x1021, 0)->set_text(std::string(input.word() % 2000, 'e'));
        break;
      case 5:
        buffer_.set_room(input.byte());
        break;
      case 6:
        send(input, 0x6A0);
        break;
      case 7: {  // a whole block of segments
        const unsigned segments = input.below(130);
        const unsigned last = input.byte();
        for (unsigned i = 1; i <= segments; ++i) {
          node_.receive(can::data_frame(
                            kRequest, {i | (i == segments ? last & 0x80 : 0), 1, 2, 3, 4, 5, 6, 7}),
                        now_);
        }
        break;
      }
      case 8: {  // an initiate request for an object that is there
        const EntryDeclaration& entry = kObjects[input.below(kObjects.size())];
        node_.receive(can::data_frame(kRequest, {input.byte(), entry.index & 0xFFU,
                                                 static_cast<unsigned>(entry.index >> 8),
                                                 entry.subindex, input.byte(), input.byte(), 0, 0}),
                      now_);
        break;
      }
      default:
        send(input, kRequest);
        break;
    }
  }

  void require_answer() {
    node_.power_off(now_);
    dictionary_.reset_values();
    buffer_.set_room(1000);
    NodeHooks hooks;
    hooks.reset_communication =
        base::Delegate<std::uint8_t(base::SimTime)>::bind<&Session::give_node_id>(*this);
    node_.set_hooks(hooks);
    node_.power_on(now_);
    wait(base::SimDuration(500'000'000));
    require(buffer_.last == can::data_frame(0x705, {0}));
    node_.receive(can::data_frame(kRequest, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0}), now_);
    require(buffer_.last == can::data_frame(0x585, {0x43, 0x00, 0x10, 0, 0x92, 0x01, 0x02, 0x00}));
  }

 private:
  std::uint8_t give_node_id(base::SimTime) { return kNodeId; }

  void send(Input& input, std::uint32_t identifier) {
    can::Frame frame = can::data_frame(identifier, {});
    frame.length = can::kMaximumData;
    input.fill(frame.data);
    node_.receive(frame, now_);
  }

  dictionary::Dictionary dictionary_;
  Objects objects_;
  Buffer buffer_;
  Disk disk_;
  Node node_;
  base::SimTime now_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  Session session(input);
  while (!input.empty()) {
    session.run_step(input);
  }
  session.require_answer();
  return 0;
}
