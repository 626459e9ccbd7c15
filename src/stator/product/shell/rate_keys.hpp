#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/settings/key.hpp"

namespace stator::product {

/// Reads a rate of which `who`, e.g. "the drive", knows only some: its place in `rates`, which are
/// in the key's unit. Nothing: it is not given, or refused with those that are known.
[[nodiscard]] std::optional<std::size_t> read_rate(const settings::KeyWords& key,
                                                   settings::Reader& reader,
                                                   settings::WholeRange range,
                                                   std::span<const std::int64_t> rates,
                                                   std::string_view who);

}  // namespace stator::product
