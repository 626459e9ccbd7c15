#pragma once

#include <string>

namespace stator::cli {

/// The file after `path` for what goes on from it: "run.stator", "run-2.stator", "run-3.stator". No
/// file of its name exists.
[[nodiscard]] std::string next_name(const std::string& path);

}  // namespace stator::cli
