#include "stator/web/stream/object_text.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/base/byte_order.hpp"
#include "stator/drive/power/state_description.hpp"
#include "stator/web/api/object_value.hpp"
#include "stator/web/json_text.hpp"

namespace stator::web {

namespace {

/// Bytes of a value that is shown at most.
constexpr std::size_t kMostBytes = 64;

const dictionary::Entry* find(const dictionary::Dictionary* objects, std::uint16_t index,
                              std::uint8_t subindex) {
  return objects != nullptr ? objects->find(index, subindex) : nullptr;
}

bool named(const dictionary::Entry& entry, std::string_view word) {
  // Clang 14 cannot take std::ranges::search from this standard library.
  const auto same = [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  };
  const std::string_view name = entry.name();
  return std::search(name.begin(), name.end(), word.begin(), word.end(), same) != name.end();
}

std::string controlword_text(std::uint16_t word) {
  constexpr std::uint16_t kFaultReset = 0x80;
  return (word & kFaultReset) != 0 ? "Fault reset"
                                   : std::string(drive::to_text(drive::command_of(word)));
}

}  // namespace

std::string hexadecimal_text(std::span<const std::byte> bytes, std::size_t most) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * std::min(bytes.size(), most));
  for (const std::byte byte : bytes.first(std::min(bytes.size(), most))) {
    text += kDigits[std::to_integer<std::size_t>(byte) >> 4U];
    text += kDigits[std::to_integer<std::size_t>(byte) & 0xFU];
  }
  return text;
}

std::string object_text(const dictionary::Dictionary* objects, std::uint16_t index,
                        std::uint8_t subindex) {
  const dictionary::Entry* entry = find(objects, index, subindex);
  return entry == nullptr ? fmt::format("{:04X}h:{:02X}h", index, subindex)
                          : fmt::format("{:04X}h:{:02X}h \"{}\"", index, subindex, entry->name());
}

std::string value_text(const dictionary::Dictionary* objects, std::uint16_t index,
                       std::uint8_t subindex, std::span<const std::byte> value) {
  const dictionary::Entry* entry = find(objects, index, subindex);
  const bool text = entry != nullptr && dictionary::is_string(entry->type());
  if (entry == nullptr || value.empty() || (!text && value.size() != entry->size())) {
    return hexadecimal_text(value, kMostBytes) + (value.size() > kMostBytes ? "..." : "");
  }
  if (value.size() == 2 && named(*entry, "controlword")) {
    const auto word = base::load_le<std::uint16_t>(value, 0);
    return fmt::format("{:04X}h ({})", word, controlword_text(word));
  }
  if (value.size() == 2 && named(*entry, "statusword")) {
    const auto word = base::load_le<std::uint16_t>(value, 0);
    const auto state = drive::power_state_of(word);
    return fmt::format("{:04X}h ({})", word, state ? drive::to_text(*state) : "no state");
  }
  const std::size_t shown = text ? std::min(value.size(), kMostBytes) : value.size();
  const nlohmann::ordered_json json = to_json(entry->type(), value.first(shown));
  return json.is_string() ? json.get<std::string>() : text_of(json);
}

}  // namespace stator::web
