// Random sequences of everything a master can do to a CANopen node, on a TMCC160. What the node
// does is compared with a reference of the standards after every frame.
//
//   STATOR_SEQUENCES=20000    that many instead of a few hundred, for a nightly run
//   STATOR_SEQUENCE_SEED=n    this one alone
//   STATOR_SEQUENCE_EXCEPT="inhibit time,node-ID"    passes over violations of these rules

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopen/memory_double.hpp"
#include "devices/canopen_sequences/reference_node.hpp"
#include "devices/canopen_sequences/sequence.hpp"
#include "stator/can/bus.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using base::SimDuration;
using base::SimTime;
using devices::Tmcc160;
using devices::Tmcc160Configuration;

constexpr std::size_t kSteps = 120;
constexpr std::uint64_t kInEveryRun = 200;
constexpr SimDuration kShortestWait(1'000);

Tmcc160Configuration configuration(bool friendly) {
  Tmcc160Configuration result;
  if (friendly) {
    result.options = devices::tmcc160::Options::friendly();
  }
  return result;
}

/// The drive, alone with a master on a bus whose frames take no time, and the reference beside it.
class Trial {
 public:
  explicit Trial(bool friendly, const std::set<Rule>& excepted)
      : configuration_(configuration(friendly)), device_(configuration_) {
    device_.connect_memory(memory_);
    device_member_ = bus_.add(device_.controller());
    bus_.add(port_);
    std::map<ReferenceNode::Key, std::uint32_t> defaults;
    advance(600_ms);
    for (const ObjectUnderTest& object : objects_under_test()) {
      const dictionary::Entry* entry = device_.dictionary().find(object.index, object.subindex);
      defaults[{object.index, object.subindex}] =
          entry == nullptr || object.rule == ObjectRule::text
              ? 0U
              : static_cast<std::uint32_t>(entry->value());
    }
    while (port_.take()) {
    }
    reference_.emplace(
        ReferenceNode::Options{
            .lss = configuration_.options.lss,
            .stores_communication = configuration_.options.stores_communication_objects,
            .boot_time = configuration_.boot_time,
            .reset_time = 100_ms,
            .sdo_timeout = configuration_.sdo_timeout},
        configuration_.node_id, defaults);
    reference_->set_excepted(excepted);
    power_cycle();
    advance(600_ms);
  }

  /// False: a rule is broken.
  bool perform(const Step& step) {
    switch (step.action) {
      case Action::wait:
        advance(1_ms * static_cast<std::int64_t>(step.a));
        break;
      case Action::set_supply:
        reference_->set_supply(step.a != 0, now_);
        for (const product::Input& input : device_.inputs()) {
          if (input.name == "axis0.supply_voltage") {
            input.set(step.a != 0 ? 24.0 : 5.0);
          }
        }
        advance(5_ms);
        break;
      case Action::power_cycle:
        power_cycle();
        break;
      default:
        send(frame_of(step));
        break;
    }
    return !reference_->violation();
  }
  /// A node that can be talked to still answers, and what is due comes.
  bool finish() {
    advance(500_ms);
    send(frame_of({.action = Action::abort}));
    send(frame_of({.action = Action::request, .a = 0x40}));
    return !reference_->violation();
  }
  [[nodiscard]] const std::optional<Violation>& violation() const {
    return reference_->violation();
  }

 private:
  void power_cycle() {
    bus_.set_power(device_member_, false);
    device_.set_power(false, now_);
    bus_.set_power(device_member_, true);
    reference_->power_on(now_);
    device_.set_power(true, now_);
    pump();
  }

  void send(const can::Frame& frame) {
    reference_->hear(frame, now_);
    ASSERT_TRUE(port_.put(frame));
    pump();
    reference_->settle(now_);
  }

  void advance(SimDuration duration) {
    const SimTime end = now_ + duration;
    while (now_ < end) {
      now_ = std::min(end, std::max(device_.next_deadline(), now_ + kShortestWait));
      device_.advance(now_);
      pump();
      if (reference_) {
        reference_->pass(now_);
      }
    }
  }

  /// Lets all frames of this instant pass.
  void pump() {
    do {
      bus_.advance(now_);
      bus_.take_reached([this](std::size_t member) {
        if (member == device_member_) {
          device_.advance(now_);
          device_.handle_bus_events(now_);
        }
      });
      if (device_.next_deadline() <= now_) {
        device_.advance(now_);
      }
    } while (bus_.next_deadline() <= now_);
    while (reference_) {
      const auto frame = port_.take();
      if (!frame) {
        break;
      }
      reference_->see(frame->frame, now_);
    }
  }

  [[nodiscard]] can::Frame request(unsigned command, std::uint32_t object,
                                   std::uint32_t data = 0) const {
    const ObjectUnderTest& about = objects_under_test()[object];
    return can::data_frame(
        0x600U + reference_->node_id(),
        {command, about.index & 0xFFU, static_cast<unsigned>(about.index >> 8), about.subindex,
         data & 0xFF, data >> 8 & 0xFF, data >> 16 & 0xFF, data >> 24});
  }

  [[nodiscard]] can::Frame segment(const Step& step) const {
    const auto count = static_cast<unsigned>(step.b);
    const unsigned toggle = reference_->next_toggle() != (step.a != 0) ? 0x10 : 0;
    const std::uint32_t value = step.c >> 1;
    return can::data_frame(0x600U + reference_->node_id(),
                           {toggle | (7 - count) << 1 | (step.c & 1), value & 0xFF,
                            value >> 8 & 0xFF, value >> 16 & 0xFF, value >> 24, 0, 0, 0});
  }

  [[nodiscard]] can::Frame receive_pdo(const Step& step) const {
    const auto communication = static_cast<std::uint16_t>(0x1400 + step.a);
    const auto mapping = static_cast<std::uint16_t>(0x1600 + step.a);
    const int bytes = std::clamp(int{reference_->mapped_bytes(mapping)} + step.b, 0, 8);
    can::Frame frame{.identifier = reference_->value(communication, 1) & 0x7FF,
                     .length = static_cast<std::uint8_t>(bytes)};
    std::size_t position = 0;
    for (std::uint8_t entry = 1; entry <= reference_->value(mapping, 0); ++entry) {
      const std::uint32_t mapped = reference_->value(mapping, entry);
      std::uint32_t value = step.c >> entry;
      switch (mapped >> 16) {
        case 0x6040:  // nothing that enables the drive
          value = std::array<std::uint32_t, 4>{0, 6, 7, 0x80}[value & 3];
          break;
        case 0x6060:  // one in eight is no mode
          value = std::array<std::uint32_t, 8>{0, 1, 3, 6, 10, 1, 3, 99}[value & 7];
          break;
        case 0x60FF:
          value = value % 8 == 0 ? 300'000 : value % 1'000;
          break;
        default:
          break;
      }
      for (std::uint32_t i = 0; i < (mapped & 0xFF) / 8 && position < 8; ++i) {
        frame.data[position++] = static_cast<std::byte>(value >> 8 * i);
      }
    }
    return frame;
  }

  [[nodiscard]] can::Frame frame_of(const Step& step) const {
    const std::uint8_t node = reference_->node_id();
    const auto b = static_cast<unsigned>(step.b);
    switch (step.action) {
      case Action::nmt:
        return can::data_frame(0, {step.a, b == 0 ? 0U : b == 1 ? unsigned{node} : 99U});
      case Action::nmt_malformed: {
        can::Frame frame = can::data_frame(0, {step.a, node, 0, 0, 0, 0, 0, 0});
        frame.length = static_cast<std::uint8_t>(b);
        return frame;
      }
      case Action::read:
        return request(0x40, step.a);
      case Action::write: {
        const int size = std::clamp(int{objects_under_test()[step.a].size} + step.b, 1, 4);
        return request(0x23U | static_cast<unsigned>(4 - size) << 2, step.a, step.c);
      }
      case Action::segment_up: {
        const unsigned toggle = reference_->next_toggle() != (step.a != 0) ? 0x10 : 0;
        return can::data_frame(0x600U + node, {0x60 | toggle, 0, 0, 0, 0, 0, 0, 0});
      }
      case Action::begin_download:
        return request(0x21, step.a,
                       objects_under_test()[step.a].size + static_cast<std::uint32_t>(step.b));
      case Action::segment_down:
        return segment(step);
      case Action::abort:
        return can::data_frame(0x600U + node, {0x80, 0, 0, 0, 0, 0, 0, 8});
      case Action::block:
        return request(b != 0 ? 0xC2 : 0xA4, step.a, 4);
      case Action::request:
        return request(step.a, b);
      case Action::request_short: {
        can::Frame frame = request(0x40, 0);
        frame.length = static_cast<std::uint8_t>(step.a);
        return frame;
      }
      case Action::receive_pdo:
        return receive_pdo(step);
      case Action::remote_pdo:
        return can::remote_frame(
            reference_->value(static_cast<std::uint16_t>(0x1800 + step.a), 1) & 0x7FF, 8);
      case Action::sync: {
        can::Frame frame = can::data_frame(reference_->value(0x1005, 0) & 0x7FF, {7});
        frame.length = static_cast<std::uint8_t>(step.a);
        return frame;
      }
      case Action::guard:
        return can::remote_frame(0x700U + node, 1);
      case Action::heartbeat:
        return can::data_frame(0x700U + step.a, {5});
      default:
        return can::data_frame(0x7E5, {step.a, b, 0, 0, 0, 0, 0, 0});
    }
  }

  Tmcc160Configuration configuration_;
  can::Port port_;
  Tmcc160 device_;
  canopen::test::MemoryDouble memory_;
  can::Bus bus_;
  std::size_t device_member_ = 0;
  std::optional<ReferenceNode> reference_;
  SimTime now_;
};

struct Failure {
  Violation violation;
  std::size_t steps = 0;  ///< until it came
};

std::optional<Failure> run(const std::vector<Step>& steps, bool friendly,
                           const std::set<Rule>& excepted) {
  Trial trial(friendly, excepted);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!trial.perform(steps[i])) {
      return Failure{*trial.violation(), i + 1};
    }
  }
  if (!trial.finish()) {
    return Failure{*trial.violation(), steps.size()};
  }
  return std::nullopt;
}

/// Takes away steps as long as the same rule is still broken.
std::vector<Step> shortened(std::vector<Step> steps, const Failure& failure, bool friendly,
                            const std::set<Rule>& excepted) {
  steps.resize(failure.steps);
  for (std::size_t part = std::max<std::size_t>(1, steps.size() / 2); part > 0; part /= 2) {
    for (std::size_t begin = 0; begin < steps.size();) {
      std::vector<Step> fewer = steps;
      const auto first = fewer.begin() + static_cast<std::ptrdiff_t>(begin);
      fewer.erase(first, first + static_cast<std::ptrdiff_t>(std::min(part, steps.size() - begin)));
      const auto still = run(fewer, friendly, excepted);
      if (still && still->violation.rule == failure.violation.rule) {
        steps = std::move(fewer);
      } else {
        begin += part;
      }
    }
  }
  return steps;
}

std::set<Rule> excepted_rules() {
  const char* const text = std::getenv("STATOR_SEQUENCE_EXCEPT");
  std::set<Rule> rules;
  for (int rule = 0; rule <= static_cast<int>(Rule::lss) && text != nullptr; ++rule) {
    if (std::string(text).find(to_text(static_cast<Rule>(rule))) != std::string::npos) {
      rules.insert(static_cast<Rule>(rule));
    }
  }
  return rules;
}

std::uint64_t number(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// Every other seed has the options that generic masters want, LSS among them.
bool is_friendly(std::uint64_t seed) {
  return seed % 2 == 1;
}

TEST(CanopenSequences, WhateverAMasterDoesTheNodeKeepsTheRulesOfTheStandards) {
  const std::set<Rule> excepted = excepted_rules();
  const std::uint64_t only = number("STATOR_SEQUENCE_SEED", 0);
  const std::uint64_t first = only != 0 ? only : 1;
  const std::uint64_t last = only != 0 ? only : number("STATOR_SEQUENCES", kInEveryRun);
  std::set<Rule> told;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const bool friendly = is_friendly(seed);
    const std::vector<Step> steps = random_sequence(seed, kSteps);
    const auto failure = run(steps, friendly, excepted);
    // Each rule once: that it is broken elsewhere too is no news.
    if (!failure || !told.insert(failure->violation.rule).second) {
      continue;
    }
    std::string text;
    const auto few = shortened(steps, *failure, friendly, excepted);
    for (const Step& step : few) {
      text += "\n  " + to_text(step);
    }
    const auto shown = run(few, friendly, excepted);
    ADD_FAILURE() << "seed " << seed << (friendly ? " (friendly)" : "") << ", rule \""
                  << to_text(failure->violation.rule)
                  << "\": " << (shown ? shown->violation.text : failure->violation.text)
                  << "\nThe shortest sequence found:" << text;
  }
}

}  // namespace
}  // namespace stator::tests
