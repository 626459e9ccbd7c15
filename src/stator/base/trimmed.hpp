// Texts without what stands around them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace stator::base {

/// The part of `text` from its first to its last character that is none of `spaces`; empty if there
/// is none.
[[nodiscard]] constexpr std::string_view trimmed(std::string_view text, std::string_view spaces) {
  const std::size_t begin = std::min(text.find_first_not_of(spaces), text.size());
  return text.substr(begin, text.find_last_not_of(spaces) + 1 - begin);
}

}  // namespace stator::base
