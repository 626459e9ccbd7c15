#pragma once

#include <nlohmann/json.hpp>

#include "web/state.hpp"

namespace stator::web {

/// An event as answers and streams show it: the schema "Event" of the OpenAPI document.
[[nodiscard]] nlohmann::ordered_json to_json(const EventRecord& event);

}  // namespace stator::web
