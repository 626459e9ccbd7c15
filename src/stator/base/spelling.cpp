#include "stator/base/spelling.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace stator::base {

namespace {

/// Longer words are not compared, which bounds the work on text of any length.
constexpr std::size_t kLongestWord = 100;
/// A word that is similar to one of kLongestWord characters is at most this long.
constexpr std::size_t kLongestAlike = 2 * kLongestWord;

/// Number of edits that turn `a` into `b`: a character put in, left out or replaced, or two
/// neighbours exchanged (Damerau and Levenshtein, no part edited twice). Neither is longer than
/// kLongestAlike.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  const auto same = [&](std::size_t i, std::size_t j) { return capital(a[i]) == capital(b[j]); };
  using Row = std::array<std::size_t, kLongestAlike + 1>;
  std::array<Row, 3> rows{};  // the present one and the two before it
  std::iota(rows[0].begin(), rows[0].begin() + static_cast<std::ptrdiff_t>(b.size() + 1),
            std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Row& before_last = rows[(i + 2) % 3];
    const Row& last = rows[i % 3];
    Row& row = rows[(i + 1) % 3];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({row[j] + 1, last[j + 1] + 1, last[j] + (same(i, j) ? 0 : 1)});
      if (i > 0 && j > 0 && same(i, j - 1) && same(i - 1, j)) {
        row[j + 1] = std::min(row[j + 1], before_last[j - 1] + 1);
      }
    }
  }
  return rows[a.size() % 3][b.size()];
}

/// As many leading characters tell which long name is meant.
constexpr std::size_t kBeginning = 4;

bool begins_with(std::string_view name, std::string_view beginning) {
  return name.size() >= beginning.size() && same_word(name.substr(0, beginning.size()), beginning);
}

}  // namespace

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, capital, capital);
}

std::string_view closest_match(std::string_view word, std::span<const std::string_view> known) {
  if (word.size() > kLongestWord) {
    return {};
  }
  std::string_view best;
  std::size_t best_distance = std::min(word.size() / 3 + 2, word.size());
  for (const std::string_view candidate : known) {
    const std::size_t longer = std::max(word.size(), candidate.size());
    if (longer - std::min(word.size(), candidate.size()) >= best_distance) {
      continue;  // that many edits at least
    }
    if (const std::size_t distance = edit_distance(word, candidate); distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  if (best.empty() && word.size() >= kBeginning) {  // a part number cut short
    const auto longer =
        std::ranges::find_if(known, [&](std::string_view name) { return begins_with(name, word); });
    return longer != known.end() ? *longer : std::string_view();
  }
  return best;
}

}  // namespace stator::base
