#include "stator/web/api/request_body.hpp"

#include <nlohmann/json.hpp>

#include "stator/web/problem.hpp"

namespace stator::web {

std::variant<nlohmann::ordered_json, Response> member_of(const Request& request,
                                                         const std::string& name) {
  const auto body = nlohmann::ordered_json::parse(request.body, nullptr, false);
  if (!body.is_object() || body.size() != 1 || !body.contains(name)) {
    return problem(400, "the body must be a JSON object with the one member \"" + name + "\"");
  }
  return body[name];
}

}  // namespace stator::web
