#include "stator/cli/usage_error.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/option_words.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

CLI::App* command_named(CLI::App& group, const std::string& name) {
  const auto found = group.get_subcommands(
      [&name](CLI::App* command) { return !name.empty() && command->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

std::string unknown_command(CLI::App& group, const std::string& word) {
  std::set<std::string> known;
  for (const CLI::App* command : commands_of(group)) {
    known.insert(command->get_name());
  }
  return fmt::format(R"({} has no command "{}"{}; "{} --help" lists them)", path_of(group), word,
                     settings::guess_text(word, known), path_of(group));
}

std::string unknown_option(CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  std::set<std::string> known;
  for (const CLI::Option* option : options_of(command)) {
    for (const std::string& spelling : spellings_of(*option)) {
      known.insert(spelling);
    }
  }
  return fmt::format(R"({} has no option "{}"{}; "{} --help" lists them)", path_of(command), name,
                     settings::guess_text(name, known), path_of(command));
}

bool is_option(const std::string& word) {
  return word.size() > 1 && word.starts_with('-');
}

/// What is left over was taken neither by an option nor as an argument.
std::string left_over(CLI::App& command, const std::vector<std::string>& rest) {
  if (const auto option = std::ranges::find_if(rest, is_option); option != rest.end()) {
    return unknown_option(command, *option);
  }
  return fmt::format(R"({} takes no further argument, and "{}" is one; "{} --help" tells its use)",
                     path_of(command), rest.front(), path_of(command));
}

}  // namespace

std::string usage_error(CLI::App& app, const CLI::ParseError& error,
                        std::span<const std::string> words) {
  CLI::App* command = &app;
  for (const std::string& word : words) {
    if (command->get_require_subcommand_min() == 0) {
      break;
    }
    CLI::App* const next = command_named(*command, word);
    if (next == nullptr) {
      return is_option(word) ? unknown_option(*command, word) : unknown_command(*command, word);
    }
    command = next;
  }
  if (command->get_require_subcommand_min() != 0) {
    return fmt::format("say which command; \"{} --help\" lists them", path_of(*command));
  }
  if (const auto rest = app.remaining(true); !rest.empty()) {
    return left_over(*command, rest);
  }
  return fmt::format("{}; \"{} --help\" tells its use", error.what(), path_of(*command));
}

}  // namespace stator::cli
