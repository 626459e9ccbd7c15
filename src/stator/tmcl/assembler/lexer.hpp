// Splits a line of a TMCL program into tokens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace stator::tmcl {

enum class TokenKind : std::uint8_t {
  name,         ///< a letter or underscore, then also digits
  number,       ///< 12, 0x1F or $1F, of at most 32 bits
  punctuation,  ///< one of , : = + - * / ( )
  bad_number,   ///< begins like one: 12k, or of more than 32 bits
  unknown,      ///< what no line of a program contains
  end,          ///< of the line
};

struct Token {
  TokenKind kind = TokenKind::end;
  std::string_view text{};  ///< of the line
  std::size_t column = 1;   ///< from 1; characters
  std::int64_t value = 0;   ///< of a number
};

/// A line of a program without its comment, as tokens; the last has the kind `end`. The tokens
/// point into `line`. Hexadecimal numbers are patterns of 32 bits: $FFFFFFFF is -1.
[[nodiscard]] std::vector<Token> tokens_of(std::string_view line);

}  // namespace stator::tmcl
