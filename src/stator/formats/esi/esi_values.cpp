#include "stator/formats/esi/esi_values.hpp"

#include <algorithm>
#include <cctype>

#include "stator/base/trimmed.hpp"
#include "stator/formats/esi/esi_encoding.hpp"

namespace stator::formats {

namespace {

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Value of a hexadecimal digit, -1 for other characters.
int digit_value(char c) {
  if (is_digit(c)) {
    return c - '0';
  }
  const char letter = lower(c);
  return letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

bool all_hexadecimal(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return digit_value(c) >= 0; });
}

/// The digits of a hexadecimal number; empty if it is none.
std::string_view hexadecimal_digits(std::string_view text) {
  bool prefix = false;
  for (const char first : {'#', '0'}) {  // some write "#x0x6040"
    if (text.size() > 2 && text[0] == first && lower(text[1]) == 'x') {
      text.remove_prefix(2);
      prefix = true;
    }
  }
  if (!prefix) {
    if (text.size() > 1 && lower(text.back()) == 'h') {
      text.remove_suffix(1);
    } else if (std::ranges::all_of(text, is_digit)) {
      return {};
    }
  }
  text = trimmed(text);
  return all_hexadecimal(text) ? text : std::string_view();
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  return base::trimmed(text, " \t\r\n");
}

std::optional<EsiNumber> esi_number(std::string_view text) {
  text = trimmed(text);
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) {
    text = trimmed(text.substr(1));
  }
  if (text.empty()) {
    return std::nullopt;
  }
  EsiNumber number;
  const std::string_view digits = hexadecimal_digits(text);
  number.hexadecimal = !digits.empty();
  if (!number.hexadecimal && !std::ranges::all_of(text, is_digit)) {
    return std::nullopt;
  }
  const std::uint64_t base = number.hexadecimal ? 16 : 10;
  for (const char c : number.hexadecimal ? digits : text) {
    const auto digit = static_cast<std::uint64_t>(digit_value(c));
    number.cut = number.cut || number.bits > (UINT64_MAX - digit) / base;
    number.bits = number.bits * base + digit;
  }
  if (negative) {
    number.bits = ~number.bits + 1;
  }
  return number;
}

std::optional<std::uint64_t> esi_number_up_to(std::string_view text, std::uint64_t limit) {
  const std::optional<EsiNumber> number = esi_number(text);
  if (!number || number->cut || number->bits > limit) {
    return std::nullopt;
  }
  return number->bits;
}

bool esi_truth(std::string_view text, bool otherwise) {
  text = trimmed(text);
  if (same_word(text, "true") || same_word(text, "yes")) {
    return true;
  }
  if (same_word(text, "false") || same_word(text, "no")) {
    return false;
  }
  const std::optional<EsiNumber> number = esi_number(text);
  return number ? number->bits != 0 : otherwise;
}

std::optional<std::vector<std::byte>> esi_bytes(std::string_view text) {
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 2);
  int high = -1;
  for (const char c : text) {
    if (is_space(c)) {
      continue;
    }
    const int digit = digit_value(c);
    if (digit < 0) {
      return std::nullopt;
    }
    if (high < 0) {
      high = digit;
    } else {
      bytes.push_back(static_cast<std::byte>(high * 16 + digit));
      high = -1;
    }
  }
  if (high >= 0) {
    return std::nullopt;
  }
  return bytes;
}

std::string readable(std::string_view text) {
  constexpr std::size_t kLongest = 250;
  std::string line;
  // One character takes at most four bytes; more of the text is not looked at.
  for (const char c : trimmed(text).substr(0, 4 * kLongest)) {
    if (is_space(c)) {
      if (!line.ends_with(' ')) {
        line.push_back(' ');
      }
    } else if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) {
      line.push_back(c);
    }
  }
  if (line.size() > kLongest) {
    std::size_t end = kLongest;
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) {
      --end;  // not within a character
    }
    line.resize(end);
  }
  return valid_utf8(trimmed(line));
}

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

std::string_view child_text(pugi::xml_node node, const char* name) {
  return trimmed(node.child_value(name));
}

std::string_view attribute_text(pugi::xml_node node, const char* name) {
  return trimmed(node.attribute(name).value());
}

std::string esi_name(pugi::xml_node node) {
  constexpr std::uint64_t kEnglish = 1033;
  pugi::xml_node chosen;
  for (const pugi::xml_node name : node.children("Name")) {
    if (trimmed(name.child_value()).empty()) {
      continue;
    }
    const auto language = esi_number(attribute_text(name, "LcId"));
    if (language && language->bits == kEnglish) {
      chosen = name;
      break;
    }
    if (!chosen) {
      chosen = name;
    }
  }
  // Tools that do not know better write the brackets of CDATA as characters.
  constexpr std::string_view kOpen = "<![CDATA[";
  constexpr std::string_view kClose = "]]>";
  std::string_view text = trimmed(chosen.child_value());
  if (text.starts_with(kOpen) && text.ends_with(kClose)) {
    text = text.substr(kOpen.size(), text.size() - kOpen.size() - kClose.size());
  }
  return readable(text);
}

}  // namespace stator::formats
