#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stator::tests {

/// What a write is judged by.
enum class ObjectRule : std::uint8_t {
  number,    ///< any value from `low` to `high`
  choice,    ///< one of `choices`
  constant,  ///< cannot be written
  live,      ///< cannot be written, and is not compared
  error_register,
  text,  ///< cannot be written, does not fit an expedited upload
  sync_id,
  emergency_id,
  receive_pdo_id,
  transmit_pdo_id,
  inhibit_time,
  mapping_count,
  mapping_entry,
  consumer_heartbeat,
  store,        ///< signature "save"
  restore,      ///< signature "load"
  no_subindex,  ///< the object has no such subindex
  no_object,
};

/// Whose stored image an object is part of.
enum class Stored : std::uint8_t { never, network, motor, communication };

struct ObjectUnderTest {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t size = 4;
  ObjectRule rule = ObjectRule::number;
  std::int64_t low = 0;
  std::int64_t high = 0;
  Stored stored = Stored::never;
  bool node_id_relative = false;
  std::span<const std::int64_t> choices{};
  std::string_view content{};
};

/// The objects that sequences deal with. CiA 301 and the product's decisions say what they take.
[[nodiscard]] std::span<const ObjectUnderTest> objects_under_test();
/// Null if it is none of them.
[[nodiscard]] const ObjectUnderTest* find_object(std::uint16_t index, std::uint8_t subindex);

/// Objects that can be mapped, as mapping entries.
[[nodiscard]] std::span<const std::uint32_t> mappable_to_receive();
[[nodiscard]] std::span<const std::uint32_t> mappable_to_transmit();

}  // namespace stator::tests
