// Default and legal values of objects, by <DefaultData>, <DefaultValue>, <DefaultString> and their
// like for minimum and maximum.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "stator/dictionary/data_type.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/formats/esi/esi_types.hpp"

namespace stator::formats {

/// A number as the dictionary keeps it, and what was wrong with it.
struct EsiValue {
  dictionary::Number number;
  std::string repaired;  ///< a sentence, or empty
};

/// A number of a type from elements that a node may have: `data` little-endian bytes, `value` a
/// number. Nothing if there is none that can be read.
[[nodiscard]] std::optional<EsiValue> esi_value(pugi::xml_node node, dictionary::DataType type,
                                                const char* data, const char* value,
                                                const char* text);

/// A string's bytes from <DefaultData>, <DefaultValue> or <DefaultString>. Nothing without them.
[[nodiscard]] std::optional<std::string> esi_string(pugi::xml_node node, dictionary::DataType type);

/// A number out of the bytes of a whole object.
[[nodiscard]] std::uint64_t esi_bits_at(const std::vector<std::byte>& bytes, std::size_t bit_offset,
                                        std::size_t bits);

/// Extends so many bits to 64 as the type says.
[[nodiscard]] std::uint64_t esi_extended(dictionary::DataType type, std::uint64_t bits);

/// The range that a node gives for a type, nothing if it gives none or none that can be.
[[nodiscard]] std::optional<dictionary::Range> esi_range(pugi::xml_node node,
                                                         dictionary::DataType type);

}  // namespace stator::formats
