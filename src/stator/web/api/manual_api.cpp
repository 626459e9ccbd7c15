#include "stator/web/api/manual_api.hpp"

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/manual/manual_control.hpp"
#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

std::string_view name_of(manual::Phase phase) {
  switch (phase) {
    case manual::Phase::off:
      return "off";
    case manual::Phase::starting:
      return "starting";
    case manual::Phase::active:
      return "active";
    case manual::Phase::ended:
      break;
  }
  return "ended";
}

template <typename Number>
Json or_null(const std::optional<Number>& number) {
  return number ? Json(*number) : Json(nullptr);
}

Json axis_json(const manual::AxisRecord& axis) {
  Json commands = Json::array();
  for (const manual::CommandKind kind : axis.description.commands) {
    commands.push_back(manual::name_of(kind));
  }
  const manual::AxisStatus& status = axis.status;
  const std::optional<product::MotionUnits>& units = axis.description.units;
  return {{"commands", std::move(commands)},
          {"modes", axis.description.modes},
          {"profile_velocity", finite(axis.description.velocity)},
          {"position_per_revolution", units ? Json(units->position) : Json(nullptr)},
          {"velocity_per_revolution", units ? Json(units->velocity) : Json(nullptr)},
          {"state", status.state},
          {"enabled", status.enabled},
          {"fault", status.fault},
          {"reached", status.reached},
          {"position", finite(status.position)},
          {"velocity", finite(status.velocity)},
          {"statusword", or_null(status.statusword)},
          {"controlword", or_null(status.controlword)},
          {"error_code", or_null(status.error_code)},
          {"mode", or_null(status.mode)},
          {"executed", axis.executed},
          {"refusal", axis.refusal}};
}

Response status_of(const manual::ManualControl& control, const DeviceRecord& device) {
  const manual::DeviceStatus status = control.status(device.address);
  const std::string impediment = control.impediment(device.address);
  Json axes = Json::array();
  for (const manual::AxisRecord& axis : status.axes) {
    axes.push_back(axis_json(axis));
  }
  return json_response({{"device", device.name},
                        {"available", impediment.empty()},
                        {"phase", name_of(status.phase)},
                        {"text", impediment.empty() ? status.text : impediment},
                        {"axes", std::move(axes)}});
}

/// An integer member of `body` that need not be there; the answer if it is something else.
std::optional<Response> read_integer(const Json& body, const char* name,
                                     std::optional<std::int64_t>& value) {
  if (!body.contains(name)) {
    return std::nullopt;
  }
  if (!body[name].is_number_integer()) {
    return problem(422, fmt::format("\"{}\" is a whole number in the device's own units", name));
  }
  value = body[name].get<std::int64_t>();
  return std::nullopt;
}

bool takes_value(manual::CommandKind kind) {
  using enum manual::CommandKind;
  return kind == jog || kind == move || kind == mode || kind == controlword;
}

std::variant<manual::Command, Response> read_command(const Request& request) {
  const auto body = Json::parse(request.body, nullptr, false);
  if (!body.is_object() || !body.contains("command") || !body["command"].is_string()) {
    return problem(400, "the body must be a JSON object with the member \"command\"");
  }
  for (const auto& [name, value] : body.items()) {
    if (name != "command" && name != "value" && name != "relative" && name != "velocity") {
      return problem(
          422,
          fmt::format(R"(a command has "command", "value", "relative" and "velocity", not "{}")",
                      name));
    }
  }
  const auto kind = manual::command_of(body["command"].get<std::string>());
  if (!kind) {
    return problem(422, fmt::format("there is no command \"{}\"; there are {}",
                                    body["command"].get<std::string>(),
                                    fmt::join(manual::command_names(), ", ")));
  }
  manual::Command command{.kind = *kind};
  std::optional<std::int64_t> value;
  std::optional<std::int64_t> velocity;
  if (auto wrong = read_integer(body, "value", value)) {
    return *wrong;
  }
  if (auto wrong = read_integer(body, "velocity", velocity)) {
    return *wrong;
  }
  if (takes_value(*kind) != value.has_value()) {
    return problem(422, fmt::format(R"("{}" {} a "value")", manual::name_of(*kind),
                                    takes_value(*kind) ? "needs" : "takes no"));
  }
  command.value = value.value_or(0);
  if (velocity && (*velocity < 1 || *velocity > std::numeric_limits<std::int32_t>::max())) {
    return problem(422, "\"velocity\" is a number from 1 to 2147483647");
  }
  if (velocity) {
    command.velocity = static_cast<std::uint32_t>(*velocity);
  }
  if (body.contains("relative")) {
    if (!body["relative"].is_boolean()) {
      return problem(422, "\"relative\" is true or false");
    }
    command.relative = body["relative"].get<bool>();
  }
  return command;
}

}  // namespace

Answer answer_manual(const Match& match, const Request& request, const State& state,
                     const DeviceRecord& device) {
  if (state.manual == nullptr) {
    return problem(409, "this rack is served without manual control");
  }
  manual::ManualControl& control = *state.manual;
  base::Expected<void, std::string> done;
  switch (match.route->operation) {
    case Operation::begin_manual:
      done = control.start(device.address);
      break;
    case Operation::end_manual:
      control.release(device.address);
      break;
    case Operation::command_axis: {
      std::size_t axis = 0;
      const std::string& text = match.parameters[1];
      const auto read = std::from_chars(text.data(), text.data() + text.size(), axis);
      if (read.ec != std::errc() || read.ptr != text.data() + text.size()) {
        return problem(404, "an axis is named by its number, from 0 on");
      }
      const auto command = read_command(request);
      if (const auto* wrong = std::get_if<Response>(&command)) {
        return *wrong;
      }
      done = control.command(device.address, axis, std::get<manual::Command>(command));
      break;
    }
    default:
      break;
  }
  return done ? status_of(control, device) : problem(409, device.name + ": " + done.error());
}

}  // namespace stator::web
