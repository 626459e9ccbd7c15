#include "web/request_body.hpp"

#include <nlohmann/json.hpp>

#include "web/problem.hpp"

namespace stator::web {

std::variant<nlohmann::ordered_json, Response> value_of(const Request& request) {
  const auto body = nlohmann::ordered_json::parse(request.body, nullptr, false);
  if (!body.is_object() || body.size() != 1 || !body.contains("value")) {
    return problem(400, "the body must be a JSON object with the one member \"value\"");
  }
  return body["value"];
}

}  // namespace stator::web
