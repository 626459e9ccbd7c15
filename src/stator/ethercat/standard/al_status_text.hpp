#pragma once

#include <string_view>

#include "stator/ethercat/standard/al_state.hpp"

namespace stator::ethercat {

/// The standard's wording for an AL status code (ETG.1020 table 15); "unknown AL status code" for
/// any other number.
[[nodiscard]] std::string_view to_text(AlStatusCode code);

}  // namespace stator::ethercat
