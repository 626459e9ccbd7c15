#pragma once

namespace CLI {
class App;
}

namespace stator::cli {

// The commands below "stator tmcl", as in commands.hpp.

void add_tmcl_run_command(CLI::App& app);
void add_tmcl_debug_command(CLI::App& app);
void add_tmcl_shell_command(CLI::App& app);

}  // namespace stator::cli
