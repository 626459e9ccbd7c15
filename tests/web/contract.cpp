#include "web/contract.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "stator/base/byte_order.hpp"
#include "stator/web/api/routes.hpp"
#include "web/http_client.hpp"

namespace stator::web {

namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

constexpr std::size_t kShownBytes = 600;

/// Lets objects have no member that is not described, `schema` and all that is in it.
void close(json& schema, const json& document) {
  if (schema.is_object() && schema.contains("allOf")) {
    // Closed, each part would refuse the members of the others.
    for (const json& part : schema["allOf"]) {
      const json& other =
          document.at(json::json_pointer(part.at("$ref").get<std::string>().substr(1)));
      schema["properties"].update(other.at("properties"));
      schema["required"].insert(schema["required"].end(), other.at("required").begin(),
                                other.at("required").end());
    }
    schema.erase("allOf");
  }
  if (schema.is_object() && schema.contains("properties") &&
      !schema.contains("additionalProperties")) {
    schema["additionalProperties"] = false;
  }
  for (json& inner : schema) {
    if (inner.is_structured()) {
      close(inner, document);
    }
  }
}

std::vector<std::string_view> segments(std::string_view path) {
  std::vector<std::string_view> all;
  path = path.substr(0, path.find('?'));
  while (path.starts_with('/')) {
    path.remove_prefix(1);
    const std::size_t end = std::min(path.find('/'), path.size());
    all.push_back(path.substr(0, end));
    path.remove_prefix(end);
  }
  return all;
}

/// In how many segments `target` is what `path` says literally; nothing: it is another path.
std::optional<std::size_t> likeness(std::string_view path, std::string_view target) {
  const auto expected = segments(path);
  const auto given = segments(target);
  if (expected.size() != given.size() || !target.starts_with('/')) {
    return std::nullopt;
  }
  std::size_t literal = 0;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (expected[i] == given[i]) {
      ++literal;
    } else if (!expected[i].starts_with('{') || given[i].empty()) {
      return std::nullopt;
    }
  }
  return literal;
}

std::string media_type(const Answer& answer) {
  const auto found = answer.headers.find("content-type");
  return found == answer.headers.end() ? "" : found->second.substr(0, found->second.find(';'));
}

/// Samples in binary, as docs/how-to/watch-a-rack.md describes them: a header and columns behind
/// it.
std::string violation_of_batch(const std::string& message) {
  constexpr std::size_t kHeader = 24;
  const auto bytes = std::as_bytes(std::span(message));
  if (message.size() < kHeader || !message.starts_with("SSB1") ||
      base::load_le<std::uint32_t>(bytes, 4) != kHeader) {
    return "a binary message begins with \"SSB1\" and the length of its header";
  }
  const std::size_t rows = base::load_le<std::uint32_t>(bytes, 8);
  const std::size_t columns = 1 + std::size_t{base::load_le<std::uint32_t>(bytes, 12)};
  const std::size_t expected = kHeader + rows * columns * 8;
  return message.size() == expected
             ? ""
             : fmt::format("a binary message of {} bytes should have {}", message.size(), expected);
}

}  // namespace

struct Contract::Schemas {
  std::map<std::string, valijson::Schema> parsed;  ///< by the text that was parsed
};

Contract::Contract(const std::string& document)
    : document_(json::parse(document)), schemas_(std::make_unique<Schemas>()) {
  const json open = document_;
  close(document_["components"]["schemas"], open);
}

Contract::~Contract() = default;

const Contract& Contract::own() {
  static const Contract contract(openapi_document());
  return contract;
}

const json* Contract::operation(std::string_view method, std::string_view target) const {
  std::string name(method == "HEAD" ? "GET" : method);
  std::ranges::transform(name, name.begin(), [](unsigned char letter) {
    return static_cast<char>(std::tolower(letter));
  });
  const json* best = nullptr;
  std::size_t most = 0;
  for (const auto& [path, operations] : document_["paths"].items()) {
    const auto literal = likeness(path, target);
    if (literal && operations.contains(name) && (best == nullptr || *literal > most)) {
      best = &operations[name];
      most = *literal;
    }
  }
  return best;
}

std::string Contract::violation(std::string_view method, std::string_view target,
                                const Answer& answer) const {
  const json* described = operation(method, target);
  const json* response = nullptr;
  if (described != nullptr) {
    const json& responses = (*described)["responses"];
    const auto found = responses.find(std::to_string(answer.status));
    response = found != responses.end() ? &*found
               : answer.status >= 400   ? &responses["default"]
                                        : nullptr;
    if (response == nullptr) {
      return fmt::format("status {} is not described", answer.status);
    }
  } else if (answer.status < 400) {
    return fmt::format("status {} where nothing is described", answer.status);
  }
  const json problem = {
      {"application/problem+json", {{"schema", {{"$ref", "#/components/schemas/Problem"}}}}}};
  const json content = response != nullptr ? response->value("content", json::object()) : problem;
  if (content.empty()) {
    return answer.body.empty() ? "" : "a body where none is described";
  }
  const std::string type = media_type(answer);
  const auto media = content.contains(type) ? content.find(type) : content.find("*/*");
  if (media == content.end() || type.empty()) {
    return fmt::format("content type \"{}\" is not described", type);
  }
  if (method == "HEAD" || (type != "application/json" && type != "application/problem+json")) {
    return "";  // no body, or one that has no schema
  }
  const json value = answer.json();
  if (value.is_discarded()) {
    return "the body is no JSON";
  }
  if (content.contains("application/problem+json") && value.value("status", 0) != answer.status) {
    return fmt::format("the body says status {}, the answer {}", value.value("status", 0),
                       answer.status);
  }
  return violation((*media)["schema"], value);
}

std::string Contract::violation(std::string_view target, bool binary,
                                const std::string& message) const {
  const json* described = operation("GET", target);
  const json::json_pointer schema("/responses/101/x-messages/server");
  if (described == nullptr || !described->contains(schema)) {
    return "no WebSocket is described here";
  }
  if (binary) {
    return violation_of_batch(message);
  }
  const json value = json::parse(message, nullptr, false);
  if (value.is_discarded()) {
    return "the message is no JSON";
  }
  return violation(described->at(schema), value);
}

std::string Contract::violation(const json& schema, const json& value) const {
  const std::scoped_lock lock(mutex_);
  const auto [place, fresh] = schemas_->parsed.try_emplace(schema.dump());
  if (fresh) {
    // References are looked up from the root.
    const json root{{"allOf", json::array({schema})}, {"components", document_["components"]}};
    const Adapter adapter(root);
    valijson::SchemaParser().populateSchema(adapter, place->second);
  }
  valijson::ValidationResults results;
  if (valijson::Validator().validate(place->second, Adapter(value), &results)) {
    return "";
  }
  std::string said;
  for (const auto& error : results) {
    std::string where;
    for (const std::string& step : error.context) {
      where += step;
    }
    said += fmt::format("{}: {}\n", where, error.description);
  }
  return said + value.dump(-1, ' ', false, json::error_handler_t::replace).substr(0, kShownBytes);
}

}  // namespace stator::web
