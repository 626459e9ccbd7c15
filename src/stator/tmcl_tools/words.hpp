// Splits command lines of the TMCL tools into words, and takes the file's name out of a path.
#pragma once

#include <algorithm>
#include <string_view>

namespace stator::tmcl_tools {

inline constexpr std::string_view kSpaces = " \t\r\n";

/// Without spaces at both ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kSpaces);
  return begin == std::string_view::npos
             ? std::string_view()
             : text.substr(begin, text.find_last_not_of(kSpaces) - begin + 1);
}

/// Up to the first space.
[[nodiscard]] inline std::string_view first_word(std::string_view text) {
  return text.substr(0, std::min(text.find_first_of(kSpaces), text.size()));
}

/// What follows the first word.
[[nodiscard]] inline std::string_view after_first_word(std::string_view text) {
  return trimmed(text.substr(first_word(text).size()));
}

/// A path's last part.
[[nodiscard]] inline std::string_view file_name(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

}  // namespace stator::tmcl_tools
