// Values as ESI files write them: numbers, truths, bytes and names, in all the ways there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

namespace stator::formats {

/// Of an object: a subindex is a byte.
inline constexpr std::size_t kHighestSubindex = 255;

/// A whole number with what its spelling tells.
struct EsiNumber {
  std::uint64_t bits = 0;    ///< two's complement
  bool hexadecimal = false;  ///< written so
  bool cut = false;          ///< it had more than 64 bits
};

/// Reads "12", "-3", "#x1A", "0x1A", "1Ah", "2E" without prefix, with zeros before it and spaces
/// around it; nothing if it is none of these.
[[nodiscard]] std::optional<EsiNumber> esi_number(std::string_view text);

/// A number of at most `limit`, nothing if there is none or it is larger.
[[nodiscard]] std::optional<std::uint64_t> esi_number_up_to(std::string_view text,
                                                            std::uint64_t limit);

/// Reads "1", "true", "TRUE", "0", "false"; `otherwise` if it is none of these.
[[nodiscard]] bool esi_truth(std::string_view text, bool otherwise);

/// Reads pairs of hexadecimal digits with or without spaces between them; nothing if it has other
/// characters or a digit alone.
[[nodiscard]] std::optional<std::vector<std::byte>> esi_bytes(std::string_view text);

/// Without spaces and line feeds around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// What people read: spaces and line feeds made one space, no other control characters, valid
/// UTF-8, not longer than anybody reads.
[[nodiscard]] std::string readable(std::string_view text);

/// Whether two words are the same but for capitals.
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);

/// The text of a child element, trimmed; empty if there is none.
[[nodiscard]] std::string_view child_text(pugi::xml_node node, const char* name);

/// The text of an attribute, trimmed; empty if there is none.
[[nodiscard]] std::string_view attribute_text(pugi::xml_node node, const char* name);

/// Of the children <Name> the English one, else the first, for people.
[[nodiscard]] std::string esi_name(pugi::xml_node node);

}  // namespace stator::formats
