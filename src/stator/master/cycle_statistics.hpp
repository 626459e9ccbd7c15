#pragma once

#include <cstdint>

namespace stator::master {

/// What became of the process data exchanges.
struct CycleStatistics {
  std::uint64_t cycles = 0;
  std::uint64_t lost = 0;                    ///< no answer within the frame timeout
  std::uint64_t working_counter_errors = 0;  ///< answered by too few or too many
};

}  // namespace stator::master
