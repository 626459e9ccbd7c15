// Errors and warnings of the TMCL assembler, with line and column.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace stator::tmcl {

enum class Severity : std::uint8_t { warning, error };

/// What the assembler has to say about a place of a program's text.
struct Diagnostic {
  Severity severity = Severity::error;
  std::size_t line = 0;    ///< from 1
  std::size_t column = 0;  ///< from 1; characters, a tab is one
  std::string message;     ///< one sentence: what was found, what was expected
};

}  // namespace stator::tmcl
