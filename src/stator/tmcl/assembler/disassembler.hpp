// Writes a TMCL program as text that the assembler makes the same instructions of.
#pragma once

#include <span>
#include <string>

#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

struct DisassemblyOptions {
  bool parameter_symbols = true;  ///< "SAP MAX_CURRENT, 0, 8" instead of "SAP 6, 0, 8"
};

/// The text of a program for `module`, one command per line and in the order of their addresses,
/// with labels where jumps lead to: L12, or Sub12 where a subroutine is called. Instructions that
/// no mnemonic expresses, with unknown numbers or with values in fields that the mnemonic does not
/// have, are written as RAW. `assemble` makes the same instructions of the text, if they are not
/// more than the module's memory holds.
[[nodiscard]] std::string disassemble(std::span<const Instruction> program,
                                      const ModuleDescription& module,
                                      const DisassemblyOptions& options = {});

}  // namespace stator::tmcl
