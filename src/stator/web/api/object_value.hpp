#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::web {

/// The value of an entry, little-endian as an SDO carries it, as JSON: numbers, true or false,
/// text; octet strings and domains as hexadecimal digits.
[[nodiscard]] nlohmann::ordered_json to_json(dictionary::DataType type,
                                             std::span<const std::byte> value);

/// The reverse, for writing `entry`. Integers may also come as text such as "0x1F". Refuses what is
/// no value of the entry's type; the range the dictionary checks.
[[nodiscard]] base::Expected<std::vector<std::byte>, dictionary::Refusal> to_bytes(
    const dictionary::Entry& entry, const nlohmann::ordered_json& value);

}  // namespace stator::web
