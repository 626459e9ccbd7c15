#include "stator/formats/esi/esi_value_text.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::DataType;
using dictionary::Number;
using dictionary::Range;

std::uint64_t little_endian(const std::vector<std::byte>& bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < std::min(bytes.size(), sizeof bits); ++i) {
    bits |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
  }
  return bits;
}

bool is_real(DataType type) {
  return type == DataType::real32 || type == DataType::real64;
}

std::uint64_t real_bits(DataType type, double value) {
  return type == DataType::real32 ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                  : std::bit_cast<std::uint64_t>(value);
}

std::optional<double> real_number(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

/// A number that is written as one.
std::optional<EsiValue> written(DataType type, std::string_view text) {
  text = trimmed(text);
  if (is_real(type)) {
    if (text.starts_with("#x") || text.starts_with("0x")) {
      const auto pattern = esi_number(text);
      return pattern ? std::optional(EsiValue{esi_extended(type, pattern->bits), {}})
                     : std::nullopt;
    }
    const auto value = real_number(text);
    return value ? std::optional(EsiValue{real_bits(type, *value), {}}) : std::nullopt;
  }
  if (same_word(text, "true") || same_word(text, "false")) {
    return EsiValue{std::uint64_t{same_word(text, "true")}, {}};
  }
  const std::optional<EsiNumber> number = esi_number(text);
  if (!number) {
    return std::nullopt;
  }
  EsiValue value;
  value.number.bits = esi_extended(type, number->bits);
  value.number.hexadecimal = number->hexadecimal;
  // FFFFFFFFh for -1 is fine, whatever the sign; what loses digits is not.
  const std::size_t length = bit_length(type);
  const std::uint64_t above = length >= 64 ? 0 : number->bits >> length;
  const bool all_ones = length < 64 && above == UINT64_MAX >> length;
  if (number->cut || (above != 0 && !all_ones)) {
    value.repaired = fmt::format("{} is no value of {}; {:#x} is taken", readable(text),
                                 dictionary::to_text(type).view(), value.number.bits);
  }
  return value;
}

/// A number given by its bytes.
std::optional<EsiValue> from_data(DataType type, std::string_view text) {
  constexpr std::size_t kLongest = 64;
  text = trimmed(text).substr(0, kLongest);  // the bytes behind are of no number
  const std::optional<std::vector<std::byte>> bytes = esi_bytes(text);
  if (!bytes) {  // "0", "#x10", "12345": not bytes, though it should be
    std::optional<EsiValue> value = written(type, text);
    if (value && value->number.bits != 0 && value->repaired.empty()) {
      value->repaired = fmt::format(
          "\"{}\" should be bytes, lowest first, but is no such; it is "
          "read as a number",
          readable(text));
    }
    return value;
  }
  if (bytes->empty()) {
    return std::nullopt;
  }
  const std::size_t length = byte_length(type);
  EsiValue value;
  value.number.bits = esi_extended(type, little_endian(*bytes));
  const auto beyond = [](std::byte b) { return b != std::byte{0} && b != std::byte{0xFF}; };
  if (bytes->size() > length &&
      std::any_of(bytes->begin() + static_cast<std::ptrdiff_t>(length), bytes->end(), beyond)) {
    value.repaired = fmt::format("\"{}\" is longer than {}; its lowest {} bytes are taken",
                                 readable(text), dictionary::to_text(type).view(), length);
  }
  return value;
}

/// Text as UTF-16, lowest byte first.
std::string wide(std::string_view text) {
  std::string bytes;
  for (const char c : text) {  // texts in such strings are ASCII
    bytes.push_back(c);
    bytes.push_back('\0');
  }
  return bytes;
}

std::string string_of(const std::vector<std::byte>& bytes) {
  std::string text;
  text.reserve(bytes.size());
  for (const std::byte b : bytes) {
    text.push_back(static_cast<char>(b));
  }
  return text;
}

bool below(DataType type, std::uint64_t a, std::uint64_t b) {
  return is_signed(type) ? static_cast<std::int64_t>(a) < static_cast<std::int64_t>(b) : a < b;
}

}  // namespace

std::uint64_t esi_extended(DataType type, std::uint64_t bits) {
  const std::size_t length = bit_length(type);
  if (length == 0 || length >= 64) {
    return bits;
  }
  const std::uint64_t mask = (std::uint64_t{1} << length) - 1;
  bits &= mask;
  const bool negative = is_signed(type) && (bits >> (length - 1)) != 0;
  return negative ? bits | ~mask : bits;
}

std::optional<EsiValue> esi_value(pugi::xml_node node, DataType type, const char* data,
                                  const char* value, const char* text) {
  if (const std::string_view bytes = child_text(node, data); !bytes.empty()) {
    if (std::optional<EsiValue> number = from_data(type, bytes)) {
      return number;
    }
  }
  for (const char* name : {value, text}) {
    if (const std::string_view number = child_text(node, name); !number.empty()) {
      if (std::optional<EsiValue> read = written(type, number)) {
        return read;
      }
    }
  }
  return std::nullopt;
}

std::optional<std::string> esi_string(pugi::xml_node node, DataType type) {
  constexpr std::size_t kLongest = 0xFFFF;
  std::optional<std::string> text;
  if (const pugi::xml_node data = node.child("DefaultData")) {
    const std::string_view digits = trimmed(data.child_value()).substr(0, 2 * kLongest);
    const auto bytes = esi_bytes(digits);
    text = bytes ? string_of(*bytes) : std::string(digits.substr(0, kLongest));
  } else {
    for (const char* name : {"DefaultString", "DefaultValue"}) {
      if (const pugi::xml_node child = node.child(name)) {
        const std::string_view value = trimmed(child.child_value()).substr(0, kLongest);
        text = type == DataType::unicode_string ? wide(value) : std::string(value);
        break;
      }
    }
  }
  if (text && type == DataType::visible_string) {
    text->resize(text->find_last_not_of('\0') + 1);  // npos + 1 is 0
  }
  return text;
}

std::uint64_t esi_bits_at(const std::vector<std::byte>& bytes, std::size_t bit_offset,
                          std::size_t bits) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bits, 64); ++i) {
    const std::size_t at = bit_offset + i;
    if (at / 8 >= bytes.size()) {
      break;
    }
    const auto byte = std::to_integer<std::uint64_t>(bytes[at / 8]);
    value |= ((byte >> (at % 8)) & 1U) << i;
  }
  return value;
}

std::optional<Range> esi_range(pugi::xml_node node, DataType type) {
  if (is_string(type) || is_real(type) || type == DataType::boolean) {
    return std::nullopt;
  }
  const auto minimum = esi_value(node, type, "MinData", "MinValue", "MinString");
  const auto maximum = esi_value(node, type, "MaxData", "MaxValue", "MaxString");
  if (!minimum && !maximum) {
    return std::nullopt;
  }
  const std::size_t length = bit_length(type);
  const std::uint64_t highest_bit = std::uint64_t{1} << (length - 1);
  Range range;
  range.minimum =
      minimum ? minimum->number : Number(is_signed(type) ? esi_extended(type, highest_bit) : 0);
  range.maximum = maximum
                      ? maximum->number
                      : Number(is_signed(type) ? highest_bit - 1 : highest_bit | (highest_bit - 1));
  // Tools write equal limits, mostly zeros, where there is none.
  if (!below(type, range.minimum.bits, range.maximum.bits)) {
    return std::nullopt;
  }
  return range;
}

}  // namespace stator::formats
