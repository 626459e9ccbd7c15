// Process data of a CANopen node: any PDOs, SYNCs and remote frames, between writes to everything
// that configures them, state changes and changes of values. Whatever came, a reset of the node
// brings back PDOs that work as declared.

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "input.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/canopen/emergency/emergency_producer.hpp"
#include "stator/canopen/nmt/node.hpp"
#include "stator/canopen/nmt_command.hpp"
#include "stator/canopen/pdo/pdo_service.hpp"
#include "stator/canopen/sync/sync_consumer.hpp"
#include "stator/canopen/sync/sync_producer.hpp"

namespace {

using namespace stator;
using namespace stator::canopen;
using dictionary::Access;
using dictionary::DataType;
using dictionary::EntryDeclaration;
using stator::fuzz::Input;
using stator::fuzz::require;

constexpr std::uint8_t kNodeId = 1;
constexpr std::uint16_t kPdos = 3;
constexpr std::uint8_t kEntries = 12;
constexpr std::array<std::uint16_t, 6> kSettings{0x1005, 0x1006, 0x1007, 0x1014, 0x1015, 0x1019};

EntryDeclaration entry(unsigned index, unsigned subindex, DataType type, std::uint64_t value = 0,
                       dictionary::PdoMapping mapping = dictionary::PdoMapping::no) {
  return {.index = static_cast<std::uint16_t>(index),
          .subindex = static_cast<std::uint8_t>(subindex),
          .name = "Object",
          .object_code = dictionary::ObjectCode::record,
          .type = type,
          .mapping = mapping,
          .default_value = value};
}

EntryDeclaration cob_id(unsigned index, unsigned subindex, std::uint64_t value) {
  EntryDeclaration declaration = entry(index, subindex, DataType::unsigned32, value);
  declaration.node_id_relative = true;
  return declaration;
}

void add_pdo(std::vector<EntryDeclaration>& objects, unsigned communication, unsigned identifier,
             std::uint64_t mapped) {
  objects.push_back(entry(communication, 0, DataType::unsigned8, 6));
  objects.push_back(cob_id(communication, 1, identifier));
  objects.push_back(entry(communication, 2, DataType::unsigned8, 255));
  objects.push_back(entry(communication, 3, DataType::unsigned16));
  objects.push_back(entry(communication, 5, DataType::unsigned16));
  objects.push_back(entry(communication, 6, DataType::unsigned8));
  objects.push_back(entry(communication + 0x200, 0, DataType::unsigned8, 1));
  objects.push_back(entry(communication + 0x200, 1, DataType::unsigned32, mapped));
  for (unsigned subindex = 2; subindex <= kEntries; ++subindex) {
    objects.push_back(entry(communication + 0x200, subindex, DataType::unsigned32));
  }
}

std::vector<EntryDeclaration> objects() {
  constexpr auto kBoth = dictionary::PdoMapping::both;
  std::vector<EntryDeclaration> objects{
      entry(0x1001, 0, DataType::unsigned8),
      entry(0x1005, 0, DataType::unsigned32, 0x80),
      entry(0x1006, 0, DataType::unsigned32),
      entry(0x1007, 0, DataType::unsigned32),
      cob_id(0x1014, 0, 0x80),
      entry(0x1015, 0, DataType::unsigned16),
      entry(0x1019, 0, DataType::unsigned8),
      entry(0x2000, 0, DataType::unsigned16, 0, kBoth),
      entry(0x2001, 0, DataType::boolean, 0, kBoth),
      entry(0x2002, 0, DataType::integer8, 0, kBoth),
      entry(0x2003, 0, DataType::unsigned32, 0, kBoth),
      entry(0x2004, 0, DataType::integer64, 0, kBoth),
      entry(0x2005, 0, DataType::unsigned16, 0, dictionary::PdoMapping::transmit),
  };
  objects[8].range = dictionary::Range{0, 0};
  objects[9].range = dictionary::Range{-5, 5};
  for (unsigned number = 0; number < kPdos; ++number) {
    add_pdo(objects, 0x1400 + number, 0x200 + 0x100 * number, 0x20000010);
    add_pdo(objects, 0x1800 + number, 0x180 + 0x100 * number, 0x20050010);
  }
  return objects;
}

/// Remembers the last frame of each CAN-ID; full now and then.
class Line final : public can::Transmitter {
 public:
  bool send(const can::Frame& frame) override {
    require(!frame.extended && frame.identifier <= 0x7FF && frame.length <= 8);
    last = frame;
    return ++sent % 16 != 0;
  }
  can::Frame last;
  unsigned sent = 0;
};

/// A dictionary finished before what is built on it.
struct Objects {
  Objects() : declarations(objects()) {
    dictionary.add(declarations);
    dictionary.finish();
  }
  std::vector<EntryDeclaration> declarations;
  dictionary::Dictionary dictionary;
};

class Session : private Objects {
 public:
  Session() {
    sync_.set_listener(SyncConsumer::Listener::bind<&PdoService::on_sync>(pdos_));
    NodeHooks hooks;
    hooks.reset_application =
        base::Delegate<void(base::SimTime)>::bind<&Session::reset_values>(*this);
    hooks.assign_node_id =
        base::Delegate<void(std::uint8_t, base::SimTime)>::bind<&Session::assign>(*this);
    node_.set_hooks(hooks);
    for (Service* service :
         std::initializer_list<Service*>{&emergencies_, &sync_, &producer_, &pdos_}) {
      node_.add(*service);
    }
    node_.power_on(now_);
    wait(1'000'000);
  }

  /// Lets time pass in steps of the node's own, at most so many that an input stays fast.
  void wait(std::int64_t microseconds) {
    constexpr int kMostSteps = 200;
    const base::SimTime end = now_ + base::SimDuration(microseconds * 1'000);
    for (int step = 0; step < kMostSteps && node_.next_deadline() <= end; ++step) {
      now_ = std::max(now_, node_.next_deadline());
      node_.advance(now_);
    }
    now_ = end;
    node_.advance(now_);
  }
  void send(const can::Frame& frame) {
    node_.receive(frame, now_);
    wait(0);
  }
  void nmt(NmtCommand command) {
    send(can::data_frame(0, {static_cast<unsigned>(command), kNodeId}));
  }
  void write(std::uint16_t index, std::uint8_t subindex, std::uint64_t value) {
    const dictionary::Entry* entry = dictionary.find(index, subindex);
    if (entry == nullptr) {
      return;
    }
    std::array<std::byte, 8> bytes{};
    base::store_le(bytes.data(), value);
    can::Frame frame{.identifier = 0x600U + kNodeId, .length = 8};
    frame.data = {std::byte{0x23},
                  static_cast<std::byte>(index),
                  static_cast<std::byte>(index >> 8),
                  static_cast<std::byte>(subindex),
                  bytes[0],
                  bytes[1],
                  bytes[2],
                  bytes[3]};
    frame.data[0] |= static_cast<std::byte>((4 - std::min<std::size_t>(entry->size(), 4)) << 2);
    send(frame);
  }
  void change(std::uint16_t index, std::uint64_t value) {
    dictionary.find(index, 0)->set_value(value);
    pdos_.values_may_have_changed(now_);
  }
  [[nodiscard]] std::uint64_t value(std::uint16_t index) const {
    return dictionary.find(index, 0)->value();
  }
  [[nodiscard]] const Line& line() const { return line_; }
  /// What must hold at any time.
  void check() const {
    for (const TransmitPdo& pdo : pdos_.transmit_pdos()) {
      require(pdo.mapping().bytes() <= 8);
    }
    const std::int64_t ranged = dictionary.find(0x2002, 0)->signed_value();
    require(ranged >= -5 && ranged <= 5);
  }

 private:
  void reset_values(base::SimTime /*now*/) { dictionary.reset_values(); }
  void assign(std::uint8_t node_id, base::SimTime /*now*/) {
    dictionary.set_node_id(node_id);
    dictionary.reset_values(0x1000, 0x1FFF);
  }

  Line line_;
  base::SimTime now_;
  EmergencyProducer emergencies_{dictionary, line_, {}};
  Node node_{dictionary, line_, {}, {.node_id = kNodeId}};
  SyncConsumer sync_{dictionary, emergencies_};
  SyncProducer producer_{dictionary, line_, sync_};
  PdoService pdos_{dictionary, line_, emergencies_, {}};
};

can::Frame some_frame(Input& input) {
  constexpr std::array<std::uint16_t, 8> kLikely{0x80,  0x201, 0x301, 0x401,
                                                 0x181, 0x281, 0x381, 0x81};
  const unsigned choice = input.byte();
  can::Frame frame{.identifier =
                       choice < 240 ? kLikely[choice % kLikely.size()] : input.word() & 0x7FFU};
  frame.remote = input.below(8) == 7;
  frame.length = static_cast<std::uint8_t>(input.below(9));
  input.fill(std::span(frame.data).first(frame.remote ? 0 : frame.length));
  return frame;
}

void configure(Input& input, Session& session) {
  const unsigned pdo = input.below(2 * kPdos);
  const auto communication =
      static_cast<std::uint16_t>((pdo < kPdos ? 0x1400U : 0x1800U) + pdo % kPdos);
  switch (input.below(4)) {
    case 0:
      session.write(communication, static_cast<std::uint8_t>(input.below(7)), input.double_word());
      break;
    case 1: {
      const std::uint32_t can_id = 0x181U + input.below(0x400);
      session.write(communication, 1, can_id | (input.below(2) != 0 ? kCobIdInvalid : 0U));
      break;
    }
    case 2: {
      constexpr std::array<std::uint32_t, 8> kMappings{0x20000010, 0x20010001, 0x20020008,
                                                       0x20030020, 0x20040040, 0x20050010,
                                                       0x00010001, 0x00050008};
      session.write(static_cast<std::uint16_t>(communication + 0x200),
                    static_cast<std::uint8_t>(1 + input.below(kEntries)),
                    kMappings[input.below(kMappings.size())]);
      break;
    }
    default:
      session.write(static_cast<std::uint16_t>(communication + 0x200), 0,
                    input.below(kEntries + 2));
      break;
  }
}

void run_step(Input& input, Session& session) {
  switch (input.below(8)) {
    case 0:
      session.nmt(static_cast<NmtCommand>(input.byte()));
      break;
    case 1:
      session.wait(input.word());
      break;
    case 2:
      session.write(kSettings[input.below(kSettings.size())], 0, input.double_word());
      break;
    case 3:
      session.change(0x2005, input.word());
      break;
    case 4:
    case 5:
      configure(input, session);
      break;
    default:
      session.send(some_frame(input));
      break;
  }
  session.check();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  Session session;
  while (!input.empty()) {
    run_step(input, session);
  }
  session.wait(1'000'000);  // a node in Initialisation hears no command
  session.nmt(NmtCommand::reset_node);
  session.wait(1'000'000);
  session.nmt(NmtCommand::start);
  session.send(can::data_frame(0x201, {0x34, 0x12}));
  require(session.value(0x2000) == 0x1234);
  const unsigned sent = session.line().sent;
  session.change(0x2005, 0xABCD);
  require(session.line().sent == sent + kPdos);
  require(session.line().last == can::data_frame(0x381, {0xCD, 0xAB}));
  return 0;
}
