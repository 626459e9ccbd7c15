// stator man: manual pages of the program and its commands, made from what they declare.
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/guide/man_page.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

struct ManOptions {
  std::vector<std::string> command;
  std::string directory;
};

CLI::App& command_at(CLI::App& app, const std::vector<std::string>& path) {
  CLI::App* command = &app;
  for (const std::string& name : path) {
    std::set<std::string> known;
    CLI::App* next = nullptr;
    for (CLI::App* each : commands_of(*command)) {
      known.insert(each->get_name());
      next = each->get_name() == name ? each : next;
    }
    if (next == nullptr) {
      throw Failure(fmt::format(R"(there is no command "{}" below "{}"{})", name,
                                command->get_name(), settings::guess_text(name, known)));
    }
    command = next;
  }
  return *command;
}

void write_pages(CLI::App& command, const std::filesystem::path& directory) {
  write_file((directory / (man_page_name(command) + ".1")).string(), man_page(command));
  for (CLI::App* sub : commands_of(command)) {
    write_pages(*sub, directory);
  }
}

void man(CLI::App& app, const ManOptions& options) {
  CLI::App& command = command_at(app, options.command);
  if (options.directory.empty()) {
    fmt::print("{}", man_page(command));
    return;
  }
  std::error_code error;
  std::filesystem::create_directories(options.directory, error);
  if (error) {
    throw Failure(
        fmt::format("cannot create the directory {}: {}", options.directory, error.message()));
  }
  write_pages(command, options.directory);
}

}  // namespace

void add_man_command(CLI::App& app) {
  auto options = std::make_shared<ManOptions>();
  CLI::App* command =
      app.add_subcommand("man", "Print the manual page of a command, or write those of all");
  command
      ->add_option("command", options->command,
                   R"(Command, e.g. "run" or "tmcl run"; without one: of the program)")
      ->check(names(Names::command));
  command
      ->add_option("--directory", options->directory,
                   "Write the page of the command and of all below it to this directory")
      ->check(names(Names::directory));
  command->footer(
      "Examples:\n"
      "  stator man run | man -l -\n"
      "  stator man --directory ~/.local/share/man/man1");
  command->callback([&app, options] { man(app, *options); });
}

}  // namespace stator::cli
