#pragma once

#include <cstdint>
#include <memory>

#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Fetches the events that have come and lists those with a number higher than `after`.
[[nodiscard]] std::unique_ptr<Job> make_events_job(State& state, std::uint64_t after);

}  // namespace stator::web
