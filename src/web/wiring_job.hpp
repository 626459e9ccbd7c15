#pragma once

#include <memory>

#include "web/job.hpp"
#include "web/state.hpp"

namespace stator::web {

/// Tells how devices are wired, which links are up, and what the ports have counted.
[[nodiscard]] std::unique_ptr<Job> make_wiring_job(const State& state);

}  // namespace stator::web
