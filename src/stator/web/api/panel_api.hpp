#pragma once

#include <memory>

#include "stator/web/job.hpp"
#include "stator/web/state.hpp"

namespace stator::web {

/// Tells what somebody in front of `device` sees and wants to know: its LEDs, where its state
/// machines stand, and what it refused last.
[[nodiscard]] std::unique_ptr<Job> make_panel_job(const State& state, const DeviceRecord& device);

}  // namespace stator::web
