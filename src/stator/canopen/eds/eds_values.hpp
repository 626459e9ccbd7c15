// Numbers, values and words as files about CANopen devices have them (CiA 306-1, CiA 311), and as
// people write them nevertheless.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "stator/dictionary/declaration.hpp"

namespace stator::canopen {

/// In which way a number is written.
enum class NumberSpelling : std::uint8_t {
  standard,          ///< decimal, or hexadecimal behind 0x
  octal,             ///< behind 0, as the standard has it and people rarely mean it
  bare_hexadecimal,  ///< with letters, but without 0x; or with an h behind it
  leading_zero,      ///< behind 0, but no octal number: it is read as a decimal one
};

/// A number of a file.
struct EdsNumber {
  std::uint64_t bits = 0;         ///< two's complement
  bool negative = false;          ///< it has a minus
  bool hexadecimal = false;       ///< so that people see it as the file has it
  bool node_id_relative = false;  ///< "$NODEID" is added to it
  bool too_large = false;         ///< `bits` are the lowest 64 of more
  NumberSpelling spelling = NumberSpelling::standard;
};

/// The text without spaces and tabs around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// A number, or a sum of numbers and "$NODEID"; nothing if it is something else. What follows a
/// semicolon is a comment.
[[nodiscard]] std::optional<EdsNumber> parse_eds_number(std::string_view text);

/// Hexadecimal digits with or without 0x, as indices and types stand in names of sections and in
/// XDD files.
[[nodiscard]] std::optional<std::uint32_t> parse_hexadecimal(std::string_view text);

/// A number with a point or an exponent, or a whole one; a comma may be the point.
[[nodiscard]] std::optional<double> parse_eds_real(std::string_view text);

/// Bytes in hexadecimal: "01 02 FF", "0x0102FF", "01,02,FF"; nothing if it is something else.
[[nodiscard]] std::optional<std::string> parse_octets(std::string_view text);

/// True for 1, true, yes; false for 0, false, no and nothing; nothing else is a flag.
[[nodiscard]] std::optional<bool> parse_flag(std::string_view text);

/// A number as a value of a type.
struct FittedNumber {
  std::uint64_t bits = 0;  ///< extended to 64 bits as the type says
  bool fits = true;        ///< else `bits` are what the type keeps of it
};
/// `type` is a type of numbers, not of reals.
[[nodiscard]] FittedNumber fit_number(dictionary::DataType type, const EdsNumber& number);

/// What the bits of a REAL32 or REAL64 are for a number.
[[nodiscard]] std::uint64_t real_bits(dictionary::DataType type, double value);

/// The type with this number; nothing for those that describe objects (20h.., 40h..) and for
/// numbers that are no type.
[[nodiscard]] std::optional<dictionary::DataType> data_type_of(std::uint32_t number);

/// Who may read and write an entry, and in which PDOs it may be if it may be in any.
struct EdsAccess {
  dictionary::Access access = dictionary::Access::read_write;
  dictionary::PdoMapping mappable = dictionary::PdoMapping::both;
};
/// Words of AccessType (CiA 306-1), accessType and access (CiA 311), whatever their letters' case.
[[nodiscard]] std::optional<EdsAccess> parse_access(std::string_view word);

/// A text for people: valid UTF-8 without control characters. What is no UTF-8 is taken for
/// Latin-1, in which most of these files are.
[[nodiscard]] std::string readable_text(std::string_view text);

/// The text is UTF-8.
[[nodiscard]] bool is_utf8(std::string_view text);

/// Latin-1 as UTF-8.
[[nodiscard]] std::string utf8_of_latin1(std::string_view text);

/// "1A" or "0001A": at least so many digits.
[[nodiscard]] std::string hexadecimal_text(std::uint64_t value, std::size_t digits);

}  // namespace stator::canopen
