#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/program.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl_tools/program_files.hpp"

namespace stator::tmcl_tools {

/// A program in TMCL with the text it comes from. The text of one that was read as bytes is its
/// disassembly, so every program can be shown line by line.
class TmclSource {
 public:
  /// `text` must assemble to `program` for `module`, which must outlive the source.
  TmclSource(std::string file, std::string_view text, tmcl::Program program,
             const tmcl::ModuleDescription& module);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const tmcl::Program& program() const { return program_; }
  [[nodiscard]] const tmcl::ModuleDescription& module() const { return *module_; }
  /// Line n of the text is element n - 1.
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

  /// Line of the command at `address`, from 1; none behind the program.
  [[nodiscard]] std::optional<std::size_t> line_of(std::size_t address) const;
  /// Address of the first command in `line` or below it; none if there is no such command.
  [[nodiscard]] std::optional<std::size_t> address_of_line(std::size_t line) const;
  /// Letter case does not count.
  [[nodiscard]] std::optional<std::size_t> address_of_label(std::string_view name) const;
  /// The label at `address` or the nearest above with the distance, "Loop+2"; the address alone
  /// where there is none.
  [[nodiscard]] std::string place_of(std::size_t address) const;
  /// The nearest label at or above `address`; empty if there is none.
  [[nodiscard]] std::string_view label_above(std::size_t address) const;

  /// The command at `address` with all numbers in place of constants, e.g. "MVP ABS, 0, 51200";
  /// jumps lead to the text's labels.
  [[nodiscard]] const std::string& command_at(std::size_t address) const;

 private:
  std::string file_;
  std::vector<std::string> lines_;
  tmcl::Program program_;
  const tmcl::ModuleDescription* module_;
  std::vector<std::string> commands_;  ///< by address, then one for empty memory
};

/// Reads a program for `module`: text, or bytes in any form `stator tmcl assemble` writes. Warnings
/// are told. Throws Failure after errors.
[[nodiscard]] TmclSource load_tmcl_source(const std::string& file,
                                          const tmcl::ModuleDescription& module,
                                          const ProgramFiles& files);

/// Tells errors and warnings as compilers do. Throws Failure if there is an error; `consequence`
/// ends its sentence: "nothing is written".
void report_diagnostics(const tmcl::Assembly& assembly, const std::string& file,
                        std::string_view consequence, const TellDiagnostic& tell);

}  // namespace stator::tmcl_tools
