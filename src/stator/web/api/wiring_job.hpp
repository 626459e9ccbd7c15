#pragma once

#include <memory>

#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Tells how devices are wired, which links are up, and what the ports have counted.
[[nodiscard]] std::unique_ptr<Job> make_wiring_job(const State& state);

/// Tells how masters and other programs reach each link of the rack.
[[nodiscard]] Response describe_connections(const State& state);

}  // namespace stator::web
