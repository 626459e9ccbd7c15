#include "stator/formats/esi/esi_slot.hpp"

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

std::optional<std::uint16_t> EsiSlot::index_of(pugi::xml_node element) const {
  constexpr std::uint32_t kHighest = 0xFFFF;
  constexpr std::uint32_t kFirstOfDevice = 0x2000;  // below are communication and types
  const auto written = esi_number_up_to(element.child_value(), kHighest);
  if (!written) {
    return std::nullopt;
  }
  std::uint64_t index = *written;
  const bool pdo = esi_is_pdo(static_cast<std::uint32_t>(index));
  const bool depends = esi_truth(attribute_text(element, "DependOnSlot"), false) ||
                       (shift_all && (pdo || index >= kFirstOfDevice));
  if (module && depends) {
    index += std::uint64_t{number} * (pdo ? increments.pdo : increments.index);
  }
  if (module && esi_truth(attribute_text(element, "DependOnSlotGroup"), false)) {
    index += std::uint64_t{group} * (pdo ? of_group.pdo : of_group.index);
  }
  return index > kHighest ? std::nullopt : std::optional(static_cast<std::uint16_t>(index));
}

}  // namespace stator::formats
