#include "stator/cli/option_values.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

CLI::Option* add_set_option(CLI::App& command, std::vector<std::string>& changes) {
  return command
      .add_option(
          "--set", changes,
          "Change a value of the rack, as often as needed, e.g. gantry.axis[1].load.inertia=2e-4 "
          "or fault[0].at=1s; \"stator check --keys\" lists the keys")
      ->option_text("PATH=VALUE")
      ->allow_extra_args(false);
}

base::SimDuration duration_option(const std::string& name, const std::string& text) {
  const auto duration = settings::parse_duration(text);
  if (!duration || *duration <= base::SimDuration(0)) {
    throw Failure(
        fmt::format("{} \"{}\" is no duration; write e.g. 1ms, 250us or 10s", name, text));
  }
  return *duration;
}

link::LinkAddress link_of(const std::string& text) {
  const auto address = link::parse_link_address(text);
  if (!address) {
    throw Failure(address.error().text);
  }
  return *address;
}

}  // namespace stator::cli
