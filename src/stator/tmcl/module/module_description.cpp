#include "stator/tmcl/module/module_description.hpp"

#include <algorithm>

namespace stator::tmcl {

namespace {

const ParameterDeclaration* find(std::span<const ParameterDeclaration> declarations,
                                 std::uint8_t bank, std::uint8_t number) {
  const auto found = std::ranges::find_if(declarations, [&](const ParameterDeclaration& each) {
    return each.number == number && each.bank == bank;
  });
  return found != declarations.end() ? &*found : nullptr;
}

}  // namespace

const ParameterDeclaration* ModuleDescription::axis_parameter(std::uint8_t number) const {
  return find(axis_parameters, 0, number);
}

const ParameterDeclaration* ModuleDescription::global_parameter(std::uint8_t bank,
                                                                std::uint8_t number) const {
  return find(global_parameters, bank, number);
}

}  // namespace stator::tmcl
