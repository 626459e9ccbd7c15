// Values of objects as programs handle them - numbers, texts, bytes - and as an SDO carries them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "stator/dictionary/data_type.hpp"

namespace stator::dictionary {

/// The value of an entry: a truth value, a signed or unsigned whole number, a real one, a visible
/// string, or the bytes of an octet string or a domain.
using Content =
    std::variant<bool, std::int64_t, std::uint64_t, double, std::string, std::vector<std::byte>>;

/// What `bytes`, little-endian as an SDO carries them, mean to an entry of that type. Bytes that
/// are missing count as zero, those beyond the eighth of a number do not count.
[[nodiscard]] Content decode(DataType type, std::span<const std::byte> bytes);

/// The reverse. Nothing: `content` is no value of that type; the entry's own range is not checked.
/// Whole numbers serve for reals and, 0 and 1, for truth values.
[[nodiscard]] std::optional<std::vector<std::byte>> encode(DataType type, const Content& content);

}  // namespace stator::dictionary
