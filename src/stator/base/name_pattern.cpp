#include "stator/base/name_pattern.hpp"

#include <cstddef>

namespace stator::base {

namespace {

constexpr std::size_t kNone = std::string_view::npos;

char as_is(char letter) {
  return letter;
}

char lower(char letter) {
  return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
}

/// Where the pattern goes on if what stands at `at` takes `letter`; kNone: it does not.
template <auto Folded>
std::size_t take(std::string_view pattern, std::size_t at, char letter) {
  const char wanted = pattern[at];
  if (wanted == '?') {
    return at + 1;
  }
  const std::size_t first = at + 1 + (at + 1 < pattern.size() && pattern[at + 1] == '!' ? 1U : 0U);
  const std::size_t close = wanted == '[' ? pattern.find(']', first + 1) : kNone;
  if (close == kNone) {  // a bracket that is not closed stands for itself
    return Folded(wanted) == Folded(letter) ? at + 1 : kNone;
  }
  bool found = false;
  for (std::size_t i = first; i < close; ++i) {
    const char low = Folded(pattern[i]);
    char high = low;
    if (i + 2 < close && pattern[i + 1] == '-') {
      i += 2;
      high = Folded(pattern[i]);
    }
    found = found || (Folded(letter) >= low && Folded(letter) <= high);
  }
  return found != (pattern[at + 1] == '!') ? close + 1 : kNone;
}

// Only the last star needs to be tried again: whatever an earlier one took more, the later could
// take as well.
template <auto Folded>
bool fits(std::string_view pattern, std::string_view name) {
  std::size_t at = 0;
  std::size_t star = kNone;
  std::size_t after_star = 0;
  for (std::size_t i = 0; i < name.size();) {
    if (at < pattern.size() && pattern[at] == '*') {
      star = at++;
      after_star = i;
      continue;
    }
    const std::size_t next = at < pattern.size() ? take<Folded>(pattern, at, name[i]) : kNone;
    if (next != kNone) {
      at = next;
      ++i;
    } else if (star != kNone) {
      at = star + 1;
      i = ++after_star;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', at) == kNone;
}

}  // namespace

bool matches(std::string_view pattern, std::string_view name) {
  return fits<as_is>(pattern, name);
}

bool matches_in_any_case(std::string_view pattern, std::string_view name) {
  return fits<lower>(pattern, name);
}

}  // namespace stator::base
