#pragma once

#include <string>

namespace stator::rack {

/// Why a file could not be written at `path` by this user, as a reason with remedy; empty if it
/// could, as far as can be told without writing it.
[[nodiscard]] std::string output_problem(const std::string& path);

}  // namespace stator::rack
