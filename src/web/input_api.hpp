#pragma once

#include "web/job.hpp"
#include "web/routes.hpp"
#include "web/state.hpp"

namespace stator::web {

/// Answers what is asked about the inputs of devices, or sets one.
[[nodiscard]] Answer answer_inputs(const Match& match, const Request& request, const State& state);

}  // namespace stator::web
