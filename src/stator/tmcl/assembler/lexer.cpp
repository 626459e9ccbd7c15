#include "stator/tmcl/assembler/lexer.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>

namespace stator::tmcl {

namespace {

constexpr std::string_view kPunctuation = ",:=+-*/()";

constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
constexpr bool is_word_part(char c) {
  return begins_name(c) || is_digit(c);
}
constexpr bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}
/// Of a character of several bytes in UTF-8, all but the first.
constexpr bool continues_character(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

class Lexer {
 public:
  explicit Lexer(std::string_view line) : line_(line) {}

  std::vector<Token> tokens() {
    std::vector<Token> tokens;
    do {
      tokens.push_back(next());
    } while (tokens.back().kind != TokenKind::end);
    return tokens;
  }

 private:
  [[nodiscard]] char current(std::size_t ahead = 0) const {
    return position_ + ahead < line_.size() ? line_[position_ + ahead] : '\0';
  }

  Token next() {
    while (position_ < line_.size() && is_space(line_[position_])) {
      ++position_;
    }
    if (position_ >= line_.size() || line_.substr(position_).starts_with("//")) {
      return take(TokenKind::end, 0);
    }
    if (begins_name(current())) {
      return take(TokenKind::name, word_length(0));
    }
    if (is_digit(current()) || current() == '$') {
      return number();
    }
    if (kPunctuation.find(current()) != std::string_view::npos) {
      return take(TokenKind::punctuation, 1);
    }
    std::size_t length = 1;
    while (position_ + length < line_.size() && continues_character(current(length))) {
      ++length;
    }
    return take(TokenKind::unknown, length);
  }

  Token number() {
    const std::size_t prefix = current() == '$'                                 ? 1
                               : current() == '0' && (current(1) | 0x20) == 'x' ? 2
                                                                                : 0;
    const std::size_t length = word_length(prefix);
    const std::string_view digits = line_.substr(position_ + prefix, length - prefix);
    std::uint32_t value = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value, prefix > 0 ? 16 : 10);
    const bool valid = error == std::errc() && end == digits.data() + digits.size();
    Token token = take(valid ? TokenKind::number : TokenKind::bad_number, length);
    token.value = prefix > 0 ? std::int64_t{static_cast<std::int32_t>(value)} : std::int64_t{value};
    return token;
  }

  /// Of letters and digits that stand together, `prefix` characters included.
  [[nodiscard]] std::size_t word_length(std::size_t prefix) const {
    std::size_t length = prefix;
    while (is_word_part(current(length))) {
      ++length;
    }
    return length;
  }

  Token take(TokenKind kind, std::size_t length) {
    const std::string_view skipped = line_.substr(counted_, position_ - counted_);
    column_ += static_cast<std::size_t>(
        std::ranges::count_if(skipped, [](char c) { return !continues_character(c); }));
    counted_ = position_;
    const Token token{.kind = kind, .text = line_.substr(position_, length), .column = column_};
    position_ += length;
    return token;
  }

  std::string_view line_;
  std::size_t position_ = 0;
  std::size_t counted_ = 0;  ///< up to where column_ has counted
  std::size_t column_ = 1;
};

}  // namespace

std::vector<Token> tokens_of(std::string_view line) {
  return Lexer(line).tokens();
}

}  // namespace stator::tmcl
