#pragma once

#include <string>

namespace stator::cli {

/// How known masters reach what runs on `interface`, ready to paste, chosen by what this machine
/// has: the other end of a veth pair if there is one, the installed masters, and whether root is
/// needed.
[[nodiscard]] std::string connection_hints(const std::string& interface);

}  // namespace stator::cli
