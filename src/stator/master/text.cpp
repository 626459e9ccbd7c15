#include "stator/master/text.hpp"

#include <array>
#include <cinttypes>
#include <cstdio>

namespace stator::master {

std::string hexadecimal(std::uint64_t number, int digits) {
  std::array<char, 32> text{};
  // Whatever the number is, it fits.
  static_cast<void>(std::snprintf(text.data(), text.size(), "%0*" PRIX64 "h", digits, number));
  return text.data();
}

std::string to_text(const ObjectAddress& object) {
  std::array<char, 32> text{};
  static_cast<void>(std::snprintf(text.data(), text.size(), "%04Xh:%02X", unsigned{object.index},
                                  unsigned{object.subindex}));
  return object.complete_access ? std::string(text.data()) + " (complete access)" : text.data();
}

}  // namespace stator::master
