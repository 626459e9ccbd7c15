#include "stator/board/peripheral/settings.hpp"

#include <stdexcept>

namespace stator::board {

namespace {

std::string quoted(std::string_view text) {
  return '"' + std::string(text) + '"';
}

}  // namespace

Settings::Settings(const PeripheralType& type) : type_(&type) {
  for (const ParameterDeclaration& parameter : type.parameters) {
    numbers_.push_back(parameter.value);
    texts_.emplace_back(parameter.text);
  }
}

std::size_t Settings::declared(std::string_view parameter, bool is_text) const {
  const auto found = find_declared(type_->parameters, parameter);
  if (!found) {
    throw std::invalid_argument("a " + std::string(type_->name) + " has no parameter " +
                                quoted(parameter));
  }
  if (type_->parameters[*found].is_text != is_text) {
    throw std::invalid_argument(quoted(parameter) +
                                (is_text ? " takes a number" : " takes a text"));
  }
  return *found;
}

void Settings::set(std::string_view parameter, double value) {
  const std::size_t k = declared(parameter, false);
  const ParameterDeclaration& declaration = type_->parameters[k];
  if (!(value >= declaration.minimum && value <= declaration.maximum)) {
    throw std::invalid_argument(quoted(parameter) + " is out of range");
  }
  numbers_[k] = value;
}

void Settings::set(std::string_view parameter, std::string_view text) {
  texts_[declared(parameter, true)] = text;
}

std::size_t Settings::index_of(std::string_view parameter, bool is_text) const {
  const auto found = find_declared(type_->parameters, parameter);
  if (!found || type_->parameters[*found].is_text != is_text) {
    throw std::logic_error("the model of a " + std::string(type_->name) +
                           " reads a parameter it does not declare: " + std::string(parameter));
  }
  return *found;
}

double Settings::number(std::string_view parameter) const {
  return numbers_[index_of(parameter, false)];
}

const std::string& Settings::text(std::string_view parameter) const {
  return texts_[index_of(parameter, true)];
}

}  // namespace stator::board
