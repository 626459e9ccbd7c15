#pragma once

#include <string_view>
#include <vector>

#include "stator/tmcl/assembler/diagnostic.hpp"
#include "stator/tmcl/assembler/program.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

/// What became of a text.
struct Assembly {
  Program program;                      ///< empty if there is an error
  std::vector<Diagnostic> diagnostics;  ///< by line and column

  [[nodiscard]] bool succeeded() const;
};

/// Makes a program for `module` of its text, one command per line (TMCM-142 TMCL Firmware Manual,
/// L357-L371, L684-L762):
///
///     Distance = 10 * 51200            // a constant
///     Loop:  MVP REL, 0, Distance      // label, mnemonic, operands
///            WAIT POS, 0, 0
///            JA Loop
///
/// The case of letters does not count. Numbers are decimal or hexadecimal, $1F or 0x1F, and may be
/// joined by + - * / and parentheses. A parameter may be written by its symbol. "RAW command, type,
/// motor, value" is any instruction. docs/how-to/tmcl-programs.md has it all.
///
/// Errors are what can not be put into program memory: unknown words, numbers beyond their field,
/// addresses beyond the memory, more commands than it holds. Warnings are what the module will
/// refuse when it comes to it, and a program that can run on behind its end. Never fails otherwise,
/// whatever the text is.
[[nodiscard]] Assembly assemble(std::string_view text, const ModuleDescription& module);

}  // namespace stator::tmcl
