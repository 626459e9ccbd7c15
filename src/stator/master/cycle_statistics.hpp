#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::master {

/// What became of the process data exchanges.
struct CycleStatistics {
  std::uint64_t cycles = 0;
  std::uint64_t lost = 0;                    ///< no answer within the frame timeout, so far or ever
  std::uint64_t working_counter_errors = 0;  ///< answered by too few or too many
  base::SimDuration longest_silence;         ///< from a frame that was lost to the next answer
};

}  // namespace stator::master
