#include "stator/web/api/object_value.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace stator::web {

namespace {

using dictionary::AbortCode;
using dictionary::DataType;
using Json = nlohmann::ordered_json;

constexpr base::EventRule kNoValueOfType{
    "od-no-value-of-type", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: what came is no value of its type {3}; write a number "
    "in the type's range, true or false, or text"};

std::uint64_t from_little_endian(std::span<const std::byte> bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < bytes.size() && i < sizeof bits; ++i) {
    bits |= std::to_integer<std::uint64_t>(bytes[i]) << (8 * i);
  }
  return bits;
}

std::vector<std::byte> to_little_endian(std::uint64_t bits, std::size_t length) {
  std::vector<std::byte> bytes(length);
  for (std::size_t i = 0; i < length; ++i) {
    bytes[i] = static_cast<std::byte>(bits >> (8 * i));
  }
  return bytes;
}

std::int64_t sign_extended(std::uint64_t bits, std::size_t length) {
  const auto unused = static_cast<unsigned>(64 - 8 * length);
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

std::string hexadecimal(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    fmt::format_to(std::back_inserter(text), "{:02x}", std::to_integer<unsigned>(byte));
  }
  return text;
}

/// An integer with its sign, or nothing.
struct Integer {
  std::uint64_t bits = 0;
  bool negative = false;
};

std::optional<Integer> parse_integer(std::string_view text) {
  const bool negative = text.starts_with('-');
  text.remove_prefix(negative ? 1 : 0);
  const bool hex = text.starts_with("0x") || text.starts_with("0X");
  text.remove_prefix(hex ? 2 : 0);
  std::uint64_t magnitude = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, magnitude, hex ? 16 : 10);
  constexpr std::uint64_t kLargestNegative = std::uint64_t{1} << 63U;
  if (text.empty() || result.ec != std::errc() || result.ptr != end ||
      (negative && magnitude > kLargestNegative)) {
    return std::nullopt;
  }
  return Integer{negative ? ~magnitude + 1 : magnitude, negative && magnitude != 0};
}

std::optional<Integer> integer_of(const Json& value) {
  if (value.is_number_unsigned()) {
    return Integer{value.get<std::uint64_t>(), false};
  }
  if (value.is_number_integer()) {
    const auto number = value.get<std::int64_t>();
    return Integer{static_cast<std::uint64_t>(number), number < 0};
  }
  if (value.is_string()) {
    return parse_integer(value.get_ref<const std::string&>());
  }
  return std::nullopt;
}

bool fits(const Integer& integer, DataType type) {
  const std::size_t bits = dictionary::bit_length(type);
  if (dictionary::is_signed(type)) {
    const std::uint64_t limit = std::uint64_t{1} << (bits - 1);
    return integer.negative ? ~integer.bits + 1 <= limit : integer.bits < limit;
  }
  return !integer.negative && (bits == 64 || integer.bits >> bits == 0);
}

std::optional<std::vector<std::byte>> bytes_of_digits(std::string_view digits) {
  std::vector<std::byte> bytes(digits.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    unsigned value = 0;
    const char* first = digits.data() + 2 * i;
    if (std::from_chars(first, first + 2, value, 16).ptr != first + 2) {
      return std::nullopt;
    }
    bytes[i] = static_cast<std::byte>(value);
  }
  return digits.size() % 2 == 0 ? std::optional(bytes) : std::nullopt;
}

std::optional<std::vector<std::byte>> encode(DataType type, const Json& value) {
  switch (type) {
    case DataType::visible_string:
      if (value.is_string()) {
        const auto& text = value.get_ref<const std::string&>();
        const auto bytes = std::as_bytes(std::span(text));
        return std::vector<std::byte>(bytes.begin(), bytes.end());
      }
      return std::nullopt;
    case DataType::octet_string:
    case DataType::domain:
      return value.is_string() ? bytes_of_digits(value.get_ref<const std::string&>())
                               : std::nullopt;
    case DataType::real32:
      if (value.is_number()) {
        const auto number = value.get<float>();
        return std::isfinite(number)
                   ? std::optional(to_little_endian(std::bit_cast<std::uint32_t>(number), 4))
                   : std::nullopt;
      }
      return std::nullopt;
    case DataType::real64:
      return value.is_number() ? std::optional(to_little_endian(
                                     std::bit_cast<std::uint64_t>(value.get<double>()), 8))
                               : std::nullopt;
    default:
      break;
  }
  if (type == DataType::boolean && value.is_boolean()) {
    return to_little_endian(value.get<bool>() ? 1 : 0, 1);
  }
  const std::optional<Integer> integer = integer_of(value);
  if (!integer || !fits(*integer, type)) {
    return std::nullopt;
  }
  return to_little_endian(integer->bits, dictionary::byte_length(type));
}

}  // namespace

Json to_json(DataType type, std::span<const std::byte> value) {
  const std::uint64_t bits = from_little_endian(value);
  switch (type) {
    case DataType::boolean:
      return bits != 0;
    case DataType::visible_string: {
      std::string text;
      for (const std::byte byte : value) {
        text += static_cast<char>(byte);
      }
      return text;
    }
    case DataType::octet_string:
    case DataType::domain:
      return hexadecimal(value);
    case DataType::real32:
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case DataType::real64:
      return std::bit_cast<double>(bits);
    default:
      break;
  }
  if (dictionary::is_signed(type) && !value.empty()) {
    return sign_extended(bits, std::min<std::size_t>(value.size(), 8));
  }
  return bits;
}

base::Expected<std::vector<std::byte>, dictionary::Refusal> to_bytes(const dictionary::Entry& entry,
                                                                     const Json& value) {
  auto bytes = encode(entry.type(), value);
  if (!bytes) {
    return dictionary::refuse(
        AbortCode::value_range_exceeded, kNoValueOfType,
        {entry.index(), std::size_t{entry.subindex()}, entry.shared_name(), to_text(entry.type())});
  }
  return std::move(*bytes);
}

}  // namespace stator::web
