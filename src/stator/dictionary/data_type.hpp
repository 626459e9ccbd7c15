#pragma once

#include <cstddef>
#include <cstdint>

#include "stator/base/event_text.hpp"

namespace stator::dictionary {

/// Basic data types with their index in the object dictionary (CiA 301 §7.4.7, ETG.1000.6
/// §5.6.7.3).
enum class DataType : std::uint16_t {
  boolean = 0x0001,
  integer8 = 0x0002,
  integer16 = 0x0003,
  integer32 = 0x0004,
  unsigned8 = 0x0005,
  unsigned16 = 0x0006,
  unsigned32 = 0x0007,
  real32 = 0x0008,
  visible_string = 0x0009,
  octet_string = 0x000A,
  unicode_string = 0x000B,  ///< 16 bits for each character, kept as bytes
  time_of_day = 0x000C,     ///< milliseconds in 28 of 32 bits, then days, kept as a number
  time_difference = 0x000D,
  domain = 0x000F,
  integer24 = 0x0010,
  real64 = 0x0011,
  integer40 = 0x0012,
  integer48 = 0x0013,
  integer56 = 0x0014,
  integer64 = 0x0015,
  unsigned24 = 0x0016,
  unsigned40 = 0x0018,
  unsigned48 = 0x0019,
  unsigned56 = 0x001A,
  unsigned64 = 0x001B,
  bit2 = 0x0031,  ///< ETG.1000.6: so many bits
  bit3 = 0x0032,
  bit4 = 0x0033,
  bit5 = 0x0034,
  bit6 = 0x0035,
  bit7 = 0x0036,
};

/// The standard's name, e.g. "UNSIGNED32"; "?" for a number that is no type.
[[nodiscard]] base::StaticText to_text(DataType type);

/// Length of a value in bits; 0 for strings and domains, whose length is the
/// value's own.
[[nodiscard]] constexpr std::size_t bit_length(DataType type) {
  switch (type) {
    case DataType::boolean:
      return 1;
    case DataType::bit2:
      return 2;
    case DataType::bit3:
      return 3;
    case DataType::bit4:
      return 4;
    case DataType::bit5:
      return 5;
    case DataType::bit6:
      return 6;
    case DataType::bit7:
      return 7;
    case DataType::integer8:
    case DataType::unsigned8:
      return 8;
    case DataType::integer16:
    case DataType::unsigned16:
      return 16;
    case DataType::integer24:
    case DataType::unsigned24:
      return 24;
    case DataType::integer32:
    case DataType::unsigned32:
    case DataType::real32:
      return 32;
    case DataType::integer40:
    case DataType::unsigned40:
      return 40;
    case DataType::integer48:
    case DataType::unsigned48:
    case DataType::time_of_day:
    case DataType::time_difference:
      return 48;
    case DataType::integer56:
    case DataType::unsigned56:
      return 56;
    case DataType::real64:
    case DataType::integer64:
    case DataType::unsigned64:
      return 64;
    case DataType::visible_string:
    case DataType::octet_string:
    case DataType::unicode_string:
    case DataType::domain:
      return 0;
  }
  return 0;
}

/// Length of a value in bytes as an SDO carries it; 0 for strings.
[[nodiscard]] constexpr std::size_t byte_length(DataType type) {
  return (bit_length(type) + 7) / 8;
}

/// Values of any length, kept as text; a domain, a block of data such as a file (1021h), is one.
[[nodiscard]] constexpr bool is_string(DataType type) {
  return type == DataType::visible_string || type == DataType::octet_string ||
         type == DataType::unicode_string || type == DataType::domain;
}

[[nodiscard]] constexpr bool is_signed(DataType type) {
  switch (type) {
    case DataType::integer8:
    case DataType::integer16:
    case DataType::integer24:
    case DataType::integer32:
    case DataType::integer40:
    case DataType::integer48:
    case DataType::integer56:
    case DataType::integer64:
      return true;
    default:
      return false;
  }
}

}  // namespace stator::dictionary
