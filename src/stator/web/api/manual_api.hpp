#pragma once

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Manual control of `device`: begins, ends, a command for an axis, and how it stands.
[[nodiscard]] Answer answer_manual(const Match& match, const Request& request, const State& state,
                                   const DeviceRecord& device);

}  // namespace stator::web
