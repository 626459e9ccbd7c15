#pragma once

#include <functional>
#include <string>
#include <vector>

#include "stator/cli/interruption.hpp"
#include "stator/tmcl_tools/tmcl_debug_console.hpp"
#include "stator/tmcl_tools/tmcl_debugger.hpp"

namespace stator::cli {

/// What the screen needs beside the debugger.
struct DebugScreenOptions {
  std::vector<std::string> commands;         ///< to begin with
  std::function<std::string()> take_events;  ///< what the device said since the last call, in lines
  const Interruption* interruption = nullptr;  ///< Ctrl-C
};

/// The debugger on a full screen until the person ends it: the program's text with the present line
/// on the left, registers and motion on the right, commands and what they told below. Standard
/// input and output must be a terminal.
void run_debug_screen(tmcl_tools::TmclDebugger& debugger, tmcl_tools::TmclDebugConsole& console,
                      const DebugScreenOptions& options);

}  // namespace stator::cli
