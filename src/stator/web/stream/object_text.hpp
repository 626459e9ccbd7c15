#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "stator/dictionary/dictionary.hpp"

namespace stator::web {

/// `6041h:00h "Statusword"`, without the name if `objects` is null or has no such entry.
[[nodiscard]] std::string object_text(const dictionary::Dictionary* objects, std::uint16_t index,
                                      std::uint8_t subindex);

/// What `value`, little-endian, is for that entry: a number in its type, text, a controlword or
/// statusword in words. Bytes in hexadecimal where the entry is not known or the length is not its.
[[nodiscard]] std::string value_text(const dictionary::Dictionary* objects, std::uint16_t index,
                                     std::uint8_t subindex, std::span<const std::byte> value);

/// Bytes as hexadecimal digits, `most` of them at most.
[[nodiscard]] std::string hexadecimal_text(std::span<const std::byte> bytes,
                                           std::size_t most = SIZE_MAX);

}  // namespace stator::web
