#pragma once

#include <memory>

#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Lists the TMCL program in the memory of `device`, and where it stands.
[[nodiscard]] std::unique_ptr<Job> make_program_job(const DeviceRecord& device);

}  // namespace stator::web
