#pragma once

#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/link/ethernet/link_address.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stator::cli {

/// Adds --set, which changes single values of the rack the command takes (rack::apply_changes);
/// `changes` must outlive the command.
CLI::Option* add_set_option(CLI::App& command, std::vector<std::string>& changes);

/// Reads the duration given with option `name`. Throws Failure if `text` is none or not positive.
[[nodiscard]] base::SimDuration duration_option(const std::string& name, const std::string& text);

/// The link as the command line names it. Throws Failure naming the forms there are.
[[nodiscard]] link::LinkAddress link_of(const std::string& text);

}  // namespace stator::cli
