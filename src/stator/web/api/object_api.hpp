#pragma once

#include "stator/web/api/routes.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Answers what is asked about the object dictionary of `device`, or writes an entry.
[[nodiscard]] Answer answer_objects(const Match& match, const Request& request,
                                    const DeviceRecord& device);

}  // namespace stator::web
