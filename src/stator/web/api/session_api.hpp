#pragma once

#include <string_view>

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/session_control.hpp"

namespace stator::web {

/// Whether a snapshot may be called that: 1 to 64 letters of ASCII, digits, "-" and "_", no digit
/// first, since "5s" is a time.
[[nodiscard]] bool is_snapshot_name(std::string_view text);

/// What is recorded, and snapshots in it; `control` is null if nothing is recorded.
[[nodiscard]] Answer answer_session(const Match& match, const Request& request,
                                    SessionControl* control);

}  // namespace stator::web
