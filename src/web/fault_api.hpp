#pragma once

#include "web/job.hpp"
#include "web/routes.hpp"
#include "web/state.hpp"

namespace stator::web {

/// Faults: their kinds, those there are, new ones, the end of them.
[[nodiscard]] Answer answer_faults(const Match& match, const Request& request, const State& state);

}  // namespace stator::web
