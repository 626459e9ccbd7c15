#pragma once

#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/link/ethernet/link_address.hpp"

namespace stator::cli {

/// Reads the duration given with option `name`. Throws Failure if `text` is none or not positive.
[[nodiscard]] base::SimDuration duration_option(const std::string& name, const std::string& text);

/// The link as the command line names it. Throws Failure naming the forms there are.
[[nodiscard]] link::LinkAddress link_of(const std::string& text);

}  // namespace stator::cli
