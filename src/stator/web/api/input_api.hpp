#pragma once

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Answers what is asked about the inputs of devices, or sets one.
[[nodiscard]] Answer answer_inputs(const Match& match, const Request& request, const State& state);

}  // namespace stator::web
