#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "web/job.hpp"
#include "web/routes.hpp"
#include "web/state.hpp"

namespace stator::web {

/// Tells what the rack, its devices or its signals are at one moment, as `operation` wants it.
/// `signals` are read, numbers in State::signals(); `device` is the one asked for.
[[nodiscard]] std::unique_ptr<Job> make_snapshot_job(const State& state, Operation operation,
                                                     std::vector<std::size_t> signals = {},
                                                     std::size_t device = 0);

}  // namespace stator::web
