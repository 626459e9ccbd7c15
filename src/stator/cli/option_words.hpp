#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace stator::cli {

/// What a value of the command line names. Shells complete it by that; it refuses nothing.
enum class Names : std::uint8_t {
  product,        ///< of the catalogue
  rack_file,      ///< TOML or JSON
  scenario_file,  ///< TOML
  recording,      ///< NAME.stator
  tmcl_program,   ///< .tmc, .bin, .hex
  file,
  directory,
  fault_kind,
  fault_key,      ///< KEY=VALUE of the kind that the argument before it names
  command,        ///< of this program
  ethernet_link,  ///< ethercat:INTERFACE and so on
  can_port,
  serial_line,
};

/// For CLI::Option::check(): the value is one of `words`. Anything else is refused with all of
/// them and the nearest.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words);

/// For CLI::Option::check(): what the value names.
[[nodiscard]] CLI::Validator names(Names what);

/// What was declared of an option by one_of() and names(), and of its words.
struct OptionWords {
  std::vector<std::string> choices;  ///< of one_of(); empty without
  std::optional<Names> named;
};
[[nodiscard]] OptionWords words_of(CLI::Option& option);

/// The options of a command, those of its option groups with them; none that is hidden.
[[nodiscard]] std::vector<CLI::Option*> options_of(CLI::App& command);
/// The commands below `command` that are not hidden, in their order.
[[nodiscard]] std::vector<CLI::App*> commands_of(CLI::App& command);
/// "stator tmcl run".
[[nodiscard]] std::string path_of(const CLI::App& command);
/// "--device", "-o": all that can be written for it; none of an argument.
[[nodiscard]] std::vector<std::string> spellings_of(const CLI::Option& option);

}  // namespace stator::cli
