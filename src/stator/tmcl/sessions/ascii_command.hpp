#pragma once

#include <cstdint>
#include <string_view>

#include "stator/tmcl/command_set.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// What a line of text asks for.
enum class LineKind : std::uint8_t {
  command,      ///< a TMCL command
  binary_mode,  ///< BIN: back to telegrams
  run,          ///< RUN: start the program
  stop,         ///< STOP: stop the program
  nothing,      ///< an empty line
  refused,      ///< none of these; `status` says why
};

struct AsciiCommand {
  LineKind kind = LineKind::nothing;
  Instruction instruction{};
  Status status = Status::success;
};

/// Reads a line without the letter of its module: a mnemonic and its operands, as the assembler
/// writes them, separated by commas; numbers are decimal. Status::invalid_command: the word is no
/// command for lines of text. Status::invalid_value: an operand is missing, too much, no number or
/// does not fit (A16).
[[nodiscard]] AsciiCommand parse_ascii_command(std::string_view line, const CommandSet& commands);

[[nodiscard]] constexpr char upper_case(char character) {
  return character >= 'a' && character <= 'z' ? static_cast<char>(character - 'a' + 'A')
                                              : character;
}

}  // namespace stator::tmcl
