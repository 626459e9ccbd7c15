#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl_tools/program_files.hpp"
#include "stator/tmcl_tools/tmcl_connection.hpp"

namespace stator::tmcl_tools {

/// What the shell answered to a line.
struct ShellResponse {
  std::string text{};    ///< whole lines; may be empty
  bool refused = false;  ///< by the module, or not understood, or no reply
  bool quit = false;
};

/// Direct mode by name: a line is a command as programs write it, or one of the shell's own for
/// what has no mnemonic (run, halt, download, ...).
class TmclShell {
 public:
  /// Connection and module must outlive the shell.
  TmclShell(TmclConnection& connection, const tmcl::ModuleDescription& module, ProgramFiles files)
      : connection_(connection), module_(module), files_(std::move(files)) {}

  ShellResponse execute(std::string_view line);
  /// Words that may stand in place of `word`, which stands behind `before`.
  [[nodiscard]] std::vector<std::string> completions(std::string_view before,
                                                     std::string_view word) const;

 private:
  friend struct ShellCommands;

  struct Refusal {
    std::string sentence;
  };

  /// Sends it; throws Refusal when it is refused or no reply comes.
  TmclReply send(const tmcl::Instruction& instruction);
  TmclReply send(tmcl::Command command, std::uint8_t type = 0, std::int32_t value = 0);

  TmclConnection& connection_;
  const tmcl::ModuleDescription& module_;
  ProgramFiles files_;
};

}  // namespace stator::tmcl_tools
