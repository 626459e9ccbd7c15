#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmc8670 {

/// Declares the complete object dictionary of the TMC8670's firmware and finishes it.
void add_objects(dictionary::Dictionary& dictionary);

/// A value that replaces the default of an object, as if the maker had delivered it so.
struct ObjectValue {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint64_t bits = 0;
};

}  // namespace stator::devices::tmc8670
