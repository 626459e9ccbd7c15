#pragma once

#include "web/job.hpp"
#include "web/routes.hpp"
#include "web/state.hpp"

namespace stator::web {

/// Answers what is asked about the object dictionary of `device`, or writes an entry.
[[nodiscard]] Answer answer_objects(const Match& match, const Request& request,
                                    const DeviceRecord& device);

}  // namespace stator::web
