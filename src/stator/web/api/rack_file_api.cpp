#include "stator/web/api/rack_file_api.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/rack/file/rack_check.hpp"
#include "stator/web/api/request_body.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

RackFileControl::File file_of(const State& state) {
  if (state.rack_file != nullptr) {
    return state.rack_file->file();
  }
  RackFileControl::File none;
  none.fixed = "the program that runs this rack has no rack file of it";
  return none;
}

Response tell_file(const State& state) {
  const RackFileControl::File file = file_of(state);
  return json_response({{"path", file.path},
                        {"text", file.text},
                        {"changes", file.changes},
                        {"fixed", file.fixed},
                        {"refusal", file.refusal}});
}

rack::RackCheck check_text(const std::string& text, const State& state) {
  const RackFileControl::File file = file_of(state);
  return rack::check_rack_text(text, file.path.empty() ? "rack.toml" : file.path, state.catalogue,
                               file.changes);
}

Response tell_check(const rack::RackCheck& check) {
  Json errors = Json::array();
  for (const settings::Problem& error : check.errors) {
    errors.push_back({{"file", error.file()},
                      {"line", error.line()},
                      {"column", error.column()},
                      {"key", error.key()},
                      {"message", error.reason()}});
  }
  return json_response({{"errors", std::move(errors)}, {"warnings", check.warnings}});
}

/// The files that a run of the rack writes.
std::vector<std::string> outputs_of(const rack::RackConfiguration& configuration) {
  std::vector<std::string> files{configuration.state};
  for (const rack::SegmentConfiguration& segment : configuration.segments) {
    files.push_back(segment.capture);
  }
  for (const rack::BusConfiguration& bus : configuration.buses) {
    files.push_back(bus.log);
    files.push_back(bus.capture);
  }
  if (configuration.record) {
    files.push_back(configuration.record->file);
  }
  std::erase(files, "");
  return files;
}

/// Whoever has the token may change what runs, not which files the program overwrites.
std::string new_output(const rack::RackConfiguration& wanted,
                       const rack::RackConfiguration& present) {
  const std::vector<std::string> known = outputs_of(present);
  for (std::string& file : outputs_of(wanted)) {
    if (std::ranges::find(known, file) == known.end()) {
      return std::move(file);
    }
  }
  return {};
}

Response run_text(const std::string& text, const State& state) {
  if (const std::string fixed = file_of(state).fixed; !fixed.empty()) {
    return problem(409, fixed);
  }
  const rack::RackCheck check = check_text(text, state);
  if (!check.configuration) {
    return problem(422, check.errors.front().text());
  }
  if (const std::string file = new_output(*check.configuration, state.configuration());
      !file.empty()) {
    return problem(
        422, fmt::format("the running rack does not write to \"{}\", and a rack that is run over "
                         "the web writes to no other places than the one before; take it out, or "
                         "start this rack with \"stator run\"",
                         file));
  }
  const auto path = state.rack_file->replace(text);
  return path ? json_response({{"path", *path}}) : problem(409, path.error());
}

}  // namespace

Answer answer_rack_file(const Match& match, const Request& request, const State& state) {
  const Operation operation = match.route->operation;
  if (operation == Operation::rack_file) {
    return tell_file(state);
  }
  const auto value = member_of(request, "text");
  if (const auto* wrong = std::get_if<Response>(&value)) {
    return *wrong;
  }
  const Json& given = std::get<Json>(value);
  if (!given.is_string()) {
    return problem(422, "\"text\" is the text of a rack file");
  }
  const auto& text = given.get_ref<const std::string&>();
  return operation == Operation::check_rack ? tell_check(check_text(text, state))
                                            : run_text(text, state);
}

}  // namespace stator::web
