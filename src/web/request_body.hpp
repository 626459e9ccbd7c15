#pragma once

#include <variant>

#include <nlohmann/json_fwd.hpp>

#include "web/message.hpp"

namespace stator::web {

/// The member "value" of a body, or the answer that says what is wrong with it.
[[nodiscard]] std::variant<nlohmann::ordered_json, Response> value_of(const Request& request);

}  // namespace stator::web
