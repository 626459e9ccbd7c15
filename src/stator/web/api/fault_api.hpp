#pragma once

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Faults: their kinds, those there are, new ones, the end of them.
[[nodiscard]] Answer answer_faults(const Match& match, const Request& request, const State& state);

}  // namespace stator::web
