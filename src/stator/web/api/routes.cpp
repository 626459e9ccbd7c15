#include "stator/web/api/routes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

#include <fmt/format.h>

#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

constexpr auto kRoutes = std::to_array<Route>({
    {.operation = Operation::page,
     .method = "GET",
     .path = "/",
     .id = "dashboard",
     .summary = "The dashboard, a page for people",
     .schema = "",
     .open = true,
     .content_type = "text/html; charset=utf-8",
     .kept = true},
    {.operation = Operation::asset,
     .method = "GET",
     .path = "/assets/{file}",
     .id = "dashboardFile",
     .summary = "What the dashboard consists of",
     .schema = "",
     .open = true,
     .content_type = "*/*",
     .kept = true},
    {.operation = Operation::health,
     .method = "GET",
     .path = "/healthz",
     .id = "health",
     .summary = "\"ok\" while the rack's threads serve requests",
     .schema = "",
     .open = true,
     .content_type = "text/plain; charset=utf-8"},
    {.operation = Operation::metrics,
     .method = "GET",
     .path = "/metrics",
     .id = "metrics",
     .summary = "Counters and all signals as OpenMetrics text",
     .schema = "",
     .content_type = "application/openmetrics-text; version=1.0.0; charset=utf-8"},
    {.operation = Operation::openapi,
     .method = "GET",
     .path = "/openapi.json",
     .id = "openapi",
     .summary = "This document",
     .schema = "Any"},
    {.operation = Operation::rack,
     .method = "GET",
     .path = "/api/v1/rack",
     .id = "getRack",
     .summary = "The rack: its clock, its networks and what they have done so far",
     .schema = "Rack"},
    {.operation = Operation::keys,
     .method = "GET",
     .path = "/api/v1/keys",
     .id = "listKeys",
     .summary = "All keys of rack files with range, unit, default and meaning, as a JSON schema: "
                "what editors check and forms are made from",
     .schema = "Any"},
    {.operation = Operation::rack_file,
     .method = "GET",
     .path = "/api/v1/rack/file",
     .id = "getRackFile",
     .summary = "The rack file of this run, as it was when the run began",
     .schema = "RackFile"},
    {.operation = Operation::run_rack,
     .method = "PUT",
     .path = "/api/v1/rack/file",
     .id = "runRack",
     .summary = "Runs another rack instead of this one, or this one again if that cannot start; "
                "its text is kept in a new file beside the present one; links and this server "
                "are gone meanwhile",
     .schema = "RackPath",
     .request_schema = "RackText"},
    {.operation = Operation::check_rack,
     .method = "POST",
     .path = "/api/v1/rack/check",
     .id = "checkRack",
     .summary = "Tells what is wrong with the text of a rack file, as \"stator check\" does; the "
                "running rack is not touched",
     .schema = "RackCheck",
     .request_schema = "RackText"},
    {.operation = Operation::devices,
     .method = "GET",
     .path = "/api/v1/devices",
     .id = "listDevices",
     .summary = "All devices with their state",
     .schema = "Devices"},
    {.operation = Operation::device,
     .method = "GET",
     .path = "/api/v1/devices/{device}",
     .id = "getDevice",
     .summary = "One device",
     .schema = "Device"},
    {.operation = Operation::signals,
     .method = "GET",
     .path = "/api/v1/signals",
     .id = "listSignals",
     .summary = "Signals with their present values; as a WebSocket: a stream of samples and events",
     .schema = "Signals",
     .query = {"names", "string", "Patterns separated by commas, * for any run of characters"},
     .server_messages = "SignalMessage",
     .client_messages = "Subscription"},
    {.operation = Operation::inputs,
     .method = "GET",
     .path = "/api/v1/inputs",
     .id = "listInputs",
     .summary = "What can be set around the devices, with its range",
     .schema = "Inputs"},
    {.operation = Operation::input,
     .method = "GET",
     .path = "/api/v1/inputs/{input}",
     .id = "getInput",
     .summary = "One input",
     .schema = "Input"},
    {.operation = Operation::set_input,
     .method = "PUT",
     .path = "/api/v1/inputs/{input}",
     .id = "setInput",
     .summary = "Sets an input to a value within its range",
     .schema = "Done",
     .request_schema = "InputValue"},
    {.operation = Operation::objects,
     .method = "GET",
     .path = "/api/v1/devices/{device}/objects",
     .id = "listObjects",
     .summary = "The declarations of a device's object dictionary",
     .schema = "Objects"},
    {.operation = Operation::object,
     .method = "GET",
     .path = "/api/v1/devices/{device}/objects/{index}",
     .id = "readObject",
     .summary = "One object with the values of all entries; the index is hexadecimal",
     .schema = "Object"},
    {.operation = Operation::entry,
     .method = "GET",
     .path = "/api/v1/devices/{device}/objects/{index}/{subindex}",
     .id = "readEntry",
     .summary = "One entry with its value; index and subindex are hexadecimal",
     .schema = "Entry"},
    {.operation = Operation::write_entry,
     .method = "PUT",
     .path = "/api/v1/devices/{device}/objects/{index}/{subindex}",
     .id = "writeEntry",
     .summary = "Writes one entry with all checks of an SDO",
     .schema = "Done",
     .request_schema = "EntryValue"},
    {.operation = Operation::events,
     .method = "GET",
     .path = "/api/v1/events",
     .id = "listEvents",
     .summary = "The newest events, oldest first",
     .schema = "Events",
     .query = {"after", "integer", "Only events with a higher number"}},
    {.operation = Operation::recording,
     .method = "GET",
     .path = "/api/v1/recording",
     .id = "getRecording",
     .summary = "The recording of this run",
     .schema = "Recording"},
    {.operation = Operation::start_recording,
     .method = "POST",
     .path = "/api/v1/recording",
     .id = "startRecording",
     .summary = "Has the rack begin anew at power-on, recorded into a new file NAME.stator; links "
                "and this server are gone meanwhile",
     .schema = "Done",
     .request_schema = "SnapshotName"},
    {.operation = Operation::stop_recording,
     .method = "DELETE",
     .path = "/api/v1/recording",
     .id = "stopRecording",
     .summary = "Ends the recording; the rack goes on",
     .schema = "Done"},
    {.operation = Operation::recording_content,
     .method = "GET",
     .path = "/api/v1/recording/content",
     .id = "getRecordingContent",
     .summary = "A piece of the recording's file, 1 MiB at most; an empty one is behind its end",
     .schema = "",
     .query = {"from", "integer", "Where the piece begins, in bytes"},
     .content_type = "application/octet-stream"},
    {.operation = Operation::snapshots,
     .method = "GET",
     .path = "/api/v1/snapshots",
     .id = "listSnapshots",
     .summary = "Moments of the recording that can be restored",
     .schema = "Snapshots"},
    {.operation = Operation::take_snapshot,
     .method = "POST",
     .path = "/api/v1/snapshots",
     .id = "takeSnapshot",
     .summary = "Gives the present moment a name",
     .schema = "Done",
     .request_schema = "SnapshotName"},
    {.operation = Operation::restore_snapshot,
     .method = "POST",
     .path = "/api/v1/snapshots/{snapshot}/restore",
     .id = "restoreSnapshot",
     .summary = "Has the rack go on from a snapshot; links and this server are gone meanwhile",
     .schema = "Done"},
    {.operation = Operation::wiring,
     .method = "GET",
     .path = "/api/v1/wiring",
     .id = "getWiring",
     .summary = "How devices are wired, which links are up, and what ports have counted",
     .schema = "Wiring"},
    {.operation = Operation::connections,
     .method = "GET",
     .path = "/api/v1/connections",
     .id = "listConnections",
     .summary = "How masters and other programs reach each link of this rack: lines to paste, with "
                "its own interfaces, addresses, paths and identifiers",
     .schema = "Connections"},
    {.operation = Operation::panel,
     .method = "GET",
     .path = "/api/v1/devices/{device}/panel",
     .id = "getPanel",
     .summary = "What a device shows: LEDs, state machines, what it refused last",
     .schema = "Panel"},
    {.operation = Operation::state_machines,
     .method = "GET",
     .path = "/api/v1/state-machines",
     .id = "listStateMachines",
     .summary = "States and transitions of the state machines that panels name",
     .schema = "StateMachines"},
    {.operation = Operation::program,
     .method = "GET",
     .path = "/api/v1/devices/{device}/program",
     .id = "getProgram",
     .summary = "The TMCL program of a device, and where it stands",
     .schema = "Program"},
    {.operation = Operation::traffic,
     .method = "GET",
     .path = "/api/v1/traffic",
     .id = "watchTraffic",
     .summary = "As a WebSocket: what passes over the networks, in words",
     .schema = "",
     .status = 101,
     .server_messages = "TrafficMessage",
     .client_messages = "TrafficFilter"},
    {.operation = Operation::fault_kinds,
     .method = "GET",
     .path = "/api/v1/faults/kinds",
     .id = "listFaultKinds",
     .summary = "What can go wrong on demand, with the parameters of each kind",
     .schema = "FaultKinds"},
    {.operation = Operation::faults,
     .method = "GET",
     .path = "/api/v1/faults",
     .id = "listFaults",
     .summary = "Faults that wait or are active, and the last ones that are over",
     .schema = "Faults"},
    {.operation = Operation::inject_fault,
     .method = "POST",
     .path = "/api/v1/faults",
     .id = "injectFault",
     .summary = "Arms a fault, given by the keys of a [[fault]] of a rack file",
     .schema = "FaultNumber",
     .request_schema = "FaultRequest",
     .status = 201},
    {.operation = Operation::clear_fault,
     .method = "DELETE",
     .path = "/api/v1/faults/{fault}",
     .id = "clearFault",
     .summary = "Ends a fault, or takes it back if it waits",
     .schema = "Cleared"},
    {.operation = Operation::clear_faults,
     .method = "DELETE",
     .path = "/api/v1/faults",
     .id = "clearFaults",
     .summary = "Ends all faults",
     .schema = "Cleared"},
    {.operation = Operation::manual,
     .method = "GET",
     .path = "/api/v1/devices/{device}/manual",
     .id = "getManualControl",
     .summary = "Manual control of a device: how it stands, and what its axes tell",
     .schema = "ManualControl"},
    {.operation = Operation::begin_manual,
     .method = "PUT",
     .path = "/api/v1/devices/{device}/manual",
     .id = "beginManualControl",
     .summary =
         "Has a small master inside Stator take a device into operation, to move its axes by "
         "hand; it steps aside when another master speaks",
     .schema = "ManualControl"},
    {.operation = Operation::command_axis,
     .method = "POST",
     .path = "/api/v1/devices/{device}/manual/{axis}",
     .id = "commandAxis",
     .summary = "Has an axis under manual control do something; what came of it is in the device's "
                "manual control a moment later",
     .schema = "ManualControl",
     .request_schema = "ManualCommand"},
    {.operation = Operation::end_manual,
     .method = "DELETE",
     .path = "/api/v1/devices/{device}/manual",
     .id = "endManualControl",
     .summary = "Gives a device back: its axes lose their current",
     .schema = "ManualControl"},
});

std::optional<unsigned> hex_digit(char letter) {
  if (letter >= '0' && letter <= '9') {
    return static_cast<unsigned>(letter - '0');
  }
  if (letter >= 'a' && letter <= 'f') {
    return static_cast<unsigned>(letter - 'a') + 10;
  }
  if (letter >= 'A' && letter <= 'F') {
    return static_cast<unsigned>(letter - 'A') + 10;
  }
  return std::nullopt;
}

/// Resolves %XX (RFC 3986 §2.1). Nothing: it is malformed or hides a control character.
std::optional<std::string> decode(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char letter = text[i];
    if (letter == '%') {
      const bool complete = i + 2 < text.size();
      const auto high = complete ? hex_digit(text[i + 1]) : std::nullopt;
      const auto low = complete ? hex_digit(text[i + 2]) : std::nullopt;
      if (!high || !low) {
        return std::nullopt;
      }
      letter = static_cast<char>(*high << 4U | *low);
      i += 2;
    }
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F) {
      return std::nullopt;
    }
    decoded += letter;
  }
  return decoded;
}

std::vector<std::string_view> segments(std::string_view path) {
  std::vector<std::string_view> all;
  while (!path.empty()) {
    path.remove_prefix(1);  // the slash
    const std::size_t end = std::min(path.find('/'), path.size());
    all.push_back(path.substr(0, end));
    path.remove_prefix(end);
  }
  return all;
}

bool fits(std::string_view pattern, const std::vector<std::string_view>& path,
          std::vector<std::string>& parameters) {
  const std::vector<std::string_view> expected = segments(pattern);
  if (expected.size() != path.size()) {
    return false;
  }
  parameters.clear();
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (expected[i].starts_with('{')) {
      auto decoded = decode(path[i]);
      if (!decoded || decoded->empty()) {
        return false;
      }
      parameters.push_back(std::move(*decoded));
    } else if (expected[i] != path[i]) {
      return false;
    }
  }
  return true;
}

/// The value of `name` in a query, decoded; empty: none.
std::string query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    if (pair.starts_with(name) && pair.substr(name.size()).starts_with('=')) {
      return decode(pair.substr(name.size() + 1)).value_or("");
    }
  }
  return {};
}

}  // namespace

std::span<const Route> routes() {
  return kRoutes;
}

std::variant<Match, Response> find_route(const Request& request) {
  const std::string_view target(request.target);
  const std::size_t mark = std::min(target.find('?'), target.size());
  const std::string_view path = target.substr(0, mark);
  if (!path.starts_with('/')) {
    return problem(400, "the request's target must be a path, e.g. /api/v1/rack");
  }
  const std::vector<std::string_view> parts = segments(path);
  const std::string_view method =
      request.method == "HEAD" ? std::string_view("GET") : std::string_view(request.method);
  Match match;
  std::string allowed;
  for (const Route& route : kRoutes) {
    if (!fits(route.path, parts, match.parameters)) {
      continue;
    }
    if (route.method == method) {
      match.route = &route;
      if (!route.query.name.empty() && mark < target.size()) {
        match.query = query_value(target.substr(mark + 1), route.query.name);
      }
      return match;
    }
    allowed += (allowed.empty() ? "" : ", ") + std::string(route.method);
    allowed += route.method == "GET" ? ", HEAD" : "";
  }
  if (allowed.empty()) {
    return problem(404, "there is nothing at this path; /openapi.json tells all there are");
  }
  Response response = problem(405, fmt::format("this path takes {}", allowed));
  response.headers.emplace_back("Allow", allowed);
  return response;
}

}  // namespace stator::web
