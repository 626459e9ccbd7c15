// Objects of a device that has everything CiA 301 describes, for conformance and EDS tests.
#pragma once

#include <vector>

#include "stator/dictionary/declaration.hpp"

namespace stator::canopen::test {

inline constexpr std::uint8_t kNodeId = 5;
/// Entries of each mapping object.
inline constexpr std::uint8_t kMappingEntries = 16;

/// The objects of a device that has everything CiA 301 describes: 1000h to 1029h, 1200h, five PDOs
/// of each direction, and application objects of every kind of access and mapping.
[[nodiscard]] std::vector<dictionary::EntryDeclaration> full_featured_objects();

}  // namespace stator::canopen::test
