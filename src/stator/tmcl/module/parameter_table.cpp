#include "stator/tmcl/module/parameter_table.hpp"

#include <stdexcept>

namespace stator::tmcl {

ParameterTable::ParameterTable(std::span<const ParameterDeclaration> declarations)
    : declarations_(declarations) {
  if (declarations.size() >= kNone) {
    throw std::logic_error("TMCL: more than 65534 parameters in one table");
  }
  for (auto& bank : places_) {
    bank.fill(kNone);
  }
  for (std::size_t i = 0; i < declarations.size(); ++i) {
    const ParameterDeclaration& declaration = declarations[i];
    if (declaration.bank >= kBanks) {
      throw std::logic_error("TMCL: a parameter is declared in a bank above 3");
    }
    std::uint16_t& place = places_[declaration.bank][declaration.number];
    if (place != kNone) {
      throw std::logic_error("TMCL: two parameters have the same bank and number");
    }
    place = static_cast<std::uint16_t>(i);
  }
}

}  // namespace stator::tmcl
