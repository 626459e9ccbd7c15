#pragma once

#include <string>

#include "stator/rack/core/rack_configuration.hpp"

namespace stator::cli {

/// How known masters reach a segment, ready to paste, chosen by what it contains and what this
/// machine has: an axis to move, objects to list, the other end of a veth pair, the installed
/// masters, and whether root is needed.
[[nodiscard]] std::string connection_hints(const rack::SegmentConfiguration& segment);

}  // namespace stator::cli
