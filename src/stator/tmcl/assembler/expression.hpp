#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "stator/base/expected.hpp"
#include "stator/tmcl/assembler/lexer.hpp"

namespace stator::tmcl {

/// Why an expression has no value: the token it fails at and a sentence.
struct ExpressionError {
  Token at;
  std::string message;  ///< empty if it has been told elsewhere
};

/// Names an expression may contain.
class NameScope {
 public:
  virtual ~NameScope() = default;
  /// The value of the name, or what to tell about it.
  [[nodiscard]] virtual base::Expected<std::int64_t, std::string> value_of(
      std::string_view name) const = 0;
};

/// The value of a sum of products of numbers, names and parentheses. Every intermediate result has
/// to stay within -2147483648..2147483648; division cuts the fraction off. The last of `tokens` is
/// what ends the expression, a comma or the end of the line.
[[nodiscard]] base::Expected<std::int64_t, ExpressionError> value_of_expression(
    std::span<const Token> tokens, const NameScope& names);

/// What a token is, for messages: "\"=\"", or "the end of the line".
[[nodiscard]] std::string quoted(const Token& token);

}  // namespace stator::tmcl
