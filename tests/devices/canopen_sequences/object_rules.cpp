#include "devices/canopen_sequences/object_rules.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace stator::tests {

namespace {

constexpr std::array<std::int64_t, 3> kReceiveTypes{0, 254, 255};
constexpr std::array<std::int64_t, 4> kTransmitTypes{0, 1, 254, 255};
constexpr std::array<std::int64_t, 2> kReactions{0, 1};
constexpr std::array<std::int64_t, 5> kModes{0, 1, 3, 6, 10};
constexpr std::array<std::uint32_t, 4> kReceivable{0x60400010, 0x60600008, 0x607A0020, 0x60FF0020};
constexpr std::array<std::uint32_t, 4> kTransmittable{0x60410010, 0x60610008, 0x60640020,
                                                      0x606C0020};

using enum ObjectRule;
using enum Stored;

constexpr auto kFixed = std::to_array<ObjectUnderTest>({
    {.index = 0x1000, .rule = constant},
    {.index = 0x1001, .size = 1, .rule = error_register},
    {.index = 0x1008, .rule = text, .content = "TMCC160"},
    {.index = 0x1018, .subindex = 1, .rule = constant},
    {.index = 0x1018, .subindex = 2, .rule = constant},
    {.index = 0x1005, .rule = sync_id, .stored = communication},
    {.index = 0x100C, .size = 2, .high = 0xFFFF, .stored = communication},
    {.index = 0x100D, .size = 1, .high = 0xFF, .stored = communication},
    {.index = 0x1014, .rule = emergency_id, .stored = communication, .node_id_relative = true},
    {.index = 0x1015, .size = 2, .high = 0xFFFF, .stored = communication},
    {.index = 0x1016, .subindex = 1, .rule = consumer_heartbeat, .stored = communication},
    {.index = 0x1017, .size = 2, .high = 0xFFFF, .stored = communication},
    {.index = 0x1029,
     .subindex = 1,
     .size = 1,
     .rule = choice,
     .stored = communication,
     .choices = kReactions},
    {.index = 0x1010, .subindex = 1, .rule = store},
    {.index = 0x1010, .subindex = 2, .rule = store},
    {.index = 0x1010, .subindex = 3, .rule = no_subindex},
    {.index = 0x1010, .subindex = 4, .rule = store},
    {.index = 0x1011, .subindex = 1, .rule = restore},
    {.index = 0x1011, .subindex = 2, .rule = restore},
    {.index = 0x1011, .subindex = 4, .rule = restore},
    {.index = 0x1400, .subindex = 9, .rule = no_subindex},
    {.index = 0x1404, .rule = no_object},
    {.index = 0x2005, .high = 63, .stored = motor},
    {.index = 0x2705, .size = 1, .low = 1, .high = 127, .stored = network},
    {.index = 0x2706, .rule = store},
    {.index = 0x2708, .size = 1, .rule = live},
    {.index = 0x5FFF, .rule = no_object},
    {.index = 0x6040, .size = 2, .high = 0xFFFF},
    {.index = 0x6041, .size = 2, .rule = live},
    {.index = 0x6060, .size = 1, .rule = choice, .choices = kModes},
    {.index = 0x6061, .size = 1, .rule = live},
    {.index = 0x607A, .low = -0x80000000LL, .high = 0x7FFFFFFF},
    {.index = 0x60FF, .low = -200'000, .high = 200'000},
    {.index = 0x6083, .high = 100'000, .stored = motor},
    {.index = 0x6064, .rule = live},
    {.index = 0x606C, .rule = live},
});

std::vector<ObjectUnderTest> all_objects() {
  std::vector<ObjectUnderTest> all(kFixed.begin(), kFixed.end());
  for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
    const auto at = [pdo](unsigned first) { return static_cast<std::uint16_t>(first + pdo); };
    all.push_back({.index = at(0x1400),
                   .subindex = 1,
                   .rule = receive_pdo_id,
                   .stored = communication,
                   .node_id_relative = true});
    all.push_back({.index = at(0x1400),
                   .subindex = 2,
                   .size = 1,
                   .rule = choice,
                   .stored = communication,
                   .choices = kReceiveTypes});
    all.push_back({.index = at(0x1800),
                   .subindex = 1,
                   .rule = transmit_pdo_id,
                   .stored = communication,
                   .node_id_relative = true});
    all.push_back({.index = at(0x1800),
                   .subindex = 2,
                   .size = 1,
                   .rule = choice,
                   .stored = communication,
                   .choices = kTransmitTypes});
    all.push_back({.index = at(0x1800),
                   .subindex = 3,
                   .size = 2,
                   .rule = inhibit_time,
                   .high = 0xFFFF,
                   .stored = communication});
    all.push_back(
        {.index = at(0x1800), .subindex = 5, .size = 2, .high = 0xFFFF, .stored = communication});
    for (const unsigned first : {0x1600U, 0x1A00U}) {
      all.push_back(
          {.index = at(first), .size = 1, .rule = mapping_count, .stored = communication});
      for (std::uint8_t entry = 1; entry <= 3; ++entry) {
        all.push_back({.index = at(first),
                       .subindex = entry,
                       .rule = mapping_entry,
                       .stored = communication});
      }
    }
  }
  return all;
}

}  // namespace

std::span<const ObjectUnderTest> objects_under_test() {
  static const std::vector<ObjectUnderTest> all = all_objects();
  return all;
}

const ObjectUnderTest* find_object(std::uint16_t index, std::uint8_t subindex) {
  const auto all = objects_under_test();
  const auto found = std::ranges::find_if(all, [=](const ObjectUnderTest& each) {
    return each.index == index && each.subindex == subindex;
  });
  return found == all.end() ? nullptr : &*found;
}

std::span<const std::uint32_t> mappable_to_receive() {
  return kReceivable;
}

std::span<const std::uint32_t> mappable_to_transmit() {
  return kTransmittable;
}

}  // namespace stator::tests
