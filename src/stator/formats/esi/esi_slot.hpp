// What the place of a module in its device adds to the indices that its description has.
#pragma once

#include <cstdint>
#include <optional>

#include <pugixml.hpp>

namespace stator::formats {

/// The shift of one slot (ETG.2000, ETG.5001): nothing for what stands in the device itself.
struct EsiSlot {
  /// What is added for each slot or group of slots before this one.
  struct Increments {
    std::uint32_t index = 0;  ///< to objects
    std::uint32_t pdo = 0;    ///< to PDOs
  };
  std::uint32_t number = 0;  ///< of the slot, from 0
  Increments increments;     ///< for each slot
  std::uint32_t group = 0;   ///< number of its group
  Increments of_group;       ///< for each group
  bool module = false;       ///< a module stands in it
  bool shift_all = false;    ///< also what does not say that it depends on the slot

  /// The index of an object or PDO in this slot, by its element <Index>; nothing if it is none.
  [[nodiscard]] std::optional<std::uint16_t> index_of(pugi::xml_node element) const;
};

/// PDO mappings: 1600h to 17FFh and 1A00h to 1BFFh.
[[nodiscard]] constexpr bool esi_is_pdo(std::uint32_t index) {
  return (index >= 0x1600 && index < 0x1800) || (index >= 0x1A00 && index < 0x1C00);
}

}  // namespace stator::formats
