// Words for numbers in the arguments and results of the package's functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "stator/settings/key.hpp"
#include "stator/settings/words.hpp"

namespace stator::python {

/// The number behind `word`; `what` says in messages what it is for. Throws std::runtime_error
/// naming the words there are.
template <std::size_t N>
std::int64_t number_of(const std::array<settings::Word, N>& words, const std::string& word,
                       const char* what) {
  std::set<std::string> names;
  for (const settings::Word& each : words) {
    if (each.name == word) {
      return each.value;
    }
    names.emplace(each.name);
  }
  throw std::runtime_error(fmt::format("there is no {} \"{}\"{}; there are: {}", what, word,
                                       settings::guess_text(word, names), settings::joined(names)));
}

/// The word for `number`; without one the number in digits.
template <std::size_t N>
std::string word_of(const std::array<settings::Word, N>& words, std::int64_t number) {
  for (const settings::Word& each : words) {
    if (each.value == number) {
      return std::string(each.name);
    }
  }
  return std::to_string(number);
}

}  // namespace stator::python
