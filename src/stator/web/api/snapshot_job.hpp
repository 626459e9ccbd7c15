#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Tells what the rack, its devices or its signals are at one moment, as `operation` wants it.
/// `signals` are read, numbers in State::signals(); `device` is the one asked for.
[[nodiscard]] std::unique_ptr<Job> make_snapshot_job(const State& state, Operation operation,
                                                     std::vector<std::size_t> signals = {},
                                                     std::size_t device = 0);

}  // namespace stator::web
