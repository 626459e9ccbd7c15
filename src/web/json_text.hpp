#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace stator::web {

/// `value` as UTF-8 text; bytes that are no UTF-8, as a device's strings may have, are replaced.
[[nodiscard]] inline std::string text_of(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace stator::web
