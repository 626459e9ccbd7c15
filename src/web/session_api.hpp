#pragma once

#include "web/job.hpp"
#include "web/routes.hpp"
#include "web/session_control.hpp"

namespace stator::web {

/// What is recorded, and snapshots in it; `control` is null if nothing is recorded.
[[nodiscard]] Answer answer_session(const Match& match, const Request& request,
                                    SessionControl* control);

}  // namespace stator::web
