#pragma once

#include <span>
#include <string_view>

namespace stator::base {

/// The entry of `known` that is most alike to `word`, else the first that begins with it; empty
/// when none is close. Letter case does not count. For "did you mean" in messages.
[[nodiscard]] std::string_view closest_match(std::string_view word,
                                             std::span<const std::string_view> known);

/// The same words, whatever the case of their letters a to z.
[[nodiscard]] bool same_word(std::string_view a, std::string_view b);

/// a to z as capitals; other characters as they are.
[[nodiscard]] constexpr char capital(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

}  // namespace stator::base
