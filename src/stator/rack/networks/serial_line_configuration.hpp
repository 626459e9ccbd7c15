#pragma once

#include <optional>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::rack {

/// How bytes pass over a serial line, and how its thread waits for them.
struct SerialLineConfiguration {
  std::string link;     ///< as in SerialConnection::line
  bool pacing = false;  ///< bytes take the time of their bits, in simulated time
  link::WaitMode wait = link::WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  std::optional<unsigned> cpu{};         ///< processor the line's thread is tied to
};

}  // namespace stator::rack
