#pragma once

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// The rack file of the run, what is wrong with a text that could be another, and running it.
[[nodiscard]] Answer answer_rack_file(const Match& match, const Request& request,
                                      const State& state);

}  // namespace stator::web
