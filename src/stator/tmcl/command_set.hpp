#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "stator/base/event_text.hpp"
#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

/// Where a command may come from.
struct CommandUse {
  bool direct = false;   ///< binary telegrams, executed at once
  bool program = false;  ///< program memory
  bool ascii = false;    ///< lines of text
};

/// The part of an instruction an operand is.
enum class Field : std::uint8_t { none, type, motor, value };

/// What an operand means; decides which names may stand for it.
enum class Meaning : std::uint8_t {
  number,            ///< as it is
  symbol,            ///< one of the declaration's symbols
  motor,             ///< number of an axis
  axis_parameter,    ///< number or name of one
  global_parameter,  ///< number or name of one of the bank the instruction names
  bank,
  coordinate,
  port,     ///< of a digital output or an input
  address,  ///< of an instruction in program memory, or a label
  ticks,    ///< of WAIT, 10 ms
};

struct Operand {
  Field field = Field::none;
  Meaning meaning = Meaning::number;
};

/// A name that a program may write for a number.
struct Symbol {
  std::string_view name;
  std::int32_t value = 0;
  std::string_view source{};  ///< lines of the document, where it tells of each on its own
};

/// One of several uses of a command that the document tells of on their own, as far as no symbol
/// names it.
struct CommandForm {
  static constexpr int kAny = -1;

  std::string_view name;
  int type = kAny;
  int bank = kAny;
  std::string_view source{};  ///< lines of the document
};

/// One command: from it follow its name, the syntax of assembler, disassembler and ASCII lines, and
/// who may use it.
struct CommandDeclaration {
  static constexpr std::size_t kOperands = 3;

  Command command;
  base::StaticText mnemonic;  ///< in programs and lines; empty if it has none
  base::StaticText name;      ///< for people
  CommandUse use;
  std::array<Operand, kOperands> operands{};  ///< in the order of the text; unused ones at the end
  std::span<const Symbol> symbols{};          ///< of the operand with Meaning::symbol
  std::string_view source{};                  ///< lines of the document
  std::span<const CommandForm> forms{};       ///< for lists

  [[nodiscard]] constexpr std::size_t operand_count() const {
    std::size_t count = 0;
    while (count < kOperands && operands[count].field != Field::none) {
      ++count;
    }
    return count;
  }
};

/// The commands a module knows, ordered by their numbers. Modules differ in their command sets:
/// each is a table.
class CommandSet {
 public:
  constexpr explicit CommandSet(std::span<const CommandDeclaration> declarations)
      : declarations_(declarations) {}

  /// Null if no command has that number.
  [[nodiscard]] const CommandDeclaration* find(std::uint8_t command) const;
  /// Null if no command has that mnemonic; letter case does not count.
  [[nodiscard]] const CommandDeclaration* find(std::string_view mnemonic) const;
  [[nodiscard]] std::span<const CommandDeclaration> all() const { return declarations_; }

 private:
  std::span<const CommandDeclaration> declarations_;
};

/// The classic set, as firmware of the TMCM-142's time has it (TMCM-142 TMCL Firmware Manual,
/// chapter 6): no interrupts, no vectors.
[[nodiscard]] const CommandSet& classic_command_set();

}  // namespace stator::tmcl
