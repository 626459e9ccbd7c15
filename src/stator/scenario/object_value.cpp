#include "stator/scenario/object_value.hpp"

#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "stator/master/cia402/drive_port.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/scenario/comparison.hpp"

namespace stator::scenario {

namespace {

using dictionary::DataType;

constexpr double kAnyValue = 1e18;
/// Bytes of a number that is written to an object that no dictionary describes.
constexpr std::size_t kUnknownBytes = 4;

std::vector<std::byte> bytes_of(std::uint64_t bits, std::size_t size) {
  std::vector<std::byte> bytes(size);
  master::store_number(bytes, bits);
  return bytes;
}

base::Expected<std::vector<std::byte>, std::string> whole_number(double value,
                                                                 const dictionary::Entry* entry) {
  if (value != std::trunc(value)) {
    return base::Unexpected{fmt::format("{} is no whole number, which the object is", value)};
  }
  const std::size_t size = entry != nullptr ? entry->size() : kUnknownBytes;
  const double span = std::ldexp(1.0, static_cast<int>(8 * size));
  if (value < -span / 2 || value >= span) {
    return base::Unexpected{
        fmt::format("{} does not fit the object's {} bytes", number_text(value), size)};
  }
  const auto bits = value < 0 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(value))
                              : static_cast<std::uint64_t>(value);
  return bytes_of(bits, size);
}

bool is_text(const dictionary::Entry* entry) {
  return entry != nullptr && dictionary::is_string(entry->type());
}

void read_value(const settings::KeyWords& key, settings::Reader& reader,
                std::optional<ObjectValue>& value) {
  const auto keep = [&value](const auto& given) {
    if (given) {
      value = *given;
    }
  };
  reader.either(
      reader.is_text(key.name), [&] { keep(reader.number(key, -kAnyValue, kAnyValue)); },
      [&] { keep(reader.text(key)); });
}

void read_bytes(const settings::KeyWords& key, settings::Reader& reader,
                std::optional<ObjectValue>& value) {
  const auto text = reader.text(key);
  if (!text) {
    return;
  }
  if (auto bytes = parse_bytes(*text)) {
    value = std::move(*bytes);
  } else {
    reader.refuse(key.name, fmt::format("\"{}\" is no list of bytes in hexadecimal; write e.g. "
                                        "\"2B 01 FF\"",
                                        *text));
  }
}

constexpr std::array kValueRows{settings::custom<std::optional<ObjectValue>, read_value>(
                                    "value", "What is written; a text for objects that are one"),
                                settings::custom<std::optional<ObjectValue>, read_bytes>(
                                    "bytes", "Instead of value: bytes as they are, \"2B 01\"")};

void read_object(const settings::KeyWords& key, settings::Reader& reader,
                 std::optional<master::ObjectAddress>& object) {
  const auto text = reader.text(key);
  if (!text) {
    reader.refuse_missing(key.name, "it names an object, e.g. \"6040:00\"");
  } else if (const auto named = rack::parse_fault_object(*text)) {
    object = master::ObjectAddress{named->index, named->subindex.value_or(0)};
  } else {
    reader.refuse(key.name, fmt::format("\"{}\" is no object; write its index and subindex in "
                                        "hexadecimal, e.g. \"6040:00\"",
                                        *text));
  }
}

constexpr std::array kObjectRows{
    settings::custom<std::optional<master::ObjectAddress>, read_object>(
        "object", "Index and subindex in hexadecimal, \"6040:00\"")};

}  // namespace

constinit const settings::Section<std::optional<ObjectValue>> kObjectValueKeys{kValueRows};
constinit const settings::Section<std::optional<master::ObjectAddress>> kObjectKeys{kObjectRows};

base::Expected<std::vector<std::byte>, std::string> to_bytes(const ObjectValue& value,
                                                             const dictionary::Entry* entry) {
  if (const auto* bytes = std::get_if<std::vector<std::byte>>(&value)) {
    return *bytes;
  }
  if (const auto* text = std::get_if<std::string>(&value)) {
    const auto characters = std::as_bytes(std::span(*text));
    return std::vector<std::byte>(characters.begin(), characters.end());
  }
  const double number = std::get<double>(value);
  if (is_text(entry)) {
    return base::Unexpected{std::string("the object is a text, not a number")};
  }
  if (entry != nullptr && entry->type() == DataType::real32) {
    return bytes_of(std::bit_cast<std::uint32_t>(static_cast<float>(number)), sizeof(float));
  }
  if (entry != nullptr && entry->type() == DataType::real64) {
    return bytes_of(std::bit_cast<std::uint64_t>(number), sizeof(double));
  }
  return whole_number(number, entry);
}

std::optional<double> to_number(std::span<const std::byte> data, const dictionary::Entry* entry) {
  if (is_text(entry) || data.empty() || data.size() > sizeof(std::uint64_t)) {
    return std::nullopt;
  }
  const std::uint64_t bits = master::load_number(data);
  if (entry == nullptr) {
    return static_cast<double>(bits);
  }
  if (entry->type() == DataType::real32) {
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  }
  if (entry->type() == DataType::real64) {
    return std::bit_cast<double>(bits);
  }
  if (dictionary::is_signed(entry->type())) {
    const auto unused = static_cast<unsigned>(8 * (sizeof bits - data.size()));
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }
  return static_cast<double>(bits);
}

std::string value_text(std::span<const std::byte> data, const dictionary::Entry* entry) {
  if (entry != nullptr && entry->type() == DataType::visible_string) {
    std::string text;
    for (const std::byte byte : data) {
      text += static_cast<char>(byte);
    }
    return fmt::format("\"{}\"", text);
  }
  const auto number = to_number(data, entry);
  return number ? number_text(*number) : bytes_text(data);
}

std::optional<std::vector<std::byte>> parse_bytes(std::string_view text) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < text.size();) {
    if (std::isspace(static_cast<unsigned char>(text[i])) != 0) {
      ++i;
      continue;
    }
    unsigned value = 0;
    const char* const begin = text.data() + i;
    const auto [end, error] =
        std::from_chars(begin, begin + std::min<std::size_t>(2, text.size() - i), value, 16);
    if (error != std::errc() || end != begin + 2) {
      return std::nullopt;
    }
    bytes.push_back(static_cast<std::byte>(value));
    i += 2;
  }
  return bytes;
}

std::string bytes_text(std::span<const std::byte> data) {
  std::string text;
  for (const std::byte byte : data) {
    text += fmt::format("{}{:02X}", text.empty() ? "" : " ", std::to_integer<unsigned>(byte));
  }
  return text;
}

}  // namespace stator::scenario
