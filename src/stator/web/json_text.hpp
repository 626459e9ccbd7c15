#pragma once

#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

#include "stator/web/message.hpp"

namespace stator::web {

/// `value` as UTF-8 text; bytes that are no UTF-8, as a device's strings may have, are replaced.
[[nodiscard]] inline std::string text_of(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

[[nodiscard]] inline Response json_response(const nlohmann::ordered_json& value) {
  return {.body = text_of(value)};
}

/// JSON has no infinity and no NaN: null instead.
[[nodiscard]] inline nlohmann::ordered_json finite(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

}  // namespace stator::web
