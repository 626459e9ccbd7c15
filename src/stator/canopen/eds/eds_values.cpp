#include "stator/canopen/eds/eds_values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "stator/base/spelling.hpp"
#include "stator/base/trimmed.hpp"

namespace stator::canopen {

namespace {

using base::same_word;
using dictionary::Access;
using dictionary::DataType;
using dictionary::PdoMapping;

constexpr bool is_space(char c) {
  return c == ' ' || c == '\t';
}

constexpr bool is_decimal_digit(char c) {
  return c >= '0' && c <= '9';
}

/// 0..15, or 16 for no digit.
constexpr unsigned digit_value(char c) {
  if (is_decimal_digit(c)) {
    return static_cast<unsigned>(c - '0');
  }
  const char letter = base::capital(c);
  return letter >= 'A' && letter <= 'F' ? static_cast<unsigned>(letter - 'A') + 10 : 16;
}

bool all_digits_below(std::string_view text, unsigned limit) {
  return !text.empty() &&
         std::ranges::all_of(text, [limit](char c) { return digit_value(c) < limit; });
}

bool has_hexadecimal_prefix(std::string_view text) {
  return text.size() > 2 && text[0] == '0' && base::capital(text[1]) == 'X';
}

/// Digits that all are of the base.
EdsNumber number_of_digits(std::string_view digits, unsigned base) {
  EdsNumber number;
  for (const char c : digits) {
    const std::uint64_t digit = digit_value(c);
    constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
    number.too_large = number.too_large || number.bits > (kLargest - digit) / base;
    number.bits = number.bits * base + digit;
  }
  number.hexadecimal = base == 16;
  return number;
}

/// A number without sign.
std::optional<EdsNumber> parse_plain(std::string_view text) {
  if (has_hexadecimal_prefix(text)) {
    // "0x10UL" comes from people who program.
    std::string_view digits = text.substr(2);
    while (!digits.empty() &&
           (base::capital(digits.back()) == 'U' || base::capital(digits.back()) == 'L')) {
      digits.remove_suffix(1);
    }
    return all_digits_below(digits, 16) ? std::optional(number_of_digits(digits, 16))
                                        : std::nullopt;
  }
  if (all_digits_below(text, 10)) {
    if (text.size() == 1 || text.front() != '0') {
      return number_of_digits(text, 10);
    }
    const bool octal = all_digits_below(text, 8);
    EdsNumber number = number_of_digits(text, octal ? 8 : 10);
    if (!octal) {
      number.spelling = NumberSpelling::leading_zero;
    } else if (number.bits > 7) {  // else it is the same in every base
      number.spelling = NumberSpelling::octal;
    }
    return number;
  }
  std::string_view digits = text;
  if (!digits.empty() && base::capital(digits.back()) == 'H') {
    digits.remove_suffix(1);
  }
  if (!all_digits_below(digits, 16)) {
    return std::nullopt;
  }
  EdsNumber number = number_of_digits(digits, 16);
  number.spelling = NumberSpelling::bare_hexadecimal;
  return number;
}

std::string_view without_comment(std::string_view text) {
  return trimmed(text.substr(0, text.find(';')));
}

/// Adds one term of a sum; false if it is none.
bool add_term(EdsNumber& sum, std::string_view term, bool negative) {
  if (same_word(term, "$NODEID")) {
    const bool first = !sum.node_id_relative;
    sum.node_id_relative = true;
    return first && !negative;
  }
  const std::optional<EdsNumber> number = parse_plain(term);
  if (!number) {
    return false;
  }
  sum.bits += negative ? std::uint64_t{0} - number->bits : number->bits;
  sum.negative = sum.negative || (negative && number->bits != 0);
  sum.hexadecimal = sum.hexadecimal || number->hexadecimal;
  sum.too_large = sum.too_large || number->too_large;
  if (number->spelling != NumberSpelling::standard) {
    sum.spelling = number->spelling;
  }
  return true;
}

struct AccessWord {
  std::string_view word;
  EdsAccess access;
};

// CiA 306-1 §4.6.3.2: rwr is for process input, which the device transmits, rww for process output.
constexpr std::array<AccessWord, 17> kAccessWords{{
    {"ro", {Access::read_only, PdoMapping::transmit}},
    {"r", {Access::read_only, PdoMapping::transmit}},
    {"read", {Access::read_only, PdoMapping::transmit}},
    {"readonly", {Access::read_only, PdoMapping::transmit}},
    {"wo", {Access::write_only, PdoMapping::receive}},
    {"w", {Access::write_only, PdoMapping::receive}},
    {"write", {Access::write_only, PdoMapping::receive}},
    {"writeonly", {Access::write_only, PdoMapping::receive}},
    {"rw", {Access::read_write, PdoMapping::both}},
    {"wr", {Access::read_write, PdoMapping::both}},
    {"readwrite", {Access::read_write, PdoMapping::both}},
    {"rwr", {Access::read_write, PdoMapping::transmit}},
    {"readwriteinput", {Access::read_write, PdoMapping::transmit}},
    {"rww", {Access::read_write, PdoMapping::receive}},
    {"readwriteoutput", {Access::read_write, PdoMapping::receive}},
    {"const", {Access::constant, PdoMapping::no}},
    {"constant", {Access::constant, PdoMapping::no}},
}};

/// How many bytes the character at the beginning has in UTF-8; 0 if it is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) {
    return 1;
  }
  const std::size_t length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) {
    return 0;
  }
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) {
      return 0;
    }
  }
  // Spelt longer than needed, halves of UTF-16 pairs, beyond the last character.
  const unsigned second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) {
    return 0;
  }
  return length;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  return base::trimmed(text, " \t");
}

std::optional<EdsNumber> parse_eds_number(std::string_view text) {
  std::string_view rest = without_comment(text);
  EdsNumber sum;
  bool first = true;
  do {
    bool negative = false;
    if (!rest.empty() && (rest.front() == '+' || rest.front() == '-')) {
      negative = rest.front() == '-';
      rest = trimmed(rest.substr(1));
    } else if (!first) {
      return std::nullopt;
    }
    const std::size_t length = std::min(rest.find_first_of("+-"), rest.size());
    if (!add_term(sum, trimmed(rest.substr(0, length)), negative)) {
      return std::nullopt;
    }
    rest.remove_prefix(length);
    first = false;
  } while (!rest.empty());
  return sum;
}

std::optional<std::uint32_t> parse_hexadecimal(std::string_view text) {
  text = trimmed(text);
  if (has_hexadecimal_prefix(text)) {
    text.remove_prefix(2);
  }
  if (!all_digits_below(text, 16)) {
    return std::nullopt;
  }
  const EdsNumber number = number_of_digits(text, 16);
  if (number.too_large || number.bits > std::numeric_limits<std::uint32_t>::max()) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(number.bits);
}

std::optional<double> parse_eds_real(std::string_view text) {
  std::string number(without_comment(text));
  if (number.starts_with('+')) {
    number.erase(0, 1);
  }
  std::ranges::replace(number, ',', '.');
  if (!number.empty() && base::capital(number.back()) == 'F' && number.size() > 1 &&
      is_decimal_digit(number[number.size() - 2])) {
    number.pop_back();  // "1.5f"
  }
  double value = 0.0;
  const char* const end = number.data() + number.size();
  const auto [behind, error] = std::from_chars(number.data(), end, value);
  return error == std::errc() && behind == end ? std::optional(value) : std::nullopt;
}

std::optional<std::string> parse_octets(std::string_view text) {
  std::string octets;
  std::string_view rest = without_comment(text);
  while (!rest.empty()) {
    const std::size_t length = std::min(rest.find_first_of(" \t,"), rest.size());
    std::string_view word = rest.substr(0, length);
    rest.remove_prefix(length);
    while (!rest.empty() && (is_space(rest.front()) || rest.front() == ',')) {
      rest.remove_prefix(1);
    }
    if (has_hexadecimal_prefix(word)) {
      word.remove_prefix(2);
    }
    if (!all_digits_below(word, 16)) {
      return std::nullopt;
    }
    // An odd digit stands before pairs of them.
    unsigned high = 0;
    for (std::size_t i = word.size() % 2 == 0 ? 0 : 1; const char c : word) {
      const unsigned digit = digit_value(c);
      if (i++ % 2 == 0) {
        high = digit;
      } else {
        octets += static_cast<char>(high << 4 | digit);
      }
    }
  }
  return octets.empty() ? std::nullopt : std::optional(std::move(octets));
}

std::optional<bool> parse_flag(std::string_view text) {
  text = without_comment(text);
  if (text.empty() || same_word(text, "false") || same_word(text, "no")) {
    return false;
  }
  if (same_word(text, "true") || same_word(text, "yes")) {
    return true;
  }
  const std::optional<EdsNumber> number = parse_eds_number(text);
  return number ? std::optional(number->bits != 0) : std::nullopt;
}

FittedNumber fit_number(DataType type, const EdsNumber& number) {
  if (type == DataType::boolean) {
    return {number.bits == 0 ? std::uint64_t{0} : std::uint64_t{1},
            !number.too_large && number.bits <= 1};
  }
  const std::size_t length = bit_length(type);
  const bool with_sign = is_signed(type);
  if (length >= 64 || length == 0) {
    const bool top = (number.bits >> 63) != 0;
    // In hexadecimal, all bits of a signed number may be written.
    const bool fits =
        with_sign ? (number.negative ? top : !top || number.hexadecimal) : !number.negative;
    return {number.bits, fits && !number.too_large};
  }
  const std::uint64_t mask = (std::uint64_t{1} << length) - 1;
  std::uint64_t bits = number.bits & mask;
  if (!with_sign) {
    return {bits, bits == number.bits && !number.negative && !number.too_large};
  }
  if ((bits >> (length - 1)) != 0) {
    bits |= ~mask;
  }
  const bool all_bits = number.hexadecimal && !number.negative && (number.bits & ~mask) == 0;
  // A decimal number of 64 bits is not the negative one that has the same bits.
  const bool same =
      bits == number.bits && (number.negative || number.hexadecimal || (number.bits >> 63) == 0);
  return {bits, (same || all_bits) && !number.too_large};
}

std::uint64_t real_bits(DataType type, double value) {
  if (type == DataType::real64) {
    return std::bit_cast<std::uint64_t>(value);
  }
  // A number beyond the type becomes infinite, which a conversion alone does not promise.
  constexpr double kLargest = std::numeric_limits<float>::max();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float number = 0.0F;
  if (std::abs(value) > kLargest) {
    number = std::copysign(kInfinity, value < 0 ? -1.0F : 1.0F);
  } else {
    number = static_cast<float>(value);
  }
  return std::bit_cast<std::uint32_t>(number);
}

std::optional<DataType> data_type_of(std::uint32_t number) {
  // ETG.1000.6 has names of its own for one bit and for eight.
  if (number == 0x30) {
    return DataType::boolean;
  }
  if (number == 0x37) {
    return DataType::unsigned8;
  }
  if (number > std::numeric_limits<std::uint16_t>::max()) {
    return std::nullopt;
  }
  const auto type = static_cast<DataType>(number);
  return std::string_view(to_text(type)) == "?" ? std::nullopt : std::optional(type);
}

std::optional<EdsAccess> parse_access(std::string_view word) {
  word = without_comment(word);
  const auto found = std::ranges::find_if(
      kAccessWords, [word](const AccessWord& known) { return same_word(known.word, word); });
  return found != kAccessWords.end() ? std::optional(found->access) : std::nullopt;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0) {
      return false;
    }
    text.remove_prefix(length);
  }
  return true;
}

std::string utf8_of_latin1(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80) {
      result += c;
    } else {
      result += static_cast<char>(0xC0U | (byte >> 6U));
      result += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return result;
}

std::string readable_text(std::string_view text) {
  std::string result = is_utf8(text) ? std::string(text) : utf8_of_latin1(text);
  for (char& c : result) {
    if (c == '\t') {
      c = ' ';
    } else if (static_cast<unsigned char>(c) < 0x20 || c == '\x7F') {
      c = '?';
    }
  }
  return result;
}

std::string hexadecimal_text(std::uint64_t value, std::size_t digits) {
  std::string text;
  while (value != 0 || text.size() < digits) {
    text += "0123456789ABCDEF"[value & 0xF];
    value >>= 4;
  }
  std::ranges::reverse(text);
  return text;
}

}  // namespace stator::canopen
