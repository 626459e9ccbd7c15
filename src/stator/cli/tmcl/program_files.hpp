#pragma once

#include "stator/tmcl_tools/program_files.hpp"

namespace stator::cli {

/// Those of the machine; what is wrong with programs goes to standard error.
[[nodiscard]] tmcl_tools::ProgramFiles program_files();

}  // namespace stator::cli
