#pragma once

#include <string>

#include "link/link_address.hpp"

namespace stator::cli {

/// How known masters reach what runs on `link`, ready to paste, chosen by what this machine has:
/// the other end of a veth pair if there is one, the installed masters, and whether root is needed.
[[nodiscard]] std::string connection_hints(const link::LinkAddress& link);

}  // namespace stator::cli
