#include "stator/tmcl/module/parameter_values.hpp"

#include <algorithm>

namespace stator::tmcl {

namespace {

std::vector<std::int32_t> initial_values(std::span<const ParameterDeclaration> declarations) {
  std::vector<std::int32_t> values;
  values.reserve(declarations.size());
  for (const ParameterDeclaration& declaration : declarations) {
    values.push_back(declaration.initial);
  }
  return values;
}

}  // namespace

ParameterValues::ParameterValues(std::span<const ParameterDeclaration> declarations)
    : declarations_(declarations),
      ram_(initial_values(declarations)),
      eeprom_(initial_values(declarations)) {}

void ParameterValues::store(std::size_t place) {
  eeprom_[place] = ram_[place];
  ++writes_;
}

void ParameterValues::power_on() {
  for (std::size_t i = 0; i < ram_.size(); ++i) {
    ram_[i] = declarations_[i].stored ? eeprom_[i] : declarations_[i].initial;
  }
}

void ParameterValues::restore_factory_settings() {
  for (std::size_t i = 0; i < eeprom_.size(); ++i) {
    eeprom_[i] = declarations_[i].initial;
  }
  ++writes_;
}

void ParameterValues::load_eeprom(std::span<const std::int32_t> values) {
  const std::size_t count = std::min(values.size(), eeprom_.size());
  for (std::size_t i = 0; i < count; ++i) {
    const ParameterDeclaration& declaration = declarations_[i];
    eeprom_[i] = declaration.range().contains(values[i]) ? values[i] : declaration.initial;
  }
}

}  // namespace stator::tmcl
