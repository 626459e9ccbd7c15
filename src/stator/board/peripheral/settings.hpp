#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stator/board/peripheral/declaration.hpp"

namespace stator::board {

/// The values of a peripheral's parameters: the declared defaults until set otherwise.
class Settings {
 public:
  explicit Settings(const PeripheralType& type);

  /// Throw std::invalid_argument with one sentence: no such parameter, not of that kind, or out of
  /// range.
  void set(std::string_view parameter, double value);
  void set(std::string_view parameter, std::string_view text);

  /// Throw std::logic_error for what the type does not declare: a mistake in a model.
  [[nodiscard]] double number(std::string_view parameter) const;
  [[nodiscard]] bool flag(std::string_view parameter) const { return number(parameter) != 0.0; }
  [[nodiscard]] std::int64_t integer(std::string_view parameter) const {
    return static_cast<std::int64_t>(number(parameter));
  }
  [[nodiscard]] const std::string& text(std::string_view parameter) const;

 private:
  [[nodiscard]] std::size_t declared(std::string_view parameter, bool is_text) const;
  [[nodiscard]] std::size_t index_of(std::string_view parameter, bool is_text) const;

  const PeripheralType* type_;
  std::vector<double> numbers_;
  std::vector<std::string> texts_;
};

}  // namespace stator::board
