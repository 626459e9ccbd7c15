#include "stator/cli/client/fault_keys.hpp"

#include <algorithm>
#include <cstdlib>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/base/spelling.hpp"
#include "stator/cli/failure.hpp"
#include "stator/rack/faults/fault_kinds.hpp"

namespace stator::cli {

namespace {

using rack::FaultKind;
using rack::FaultParameter;
using rack::FaultValueType;

constexpr std::string_view kMilestone = "when.";

const FaultParameter* find_in(std::span<const FaultParameter> keys, std::string_view name) {
  const auto found = std::ranges::find(keys, name, &FaultParameter::name);
  return found == keys.end() ? nullptr : &*found;
}

const FaultParameter* find_key(const FaultKind& kind, std::string_view name) {
  if (name.starts_with(kMilestone)) {
    return find_in(rack::milestone_keys(), name.substr(kMilestone.size()));
  }
  for (const auto keys :
       {kind.parameters, rack::target_keys(kind.scope), rack::common_fault_keys()}) {
    if (const FaultParameter* found = find_in(keys, name)) {
      return found;
    }
  }
  return nullptr;
}

const FaultKind& require_kind(const std::string& name) {
  if (const FaultKind* kind = rack::find_fault_kind(name)) {
    return *kind;
  }
  std::vector<std::string_view> names;
  for (const FaultKind& kind : rack::fault_kinds()) {
    names.push_back(kind.name);
  }
  const std::string_view guess = base::closest_match(name, names);
  throw Failure(fmt::format(R"(there is no kind of fault "{}"{}; "stator faults" lists all)", name,
                            guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess)));
}

/// What is no number stays a text, and the server says what is wrong with it.
nlohmann::json value_of(const std::string& text, const FaultParameter* key) {
  const bool number =
      key != nullptr && (key->type == FaultValueType::whole || key->type == FaultValueType::number);
  if (!number || text.empty()) {
    return text;
  }
  char* end = nullptr;
  const long long whole = std::strtoll(text.c_str(), &end, 0);
  if (*end == '\0') {
    return static_cast<std::int64_t>(whole);
  }
  const double value = std::strtod(text.c_str(), &end);
  return *end == '\0' ? nlohmann::json(value) : nlohmann::json(text);
}

}  // namespace

nlohmann::json fault_of_words(const std::string& kind_name, const std::vector<std::string>& words) {
  const FaultKind& kind = require_kind(kind_name);
  nlohmann::json fault{{"kind", kind.name}};
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Failure(
          fmt::format("\"{}\" is no KEY=VALUE, e.g. count=3; \"stator faults {}\" lists "
                      "the keys",
                      word, kind.name));
    }
    const std::string name = word.substr(0, equals);
    nlohmann::json value = value_of(word.substr(equals + 1), find_key(kind, name));
    if (name.starts_with(kMilestone)) {
      fault["when"][name.substr(kMilestone.size())] = std::move(value);
    } else {
      fault[name] = std::move(value);
    }
  }
  return fault;
}

}  // namespace stator::cli
