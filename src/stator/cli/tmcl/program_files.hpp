#pragma once

#include "stator/cli/tmcl_tools/program_files.hpp"

namespace stator::cli {

/// Those of the machine; what is wrong with programs goes to standard error.
[[nodiscard]] ProgramFiles program_files();

}  // namespace stator::cli
