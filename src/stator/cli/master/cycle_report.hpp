#pragma once

#include <string>

#include "stator/master/cycle_statistics.hpp"

namespace stator::cli {

/// What became of a master's cycles, for people: "2823 bus cycles, 0 lost, 0 with a wrong working
/// counter".
[[nodiscard]] std::string cycles_text(const master::CycleStatistics& cycles);

}  // namespace stator::cli
