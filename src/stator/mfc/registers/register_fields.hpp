#pragma once

#include <span>

#include "stator/mfc/registers/register_map.hpp"

namespace stator::mfc {

/// The document's signs for FieldAccess, for the tables in register_fields_*.cpp.
// NOLINTBEGIN(readability-identifier-naming): the document's signs
namespace notation {
inline constexpr FieldAccess no = FieldAccess::none;
inline constexpr FieldAccess r = FieldAccess::read;
inline constexpr FieldAccess r_c = FieldAccess::read_clears;
inline constexpr FieldAccess rw = FieldAccess::read_write;
inline constexpr FieldAccess w = FieldAccess::write;
}  // namespace notation
// NOLINTEND(readability-identifier-naming)

[[nodiscard]] std::span<const RegisterField> encoder_and_serial_fields();
[[nodiscard]] std::span<const RegisterField> generator_fields();
[[nodiscard]] std::span<const RegisterField> supervision_fields();

}  // namespace stator::mfc
