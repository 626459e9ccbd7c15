#include "stator/cli/guide/completion.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/serial/serial_link.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/faults/fault_kinds.hpp"

namespace stator::cli {

namespace {

using Words = std::vector<Completion::Word>;

/// What has been typed of a command line, up to the word that is to be completed.
struct Typed {
  explicit Typed(CLI::App* command_typed) : command(command_typed) {}

  CLI::App* command;
  std::vector<std::string> arguments;  ///< of the command, without its options
  CLI::Option* open = nullptr;         ///< the option whose value comes next
  bool options_over = false;           ///< "--" was typed
};

bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

CLI::Option* option_named(CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  for (CLI::Option* option : options_of(command)) {
    const auto spellings = spellings_of(*option);
    if (std::ranges::find(spellings, name) != spellings.end()) {
      return option;
    }
  }
  return nullptr;
}

/// Options that take values without end (CLI11 gives them all words up to the next option).
bool goes_on(const CLI::Option& option) {
  return option.get_allow_extra_args() && option.get_items_expected_max() > 1;
}

void take(Typed& typed, const std::string& word) {
  if (!typed.options_over && word.starts_with('-') && word.size() > 1) {
    typed.open = nullptr;
    if (word == "--") {
      typed.options_over = true;
      return;
    }
    CLI::Option* const option = option_named(*typed.command, word);
    if (option != nullptr && takes_value(*option) && word.find('=') == std::string::npos) {
      typed.open = option;
    }
    return;
  }
  if (typed.open != nullptr) {
    if (!goes_on(*typed.open)) {
      typed.open = nullptr;
    }
    return;
  }
  for (CLI::App* command : commands_of(*typed.command)) {
    if (command->get_name() == word) {
      typed = Typed{command};
      return;
    }
  }
  typed.arguments.push_back(word);
}

/// The argument that the next word is for; null if the command takes no more.
CLI::Option* next_argument(const Typed& typed) {
  std::size_t before = typed.arguments.size();
  for (CLI::Option* option : options_of(*typed.command)) {
    if (!option->get_positional()) {
      continue;
    }
    const auto takes = static_cast<std::size_t>(std::max(option->get_items_expected_max(), 0));
    if (before < takes) {
      return option;
    }
    before -= takes;
  }
  return nullptr;
}

Words products() {
  Words words;
  for (const auto& product : catalogue().products()) {
    words.push_back({product->identity().type, product->identity().summary});
  }
  return words;
}

Words fault_kinds() {
  Words words;
  for (const rack::FaultKind& kind : rack::fault_kinds()) {
    words.push_back({std::string(kind.name), std::string(kind.summary)});
  }
  return words;
}

/// KEY= of the kind that has been typed before.
Words fault_keys(const Typed& typed) {
  Words words;
  const rack::FaultKind* const kind =
      typed.arguments.empty() ? nullptr : rack::find_fault_kind(typed.arguments.front());
  if (kind == nullptr) {
    return words;
  }
  const auto add = [&words](std::span<const rack::FaultParameter> keys, std::string_view prefix) {
    for (const rack::FaultParameter& key : keys) {
      if (key.name == "when") {
        continue;  // written key by key
      }
      words.push_back({fmt::format("{}{}=", prefix, key.name), std::string(key.summary)});
    }
  };
  add(rack::target_keys(kind->scope), "");
  add(kind->parameters, "");
  add(rack::common_fault_keys(), "");
  add(rack::milestone_keys(), "when.");
  return words;
}

/// The beginnings of "slcan:PATH, slcan-tcp:[ADDRESS:]PORT or can-exec:NAME".
Words beginnings(std::string_view forms) {
  Words words;
  while (!forms.empty()) {
    const std::size_t end = std::min({forms.find(", "), forms.find(" or "), forms.size()});
    const std::string_view form = forms.substr(0, end);
    words.push_back({std::string(form.substr(0, form.find(':') + 1)), std::string(form)});
    const std::size_t next = forms.find_first_of(' ', end + 1);
    forms.remove_prefix(end == forms.size() || next == std::string_view::npos ? forms.size()
                        : forms[end] == ','                                   ? end + 2
                                                                              : next + 1);
  }
  return words;
}

Words ethernet_links() {
  Words words;
  for (const link::NetworkInterface& interface : link::network_interfaces()) {
    if (!interface.loopback) {
      words.push_back({"ethercat:" + interface.name, "Ethernet interface of this machine"});
    }
  }
  const Words others = beginnings(link::kLinkForms);
  words.insert(words.end(), others.begin(), others.end());
  return words;
}

Words command_words(const Typed& typed) {
  CLI::App* group = typed.command;
  while (group->get_parent() != nullptr) {
    group = group->get_parent();
  }
  for (const std::string& name : typed.arguments) {
    for (CLI::App* command : commands_of(*group)) {
      if (command->get_name() == name) {
        group = command;
        break;
      }
    }
  }
  Words words;
  for (CLI::App* command : commands_of(*group)) {
    words.push_back({command->get_name(), command->get_description()});
  }
  return words;
}

Completion named(Names what, const Typed& typed) {
  using enum Completion::Files;
  switch (what) {
    case Names::product:
      return {products()};
    case Names::rack_file:
      return {.files = files, .endings = {"toml", "json"}};
    case Names::scenario_file:
      return {.files = files, .endings = {"toml"}};
    case Names::recording:
      return {.files = files, .endings = {"stator"}};
    case Names::tmcl_program:
      return {.files = files, .endings = {"tmc", "bin", "hex"}};
    case Names::file:
      return {.files = files};
    case Names::directory:
      return {.files = directories};
    case Names::fault_kind:
      return {fault_kinds()};
    case Names::fault_key:
      return {fault_keys(typed)};
    case Names::command:
      return {command_words(typed)};
    case Names::ethernet_link:
      return {ethernet_links()};
    case Names::can_port:
      return {beginnings(link::kCanLinkForms)};
    case Names::serial_line:
      return {beginnings(link::kSerialLinkForms)};
  }
  return {};
}

Completion values_of(CLI::Option& option, const Typed& typed) {
  const OptionWords words = words_of(option);
  if (words.named) {
    return named(*words.named, typed);
  }
  Completion values;
  for (const std::string& choice : words.choices) {
    values.words.push_back({choice});
  }
  return values;
}

/// Options that may be written once only and have been are not offered; which they are is not
/// looked at: CLI11 says so when the command is run.
Words options_to_begin(const Typed& typed) {
  Words words;
  for (CLI::Option* option : options_of(*typed.command)) {
    for (const std::string& spelling : spellings_of(*option)) {
      words.push_back({spelling, option->get_description()});
    }
  }
  return words;
}

Completion candidates(const Typed& typed, const std::string& current) {
  if (!typed.options_over && current.starts_with('-')) {
    const std::size_t equals = current.find('=');
    if (equals == std::string::npos) {
      return {options_to_begin(typed)};
    }
    CLI::Option* const option = option_named(*typed.command, current);
    Completion values = option == nullptr ? Completion{} : values_of(*option, typed);
    for (Completion::Word& word : values.words) {
      word.text.insert(0, current.substr(0, equals + 1));
    }
    return values;
  }
  if (typed.open != nullptr) {
    return values_of(*typed.open, typed);
  }
  Completion found;
  for (CLI::App* command : commands_of(*typed.command)) {
    found.words.push_back({command->get_name(), command->get_description()});
  }
  if (CLI::Option* const argument = next_argument(typed); argument != nullptr) {
    Completion values = values_of(*argument, typed);
    values.words.insert(values.words.begin(), found.words.begin(), found.words.end());
    return values;
  }
  return found;
}

}  // namespace

Completion complete(CLI::App& app, std::span<const std::string> words) {
  if (words.empty()) {
    return {};
  }
  Typed typed(&app);
  for (const std::string& word : words.first(words.size() - 1)) {
    take(typed, word);
  }
  Completion completion = candidates(typed, words.back());
  std::erase_if(completion.words, [&words](const Completion::Word& word) {
    return !word.text.starts_with(words.back());
  });
  return completion;
}

std::vector<std::string> words_of_line(std::string_view line) {
  std::vector<std::string> words;
  bool in_word = false;
  char quote = '\0';
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote == '\0' && (c == ' ' || c == '\t' || c == '\n')) {
      in_word = false;
      continue;
    }
    if (!in_word) {
      words.emplace_back();
      in_word = true;
    }
    if (quote == '\0' && (c == '"' || c == '\'')) {
      quote = c;
    } else if (quote != '\0' && c == quote) {
      quote = '\0';
    } else if (c == '\\' && quote != '\'' && i + 1 < line.size()) {
      words.back() += line[++i];
    } else {
      words.back() += c;
    }
  }
  if (!in_word) {
    words.emplace_back();
  }
  return words;
}

}  // namespace stator::cli
