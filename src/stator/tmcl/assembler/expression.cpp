#include "stator/tmcl/assembler/expression.hpp"

#include <cstddef>
#include <optional>
#include <utility>

namespace stator::tmcl {

namespace {

/// 2^31: a number before its sign is known.
constexpr std::int64_t kLimit = std::int64_t{1} << 31;
/// Parentheses within parentheses; a bound for the stack.
constexpr int kDeepest = 64;

class Parser {
 public:
  Parser(std::span<const Token> tokens, const NameScope& names) : tokens_(tokens), names_(names) {}

  base::Expected<std::int64_t, ExpressionError> whole() {
    const std::optional<std::int64_t> value = sum();
    if (value && position_ + 1 < tokens_.size()) {
      fail("found " + quoted(token()) + "; expected an operator, a comma or the end of the line");
    }
    if (error_) {
      return base::Unexpected{*std::move(error_)};
    }
    return *value;
  }

 private:
  using Value = std::optional<std::int64_t>;

  [[nodiscard]] const Token& token() const { return tokens_[position_]; }
  [[nodiscard]] bool at(std::string_view sign) const {
    return token().kind == TokenKind::punctuation && token().text == sign;
  }

  Value sum() {
    Value left = product();
    while (left && (at("+") || at("-"))) {
      const bool minus = at("-");
      const Token& sign = tokens_[position_++];
      const Value right = product();
      left = right ? checked(minus ? *left - *right : *left + *right, sign) : std::nullopt;
    }
    return left;
  }

  Value product() {
    Value left = factor();
    while (left && (at("*") || at("/"))) {
      const bool division = at("/");
      const Token& sign = tokens_[position_++];
      const Value right = factor();
      if (right && division && *right == 0) {
        return fail("division by zero", sign);
      }
      left = right ? checked(division ? *left / *right : *left * *right, sign) : std::nullopt;
    }
    return left;
  }

  Value factor() {
    bool negative = false;
    while (at("-") || at("+")) {
      negative = negative != at("-");
      ++position_;
    }
    const Value value = atom();
    return value && negative ? Value(-*value) : value;
  }

  Value atom() {
    const Token& first = token();
    if (first.kind == TokenKind::number) {
      ++position_;
      return checked(first.value, first);
    }
    if (first.kind == TokenKind::name) {
      ++position_;
      const auto value = names_.value_of(first.text);
      return value ? checked(*value, first) : fail(value.error(), first);
    }
    if (at("(")) {
      return parenthesis();
    }
    if (first.kind == TokenKind::bad_number) {
      return fail(quoted(first) + " is no number of 32 bits");
    }
    return fail("found " + quoted(first) + "; expected a number or a name");
  }

  Value parenthesis() {
    if (++depth_ > kDeepest) {
      return fail("more than " + std::to_string(kDeepest) + " parentheses within another");
    }
    ++position_;
    const Value value = sum();
    --depth_;
    if (!value) {
      return value;
    }
    if (!at(")")) {
      return fail("found " + quoted(token()) + "; expected \")\"");
    }
    ++position_;
    return value;
  }

  Value checked(std::int64_t value, const Token& where) {
    if (value < -kLimit || value > kLimit) {
      return fail(std::to_string(value) + " is beyond 32 bits", where);
    }
    return value;
  }

  Value fail(std::string message) { return fail(std::move(message), token()); }
  Value fail(std::string message, const Token& where) {
    error_ = ExpressionError{where, std::move(message)};
    return std::nullopt;
  }

  std::span<const Token> tokens_;
  const NameScope& names_;
  std::size_t position_ = 0;
  int depth_ = 0;
  std::optional<ExpressionError> error_;
};

}  // namespace

base::Expected<std::int64_t, ExpressionError> value_of_expression(std::span<const Token> tokens,
                                                                  const NameScope& names) {
  return Parser(tokens, names).whole();
}

std::string quoted(const Token& token) {
  return token.kind == TokenKind::end ? "the end of the line" : '"' + std::string(token.text) + '"';
}

}  // namespace stator::tmcl
