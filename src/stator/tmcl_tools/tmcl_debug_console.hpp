#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/tmcl_tools/program_files.hpp"
#include "stator/tmcl_tools/tmcl_debugger.hpp"

namespace stator::tmcl_tools {

/// What the debugger answered to a line.
struct DebugResponse {
  std::string text{};  ///< whole lines; may be empty
  bool failed = false;
  bool quit = false;
};

/// The debugger's commands, named as gdb names them, without a terminal: lines in, text out.
class TmclDebugConsole {
 public:
  /// `debugger` must outlive the console. `read_file` reads files of commands.
  TmclDebugConsole(TmclDebugger& debugger, ReadFile read_file)
      : debugger_(debugger), read_file_(std::move(read_file)) {}

  /// Obeys a line. Commands may be cut short as long as they are clear; an empty line repeats the
  /// one before where that is useful (step, next, list, ...).
  DebugResponse execute(std::string_view line);

  /// Words with which `word` may go on: commands at the beginning of a line, else symbols and
  /// labels.
  [[nodiscard]] std::vector<std::string> completions(std::string_view line_before,
                                                     std::string_view word) const;

  /// "12\tLoop: MVP ABS, 0, Far": where the program is.
  [[nodiscard]] std::string current_line() const;

 private:
  friend struct DebugCommands;

  /// Ends a command with a sentence.
  struct Refusal {
    std::string sentence;
  };

  DebugResponse obey(std::string_view line);
  [[nodiscard]] std::string stop_text(const Stop& stop);
  [[nodiscard]] std::string displays();
  [[nodiscard]] std::int64_t value(std::string_view expression);
  [[nodiscard]] std::size_t location(std::string_view text);
  [[nodiscard]] std::string line_text(std::size_t line, bool marks) const;
  [[nodiscard]] std::string place(std::size_t address) const;
  StopPoint& stop_point(std::string_view number);

  TmclDebugger& debugger_;
  ReadFile read_file_;
  std::string last_line_;
  std::vector<std::pair<int, std::string>> displays_;
  int last_display_ = 0;
  std::size_t list_from_ = 0;  ///< line; 0: around the present one
};

/// A command and how it is explained.
struct DebugCommand {
  std::string_view name;
  std::string_view short_name;  ///< empty if it has none
  std::string_view usage;       ///< operands
  std::string_view help;
  bool repeats;  ///< by an empty line
  std::string (*obey)(TmclDebugConsole&, std::string_view operands);
};
[[nodiscard]] std::span<const DebugCommand> debug_commands();

/// What can be listed by "info".
struct DebugTopic {
  std::string_view name;
  std::string_view help;
  std::string (*tell)(TmclDebugger&, std::string_view pattern);
};
[[nodiscard]] std::span<const DebugTopic> debug_topics();

}  // namespace stator::tmcl_tools
