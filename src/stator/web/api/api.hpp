#pragma once

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Answers a request that the guard has let pass: at once, or by a job for the rack. Changes
/// nothing but `state`.
[[nodiscard]] Answer answer(const Match& match, const Request& request, State& state);

}  // namespace stator::web
