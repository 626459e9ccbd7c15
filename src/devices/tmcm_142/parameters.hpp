#pragma once

#include <span>

#include "tmcl/module_description.hpp"

namespace stator::devices::tmcm_142 {

/// Axis parameters in the order of their numbers (TMCM-142 TMCL Firmware Manual, chapter 7,
/// L5219-L5862), read with decisions A24, A27, A33, A34, A39, A48, A50, A52, A55, A56 and A103.
///
/// What a row cannot say and the module has to do: 5 writes 16 and 17 (A22), any value written to
/// 34 clears it (A33), 42 in decimal mode refuses low halves above 9999 (A35), 128 refuses 1 (A48).
[[nodiscard]] std::span<const tmcl::ParameterDeclaration> axis_parameters();

/// Global parameters of bank 0 and the variables of bank 2, in this order (chapter 8,
/// L5921-L6058), read with decisions A9, A11, A60 and A105.
///
/// What a row cannot say: 73 takes 1234 and 4321 and reads 1 and 0; its range holds both. Rows of
/// bank 0 that are stored live in the EEPROM only, those of bank 2 by STGP.
[[nodiscard]] std::span<const tmcl::ParameterDeclaration> global_parameters();

}  // namespace stator::devices::tmcm_142

namespace stator::devices {

/// The module for assembler, disassembler and lists. Lives as long as the program.
[[nodiscard]] const tmcl::ModuleDescription& tmcm_142_description();

}  // namespace stator::devices
