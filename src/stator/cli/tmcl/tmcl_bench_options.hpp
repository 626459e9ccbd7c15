#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/cli/products.hpp"
#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl_tools/tmcl_bench.hpp"

namespace CLI {
class App;
}

namespace stator::cli {

/// What the commands have in common that run a program on a module of their own.
struct TmclBenchOptions {
  std::string program;
  std::string device = usual_tmcl_module();
  std::string rack_file;
  std::vector<std::string> changes;
  std::string rack_device;
  std::vector<std::string> inputs;                         ///< "NAME=VALUE", from the start on
  std::vector<std::pair<std::string, std::string>> later;  ///< time, "NAME=VALUE"
};

/// Adds the options of a module and its surroundings, without the program.
void add_module_options(CLI::App& command, TmclBenchOptions& options);
/// Adds the program and what is set around the module while it runs.
void add_program_options(CLI::App& command, TmclBenchOptions& options);

/// The module that is asked for, as it is after switching on; its events go to `reporter`. Throws
/// tmcl_tools::Failure naming the devices there are.
[[nodiscard]] tmcl_tools::TmclModule make_tmcl_module(const TmclBenchOptions& options,
                                                      base::EventReporter reporter);

/// What the options set at the start and later. Throws tmcl_tools::Failure saying how they are
/// written, and Failure if a time is none.
[[nodiscard]] std::vector<tmcl_tools::InputChange> input_changes(const TmclBenchOptions& options);

/// "10s", "250us". Throws Failure naming `option`.
[[nodiscard]] base::SimDuration duration_of(const std::string& option, const std::string& text);

}  // namespace stator::cli
