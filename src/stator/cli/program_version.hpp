#pragma once

#include <string>

namespace stator::cli {

/// "0.1.0".
[[nodiscard]] std::string program_version();

}  // namespace stator::cli
