#include "devices/canopen_sequences/sequence.hpp"

#include <array>
#include <string_view>

#include "devices/canopen_sequences/object_rules.hpp"
#include "stator/base/random.hpp"

namespace stator::tests {

namespace {

constexpr std::array<std::string_view, 20> kNames{
    "wait",           "nmt",          "nmt_malformed", "read",  "write",     "segment_up",
    "begin_download", "segment_down", "abort",         "block", "request",   "request_short",
    "receive_pdo",    "remote_pdo",   "sync",          "guard", "heartbeat", "lss",
    "set_supply",     "power_cycle"};

/// Bytes that LSS messages begin with; the others fill what is not defined.
constexpr std::array<std::uint32_t, 11> kLssCommands{0x04, 0x04, 0x11, 0x11, 0x17, 0x4C,
                                                     0x5A, 0x5B, 0x5E, 0x5E, 0x33};
/// Objects that RPDOs write.
constexpr std::array<std::uint16_t, 4> kReceived{0x6040, 0x6060, 0x607A, 0x60FF};
constexpr std::array<std::uint8_t, 4> kNodeIds{1, 2, 5, 42};

std::string hexadecimal(std::uint64_t value) {
  std::string text;
  do {
    text.insert(text.begin(), "0123456789ABCDEF"[value & 15]);
    value >>= 4;
  } while (value != 0);
  return text + "h";
}

class Generator {
 public:
  explicit Generator(std::uint64_t seed) : random_(seed) {}

  std::vector<Step> steps(std::size_t length) {
    std::vector<Step> steps;
    while (steps.size() < length) {
      switch (below(24)) {
        case 0:
          configure_pdo(steps);
          break;
        case 1:
          steps.push_back({.action = Action::nmt, .a = 1, .b = 1});
          steps.push_back({.action = Action::sync});
          break;
        case 2:
          change_node_id(steps);
          break;
        case 3:
          upload_text(steps);
          break;
        case 4:
          download_in_segments(steps);
          break;
        case 5:
          receive_synchronously(steps);
          break;
        case 6:
          supervise(steps);
          break;
        case 7:
          store_and_return(steps);
          break;
        default:
          steps.push_back(any());
          if (steps.back().action == Action::write && below(2) == 0) {
            steps.push_back({.action = Action::read, .a = steps.back().a});
          }
          break;
      }
    }
    steps.resize(length);
    return steps;
  }

 private:
  std::uint32_t below(std::uint64_t bound) {
    return static_cast<std::uint32_t>(random_.below(bound));
  }
  template <typename Range>
  auto one_of(const Range& range) {
    return range[below(std::size(range))];
  }
  static std::uint32_t position(std::uint16_t index, std::uint8_t subindex) {
    return static_cast<std::uint32_t>(find_object(index, subindex) - objects_under_test().data());
  }
  static Step write(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) {
    return {.action = Action::write, .a = position(index, subindex), .c = value};
  }

  /// As a master does it: invalid, mapping, valid; now and then a step is missing.
  void configure_pdo(std::vector<Step>& steps) {
    const bool transmit = below(2) == 0;
    const std::uint32_t pdo = below(4);
    const auto communication = static_cast<std::uint16_t>((transmit ? 0x1800 : 0x1400) + pdo);
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    const std::uint32_t id = 0x40000000U + (transmit ? 0x1E0 : 0x270) + 0x100 * pdo + below(2);
    std::vector<Step> all{write(communication, 1, 0x80000000U | id)};
    if (below(2) == 0) {
      all.push_back(write(mapping, 0, 0));
      const std::uint32_t count = 1 + below(3);
      for (std::uint32_t entry = 1; entry <= count; ++entry) {
        all.push_back(write(mapping, static_cast<std::uint8_t>(entry),
                            one_of(transmit ? mappable_to_transmit() : mappable_to_receive())));
      }
      all.push_back(write(mapping, 0, count));
    }
    if (transmit) {
      all.push_back(write(communication, 3, below(30)));
      all.push_back(write(communication, 5, below(2) == 0 ? 0 : 10 + below(90)));
    }
    all.push_back(write(
        communication, 2,
        transmit ? one_of(std::array{0U, 1U, 254U, 255U}) : one_of(std::array{0U, 254U, 255U})));
    all.push_back(write(communication, 1, id));
    for (const Step& step : all) {
      if (below(12) != 0) {
        steps.push_back(step);
      }
    }
    if (below(2) == 0) {
      steps.push_back({.action = Action::nmt, .a = 1, .b = 1});
    }
  }

  void change_node_id(std::vector<Step>& steps) {
    const std::uint32_t id = one_of(kNodeIds);
    if (below(2) == 0) {
      steps.push_back({.action = Action::lss, .a = 0x04, .b = 1});
      steps.push_back({.action = Action::lss, .a = 0x11, .b = static_cast<std::int32_t>(id)});
      if (below(2) == 0) {
        steps.push_back({.action = Action::lss, .a = 0x17});
      }
    } else {
      steps.push_back(write(0x2705, 0, id));
      steps.push_back(write(0x2706, 0, 0x65766173));
    }
    if (below(3) != 0) {
      steps.push_back({.action = Action::nmt, .a = 129 + below(2), .b = 1});
      steps.push_back({.action = Action::wait, .a = 120});
    }
  }

  void upload_text(std::vector<Step>& steps) {
    steps.push_back({.action = Action::read, .a = position(0x1008, 0)});
    if (below(4) == 0) {
      steps.push_back(any());
    }
    steps.push_back({.action = Action::segment_up, .a = below(8) == 0 ? 1U : 0U});
  }

  void download_in_segments(std::vector<Step>& steps) {
    const std::uint32_t object = below(objects_under_test().size());
    const std::int32_t size = objects_under_test()[object].size;
    steps.push_back({.action = Action::begin_download,
                     .a = object,
                     .b = below(4) == 0 ? static_cast<std::int32_t>(below(3)) - 1 : 0});
    if (below(6) == 0) {
      steps.push_back(any());
    }
    steps.push_back({.action = Action::segment_down,
                     .a = below(10) == 0 ? 1U : 0U,
                     .b = below(6) == 0 ? static_cast<std::int32_t>(below(8)) : size,
                     .c = 1 | value_of(object) << 1});
  }

  /// What comes before a SYNC acts at it, whatever is done in between.
  void receive_synchronously(std::vector<Step>& steps) {
    const std::uint32_t pdo = below(4);
    const auto communication = static_cast<std::uint16_t>(0x1400 + pdo);
    steps.push_back(write(communication, 2, 0));
    steps.push_back({.action = Action::nmt, .a = 1, .b = 1});
    steps.push_back(
        {.action = Action::receive_pdo, .a = pdo, .c = static_cast<std::uint32_t>(random_.next())});
    switch (below(4)) {
      case 0:
        steps.push_back(any());
        break;
      case 1:
        steps.push_back(write(communication, 2, 0));
        break;
      case 2:
        steps.push_back({.action = Action::read, .a = position(one_of(kReceived), 0)});
        break;
      default:
        break;
    }
    steps.push_back({.action = Action::sync});
    for (const std::uint16_t index : kReceived) {
      steps.push_back({.action = Action::read, .a = position(index, 0)});
    }
  }

  /// Guarding or heartbeat, and the supervisor falls silent.
  void supervise(std::vector<Step>& steps) {
    Step sign{.action = Action::guard};
    if (below(2) == 0) {
      steps.push_back(write(0x1017, 0, 0));
      steps.push_back(write(0x100C, 0, 20));
      steps.push_back(write(0x100D, 0, 1 + below(2)));
    } else {
      steps.push_back(write(0x1016, 1, 0x007F0032));
      sign = {.action = Action::heartbeat, .a = 0x7F};
    }
    const std::uint32_t signs = below(4);
    for (std::uint32_t i = 0; i < signs; ++i) {
      steps.push_back(sign);
      steps.push_back(below(3) == 0 ? any() : Step{.action = Action::wait, .a = below(30)});
    }
    steps.push_back({.action = Action::wait, .a = 60});
    steps.push_back({.action = Action::read, .a = position(0x1001, 0)});
    if (below(2) == 0) {
      steps.push_back(sign);
      steps.push_back({.action = Action::read, .a = position(0x1001, 0)});
    }
  }

  void store_and_return(std::vector<Step>& steps) {
    const std::uint32_t object = below(objects_under_test().size());
    steps.push_back({.action = Action::write, .a = object, .c = value_of(object)});
    const auto group = one_of(std::array<std::uint8_t, 3>{1, 2, 4});
    if (below(3) != 0) {
      steps.push_back(write(0x1010, group, 0x65766173));
    }
    if (below(3) == 0) {
      steps.push_back(write(0x1011, group, 0x64616F6C));
    }
    steps.push_back(below(4) == 0 ? Step{.action = Action::power_cycle}
                                  : Step{.action = Action::nmt, .a = 129 + below(2), .b = 1});
    steps.push_back({.action = Action::wait, .a = 520});
    steps.push_back({.action = Action::read, .a = object});
  }

  /// A value that the object may take, and some that it may not.
  std::uint32_t value_of(std::uint32_t object) {
    const ObjectUnderTest& about = objects_under_test()[object];
    const auto pdo = static_cast<std::uint32_t>(about.index & 3U);
    switch (about.rule) {
      case ObjectRule::choice:
        return below(5) == 0 ? below(256) : static_cast<std::uint32_t>(one_of(about.choices));
      case ObjectRule::sync_id:
        return one_of(std::array{0x80U, 0x80U, 0xA0U, 0x40000080U, 0x7FU, 0x200000A0U, 0x181U});
      case ObjectRule::emergency_id:
        return one_of(std::array{0x81U, 0x90U, 0x80000090U, 0x40000090U, 0x601U});
      case ObjectRule::receive_pdo_id:
      case ObjectRule::transmit_pdo_id: {
        const std::uint32_t id =
            (about.rule == ObjectRule::transmit_pdo_id ? 0x1E0 : 0x270) + 0x100 * pdo + below(2);
        return one_of(std::array{0x40000000U | id, 0x40000000U | id, 0xC0000000U | id, id,
                                 0x60000000U | id, 0x40000601U, 0xC0000000U});
      }
      case ObjectRule::mapping_count:
        return below(6);
      case ObjectRule::mapping_entry:
        return one_of(std::array{0x60400010U, 0x60410010U, 0x607A0020U, 0x60640020U, 0x60FF0020U,
                                 0x60400020U, 0x5FFF0020U, 0x10000020U, 0U});
      case ObjectRule::consumer_heartbeat:
        return one_of(std::array{0U, 0x007F0032U, 0x00700014U, 0x017F0032U});
      case ObjectRule::store:
        return below(4) == 0 ? below(1000) : 0x65766173U;
      case ObjectRule::restore:
        return below(4) == 0 ? below(1000) : 0x64616F6CU;
      case ObjectRule::inhibit_time:
        return below(40);
      default:
        break;
    }
    switch (about.index) {
      case 0x100C:
        return below(3) * 20;
      case 0x100D:
        return below(3);
      case 0x1015:
        return below(3) * 50;
      case 0x1017:
        return one_of(std::array{0U, 1U, 7U, 20U, 50U});
      case 0x2705:
        return below(6) == 0 ? 128 + below(100) : one_of(kNodeIds);
      case 0x6040:
        return one_of(std::array{0U, 6U, 7U, 0x80U});
      default:
        return below(5) == 0 ? static_cast<std::uint32_t>(random_.next()) : below(100);
    }
  }

  Step any() {
    const std::uint32_t object = below(objects_under_test().size());
    switch (below(26)) {
      case 0:
      case 1:
        return {.action = Action::wait, .a = 1 + below(4) * below(60)};
      case 2:
        return {.action = Action::wait, .a = below(30) == 0 ? 1'100U : 0U};
      case 3:
        return {.action = Action::nmt,
                .a = one_of(std::array{1U, 1U, 1U, 2U, 128U, 129U, 130U, 3U}),
                .b = static_cast<std::int32_t>(one_of(std::array{1U, 1U, 0U, 2U}))};
      case 4:
        return {.action = Action::nmt_malformed,
                .a = one_of(std::array{1U, 2U, 129U}),
                .b = static_cast<std::int32_t>(one_of(std::array{0U, 1U, 3U, 8U}))};
      case 5:
      case 6:
        return {.action = Action::read, .a = below(4) == 0 ? position(0x1001, 0) : object};
      case 7:
      case 8:
      case 9:
        return {.action = Action::write,
                .a = object,
                .b = below(8) == 0 ? static_cast<std::int32_t>(below(7)) - 3 : 0,
                .c = value_of(object)};
      case 10:
        return {.action = Action::segment_up, .a = below(4) == 0 ? 1U : 0U};
      case 11:
        return {.action = Action::segment_down,
                .a = below(4) == 0 ? 1U : 0U,
                .b = static_cast<std::int32_t>(below(8)),
                .c = below(8)};
      case 12:
        return below(2) == 0 ? Step{.action = Action::abort}
                             : Step{.action = Action::block,
                                    .a = object,
                                    .b = static_cast<std::int32_t>(below(2))};
      case 13:
        return {.action = Action::request, .a = below(256), .b = static_cast<std::int32_t>(object)};
      case 14:
        return {.action = Action::request_short, .a = below(8)};
      case 15:
      case 16:
      case 17:
        return {.action = Action::receive_pdo,
                .a = below(4),
                .b = below(8) == 0 ? static_cast<std::int32_t>(below(5)) - 2 : 0,
                .c = static_cast<std::uint32_t>(random_.next())};
      case 18:
        return {.action = Action::remote_pdo, .a = below(4)};
      case 19:
      case 20:
        return {.action = Action::sync, .a = below(6) == 0 ? 1U : 0U};
      case 21:
        return {.action = Action::guard};
      case 22:
        return {.action = Action::heartbeat, .a = one_of(std::array{0x7FU, 0x70U, 3U})};
      case 23:
        return {.action = Action::lss,
                .a = one_of(kLssCommands),
                .b = static_cast<std::int32_t>(one_of(std::array{0U, 1U, 2U, 5U, 42U, 128U}))};
      case 24:
        return {.action = Action::set_supply, .a = below(2)};
      default:
        return below(8) == 0 ? Step{.action = Action::power_cycle} : Step{.action = Action::sync};
    }
  }

  base::Random random_;
};

}  // namespace

std::string to_text(const Step& step) {
  std::string text(kNames[static_cast<std::size_t>(step.action)]);
  const bool about_object = step.action == Action::read || step.action == Action::write ||
                            step.action == Action::begin_download || step.action == Action::block;
  if (about_object) {
    const ObjectUnderTest& about = objects_under_test()[step.a];
    text += " " + hexadecimal(about.index) + ":" + hexadecimal(about.subindex);
  } else {
    text += " " + std::to_string(step.a);
  }
  return text + " " + std::to_string(step.b) + " " + hexadecimal(step.c);
}

std::vector<Step> random_sequence(std::uint64_t seed, std::size_t length) {
  return Generator(seed).steps(length);
}

}  // namespace stator::tests
