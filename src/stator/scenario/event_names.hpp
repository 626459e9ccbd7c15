#pragma once

#include <span>
#include <string_view>

namespace stator::scenario {

/// The names of all events that rooms of Stator tell, sorted; made from the sources when these are
/// built.
[[nodiscard]] std::span<const std::string_view> event_names();

}  // namespace stator::scenario
