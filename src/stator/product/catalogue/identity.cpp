#include "stator/product/catalogue/identity.hpp"

#include <algorithm>

namespace stator::product {

std::string Identity::name() const {
  std::string name = type;
  std::ranges::transform(name, name.begin(), [](char letter) {
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  });
  return name;
}

std::vector<std::string> Identity::serial_interface_names() const {
  std::vector<std::string> names;
  for (const SerialInterface& interface : serial_interfaces) {
    names.push_back(interface.name);
  }
  return names;
}

}  // namespace stator::product
