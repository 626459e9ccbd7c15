#pragma once

#include <cstdint>

namespace stator::master {

/// An entry of the process image, as the slave's PDO mapping places it.
struct MappedEntry {
  std::uint16_t index = 0;  ///< 0: padding
  std::uint8_t subindex = 0;
  std::uint32_t bit_offset = 0;  ///< within the slave's outputs or inputs
  std::uint32_t bit_length = 0;
};

}  // namespace stator::master
