#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "stator/rack/faults/fault_configuration.hpp"

namespace stator::rack {

/// Bit n for each ethercat::Command n that a text like "LRD LWR" names.
[[nodiscard]] std::uint16_t command_mask(std::string_view text);
/// Why such a text names no commands; empty: it does.
[[nodiscard]] std::string command_problem(const std::string& text);

}  // namespace stator::rack
