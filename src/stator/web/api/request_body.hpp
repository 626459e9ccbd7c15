#pragma once

#include <string>
#include <variant>

#include <nlohmann/json_fwd.hpp>

#include "stator/web/message.hpp"

namespace stator::web {

/// The one member that a body has, or the answer that says what is wrong with it.
[[nodiscard]] std::variant<nlohmann::ordered_json, Response> member_of(const Request& request,
                                                                       const std::string& name);

}  // namespace stator::web
