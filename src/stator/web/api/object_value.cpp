#include "stator/web/api/object_value.hpp"

#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/dictionary/content.hpp"

namespace stator::web {

namespace {

using dictionary::AbortCode;
using dictionary::DataType;
using Json = nlohmann::ordered_json;

constexpr base::EventRule kNoValueOfType{
    "od-no-value-of-type", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: what came is no value of its type {3}; write a number "
    "in the type's range, true or false, or text"};

std::string hexadecimal(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    fmt::format_to(std::back_inserter(text), "{:02x}", std::to_integer<unsigned>(byte));
  }
  return text;
}

/// A whole number as text, decimal or such as "0x1F"; nothing: it is none.
std::optional<dictionary::Content> parse_integer(std::string_view text) {
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
  if (negative) {
    return static_cast<std::int64_t>(~magnitude + 1);
  }
  return magnitude;
}

std::optional<dictionary::Content> bytes_of_digits(std::string_view digits) {
  std::vector<std::byte> bytes(digits.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    unsigned value = 0;
    const char* first = digits.data() + 2 * i;
    if (std::from_chars(first, first + 2, value, 16).ptr != first + 2) {
      return std::nullopt;
    }
    bytes[i] = static_cast<std::byte>(value);
  }
  return digits.size() % 2 == 0 ? std::optional<dictionary::Content>(std::move(bytes))
                                : std::nullopt;
}

/// Texts are what the type makes of them; nothing: no value of any type.
std::optional<dictionary::Content> content_of(DataType type, const Json& value) {
  if (value.is_boolean()) {
    return value.get<bool>();
  }
  if (value.is_number_unsigned()) {
    return value.get<std::uint64_t>();
  }
  if (value.is_number_integer()) {
    return value.get<std::int64_t>();
  }
  if (value.is_number()) {
    return value.get<double>();
  }
  if (!value.is_string()) {
    return std::nullopt;
  }
  const auto& text = value.get_ref<const std::string&>();
  switch (type) {
    case DataType::visible_string:
      return text;
    case DataType::octet_string:
    case DataType::unicode_string:
    case DataType::domain:
      return bytes_of_digits(text);
    case DataType::real32:
    case DataType::real64:
      return std::nullopt;
    default:
      return parse_integer(text);
  }
}

}  // namespace

Json to_json(DataType type, std::span<const std::byte> value) {
  return std::visit(
      [](const auto& content) -> Json {
        if constexpr (std::is_same_v<decltype(content), const std::vector<std::byte>&>) {
          return hexadecimal(content);
        } else {
          return content;
        }
      },
      dictionary::decode(type, value));
}

base::Expected<std::vector<std::byte>, dictionary::Refusal> to_bytes(const dictionary::Entry& entry,
                                                                     const Json& value) {
  const std::optional<dictionary::Content> content = content_of(entry.type(), value);
  auto bytes = content ? dictionary::encode(entry.type(), *content) : std::nullopt;
  if (!bytes) {
    return dictionary::refuse(
        AbortCode::value_range_exceeded, kNoValueOfType,
        {entry.index(), std::size_t{entry.subindex()}, entry.shared_name(), to_text(entry.type())});
  }
  return std::move(*bytes);
}

}  // namespace stator::web
