// stator tmcl debug: the debugger of TMCL programs with commands from a terminal, options, files or
// a pipe.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/event_printer.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/interruption.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/tmcl/line_reader.hpp"
#include "stator/cli/tmcl/program_files.hpp"
#include "stator/cli/tmcl/tmcl_bench_options.hpp"
#include "stator/cli/tmcl/tmcl_commands.hpp"
#include "stator/cli/tmcl/tmcl_debug_screen.hpp"
#include "stator/tmcl_tools/tmcl_debug_console.hpp"
#include "stator/tmcl_tools/tmcl_debugger.hpp"

namespace stator::cli {

namespace {

struct DebugOptions : TmclBenchOptions {
  std::vector<std::string> command_files;
  std::vector<std::string> commands;
  bool batch = false;
  bool screen = false;
};

/// Counts what failed, for the exit status of scripts.
class Session {
 public:
  explicit Session(tmcl_tools::TmclDebugConsole& console) : console_(console) {}

  /// False: the debugger is to end.
  bool obey(std::string_view line) {
    const tmcl_tools::DebugResponse response = console_.execute(line);
    fmt::print(response.failed ? stderr : stdout, "{}", response.text);
    static_cast<void>(std::fflush(stdout));
    failures_ += response.failed ? 1 : 0;
    return !response.quit;
  }
  [[nodiscard]] int failures() const { return failures_; }

 private:
  tmcl_tools::TmclDebugConsole& console_;
  int failures_ = 0;
};

/// False: one of them ended the debugger.
bool obey_options(const DebugOptions& options, Session& session) {
  for (const std::string& file : options.command_files) {
    if (!session.obey("source " + file)) {
      return false;
    }
  }
  for (const std::string& command : options.commands) {
    if (!session.obey(command)) {
      return false;
    }
  }
  return true;
}

void converse(const DebugOptions& options, tmcl_tools::TmclDebugger& debugger,
              const Interruption& interruption) {
  tmcl_tools::TmclDebugConsole console(debugger, program_files().read);
  Session session(console);
  LineReader reader("(stator) ", [&console](std::string_view before, std::string_view word) {
    return console.completions(before, word);
  });
  if (reader.interactive() && !options.batch) {
    fmt::print("{} on a {} in simulated time; \"help\" lists the commands.\n{}", options.program,
               options.device, console.current_line());
  }
  bool going_on = obey_options(options, session);
  const bool person = reader.interactive();
  const int failures_of_options = session.failures();
  while (going_on && !options.batch) {
    const auto line = reader.read();
    // Ctrl-C that was pressed at the prompt means nothing now.
    static_cast<void>(interruption.taken());
    going_on = line && session.obey(*line);
  }
  const int failures = person && !options.batch ? failures_of_options : session.failures();
  if (failures != 0) {
    throw Failure(
        fmt::format("{} command{} of the debugger failed", failures, failures == 1 ? "" : "s"));
  }
}

void debug(const DebugOptions& options) {
  const bool terminal = ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
  if (options.screen && !terminal) {
    throw Failure("--tui needs a terminal; without it commands may come from a pipe or a file");
  }
  EventPrinter printer;
  EventCollector collector;
  base::EventSink* sink = &printer;
  if (options.screen) {
    sink = &collector;
  }
  tmcl_tools::TmclDebugger debugger(
      [&] { return make_tmcl_module(options, base::EventReporter(sink, 0)); },
      tmcl_tools::load_tmcl_source(options.program, tmcl_module(options.device), program_files()),
      input_changes(options));
  const Interruption interruption;
  debugger.set_interruption([&interruption] { return interruption.taken(); });
  if (!options.screen) {
    converse(options, debugger, interruption);
    return;
  }
  tmcl_tools::TmclDebugConsole console(debugger, program_files().read);
  DebugScreenOptions screen{.commands = options.commands,
                            .take_events = [&collector] { return collector.take(); },
                            .interruption = &interruption};
  for (const std::string& file : options.command_files) {
    screen.commands.insert(screen.commands.begin(), "source " + file);
  }
  run_debug_screen(debugger, console, screen);
}

}  // namespace

void add_tmcl_debug_command(CLI::App& app) {
  auto options = std::make_shared<DebugOptions>();
  CLI::App* command = app.add_subcommand(
      "debug", "Step through a program, with breakpoints and a look at everything");
  add_program_options(*command, *options);
  CLI::Option* screen =
      command->add_flag("--tui", options->screen,
                        "Text, registers and motion on a full screen, in the style of gdb's");
  command->add_option("-x,--command", options->command_files, "File with commands to begin with")
      ->check(names(Names::file))
      ->allow_extra_args(false);
  command->add_option("--ex", options->commands, "Command to begin with, as often as needed")
      ->allow_extra_args(false);
  command->add_flag("--batch", options->batch, "End after these commands")->excludes(screen);
  command->footer(
      "Commands are those of gdb; \"help\" lists them. They may also come from standard input.\n"
      "Ctrl-C holds a running program.\n"
      "Examples:\n"
      "  stator tmcl debug examples/tmcl/subroutine_library.tmc --tui\n"
      "  stator tmcl debug examples/tmcl/watchdog.tmc --ex \"break Late\" --ex run --batch");
  command->callback([options] { debug(*options); });
}

}  // namespace stator::cli
