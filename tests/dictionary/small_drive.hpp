#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "stator/base/byte_order.hpp"
#include "stator/base/event.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::dictionary {

/// The dictionary the tests of this room speak to: one of everything a declaration can say.
inline constexpr std::array<std::int64_t, 3> kLegalModes{-1, 1, 8};

inline constexpr auto kSmallDrive = std::to_array<EntryDeclaration>({
    {.index = 0x1000,
     .name = "Device type",
     .access = Access::constant,
     .default_value = hex(0xFFFC0192)},
    {.index = 0x1008,
     .name = "Manufacturer device name",
     .type = DataType::visible_string,
     .access = Access::read_only,
     .default_value = "TMCM-3315"},
    {.index = 0x1018,
     .subindex = 0,
     .name = "Number of entries",
     .object_code = ObjectCode::record,
     .type = DataType::unsigned8,
     .access = Access::read_only,
     .default_value = 2,
     .object_name = "Identity"},
    {.index = 0x1018,
     .subindex = 2,
     .name = "Product code",
     .object_code = ObjectCode::record,
     .access = Access::read_only,
     .default_value = 3315},
    {.index = 0x1021,
     .name = "Store EDS",
     .object_code = ObjectCode::domain_object,
     .type = DataType::domain,
     .access = Access::read_only},
    {.index = 0x2000,
     .name = "Microstep resolution",
     .type = DataType::unsigned8,
     .default_value = 8,
     .range = Range{1, 8},
     .drive_condition = DriveCondition::switch_on_disabled},
    {.index = 0x2001, .name = "Owner", .type = DataType::visible_string, .default_value = "nobody"},
    {.index = 0x2002, .name = "Key", .type = DataType::unsigned32, .access = Access::write_only},
    {.index = 0x2003,
     .name = "Cycle time",
     .type = DataType::unsigned16,
     .default_value = 1000,
     .write_states = kPreOperationalOnly},
    {.index = 0x2004, .name = "Enabled", .type = DataType::boolean},
    {.index = 0x2005, .name = "Serial", .type = DataType::unsigned64},
    {.index = 0x6040, .name = "Controlword", .type = DataType::unsigned16},
    {.index = 0x6060,
     .name = "Modes of operation",
     .type = DataType::integer8,
     .default_value = 1,
     .range = Range{-1, 8},
     .legal_values = kLegalModes},
    {.index = 0x607A,
     .name = "Target position",
     .type = DataType::integer32,
     .default_value = -7,
     .range = Range{-1000, 1000}},
});

inline std::unique_ptr<Dictionary> make_small_drive() {
  auto dictionary = std::make_unique<Dictionary>();
  dictionary->add(kSmallDrive);
  dictionary->finish();
  return dictionary;
}

/// `value` as an SDO carries it, lowest byte first.
template <typename T>
std::array<std::byte, sizeof(T)> bytes_of(T value) {
  std::array<std::byte, sizeof(T)> bytes{};
  base::store_le(bytes, 0, value);
  return bytes;
}

template <typename T>
Verdict write(Dictionary& dictionary, std::uint16_t index, T value,
              NetworkState state = NetworkState::pre_operational) {
  return dictionary.write(*dictionary.find(index, 0), bytes_of(value), {state});
}

/// The sentence a person reads about a refusal.
inline std::string sentence(const Refusal& refusal) {
  return base::to_sentence(base::Event{base::SimTime(), refusal.rule, 0, refusal.arguments});
}

}  // namespace stator::dictionary
