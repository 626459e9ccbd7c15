#include "masters/master_sequence.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "ethercat/raw_frame.hpp"
#include "masters/slave_rules.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/base/random.hpp"
#include "stator/ethercat/segment/segment.hpp"

namespace stator::tests {

namespace {

using Kind = MasterAction::Kind;

struct Choice {
  Kind kind;
  unsigned weight;
  std::vector<std::uint32_t> values;
};

const std::vector<Choice>& choices() {
  static const std::vector<Choice> all{
      {Kind::request_state,
       24,
       {0x01, 0x11, 0x02, 0x12, 0x02, 0x12, 0x04, 0x14, 0x04, 0x14, 0x08, 0x18, 0x08, 0x18, 0x18,
        0x03, 0x13, 0x05, 0x10}},
      {Kind::mailboxes, 6, {0, 0, 0, 0, 1, 2}},
      {Kind::process_data, 6, {0, 0, 0, 1, 2}},
      {Kind::exchange, 12, {1, 1, 2, 5, 20, 120}},
      {Kind::outputs_by_address, 3, {0}},
      {Kind::silence, 10, {1, 10, 60, 95, 105, 250, 1200}},
      {Kind::sync_on, 4, {1000, 2000, 4000, 123}},
      {Kind::sync_off, 3, {0}},
      {Kind::watchdog, 4, {0, 200, 1000, 1000, 5000}},
      {Kind::sync_type, 3, {0, 1, 1, 2}},
      {Kind::upload, 3, {0}},
      {Kind::download, 3, {0}},
      {Kind::mailbox_repeat, 1, {0}},
      {Kind::controller_reset, 1, {0}},
      {Kind::power_cycle, 1, {0}},
      {Kind::bring_up, 8, {0, 0, 1, 2, 3, 5}},
  };
  return all;
}

}  // namespace

std::string MasterAction::text() const {
  switch (kind) {
    case Kind::request_state:
      return fmt::format("AL control {:02X}h", value);
    case Kind::mailboxes:
      return value == 0   ? "mailboxes as the EEPROM says"
             : value == 1 ? "mailboxes too short"
                          : "mailboxes off";
    case Kind::process_data:
      return value == 0   ? "process data channels as mapped"
             : value == 1 ? "process data channels of wrong length"
                          : "process data channels without watchdog trigger";
    case Kind::exchange:
      return fmt::format("{} cycles of process data", value);
    case Kind::outputs_by_address:
      return "outputs by address";
    case Kind::silence:
      return fmt::format("{} ms of silence", value);
    case Kind::sync_on:
      return fmt::format("SYNC0 every {} us", value);
    case Kind::sync_off:
      return "SYNC0 off";
    case Kind::watchdog:
      return fmt::format("0420h = {}", value);
    case Kind::sync_type:
      return fmt::format("1C32h:01 = {}", value);
    case Kind::upload:
      return "uploads";
    case Kind::download:
      return "downloads";
    case Kind::mailbox_repeat:
      return "answer asked for again";
    case Kind::controller_reset:
      return "reset of the controller";
    case Kind::power_cycle:
      return "supply off and on";
    case Kind::bring_up:
      return fmt::format("bring-up by the book{}{}", (value & 1) != 0 ? " with SYNC0" : "",
                         value >> 1 == 0 ? "" : fmt::format(", 1C32h:01 = {}", value >> 1));
  }
  return {};
}

std::vector<MasterAction> random_actions(std::uint64_t seed, std::size_t length) {
  base::Random random(seed);
  unsigned sum = 0;
  for (const Choice& choice : choices()) {
    sum += choice.weight;
  }
  std::vector<MasterAction> actions;
  // Most rules are about Operational, which blind chance hardly reaches.
  actions.push_back({Kind::bring_up, static_cast<std::uint32_t>(random.below(4))});
  while (actions.size() < length) {
    auto left = static_cast<unsigned>(random.below(sum));
    const auto chosen = std::ranges::find_if(choices(), [&](const Choice& choice) {
      const bool here = left < choice.weight;
      left -= here ? 0 : choice.weight;
      return here;
    });
    actions.push_back({chosen->kind, chosen->values[random.below(chosen->values.size())]});
  }
  return actions;
}

std::optional<std::string> broken_rule(const MakeDevice& make,
                                       const std::vector<MasterAction>& actions) {
  SlaveRules slave(make);
  for (std::size_t i = 0; i < actions.size(); ++i) {
    slave.perform(actions[i]);
    if (slave.broken()) {
      return fmt::format("action {} ({}): {}", i, actions[i].text(), *slave.broken());
    }
  }
  return std::nullopt;
}

std::vector<MasterAction> shortened(const MakeDevice& make, std::vector<MasterAction> actions) {
  for (std::size_t part = std::max<std::size_t>(actions.size() / 2, 1);; part /= 2) {
    for (std::size_t begin = 0; begin < actions.size();) {
      std::vector<MasterAction> fewer = actions;
      const std::size_t end = std::min(begin + part, actions.size());
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(begin),
                  fewer.begin() + static_cast<std::ptrdiff_t>(end));
      if (broken_rule(make, fewer)) {
        actions = std::move(fewer);
      } else {
        begin += part;
      }
    }
    if (part == 1) {
      return actions;
    }
  }
}

}  // namespace stator::tests
