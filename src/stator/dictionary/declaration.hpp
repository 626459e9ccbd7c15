#pragma once

#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/event_text.hpp"
#include "stator/dictionary/data_type.hpp"

namespace stator::dictionary {

/// Object codes (CiA 301 table 42, ETG.1000.6 table 66).
enum class ObjectCode : std::uint8_t { domain_object = 2, variable = 7, array = 8, record = 9 };

enum class Access : std::uint8_t { read_only, read_write, write_only, constant };

/// In which process data an entry may stand, seen from the device: receive = the master's outputs.
enum class PdoMapping : std::uint8_t { no, receive, transmit, both };

/// States of the network state machine in which a write is taken.
enum class NetworkState : std::uint8_t {
  pre_operational = 1,
  safe_operational = 2,
  operational = 4
};
inline constexpr std::uint8_t kAllNetworkStates = 7;
inline constexpr std::uint8_t kPreOperationalOnly = 1;

/// What the power drive state machine must be in for a write to be taken.
enum class DriveCondition : std::uint8_t {
  none,
  switch_on_disabled,  ///< else abort 08000022h
};

/// A number of any integer type, kept as 64 bits; the entry's data type says how to read it.
/// `hexadecimal` only tells how people want to see it.
struct Number {
  std::uint64_t bits = 0;
  bool hexadecimal = false;

  constexpr Number() = default;
  template <std::integral T>
  constexpr Number(T value) : bits(static_cast<std::uint64_t>(value)) {}  // NOLINT: implicit

  [[nodiscard]] constexpr std::int64_t as_signed() const { return static_cast<std::int64_t>(bits); }
};

/// A number that people read in hexadecimal.
constexpr Number hex(std::uint64_t value) {
  Number number(value);
  number.hexadecimal = true;
  return number;
}

/// The value after power-on: a number, a text, or a number the document does not give.
struct Default {
  Number number;
  std::string_view text{};
  bool documented = true;

  constexpr Default() = default;
  template <std::integral T>
  constexpr Default(T value) : number(value) {}          // NOLINT: implicit
  constexpr Default(Number value) : number(value) {}     // NOLINT: implicit
  constexpr Default(const char* value) : text(value) {}  // NOLINT: implicit
};

/// The document gives no default; `value` is what the device starts with.
constexpr Default undocumented(Number value) {
  Default result(value);
  result.documented = false;
  return result;
}

/// Legal values, both ends included.
struct Range {
  Number minimum;
  Number maximum;
};

/// One entry of an object dictionary as its document prints it: the single place where it is
/// declared. SDO access and abort codes, SDO information, mapping checks, SII, ESI, EDS, device
/// pages and the dashboard are all derived from it.
struct EntryDeclaration {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::string_view name{};
  ObjectCode object_code = ObjectCode::variable;
  DataType type = DataType::unsigned32;
  Access access = Access::read_write;
  PdoMapping mapping = PdoMapping::no;
  Default default_value{};
  std::optional<Range> range{};
  std::string_view unit{};
  std::string_view source{};  ///< where in the device's document
  std::string_view note{};

  std::string_view object_name{};  ///< name of the whole array or record, on its subindex 0
  /// If not empty, the only values a write may have, else abort 06090030h; `range` then only tells
  /// what the document prints.
  base::StaticList legal_values{};
  std::uint8_t write_states = kAllNetworkStates;  ///< NetworkState bits
  DriveCondition drive_condition = DriveCondition::none;
  /// The node-ID of a CANopen device is added to the default (CiA 301 §7.5.2 "$NODEID+80h");
  /// Dictionary::set_node_id() says which it is.
  bool node_id_relative = false;
  /// Shows something of the world or of the running firmware, so that no value is to be expected
  /// after a reset; an EDS then names none.
  bool live = false;
};

}  // namespace stator::dictionary
