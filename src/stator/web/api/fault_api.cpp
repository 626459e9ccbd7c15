#include "stator/web/api/fault_api.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/rack/core/rack.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/faults/reached_inputs.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kCreated = 201;

std::string_view json_type(rack::FaultValueType type) {
  return type == rack::FaultValueType::whole ? "integer" : to_text(type);
}

/// All keys of a kind but those of its target and of the table "when".
std::vector<rack::FaultParameter> keys_of(const rack::FaultKind& kind) {
  std::vector<rack::FaultParameter> keys(kind.parameters.begin(), kind.parameters.end());
  for (const rack::FaultParameter& key : rack::common_fault_keys()) {
    const bool of_counting = key.name == "count" || key.name == "probability" || key.name == "seed";
    const bool fits = key.name != "when" && !(kind.momentary && key.name == "for") &&
                      !(kind.counted.empty() && of_counting);
    if (fits) {
      keys.push_back(key);
    }
  }
  return keys;
}

Json parameters_json(std::span<const rack::FaultParameter> parameters) {
  Json all = Json::array();
  for (const rack::FaultParameter& parameter : parameters) {
    const bool ranged = parameter.type != rack::FaultValueType::text &&
                        parameter.type != rack::FaultValueType::choice;
    Json choices = Json::array();
    std::string_view words = parameter.choices;
    while (!words.empty()) {
      const std::size_t end = std::min(words.find(' '), words.size());
      choices.push_back(words.substr(0, end));
      words.remove_prefix(std::min(end + 1, words.size()));
    }
    all.push_back({{"name", parameter.name},
                   {"type", json_type(parameter.type)},
                   {"unit", parameter.unit},
                   {"minimum", ranged ? Json(parameter.minimum) : Json(nullptr)},
                   {"maximum", ranged ? Json(parameter.maximum) : Json(nullptr)},
                   {"choices", std::move(choices)},
                   {"default", parameter.default_value},
                   {"needed", parameter.needed},
                   {"summary", parameter.summary}});
  }
  return all;
}

/// The inputs that faults of a kind can set, and with which keys.
Json inputs_json(const rack::FaultKind& kind) {
  Json all = Json::array();
  for (const rack::ReachedInput& input : rack::inputs_reached_by(kind)) {
    Json keys = Json::object();
    for (const auto& [name, value] : input.keys) {
      const auto* const number = std::get_if<std::int64_t>(&value);
      keys[std::string(name)] =
          number != nullptr ? Json(*number) : Json(std::get<std::string>(value));
    }
    all.push_back(
        {{"name", input.name}, {"of_peripheral", input.of_peripheral}, {"keys", std::move(keys)}});
  }
  return all;
}

template <typename Value>
Json nanoseconds(const std::optional<Value>& value) {
  if (!value) {
    return nullptr;
  }
  return value->nanoseconds();
}

Json fault_json(const rack::FaultStatus& fault) {
  return {{"id", fault.id},
          {"name", fault.name},
          {"kind", fault.kind},
          {"target", fault.target},
          {"state", to_text(fault.state)},
          {"remaining", fault.remaining},
          {"remaining_ns", nanoseconds(fault.remaining_time)},
          {"remaining_count", fault.remaining_count ? Json(*fault.remaining_count) : Json(nullptr)},
          {"hits", fault.hits},
          {"begun_ns", nanoseconds(fault.begun)},
          {"ended_ns", nanoseconds(fault.ended)}};
}

class ListFaultsJob final : public LookJob {
 public:
  bool look(const rack::View& rack, base::SimTime now) override {
    time_ = now;
    faults_ = rack.faults(now);
    return true;
  }
  Response response() override {
    Json all = Json::array();
    for (const rack::FaultStatus& fault : faults_) {
      all.push_back(fault_json(fault));
    }
    return json_response({{"time_ns", time_.nanoseconds()}, {"faults", std::move(all)}});
  }

 private:
  base::SimTime time_;
  std::vector<rack::FaultStatus> faults_;
};

class InjectJob final : public ActJob {
 public:
  explicit InjectJob(rack::FaultConfiguration fault) : fault_(std::move(fault)) {}

  bool act(rack::Rack& rack, base::SimTime now) override {
    const auto armed = rack.inject(fault_, now);
    if (armed) {
      id_ = *armed;
    } else {
      problem_ = armed.error();
    }
    return true;
  }
  Response response() override {
    if (!problem_.empty()) {
      return problem(422, problem_);
    }
    Response created = json_response({{"id", id_}});
    created.status = kCreated;
    return created;
  }

 private:
  rack::FaultConfiguration fault_;
  std::uint64_t id_ = 0;
  std::string problem_;
};

class ClearJob final : public ActJob {
 public:
  /// Nothing: all of them.
  explicit ClearJob(std::optional<std::uint64_t> id) : id_(id) {}

  bool act(rack::Rack& rack, base::SimTime now) override {
    time_ = now;
    cleared_ = rack.clear_faults(id_, now);
    return true;
  }
  Response response() override {
    if (id_ && cleared_ == 0) {
      return problem(404, fmt::format("there is no fault {}; /api/v1/faults lists all", *id_));
    }
    return json_response({{"time_ns", time_.nanoseconds()}, {"cleared", cleared_}});
  }

 private:
  std::optional<std::uint64_t> id_;
  base::SimTime time_;
  std::size_t cleared_ = 0;
};

/// A JSON object as an inline table of a rack file, whose texts and numbers are written alike.
/// Empty: there is something in it that a rack file cannot say.
std::string toml_of(const Json& value) {
  if (value.is_null() || value.is_array()) {
    return "";
  }
  if (!value.is_object()) {
    return value.dump();
  }
  std::string text;
  for (const auto& [key, member] : value.items()) {
    const std::string inner = toml_of(member);
    if (inner.empty()) {
      return "";
    }
    text += (text.empty() ? "" : ", ") + Json(key).dump() + " = " + inner;
  }
  return "{" + text + "}";
}

Answer inject(const Request& request, const State& state) {
  const Json body = Json::parse(request.body, nullptr, false);
  if (!body.is_object()) {
    return problem(400, "the body must be a JSON object with the keys of a [[fault]]");
  }
  std::string text;
  for (const auto& [name, member] : body.items()) {
    // An [[event]] of a rack file names what happens by "action"; clients may write a fault alike.
    const std::string key = name == "action" && !body.contains("kind") ? "kind" : name;
    const std::string value = toml_of(member);
    if (value.empty()) {
      return problem(422, fmt::format("\"{}\" must be a text, a number or an object", key));
    }
    text += Json(key).dump() + " = " + value + "\n";
  }
  try {
    return std::make_unique<InjectJob>(rack::parse_fault(text, state.configuration()));
  } catch (const std::exception& error) {
    return problem(422, error.what());
  }
}

Answer clear(const std::string& text) {
  std::uint64_t id = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, id);
  if (result.ec != std::errc() || result.ptr != end) {
    return problem(400, "a fault is named by its number, as /api/v1/faults lists it");
  }
  return std::make_unique<ClearJob>(id);
}

}  // namespace

nlohmann::ordered_json fault_kinds_json() {
  Json kinds = Json::array();
  for (const rack::FaultKind& kind : rack::fault_kinds()) {
    kinds.push_back({{"name", kind.name},
                     {"summary", kind.summary},
                     {"effect", kind.effect},
                     {"applies_to", to_text(kind.scope)},
                     {"counts", kind.counted},
                     {"momentary", kind.momentary},
                     {"target", parameters_json(rack::target_keys(kind.scope))},
                     {"parameters", parameters_json(keys_of(kind))},
                     {"inputs", inputs_json(kind)}});
  }
  return {{"kinds", std::move(kinds)}, {"when", parameters_json(rack::milestone_keys())}};
}

Answer answer_faults(const Match& match, const Request& request, const State& state) {
  switch (match.route->operation) {
    case Operation::fault_kinds:
      return json_response(fault_kinds_json());
    case Operation::inject_fault:
      return inject(request, state);
    case Operation::clear_fault:
      return clear(match.parameters[0]);
    case Operation::clear_faults:
      return std::make_unique<ClearJob>(std::nullopt);
    default:
      return std::make_unique<ListFaultsJob>();
  }
}

}  // namespace stator::web
