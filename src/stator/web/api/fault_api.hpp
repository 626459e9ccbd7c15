#pragma once

#include <nlohmann/json_fwd.hpp>

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Faults: their kinds, those there are, new ones, the end of them.
[[nodiscard]] Answer answer_faults(const Match& match, const Request& request, const State& state);

/// The kinds of faults with their keys, as GET /api/v1/faults/kinds gives them.
[[nodiscard]] nlohmann::ordered_json fault_kinds_json();

}  // namespace stator::web
