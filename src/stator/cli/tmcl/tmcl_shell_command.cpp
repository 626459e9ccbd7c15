// stator tmcl shell: commands in direct mode to a simulated module, or to one on a serial line or
// CAN bus.
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/event_printer.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/tmcl/line_reader.hpp"
#include "stator/cli/tmcl/program_files.hpp"
#include "stator/cli/tmcl/tmcl_bench_options.hpp"
#include "stator/cli/tmcl/tmcl_commands.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/tmcl_tools/tmcl_bench_connection.hpp"
#include "stator/tmcl_tools/tmcl_shell.hpp"

namespace stator::cli {

namespace {

struct ShellOptions : TmclBenchOptions {
  std::string port;
  std::string can;
  std::string clock;
  std::string timeout = "1s";
  unsigned address = 1;
  unsigned can_id = 1;
  unsigned can_reply_id = 2;
  unsigned baud_rate = 9600;
  bool strict = false;
};

/// Lines until the end; the number of those that were refused.
int converse(tmcl_tools::TmclShell& shell, const std::string& name, bool strict) {
  LineReader reader("tmcl> ", [&shell](std::string_view before, std::string_view word) {
    return shell.completions(before, word);
  });
  if (reader.interactive()) {
    fmt::print("Connected to {}; \"help\" lists the commands.\n", name);
  }
  int refused = 0;
  while (const auto line = reader.read()) {
    const tmcl_tools::ShellResponse response = shell.execute(*line);
    fmt::print("{}", response.text);
    static_cast<void>(std::fflush(stdout));
    refused += response.refused ? 1 : 0;
    if (response.quit || (strict && response.refused && !reader.interactive())) {
      break;
    }
  }
  return refused;
}

void run_shell(const ShellOptions& options) {
  const tmcl::ModuleDescription& module = tmcl_module(options.device);
  const tmcl_tools::TmclHostOptions host{
      .module_address = static_cast<std::uint8_t>(options.address),
      .can_id = static_cast<std::uint16_t>(options.can_id),
      .can_reply_id = static_cast<std::uint16_t>(options.can_reply_id),
      .baud_rate = options.baud_rate,
      .timeout = duration_of("--timeout", options.timeout)};
  EventPrinter events;
  std::optional<tmcl_tools::TmclBench> bench;
  std::unique_ptr<tmcl_tools::TmclConnection> connection;
  if (!options.port.empty()) {
    connection = tmcl_tools::connect_tmcl_serial(options.port, host);
  } else if (!options.can.empty()) {
    connection = tmcl_tools::connect_tmcl_can(options.can, host);
  } else {
    bench.emplace(make_tmcl_module(options, base::EventReporter(&events, 0)));
    const bool person = LineReader("").interactive();
    const bool machine = options.clock.empty() ? person : options.clock == "real";
    connection = std::make_unique<tmcl_tools::TmclBenchConnection>(
        *bench, options.device,
        machine ? tmcl_tools::BenchClock::machine : tmcl_tools::BenchClock::simulated);
  }
  tmcl_tools::TmclShell shell(*connection, module, program_files());
  const int refused = converse(shell, connection->name(), options.strict);
  if (options.strict && refused != 0) {
    throw Failure(fmt::format("{} command{} refused", refused, refused == 1 ? " was" : "s were"));
  }
}

}  // namespace

void add_tmcl_shell_command(CLI::App& app) {
  auto options = std::make_shared<ShellOptions>();
  CLI::App* command = app.add_subcommand("shell", "Send commands in direct mode, by their names");
  add_module_options(*command, *options);
  CLI::Option* port =
      command
          ->add_option("--port", options->port,
                       "Serial line to a module: pty:PATH, /dev/NAME or tcp:HOST:PORT; without "
                       "one a module runs in this process")
          ->check(names(Names::serial_line));
  command
      ->add_option("--can", options->can,
                   "CAN bus with a module: " + std::string(link::kCanLinkForms))
      ->check(names(Names::can_port))
      ->excludes(port);
  command->add_option("--address", options->address, "Address of the module on its serial line")
      ->check(CLI::Range(0U, 255U))
      ->capture_default_str();
  command->add_option("--baud", options->baud_rate, "bit/s of a serial interface")
      ->capture_default_str();
  command->add_option("--can-id", options->can_id, "Identifier of the module's commands")
      ->check(CLI::Range(0U, 0x7FFU))
      ->capture_default_str();
  command->add_option("--reply-id", options->can_reply_id, "Identifier of its replies")
      ->check(CLI::Range(0U, 0x7FFU))
      ->capture_default_str();
  command->add_option("--timeout", options->timeout, "How long a reply may take")
      ->capture_default_str();
  command
      ->add_option("--clock", options->clock,
                   "Of a module in this process. real: the machine's, as for a person; simulated: "
                   "time goes on by \"wait\" and a little by each command, as for a script")
      ->check(one_of({"real", "simulated"}));
  command->add_flag("--strict", options->strict,
                    "Scripts end at the first command that is refused, with exit status 1");
  command->footer(
      "Examples:\n"
      "  stator tmcl shell\n"
      "  echo 'gap MAX_CURRENT 0' | stator tmcl shell --port pty:/tmp/stator-tmcm-142\n"
      "  stator tmcl shell --can socketcan:vcan0 --can-id 1 --reply-id 2");
  command->callback([options] { run_shell(*options); });
}

}  // namespace stator::cli
