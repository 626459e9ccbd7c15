#include "stator/cli/option_words.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

// CLI11 keeps validators with their option and finds them by their names, so that what an option
// takes stands where the option is declared.
constexpr std::string_view kOneOf = "one of";
constexpr std::string_view kNames = "names ";

/// The words as help shows them, from which words_of() takes them back.
std::string braced(const std::vector<std::string>& words) {
  return fmt::format("{{{}}}", fmt::join(words, ","));
}

std::vector<std::string> without_braces(std::string_view text) {
  std::vector<std::string> words;
  for (std::string_view rest = text.substr(1, text.size() - 2); !rest.empty();) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    words.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return words;
}

}  // namespace

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string all = braced(words);
  return {[words = std::move(words), all](const std::string& word) {
            return std::ranges::find(words, word) != words.end()
                       ? std::string()
                       : fmt::format("{} not in {}{}", word, all,
                                     settings::guess_text(word, {words.begin(), words.end()}));
          },
          all, std::string(kOneOf)};
}

CLI::Validator names(Names what) {
  return {[](const std::string& /*word*/) { return std::string(); }, "",
          fmt::format("{}{}", kNames, static_cast<unsigned>(what))};
}

OptionWords words_of(CLI::Option& option) {
  OptionWords words;
  try {
    for (int i = 0;; ++i) {
      const CLI::Validator& validator = *option.get_validator(i);
      const std::string_view name = validator.get_name();
      if (name == kOneOf) {
        words.choices = without_braces(validator.get_description());
      } else if (name.starts_with(kNames)) {
        unsigned value = 0;
        std::from_chars(name.data() + kNames.size(), name.data() + name.size(), value);
        words.named = static_cast<Names>(value);
      }
    }
  } catch (const CLI::OptionNotFound&) {  // the only way to learn how many there are
  }
  return words;
}

std::vector<CLI::Option*> options_of(CLI::App& command) {
  std::vector<CLI::Option*> options =
      command.get_options([](CLI::Option* option) { return !option->get_group().empty(); });
  for (CLI::App* group :
       command.get_subcommands([](CLI::App* sub) { return sub->get_name().empty(); })) {
    const auto more = options_of(*group);
    options.insert(options.end(), more.begin(), more.end());
  }
  return options;
}

std::vector<CLI::App*> commands_of(CLI::App& command) {
  return command.get_subcommands(
      [](CLI::App* sub) { return !sub->get_name().empty() && !sub->get_group().empty(); });
}

std::string path_of(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  return parent == nullptr ? command.get_name()
                           : fmt::format("{} {}", path_of(*parent), command.get_name());
}

std::vector<std::string> spellings_of(const CLI::Option& option) {
  std::vector<std::string> spellings;
  for (const std::string& name : option.get_lnames()) {
    spellings.push_back("--" + name);
  }
  for (const std::string& name : option.get_snames()) {
    spellings.push_back("-" + name);
  }
  return spellings;
}

}  // namespace stator::cli
